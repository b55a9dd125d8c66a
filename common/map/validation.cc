#include "common/map/validation.h"

#include <cmath>
#include <string>

#include "common/map/edits/reference_scale.h"
#include "common/map/limits.h"

namespace pangaea {
namespace {

template <typename Tag>
Status CheckCounter(Id<Tag> id, std::uint32_t max, const char* what) {
  if (id.session != 0 && id.counter >= 1 && id.counter <= max) return {};
  return Fail(ErrorCode::kInvalidArgument, std::string(what) + " " + ToString(id) +
                                               ": it must have a session and a counter of 1 to " + std::to_string(max));
}

Status Invalid(const std::string& what) { return Fail(ErrorCode::kInvalidArgument, what); }

bool IsWithin(const Eigen::Vector3d& vector, double limit) { return vector.norm() <= limit; }  // false for NaN

bool IsUnit(const Eigen::Quaterniond& rotation) { return std::abs(rotation.norm() - 1.0) <= 1e-6; }

Status CheckCamera(const IdealCamera& camera) {
  const bool sized =
      camera.width > 0 && camera.height > 0 && camera.width <= kMaxImageSide && camera.height <= kMaxImageSide;
  if (!sized) return Invalid("camera: width and height must be 1 to " + std::to_string(kMaxImageSide) + " pixels");
  const auto is_focal = [](double focal) { return focal > 0.0 && focal <= kMaxLength; };
  if (!is_focal(camera.focal_x) || !is_focal(camera.focal_y)) return Invalid("camera: focal lengths must be positive");
  if (!(std::abs(camera.center_x) <= kMaxLength) || !(std::abs(camera.center_y) <= kMaxLength)) {
    return Invalid("camera: the centre is not finite");
  }
  if (!(camera.baseline >= 0.0) || !(camera.baseline <= kMaxLength)) return Invalid("camera: negative baseline");
  return {};
}

// A whole multiple of the quantum within [0, limit).
bool IsPixel(float value, int limit) {
  const float counts = value / kPixelQuantum;
  return value >= 0.0F && value < static_cast<float>(limit) && counts == std::floor(counts);
}

bool IsKeypoint(const Keypoint& keypoint, const IdealCamera& camera) {
  const bool right = keypoint.u_right == -1.0F || (camera.is_stereo() && IsPixel(keypoint.u_right, camera.width));
  return right && IsPixel(keypoint.u, camera.width) && IsPixel(keypoint.v, camera.height) && keypoint.octave < kOctaves;
}

}  // namespace

Status CheckNewId(KeyframeId id) { return CheckCounter(id, kMaxKeyframeCounter, "keyframe"); }
Status CheckNewId(LandmarkId id) { return CheckCounter(id, kMaxLandmarkCounter, "landmark"); }
Status CheckNewId(MapId id) { return CheckCounter(id, kMaxMapCounter, "map"); }

Status CheckKnown(const Atlas& atlas, KeyframeId id) {
  if (atlas.Knows(id)) return {};
  return Fail(ErrorCode::kNotFound, "unknown keyframe " + ToString(id));
}

Status CheckKnown(const Atlas& atlas, LandmarkId id) {
  if (atlas.Knows(id)) return {};
  return Fail(ErrorCode::kNotFound, "unknown landmark " + ToString(id));
}

Status CheckPose(const Rigid3d& pose) {
  if (!IsUnit(pose.rotation())) return Invalid("a pose's rotation is not a unit quaternion");
  if (!IsWithin(pose.translation(), kMaxLength)) return Invalid("a pose's translation is not finite or too long");
  return {};
}

Status CheckSimilarity(const Similarity3d& similarity) {
  if (!(similarity.scale() <= kMaxScale) || !(similarity.scale() >= 1.0 / kMaxScale)) {
    return Invalid("a similarity's scale is out of range");
  }
  if (!IsUnit(similarity.rotation()) || !IsWithin(similarity.translation(), kMaxLength)) {
    return Invalid("a similarity is not finite or too long");
  }
  return {};
}

bool IsTotalScale(double scale) { return scale >= 1.0 / kMaxTotalScale && scale <= kMaxTotalScale; }

Status CheckPoint(const Eigen::Vector3d& point) {
  if (IsWithin(point, kMaxLength)) return {};
  return Invalid("a landmark is not finite or too far");
}

Status CheckPointInCamera(const Eigen::Vector3d& point_in_camera) {
  if (auto status = CheckPoint(point_in_camera); !status) return status;
  if (!(point_in_camera.z() > 0.0)) return Invalid("a landmark is behind its reference camera");
  return {};
}

Status CheckVergence(double vergence) {
  if (std::abs(vergence) <= kMaxVergence) return {};  // false for NaN
  return Invalid("a vergence must be within " + std::to_string(kMaxVergence) + " rad of the calibration");
}

Status CheckArrival(const KeyframeData& data) {
  const TrackedArrival& arrival = data.arrival;
  if (!arrival.reference.valid()) return {};
  if (auto status = CheckNewId(arrival.reference); !status) return status;
  if (auto status = CheckPose(arrival.camera_from_reference); !status) return status;
  if (auto status = CheckScale({arrival.reference_scale}); !status) return status;
  if (arrival.since_ns < data.stamp_ns) return {};
  return Invalid("a keyframe that arrived before the one before it");
}

Status CheckKeyframeData(const KeyframeData& data) {
  if (auto status = CheckCamera(data.camera); !status) return status;
  if (auto status = CheckVergence(data.vergence); !status) return status;
  if (auto status = CheckArrival(data); !status) return status;
  const auto& keypoints = data.features.keypoints;
  if (keypoints.size() > kMaxKeypoints) return Invalid("more than " + std::to_string(kMaxKeypoints) + " keypoints");
  if (data.features.descriptors.size() != keypoints.size())
    return Invalid("keypoints and descriptors differ in number");
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    if (IsKeypoint(keypoints[i], data.camera)) continue;
    return Invalid("keypoint " + std::to_string(i) + " is outside the image, unquantised or of an impossible octave");
  }
  return {};
}

Status CheckKeypoint(const Keyframe& keyframe, std::uint32_t keypoint) {
  if (keypoint < keyframe.landmarks.size()) return {};
  return Invalid("keyframe " + ToString(keyframe.id) + " has no keypoint " + std::to_string(keypoint));
}

Status CheckFreeKeypoint(const Keyframe& keyframe, std::uint32_t keypoint) {
  if (auto status = CheckKeypoint(keyframe, keypoint); !status) return status;
  if (!keyframe.landmarks[keypoint].valid()) return {};
  return Fail(ErrorCode::kRefused, "keypoint " + std::to_string(keypoint) + " of keyframe " + ToString(keyframe.id) +
                                       " observes landmark " + ToString(keyframe.landmarks[keypoint]) + " already");
}

}  // namespace pangaea
