#include "agent/mapping/map_opening.h"

namespace pangaea {

std::vector<MapEdit> OpenMap(const Atlas& atlas, const MapOpening& opening, LandmarkId first_id) {
  const KeyframeCandidate& first = opening.first;
  const KeyframeCandidate& second = opening.second;
  if (atlas.FindMap(first.map) != nullptr || atlas.Knows(first.id) || atlas.Knows(second.id)) return {};
  std::vector<MapEdit> edits;
  edits.reserve(2 + 2 * opening.points.size());
  edits.push_back(AddKeyframe{.id = first.id,
                              .map = first.map,
                              .parent = {},
                              .camera_from_parent = first.camera_from_reference,
                              .data = first.data});
  edits.push_back(AddKeyframe{.id = second.id,
                              .map = first.map,
                              .parent = first.id,
                              .camera_from_parent = second.camera_from_reference,
                              .data = second.data});
  LandmarkId id = first_id;
  for (const OpeningPoint& point : opening.points) {
    edits.push_back(AddLandmark{
        .id = id, .reference = first.id, .keypoint = point.first_keypoint, .point_in_reference = point.point_in_first});
    edits.push_back(AddObservation{.landmark = id, .keyframe = second.id, .keypoint = point.second_keypoint});
    ++id.counter;
  }
  return edits;
}

}  // namespace pangaea
