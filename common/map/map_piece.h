#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <set>
#include <span>
#include <vector>

#include "common/base/result.h"
#include "common/geometry/rigid3.h"
#include "common/map/atlas.h"
#include "common/map/ids.h"
#include "common/map/keyframe.h"
#include "common/map/landmark.h"

namespace pangaea {

struct PieceKeyframe {
  KeyframeId id;
  Rigid3d camera_from_map;
  std::uint64_t corrected_at = 0;  // as Keyframe::corrected_at, and so is the scale
  double scale = 1.0;
  std::shared_ptr<const KeyframeData> data;  // nullptr where the receiver holds it
};

struct PieceLandmark {
  LandmarkId id;
  Eigen::Vector3d point_in_map = Eigen::Vector3d::Zero();
  KeyframeId reference;  // one of the observers below; none where there are none
  // By keyframes of the piece, all of them, ascending: a keyframe of the piece that is not among these does not observe
  // it. Empty for a landmark that only moved.
  std::vector<Observation> observations;
};

struct FusedLandmark {
  LandmarkId absorbed;
  LandmarkId kept;
  bool operator==(const FusedLandmark&) const = default;
};

// Part of one map of the server's atlas as it is, in absolute numbers: what an agent is sent, be it a correction of its
// own keyframes, those of other sessions around its camera (its guests), or the place where it was found again.
// What the receiver has and the piece does not list has not changed: keyframes keep their pose, landmarks keep their
// coordinates in the camera frame of their reference keyframe (so list those that do not, and those whose reference is
// another than the receiver knows).
struct MapPiece {
  MapId map;
  std::vector<MapId> merged;             // maps that were merged into it and forward to it, ascending
  std::vector<PieceKeyframe> keyframes;  // ascending by id
  std::vector<PieceLandmark> landmarks;  // ascending by id
  std::vector<FusedLandmark> fused;      // each absorbed landmark once
  std::vector<LandmarkId> removed;       // landmarks that are gone
  std::vector<KeyframeId> culled;        // keyframes that are gone

  bool empty() const;
};

// What of an atlas a piece is made of. Ids that are not alive, or are of another map, are left out.
struct PieceSelection {
  MapId map;
  std::vector<KeyframeId> keyframes;
  std::set<KeyframeId> held;  // of these the receiver has the data
  std::vector<LandmarkId> landmarks;
  // As in the piece. Landmarks fused into something that is gone count as removed; ids that are alive are left out.
  std::vector<LandmarkId> former_landmarks;
  std::vector<KeyframeId> culled;
};
MapPiece CutPiece(const Atlas& atlas, const PieceSelection& selection);
// The landmarks that at least one of the keyframes observes, ascending.
std::vector<LandmarkId> LandmarksOf(const Atlas& atlas, std::span<const KeyframeId> keyframes);

// Several pieces, which share one table of sessions.
std::vector<std::byte> EncodePieces(std::span<const MapPiece> pieces);
// Any bytes give an error, or pieces that encode to what they mean: ids that can be, finite poses and points, orders as
// above, observations of keyframes of the same piece alone. Whether they fit an atlas is judged by who applies them.
Result<std::vector<MapPiece>> DecodePieces(std::span<const std::byte> bytes);

}  // namespace pangaea
