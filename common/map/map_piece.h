#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
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
  // it. Empty where none of them does any more.
  std::vector<Observation> observations;
};

struct GoneKeyframe {
  KeyframeId id;
  // Where it would be: late edits measure from it. None where its map is gone, too, and for a guest that lives in a map
  // which has nothing to do with the receiver any more: it goes with the keyframe it hangs on, and then away.
  std::optional<Rigid3d> camera_from_map;
};

struct FusedLandmark {
  LandmarkId absorbed;
  LandmarkId kept;
  bool operator==(const FusedLandmark&) const = default;
};

// Part of one map of the server's atlas as it is, in absolute numbers: what an agent is sent, be it a correction of its
// own keyframes, those of other sessions around its camera (its guests), or the place where it was found again.
// What the receiver has and the piece does not list follows what is: keyframes of its own session their parent,
// landmarks their reference keyframe; everything else stays. So where any keyframe of the receiver's session moved,
// list all of them (60 bytes each): some arrived after the correction and before the piece was cut, and trees differ.
// List all landmarks that moved keyframes observe, unless they follow: agent and server may know different references.
// List the guests that moved.
struct MapPiece {
  MapId map;
  std::vector<MapId> merged;             // maps that were merged into it and forward to it, ascending
  std::vector<PieceKeyframe> keyframes;  // ascending by id
  std::vector<PieceLandmark> landmarks;  // ascending by id
  std::vector<FusedLandmark> fused;      // each absorbed landmark once
  std::vector<LandmarkId> removed;       // landmarks that are gone, ascending
  std::vector<GoneKeyframe> culled;      // ascending by id

  bool empty() const;
};

// What of an atlas a piece is made of. Ids that are not alive, or are of another map, are left out.
struct PieceSelection {
  MapId map;
  std::vector<KeyframeId> keyframes;
  std::set<KeyframeId> held;  // of these the receiver has the data
  std::vector<LandmarkId> landmarks;
  // As in the piece; also what the receiver added in vain, because the server had changed things meanwhile: its
  // landmarks at a keypoint that showed another by then, or of a keyframe that was culled. Landmarks fused into
  // something that is gone count as removed; ids that are alive are left out.
  std::vector<LandmarkId> former_landmarks;
  std::vector<KeyframeId> culled;
  // Guests that live in another map by now, and their landmarks: the receiver is to let them go.
  std::vector<KeyframeId> released = {};
  std::vector<LandmarkId> released_landmarks = {};
};
MapPiece CutPiece(const Atlas& atlas, const PieceSelection& selection);
// Several pieces, which share one table of sessions.
std::vector<std::byte> EncodePieces(std::span<const MapPiece> pieces);
// Any bytes give an error, or pieces that encode to what they mean: ids that can be, finite poses and points, orders as
// above, observations of keyframes of the same piece alone. Whether they fit an atlas is judged by who applies them.
Result<std::vector<MapPiece>> DecodePieces(std::span<const std::byte> bytes);

}  // namespace pangaea
