#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "common/base/result.h"
#include "common/geometry/similarity3.h"
#include "common/map/atlas.h"

namespace pangaea {

// The checks that the kinds of edit have in common. Messages name the id and what is wrong with it.

// An id that may be created: a counter from 1 to its limit.
Status CheckNewId(KeyframeId id);
Status CheckNewId(LandmarkId id);
Status CheckNewId(MapId id);
// An id that is alive, forwarded or gone here.
Status CheckKnown(const Atlas& atlas, KeyframeId id);
Status CheckKnown(const Atlas& atlas, LandmarkId id);
// Finite, lengths up to kMaxLength.
Status CheckPose(const Rigid3d& pose);
Status CheckSimilarity(const Similarity3d& similarity);
// Of a keyframe, from 1 / kMaxTotalScale to kMaxTotalScale.
bool IsTotalScale(double scale);
// Finite, not farther than kMaxLength.
Status CheckPoint(const Eigen::Vector3d& point);
// Also in front of the camera.
Status CheckPointInCamera(const Eigen::Vector3d& point_in_camera);
// Finite, within kMaxVergence.
Status CheckVergence(double vergence);
// A camera that can be and features that it can have seen.
Status CheckKeyframeData(const KeyframeData& data);
Status CheckKeypoint(const Keyframe& keyframe, std::uint32_t keypoint);
// A keypoint of the keyframe that observes nothing.
Status CheckFreeKeypoint(const Keyframe& keyframe, std::uint32_t keypoint);

}  // namespace pangaea
