#pragma once

#include <optional>

#include "agent/tracking/local_map.h"
#include "agent/tracking/patch_search.h"
#include "common/mapping/guided_location.h"

namespace pangaea {

// Looks for the local map's landmarks among a frame's features, where a rough pose expects them, and refines the pose
// on them. Needs no templates: this is how a place is entered whose images are long gone, or that somebody else saw.
// `local_map` was collected from `atlas`. Nothing when there is no pose on options.refinement.min_inliers.
std::optional<LocatedFrame> LocateByDescriptors(const IdealCamera& camera, const Features& features, const Atlas& atlas,
                                                const Rigid3d& rough_camera_from_map, const LocalMap& local_map,
                                                const GuidedSearchOptions& options);

}  // namespace pangaea
