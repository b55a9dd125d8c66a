#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "agent/tracking/guided_search.h"
#include "agent/tracking/local_map.h"
#include "agent/tracking/place_memory.h"
#include "agent/tracking/pose_observability.h"
#include "agent/tracking/template_store.h"
#include "common/mapping/relocalization.h"

namespace pangaea {

struct RecognitionOptions {
  std::size_t place_candidates = 8;  // keyframes of all maps that look like the frame by their words
  std::size_t local_candidates = 4;  // keyframes around the latest known place, whatever they look like
  // Keyframes around a candidate, itself included, whose landmarks a lost frame is compared with where no candidate's
  // own lead to a place.
  std::size_t window = 6;
  std::size_t verified = 3;              // of the poses these give, the best so many are tried in the map around them
  std::size_t learned_per_snapshot = 8;  // keyframes whose words are computed at once, see PlaceMemory::Follow
  RelocalizationOptions relocalization;
  GuidedSearchOptions guided;
};

// A frame found without any prediction, and the local map of the place, which its matches refer to.
struct RecognisedFrame {
  MapId map;
  LocatedFrame located;
  LocalMap local_map;
};

// Finds frames by what they look like in all maps of the agent (Elvira et al. 2019, section "Relocalization in multiple
// maps"): words → candidate keyframes → three-point RANSAC → guided search → pose. Deterministic by its seed. Belongs
// to one thread.
class Recognition {
 public:
  Recognition(const IdealCamera& camera, const RecognitionOptions& options,
              std::shared_ptr<const VocabularyTree> vocabulary, std::uint64_t seed);

  // The atlas is the newest snapshot: keyframes of earlier ones are recognised.
  void Follow(const Atlas& atlas) { memory_.Follow(atlas, options_.learned_per_snapshot); }

  // What a found pose must satisfy.
  using Trust = std::function<bool(const LocatedFrame&, const LocalMap&)>;
  // How the landmarks around a keyframe are collected.
  using Surroundings = std::function<LocalMap(KeyframeId)>;

  // The candidates by words among those that `admits` (empty: all), then `nearby`, up to the options' numbers.
  std::vector<KeyframeId> Candidates(const Features& features, std::span<const KeyframeId> nearby,
                                     const InvertedIndex::Admits& admits = {}) const;
  // The pose that the landmarks around the keyframe give, looked for where a rough pose in its map expects them;
  // nothing where it is not trusted.
  std::optional<RecognisedFrame> LocateNear(const Features& features, const Atlas& atlas, KeyframeId keyframe,
                                            const Rigid3d& rough_camera_from_map, const Surroundings& surroundings,
                                            const Trust& trust) const;
  // The first trusted pose that a candidate's own landmarks lead to, those on most matches first.
  std::optional<RecognisedFrame> Locate(const Features& features, const Atlas& atlas,
                                        std::span<const KeyframeId> candidates, const Surroundings& surroundings,
                                        const Trust& trust) const;
  // Or else one that those of its window lead to. For frames that are lost: it takes longer.
  std::optional<RecognisedFrame> LocateWidely(const Features& features, const Atlas& atlas,
                                              std::span<const KeyframeId> candidates, const Surroundings& surroundings,
                                              const Trust& trust) const;

 private:
  std::optional<RecognisedFrame> LocateBy(std::size_t window, const Features& features, const Atlas& atlas,
                                          std::span<const KeyframeId> candidates, const Surroundings& surroundings,
                                          const Trust& trust) const;

  IdealCamera camera_;
  RecognitionOptions options_;
  std::uint64_t seed_;
  PlaceMemory memory_;
};

}  // namespace pangaea
