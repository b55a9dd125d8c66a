#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "agent/mapping/local_mapping_options.h"
#include "common/map/atlas.h"
#include "common/map/edits/edits.h"

namespace pangaea {

// New landmarks on trial: which of the later keyframes should have seen them, and which did. Kept here, not in the map:
// it is scratch of the mapper.
class LandmarkTrials {
 public:
  explicit LandmarkTrials(const LandmarkCullingOptions& options) : options_(options) {}

  // A trial begins for every AddLandmark among `edits`.
  void Begin(std::span<const MapEdit> edits);
  // One more keyframe has been mapped: where it should see a landmark on trial (by projection), that is a chance.
  void CountChances(const Atlas& atlas, const Keyframe& keyframe, double max_view_angle);
  // Ends the trials that are decided and removes the landmarks that failed.
  std::vector<MapEdit> Judge(const Atlas& atlas);

  std::size_t size() const { return trials_.size(); }

 private:
  struct Trial {
    LandmarkId landmark;
    std::uint32_t keyframes = 0;  // mapped since its creation
    std::uint32_t chances = 0;    // of those, in how many it should be visible
    std::uint32_t found = 0;      // of those chances, in how many it was observed
  };
  enum class Verdict { kOpen, kTrusted, kFailed };
  Verdict JudgeOne(const Atlas& atlas, const Landmark& landmark, const Trial& trial) const;

  LandmarkCullingOptions options_;
  std::vector<Trial> trials_;  // in order of creation
};

}  // namespace pangaea
