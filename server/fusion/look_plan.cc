#include "server/fusion/look_plan.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

namespace pangaea {
namespace {

// This part of the landmarks in view moves with the keyframe; what moves further has moved on its own.
constexpr double kTogether = 0.8;
// By this share a landmark's observers have to have become more, or fewer: then there are views like those of others,
// or none is left that contradicted them.
constexpr double kOtherObservers = 0.25;

// nullptr where there is none.
template <typename States>
auto Find(States& states, const decltype(States::value_type::id)& id) {
  const auto found = std::ranges::lower_bound(states, id, {}, &States::value_type::id);
  return found != states.end() && found->id == id ? &*found : nullptr;
}

// A camera as it was.
class EarlierView {
 public:
  EarlierView(const IdealCamera& camera, const Rigid3d& camera_from_map)
      : camera_(camera),
        rotation_(camera_from_map.rotation().toRotationMatrix()),
        translation_(camera_from_map.translation()) {}

  // From where it saw the point to the pixel; infinite where that was behind it.
  float DistanceTo(const Eigen::Vector2d& pixel, const Eigen::Vector3d& point_in_map) const {
    const Eigen::Vector3d point = rotation_ * point_in_map + translation_;
    if (point.z() <= 0.0) return std::numeric_limits<float>::infinity();
    return static_cast<float>((camera_.Project(point) - pixel).norm());
  }

 private:
  const IdealCamera& camera_;
  Eigen::Matrix3d rotation_;
  Eigen::Vector3d translation_;
};

class LookPlanner {
 public:
  LookPlanner(const Atlas& atlas, LookedAtMap now, const LookedAtMap& before, const LandmarkIndex& index)
      : atlas_(atlas), before_(before), index_(index), now_(std::move(now)) {
    for (const PlacedLandmark& landmark : index.landmarks()) {
      const auto* known = Find(before.landmarks, landmark.id);
      places_.push_back({known != nullptr, 0.0F, known != nullptr ? known->point_in_map : landmark.point_in_map});
    }
  }

  LookPlan Make(double tolerance, const std::stop_token& stop) && {
    for (LookedAtMap::KeyframeState& keyframe : now_.keyframes) {
      if (stop.stop_requested()) break;
      ChooseKeyframe(0.5 * tolerance, keyframe);
    }
    for (std::size_t place = 0; place < places_.size(); ++place) {
      const PlacedLandmark& placed = index_.landmarks()[place];
      LookedAtMap::LandmarkState& landmark = *Find(now_.landmarks, placed.id);
      if (IsChanged(landmark, places_[place], 0.5 * tolerance)) plan_.landmarks.push_back(placed);
    }
    plan_.after = std::move(now_);
    return std::move(plan_);
  }

 private:
  struct Place {
    bool known;
    float apart;  // how far it has moved on its own, at most (pixels)
    Eigen::Vector3d point_before;
  };

  void ChooseKeyframe(double limit, LookedAtMap::KeyframeState& keyframe) {
    const auto* before = Find(before_.keyframes, keyframe.id);
    if (before != nullptr) {
      keyframe.crept = before->crept + MotionSince(*before, keyframe);
      if (keyframe.crept <= limit) return;
      keyframe.crept = 0.0;
      for (const LandmarkId landmark : atlas_.FindKeyframe(keyframe.id)->landmarks) {
        if (landmark.valid()) taken_along_.insert(landmark);
      }
    }
    plan_.keyframes.insert(keyframe.id);
  }

  bool IsChanged(LookedAtMap::LandmarkState& landmark, const Place& place, double limit) const {
    if (!place.known) return true;
    const auto* before = Find(before_.landmarks, landmark.id);
    const double change = std::abs(static_cast<double>(landmark.observers) - before->observers);
    if (change > kOtherObservers * before->observers || taken_along_.contains(landmark.id)) return true;
    const float crept = before->crept + place.apart;
    if (crept > limit) return true;
    // Both as when it was last looked for: small changes add up.
    landmark.crept = crept;
    landmark.observers = before->observers;
    return false;
  }

  // What most in view have moved by at most, in pixels. The rest of it is put down to the landmarks.
  double MotionSince(const LookedAtMap::KeyframeState& before, const LookedAtMap::KeyframeState& now) {
    const IdealCamera& camera = atlas_.FindKeyframe(now.id)->data->camera;
    const EarlierView earlier(camera, before.camera_from_map);
    moved_.clear();
    for (const PlaceInView& seen : index_.PlacesInView(Viewpoint(camera, now.camera_from_map))) {
      const Place& place = places_[seen.place];
      if (place.known) moved_.emplace_back(earlier.DistanceTo(seen.pixel, place.point_before), seen.place);
    }
    if (moved_.empty()) return 0.0;
    const auto most = static_cast<std::size_t>(kTogether * static_cast<double>(moved_.size() - 1));
    std::ranges::nth_element(moved_, moved_.begin() + static_cast<std::ptrdiff_t>(most));
    const float motion = moved_[most].first;
    for (std::size_t i = most + 1; i < moved_.size(); ++i) {
      float& apart = places_[moved_[i].second].apart;
      apart = std::max(apart, moved_[i].first - motion);
    }
    return motion;
  }

  const Atlas& atlas_;
  const LookedAtMap& before_;
  const LandmarkIndex& index_;
  std::vector<Place> places_;                           // as the index has them
  std::vector<std::pair<float, std::uint32_t>> moved_;  // scratch: of what is in view
  std::unordered_set<LandmarkId> taken_along_;          // by keyframes that moved
  LookedAtMap now_;
  LookPlan plan_;
};

}  // namespace

LookPlan PlanLook(const Atlas& atlas, LookedAtMap now, const LookedAtMap& before, const LandmarkIndex& index,
                  double tolerance, const std::stop_token& stop) {
  return LookPlanner(atlas, std::move(now), before, index).Make(tolerance, stop);
}

}  // namespace pangaea
