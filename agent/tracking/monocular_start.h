#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "agent/mapping/map_opening.h"
#include "agent/tracking/initial_tracks.h"
#include "agent/tracking/start_points.h"
#include "common/base/result.h"
#include "common/estimation/two_view_motion.h"
#include "common/features/orb_extractor.h"
#include "common/map/keyframe.h"

namespace pangaea {

struct MonocularStartOptions {
  // Half of the tracks must become points: a map of a small part of the view is soon left behind.
  TwoViewOptions two_view{.min_point_share = 0.5};
  // With fewer keypoints an image is no first one, and with fewer of its tracks left another one is chosen (count).
  int min_tracks = 120;
  // ... or with less than this share of them left: the camera has turned away.
  double min_track_share = 0.25;
  // Frames in a row that must allow a reconstruction; the last one is taken. A single one may rest on something near
  // that leaves the view at once, as the ground at a take-off. Nothing is lost by waiting: the frames get their poses
  // later.
  int confirmations = 6;
  // Frames after which another first image is chosen: what is kept of them is bounded. 50 s at 20 Hz.
  std::size_t max_frames = 1000;
  // Median depth of the first points, map units: the free scale. About what rooms have in metres, so that what is made
  // for metres (the camera's place on the body, the uplink's thresholds) is of the right order in such a map, too.
  double median_depth = 4.0;
  // Frames between the two keyframes that the motion is adjusted on as well (count).
  std::size_t adjusted_frames = 6;
  // A frame between the keyframes gets a pose when this many points agree with it (count).
  int min_inliers = 20;

  // Says which option is out of which range.
  Status Check() const;
};

// What a monocular map can begin with: two of the frames, the motion between them, and points that both see.
struct MonocularOpening {
  std::int64_t first_stamp_ns = 0;
  ImagePyramid first_image;
  Features first_features;
  Rigid3d second_from_first;              // median depth of the points: MonocularStartOptions::median_depth
  std::vector<OpeningPoint> points;       // second_keypoint: index into second_points
  std::vector<FixedPoint> second_points;  // where the second frame sees the points, one by one
  std::vector<FramePose> between;         // frames between the two, relative to the first; ascending by stamp
};

// Looks for the beginning of a monocular map: follows the keypoints of a first frame until some later frame shows
// enough parallax for a reconstruction from two views (Mur-Artal, Montiel and Tardos 2015, section IV). One owner
// thread.
class MonocularStart {
 public:
  // `options` have passed Check().
  MonocularStart(const IdealCamera& camera, const MonocularStartOptions& options, const InitialTracks::Options& tracks,
                 std::uint64_t seed);

  // Whether the next frame is to be given by Begin, with its features, instead of Follow.
  bool wants_first_frame() const { return !first_; }
  // False where the frame has too few keypoints.
  bool Begin(std::int64_t stamp_ns, const ImagePyramid& image, Features features);
  // The frame after the previous one. An opening ends the search: the next one begins anew.
  std::optional<MonocularOpening> Follow(std::int64_t stamp_ns, const ImagePyramid& image);
  // What is to follow does not follow what was.
  void Reset() { first_.reset(); }

 private:
  struct Frame {
    std::int64_t stamp_ns = 0;
    std::vector<InitialTrack> tracks;
  };
  struct First {
    std::int64_t stamp_ns = 0;
    Features features;
    InitialTracks tracks;
    std::vector<Frame> later;  // the latest one last
    int successes = 0;         // of the latest frames, how many in a row allowed a reconstruction
    bool had_success = false;
  };

  std::optional<MonocularOpening> Open(const TwoViewReconstruction& reconstruction) const;
  MonocularOpening MakeOpening(const StartPoints& points, const Rigid3d& second_from_first) const;

  IdealCamera camera_;
  MonocularStartOptions options_;
  InitialTracks::Options track_options_;
  std::uint64_t seed_;
  std::optional<First> first_;
  int needed_successes_;
};

}  // namespace pangaea
