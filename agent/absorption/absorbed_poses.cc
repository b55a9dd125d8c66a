// How keyframes come to where the server has them, and landmarks with them.
#include <unordered_map>

#include "agent/absorption/absorption_draft.h"
#include "common/map/edits/reference_scale.h"
#include "common/map/limits.h"
#include "common/map/spanning_tree.h"

namespace pangaea {
namespace {

struct Destination {
  Rigid3d camera_from_map;
  double scale = 1.0;  // by which lengths around the keyframe are multiplied
  bool moves = false;
  bool corrected = false;  // the server's from now on
};

bool SameBits(const Rigid3d& a, const Rigid3d& b) {
  return a.rotation().coeffs() == b.rotation().coeffs() && a.translation() == b.translation();
}

class Destinations {
 public:
  Destinations(const MapPiece& piece, const AbsorptionDraft& draft)
      : piece_(piece), draft_(draft), before_(draft.atlas()) {}

  // Of a keyframe whose parent was asked about before.
  const Destination& Choose(const Keyframe& keyframe) {
    const PieceKeyframe* listed = FindIn(piece_, keyframe.id);
    const GoneKeyframe* gone = FindGone(piece_, keyframe.id);
    // A guest to be let go takes the frames that hang on it along.
    const bool follows = draft_.IsOwn(keyframe.id) || (gone != nullptr && !gone->camera_from_map);
    Destination chosen = listed != nullptr ? Listed(keyframe, *listed) : Unlisted(keyframe, follows);
    if (gone != nullptr && gone->camera_from_map) chosen = {*gone->camera_from_map, 1.0, true, true};
    chosen.moves = chosen.moves && !(SameBits(chosen.camera_from_map, keyframe.camera_from_map) &&
                                     chosen.scale == 1.0 && chosen.corrected == (keyframe.corrected_at != 0));
    return chosen_[keyframe.id] = chosen;
  }
  const Destination& Of(KeyframeId id) const { return chosen_.at(id); }

 private:
  Destination Listed(const Keyframe& keyframe, const PieceKeyframe& listed) const {
    const double scale = listed.scale / keyframe.scale;
    if (!draft_.IsOwn(keyframe.id) || listed.corrected_at != 0) return {listed.camera_from_map, scale, true, true};
    // Still its agent's to move: what it did since the server was told stays, on top.
    const Keyframe* told = draft_.told().FindKeyframe(keyframe.id);
    if (told == nullptr || SameBits(told->camera_from_map, keyframe.camera_from_map)) {
      return {listed.camera_from_map, scale, true, false};
    }
    const Rigid3d now_from_told = keyframe.camera_from_map * told->camera_from_map.Inverse();
    return {ScaleLengths(now_from_told, scale) * listed.camera_from_map, scale, true, false};
  }

  Destination Unlisted(const Keyframe& keyframe, bool follows) const {
    const Destination stays{keyframe.camera_from_map, 1.0, false, keyframe.corrected_at != 0};
    const Keyframe* parent = follows ? before_.FindKeyframe(keyframe.parent) : nullptr;
    if (parent == nullptr) return stays;
    const auto above = chosen_.find(parent->id);
    if (above == chosen_.end() || !above->second.moves) return stays;
    const Rigid3d camera_from_parent = keyframe.camera_from_map * parent->camera_from_map.Inverse();
    return {ScaleLengths(camera_from_parent, above->second.scale) * above->second.camera_from_map, above->second.scale,
            true, false};
  }

  const MapPiece& piece_;
  const AbsorptionDraft& draft_;
  const Atlas before_;
  std::unordered_map<KeyframeId, Destination> chosen_;
};

void Emit(const std::vector<std::pair<KeyframeId, Rigid3d>>& poses, const Destinations& destinations,
          AbsorptionDraft& draft) {
  if (poses.empty()) return;
  MoveKeyframes edit = MoveKeyframesTo(draft.atlas(), poses);
  edit.correction = draft.input().version;
  for (MovedKeyframe& moved : edit.keyframes) {
    const Destination& destination = destinations.Of(moved.id);
    moved.scale = destination.scale;
    moved.settles = destination.corrected;
    moved.reference_scale = {};  // measured from the references as this very edit leaves them
  }
  draft.Emit(std::move(edit));
}

}  // namespace

std::optional<MovedLandmark> MeasureLandmark(const Atlas& atlas, const Landmark& landmark,
                                             const Eigen::Vector3d& point_in_map) {
  const Eigen::Vector3d point = atlas.FindKeyframe(landmark.reference)->camera_from_map * point_in_map;
  if (!(point.norm() <= kMaxLength)) return std::nullopt;
  return MovedLandmark{landmark.id, point, landmark.reference, {}};
}

void MoveToServersFrame(const MapPiece& piece, MapId host, AbsorptionDraft& draft) {
  const Atlas before = draft.atlas();
  Destinations destinations(piece, draft);
  std::vector<std::pair<KeyframeId, Rigid3d>> moved;
  for (const KeyframeId id : ParentsFirst(before, host)) {
    const Destination& destination = destinations.Choose(*before.FindKeyframe(id));
    if (destination.moves) moved.emplace_back(id, destination.camera_from_map);
  }
  Emit(moved, destinations, draft);
  MoveLandmarks points;
  for (const auto& [id, pose] : moved) {
    const Keyframe& old = *before.FindKeyframe(id);
    const Rigid3d map_from_camera = draft.atlas().FindKeyframe(id)->camera_from_map.Inverse();
    for (const LandmarkId landmark_id : old.landmarks) {
      if (!landmark_id.valid()) continue;
      const Landmark& landmark = *before.FindLandmark(landmark_id);
      if (landmark.reference != id) continue;
      const Eigen::Vector3d in_camera = destinations.Of(id).scale * (old.camera_from_map * landmark.point_in_map);
      if (auto point = MeasureLandmark(draft.atlas(), landmark, map_from_camera * in_camera)) {
        points.landmarks.push_back(*point);
      }
    }
  }
  if (!points.landmarks.empty()) draft.Emit(std::move(points));
}

}  // namespace pangaea
