#include "agent/tracking/monocular_start.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "common/base/range_check.h"

namespace pangaea {
namespace {

std::vector<PixelMatch> MatchesOf(const Features& first, std::span<const InitialTrack> tracks) {
  std::vector<PixelMatch> matches;
  matches.reserve(tracks.size());
  for (const InitialTrack& track : tracks) {
    const Keypoint& keypoint = first.keypoints[track.keypoint];
    matches.push_back({{keypoint.u, keypoint.v}, track.pixel.cast<double>(), 1.0 / track.sigma});
  }
  return matches;
}

StartPoints StartPointsOf(const Features& first, std::span<const InitialTrack> tracks,
                          const TwoViewReconstruction& reconstruction) {
  StartPoints points;
  for (const TwoViewPoint& point : reconstruction.points) {
    const InitialTrack& track = tracks[point.match];
    const Keypoint& keypoint = first.keypoints[track.keypoint];
    points[track.keypoint] = {point.point_in_first, {keypoint.u, keypoint.v}, track.sigma};
  }
  return points;
}

}  // namespace

Status MonocularStartOptions::Check() const {
  if (auto status = two_view.Check(); !status) return status;
  return RangeCheck("monocular start")
      .In("min_tracks", min_tracks, 20, 5000)
      .In("min_track_share", min_track_share, 0.0, 1.0)
      .In("confirmations", confirmations, 1, 100)
      .In("max_frames", max_frames, 2, 100000)
      .In("median_depth", median_depth, 0.01, 10000.0)
      .In("adjusted_frames", adjusted_frames, 0, 50)
      .In("min_inliers", min_inliers, 6, 1000)
      .status();
}

MonocularStart::MonocularStart(const IdealCamera& camera, const MonocularStartOptions& options,
                               const InitialTracks::Options& tracks, std::uint64_t seed)
    : camera_(camera),
      options_(options),
      track_options_(tracks),
      seed_(seed),
      needed_successes_(options.confirmations) {}

bool MonocularStart::Begin(std::int64_t stamp_ns, const ImagePyramid& image, Features features) {
  InitialTracks tracks(camera_, track_options_, image, features.keypoints);
  if (std::cmp_less(tracks.begun(), options_.min_tracks)) return false;
  first_ = First{stamp_ns, std::move(features), std::move(tracks), {}};
  return true;
}

std::optional<MonocularOpening> MonocularStart::Follow(std::int64_t stamp_ns, const ImagePyramid& image) {
  InitialTracks& tracks = first_->tracks;
  tracks.Follow(image);
  const auto left = static_cast<double>(tracks.tracks().size());
  if (left < options_.min_tracks || left < options_.min_track_share * static_cast<double>(tracks.begun()) ||
      first_->later.size() >= options_.max_frames) {
    // A camera this fast leaves no time for more.
    if (first_->had_success) needed_successes_ = std::max(1, needed_successes_ / 2);
    first_.reset();
    return std::nullopt;
  }
  first_->later.push_back({stamp_ns, {tracks.tracks().begin(), tracks.tracks().end()}});
  // A motion with enough parallax moves the image at least so far.
  const double least_flow = camera_.focal_x * std::tan(options_.two_view.min_parallax * std::numbers::pi / 180.0);
  if (tracks.MedianFlow() < least_flow) return std::nullopt;
  const auto reconstruction = ReconstructFromTwoViews(camera_, MatchesOf(first_->features, tracks.tracks()),
                                                      options_.two_view, seed_ + first_->later.size());
  first_->successes = reconstruction ? first_->successes + 1 : 0;
  first_->had_success = first_->had_success || reconstruction;
  // A plane may be the mirror of the true one until the motion tells the two apart: no haste there.
  const bool planar = reconstruction && reconstruction->planar;
  if (first_->successes < (planar ? options_.confirmations : needed_successes_)) return std::nullopt;
  auto opening = Open(*reconstruction);
  if (opening) {
    first_.reset();
    needed_successes_ = options_.confirmations;
  }
  return opening;
}

// Adjusts the reconstruction on frames between the two, and gives all of them a pose.
std::optional<MonocularOpening> MonocularStart::Open(const TwoViewReconstruction& reconstruction) const {
  const std::vector<Frame>& later = first_->later;
  const std::vector<InitialTrack>& second_tracks = later.back().tracks;
  StartPoints points = StartPointsOf(first_->features, second_tracks, reconstruction);
  std::vector<StartView> views;
  Rigid3d guess;
  const std::size_t stride = later.size() / (options_.adjusted_frames + 1) + 1;
  for (std::size_t i = 0; i + 1 < later.size(); ++i) {
    const auto pose = LocateOnPoints(camera_, points, later[i].tracks, guess, options_.min_inliers);
    if (!pose) continue;
    guess = *pose;
    if ((later.size() - 1 - i) % stride == 0) views.push_back({*pose, later[i].tracks});
  }
  views.push_back({reconstruction.second_from_first, second_tracks});
  AdjustStart(camera_, options_.median_depth, points, views);
  if (std::cmp_less(points.size(), options_.two_view.min_points)) return std::nullopt;
  return MakeOpening(points, views.back().frame_from_first);
}

MonocularOpening MonocularStart::MakeOpening(const StartPoints& points, const Rigid3d& second_from_first) const {
  MonocularOpening opening;
  opening.first_stamp_ns = first_->stamp_ns;
  opening.first_image = first_->tracks.first_image();
  opening.first_features = first_->features;
  opening.second_from_first = second_from_first;
  for (const InitialTrack& track : first_->later.back().tracks) {
    const auto point = points.find(track.keypoint);
    if (point == points.end()) continue;
    opening.points.push_back(
        {track.keypoint, static_cast<std::uint32_t>(opening.second_points.size()), point->second.point_in_first});
    opening.second_points.push_back(
        {track.pixel.x(), track.pixel.y(), first_->features.keypoints[track.keypoint].octave});
  }
  Rigid3d guess;
  for (std::size_t i = 0; i + 1 < first_->later.size(); ++i) {
    const Frame& frame = first_->later[i];
    const auto pose = LocateOnPoints(camera_, points, frame.tracks, guess, options_.min_inliers);
    if (!pose) continue;
    guess = *pose;
    opening.between.push_back({frame.stamp_ns, pose->Inverse()});
  }
  return opening;
}

}  // namespace pangaea
