#pragma once

#include <Eigen/Core>
#include <map>
#include <utility>
#include <vector>

#include "common/geometry/similarity3.h"
#include "common/map/atlas.h"
#include "common/map/edits/edits.h"
#include "common/map/id_set.h"
#include "server/optimization/correction.h"

namespace pangaea {

// A weld in the making: what changes the structure of the atlas, and apart from it what moves in it. The first can be
// applied to an atlas that has moved on, the second has to be rebased.
class WeldingDraft {
 public:
  explicit WeldingDraft(const Atlas& snapshot) : base_(snapshot), welded_(snapshot) {}

  // Before anything else.
  void Merge(const MergeMaps& edit);
  // Edits that move nothing. Those that do not fit are left out.
  void Change(const MapEdit& edit);
  void Change(const std::vector<MapEdit>& edits);
  // Moves keyframes and landmarks as they are moved by a similarity of the map's frame.
  void Transform(const std::vector<KeyframeId>& keyframes, const std::vector<LandmarkId>& landmarks,
                 const Similarity3d& target_from_map);
  // Landmarks that are not named follow their reference keyframe.
  void Move(const std::vector<std::pair<KeyframeId, Rigid3d>>& camera_from_map,
            std::vector<std::pair<LandmarkId, Eigen::Vector3d>> point_in_map);

  void MovePoint(LandmarkId id, const Eigen::Vector3d& point_in_map);

  // The snapshot; of a merge, with it and nothing else.
  const Atlas& base() const { return base_; }
  // With all that has been changed and moved.
  const Atlas& welded() const { return welded_; }
  const std::vector<MapEdit>& edits() const { return edits_; }
  // What moved, against the base.
  Correction Moves(MapId map) const;

 private:
  Atlas base_;
  Atlas welded_;
  std::vector<MapEdit> edits_;
  std::map<KeyframeId, double> moved_keyframes_;  // and by how much the lengths around them were scaled
  LandmarkIdSet moved_landmarks_;
};

}  // namespace pangaea
