#include "server/place_recognition/place_view.h"

#include <algorithm>
#include <unordered_map>

#include "common/base/check.h"
#include "common/map/covisibility.h"

namespace pangaea {
namespace {

constexpr std::size_t kUsualLandmarks = 2000;

class ViewBuilder {
 public:
  ViewBuilder(const Atlas& atlas, const Keyframe& center) : atlas_(atlas), center_(center) {
    view_.map = center.map;
    view_.landmark_at.assign(center.landmarks.size(), PlaceView::kNone);
    view_.grid = FeatureGrid(center.data->features.keypoints);
    index_.reserve(kUsualLandmarks);
    AddObserver(center);
    view_.central = view_.landmarks.size();
  }

  void AddObserver(const Keyframe& keyframe) {
    const Rigid3d camera_from_center = keyframe.camera_from_map * center_.camera_from_map.Inverse();
    const auto observer = static_cast<std::uint32_t>(view_.observers.size());
    view_.observers.push_back(
        {keyframe.id, keyframe.data, camera_from_center, camera_from_center.Inverse().translation()});
    for (std::uint32_t keypoint = 0; keypoint < keyframe.landmarks.size(); ++keypoint) {
      if (keyframe.landmarks[keypoint].valid()) AddLandmark(keyframe, keypoint, observer);
    }
  }

  PlaceView Finish() { return std::move(view_); }

 private:
  void AddLandmark(const Keyframe& keyframe, std::uint32_t keypoint, std::uint32_t observer) {
    const LandmarkId id = keyframe.landmarks[keypoint];
    const PlaceSighting sighting{observer, keypoint};
    const auto [entry, is_new] = index_.emplace(id, static_cast<std::uint32_t>(view_.landmarks.size()));
    if (!is_new) {
      PlaceLandmark& known = view_.landmarks[entry->second];
      if (Offset(observer) > Offset(known.far.observer)) known.far = sighting;
      return;
    }
    const Landmark* landmark = atlas_.FindLandmark(id);
    PANGAEA_CHECK(landmark != nullptr);
    if (observer == 0) view_.landmark_at[keypoint] = entry->second;
    view_.landmarks.push_back({id, center_.camera_from_map * landmark->point_in_map, sighting, sighting});
    view_.keypoints.push_back(keyframe.data->features.keypoints[keypoint]);
    view_.descriptors.push_back(keyframe.data->features.descriptors[keypoint]);
  }

  double Offset(std::uint32_t observer) const { return view_.observers[observer].position.squaredNorm(); }

  const Atlas& atlas_;
  const Keyframe& center_;
  PlaceView view_;
  std::unordered_map<LandmarkId, std::uint32_t> index_;  // into the view's landmarks
};

}  // namespace

LandmarkAppearances OwnAppearances(const Keyframe& keyframe) {
  LandmarkAppearances own;
  const Features& features = keyframe.data->features;
  for (std::size_t i = 0; i < keyframe.landmarks.size(); ++i) {
    if (!keyframe.landmarks[i].valid()) continue;
    own.keypoints.push_back(features.keypoints[i]);
    own.descriptors.push_back(features.descriptors[i]);
  }
  return own;
}

PlaceView MakePlaceView(const Atlas& atlas, std::span<const KeyframeId> keyframes) {
  PANGAEA_CHECK(!keyframes.empty());
  ViewBuilder builder(atlas, *atlas.FindKeyframe(keyframes.front()));
  for (const KeyframeId id : keyframes.subspan(1)) builder.AddObserver(*atlas.FindKeyframe(id));
  return builder.Finish();
}

PlaceView MakePlaceView(const Atlas& atlas, const Keyframe& keyframe, std::size_t covisible) {
  std::vector<KeyframeId> keyframes = {keyframe.id};
  for (const Covisibility& edge : CovisibleKeyframes(atlas, keyframe.id)) {
    if (keyframes.size() > covisible) break;
    keyframes.push_back(edge.keyframe);
  }
  return MakePlaceView(atlas, keyframes);
}

}  // namespace pangaea
