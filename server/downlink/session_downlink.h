#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <vector>

#include "common/map/atlas.h"
#include "common/wire/agent_correction.h"
#include "common/wire/map_interest.h"
#include "server/downlink/guest_choice.h"
#include "server/downlink/piece_changes.h"

namespace pangaea {

// The server's state as far as one session is concerned.
struct SessionView {
  const Atlas& atlas;
  std::uint64_t position = 0;      // of the journal
  std::uint64_t correction = 0;    // of the newest edits of the server's own
  std::uint64_t acknowledged = 0;  // the session's newest envelope in it
};

// What one agent has to be told of the atlas: what the server changed of its keyframes and landmarks, and the keyframes
// around its camera that are of other sessions or that it has forgotten. One correction at a time: what comes up until
// the agent has applied it goes into the next one, so that an agent that is slow, or a time of many changes, costs one
// correction and not many. A value without a clock or a network.
class SessionDownlink {
 public:
  SessionDownlink(SessionId session, const GuestOptions& options) : session_(session), options_(options) {}

  // An agent that says nothing gets nothing.
  void Take(const MapInterest& interest);
  // The agent was lost, and its camera was found to be near to that keyframe, whatever its interest says: the next
  // correction tells of the place. Until it was told and the agent's interest names another keyframe than before.
  void Show(KeyframeId place);
  // The correction to send now, without the server's incarnation. Nothing while the last one was not applied, and where
  // the agent knows all that concerns it. Where what it claims to have in common is not so all the same: what changed
  // since it was last told, through other agents; and where that does not help, one that tells everything anew:
  // whatever went wrong, the two agree afterwards.
  std::optional<AgentCorrection> Next(const SessionView& view);
  // What was sent last seems to be lost: Next may say it again.
  void Forget() {
    sent_.reset();
    sent_version_ = confirmed_ ? confirmed_->version : 0;
  }

  bool waits_for_agent() const { return sent_.has_value(); }
  std::uint64_t sent_version() const { return sent_version_; }
  // The newest of the agent's claims that Next found true; 0 before any.
  std::uint64_t agreed_claim() const { return agreed_claim_; }

 private:
  // An atlas that the agent was told of.
  struct Told {
    Atlas atlas;
    std::uint64_t version = 0;
    std::uint64_t position = 0;
    std::uint64_t correction = 0;
    std::vector<KeyframeId> new_guests = {};
    KeyframeId place = {};
    int answers = 0;  // to claims that were wrong, this one included, in a row
  };
  void Confirm();
  std::optional<std::uint64_t> NextVersion(std::uint64_t position) const;
  std::vector<MapId> ConcernedMaps(const Atlas& atlas) const;
  std::vector<KeyframeId> NewGuests(const Atlas& atlas) const;
  bool IsConcerned(const SessionView& view) const;
  // Whether there is a claim that was not found true yet, of the very state that the view shows.
  bool IsClaimDue(const SessionView& view) const;
  bool IsClaimTrue(const Atlas& atlas) const;
  bool HasPartIn(const Atlas& atlas, MapId map) const;
  bool WasSeparated(const Atlas& atlas, KeyframeId guest) const;
  // Whether the agent has what the keyframe saw.
  bool Holds(KeyframeId id) const;
  // What the agent knows of the server's state: of a complete correction, nothing.
  KnownState Known(bool complete) const;
  MapPiece PieceOf(MapId map, const Atlas& atlas, const std::vector<KeyframeId>& new_guests, bool is_first,
                   bool complete) const;

  SessionId session_;
  GuestOptions options_;
  std::optional<MapInterest> interest_;
  KeyframeId place_;  // where the agent was found
  bool place_told_ = true;
  std::set<KeyframeId> not_wanted_;  // guests that it was given here and did not keep
  std::set<KeyframeId> given_;       // guests that it held at some time: those that it forgot it asks back
  std::optional<Told> sent_;         // and not yet applied
  std::optional<Told> confirmed_;    // the newest applied
  std::uint64_t sent_version_ = 0;
  std::uint64_t agreed_claim_ = 0;
};

}  // namespace pangaea
