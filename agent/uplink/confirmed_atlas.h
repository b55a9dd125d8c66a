#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "common/map/atlas.h"
#include "common/map/edits/edits.h"
#include "common/map/forgetting.h"
#include "common/wire/agent_correction.h"
#include "common/wire/envelope.h"

namespace pangaea {

// What the server truly has of this session: the envelopes it acknowledged and did not reject, in order, by its own
// rule: an envelope counts whole or not at all; and the corrections that this agent absorbed, each at the place between
// two envelopes where the server made it. What the agent forgets, it forgets too, each at the place between two
// envelopes where the agent did: what it says of the rest is true all the same.
class ConfirmedAtlas {
 public:
  // How many edits back a correction may have been made. Seconds pass between a correction's making and its absorption;
  // these are half a minute of mapping (some 400 edits a keyframe), and about 5 MB.
  static constexpr std::size_t kMostRecentEdits = 20'000;

  // The next acknowledged envelope. False where it does not fit: without corrections the server cannot have taken it
  // either, and nothing is changed; with them, what fits is taken. Keyframes that `mirror` has too share their payload
  // with it.
  bool Take(const Envelope& envelope, const Atlas& mirror);

  // The agent has forgotten these when it had made the envelopes up to `sequence`: so does this when it has come as
  // far.
  void Forget(std::uint64_t sequence, std::vector<ForgottenKeyframe> keyframes);
  // Envelopes up to this one are acknowledged, and taken unless they were rejected.
  void ComeTo(std::uint64_t sequence);

  // What `atlas` becomes when the server takes the envelope as well, by the same rule. Whether it fits.
  bool Expect(const Envelope& envelope, const Atlas& mirror, Atlas& atlas) const;

  // Whether that is not too long ago to know.
  bool Reaches(std::uint64_t sequence) const { return sequence >= base_sequence_; }
  // As it was after the envelope of this sequence (or the last before it that was taken); nothing where that is too
  // long ago.
  std::optional<Atlas> At(std::uint64_t sequence);
  // What the server changed when it had the envelopes up to `correction.acknowledged`; those taken since follow on top.
  // False, and nothing changed, where that is too long ago.
  bool Absorb(const AgentCorrection& correction);

  // See common/map/forgetting.h.
  void ShareFrames(const Atlas& snapshot) {
    pangaea::ShareFrames(base_, snapshot);
    pangaea::ShareFrames(atlas_, snapshot);
  }

  const Atlas& atlas() const { return atlas_; }

 private:
  struct Taken {
    std::uint64_t sequence;
    std::vector<MapEdit> edits;
    std::vector<ForgottenKeyframe> forgotten;  // after the edits
  };

  // The edits that fit; nothing where the envelope does not count.
  std::optional<std::vector<MapEdit>> Apply(const Envelope& envelope, const Atlas& mirror, Atlas& atlas,
                                            bool& all_fit) const;
  void Remember(Taken taken);
  static void Replay(const Taken& taken, Atlas& atlas);
  void AdvanceBase();

  Atlas atlas_;
  bool corrected_ = false;
  // How it came to be: `base_` holds everything up to `base_sequence_`, `recent_` what was taken since.
  Atlas base_;
  std::uint64_t base_sequence_ = 0;
  std::deque<Taken> recent_;
  std::size_t recent_edits_ = 0;
  std::uint64_t sequence_ = 0;    // how far it has come
  std::deque<Taken> forgetting_;  // what it will forget later
};

}  // namespace pangaea
