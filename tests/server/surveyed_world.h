#pragma once

#include <cstdint>
#include <map>
#include <random>
#include <vector>

#include "common/geometry/similarity3.h"
#include "common/map/map_edit.h"
#include "server/place_recognition/place_match.h"
#include "tests/agent/mapping_synthetic_world.h"

namespace pangaea::testing {

// How a session maps what it sees.
struct SurveyOptions {
  bool stereo = true;
  Similarity3d map_from_world;  // its scale other than 1 only where not stereo
  double pose_noise = 0.002;    // standard deviation of each component, metres and (half of it) radians
  double point_noise = 0.01;    // metres
  double mapped = 0.9;          // part of the corners in view that the session has a landmark of
  std::int64_t stamp_ns = 0;    // when it begins
  // What one keyframe after the other adds to the error of the map (translation in metres, radians, log of the scale):
  // the frame in which the session maps creeps away from where it began.
  Vector6d drift_per_keyframe = Vector6d::Zero();
  double scale_drift_per_keyframe = 0.0;
  // A corner not seen in so many keyframes is taken for a new one when it is seen again (count).
  std::size_t remembered = 1000;
};

// Maps of one room, made by several sessions from what SyntheticWorld shows them: poses and points are the truth with
// noise, in a frame and with a scale of each map's own, and for each landmark it is known which corner it is.
class SurveyedWorld {
 public:
  explicit SurveyedWorld(std::uint64_t seed, int corners = 4000);

  // From now on the room looks different: this share of its corners alone looks as before.
  void Rearrange(double kept) { room_.Repaint(kept); }
  // The session flies along these poses and maps what it sees; one map for each session. Returns its map.
  MapId Fly(SessionId session, const std::vector<Rigid3d>& camera_from_world, const SurveyOptions& options);

  Atlas atlas;

  // The match that perfect place recognition would find between two keyframes.
  PlaceMatch TrueMatch(KeyframeId query, KeyframeId candidate) const;
  // The keyframes of the session, in order.
  const std::vector<KeyframeId>& KeyframesOf(SessionId session) const { return sessions_.at(session).keyframes; }
  const Rigid3d& TrueCameraFromWorld(KeyframeId id) const { return room_.true_camera_from_world(id); }
  int CornerOf(const Observation& observation) const;
  const Eigen::Vector3d& CornerPosition(int corner) const { return room_.point(corner).position; }

 private:
  struct KnownCorner {
    LandmarkId landmark;        // none where the session overlooks the corner
    std::size_t last_seen = 0;  // number of keyframes then
  };
  struct Session {
    SurveyOptions options;
    std::vector<KeyframeId> keyframes;
    std::uint32_t landmarks = 0;
    std::map<int, KnownCorner> corners;

    Similarity3d DriftedMapFromWorld() const;
  };
  void Map(const KeyframeCandidate& view, Session& session, MapId map);
  void MapCorner(const Keyframe& keyframe, std::uint32_t keypoint, int corner, Session& session);
  Rigid3d PoseInMap(KeyframeId id, const Session& session);
  double Normal() { return std::normal_distribution<double>()(random_); }
  void Do(const MapEdit& edit);

  SyntheticWorld room_;
  std::mt19937_64 random_;
  std::map<SessionId, Session> sessions_;
};

// Poses first to last of a circle of n, as CirclePose.
std::vector<Rigid3d> CirclePoses(int first, int last, int n);

}  // namespace pangaea::testing
