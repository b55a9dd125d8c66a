#include "tests/agent/tracking/rendered_flight.h"

#include <cmath>

#include "common/base/check.h"
#include "common/evaluation/absolute_error.h"
#include "common/map/trajectory.h"
#include "common/place/vocabulary_file.h"
#include "common/simulation/material.h"
#include "common/simulation/random.h"

namespace pangaea::testing {
namespace {

constexpr std::int64_t kFramePeriod = 50'000'000;  // nanoseconds

LensModel Lens() { return {LensKind::kRadialTangential, 752, 480, 450.0, 450.0, 375.5, 239.5, {}}; }

IdealCamera Camera() {
  const LensModel lens = Lens();
  IdealCamera camera;
  camera.width = lens.width;
  camera.height = lens.height;
  camera.focal_x = lens.focal_x;
  camera.focal_y = lens.focal_y;
  camera.center_x = lens.center_x;
  camera.center_y = lens.center_y;
  camera.baseline = 0.11;
  return camera;
}

// The synthetic rig is calibrated exactly, so that depth may be believed at any distance.
LocalMappingOptions ExactRig() {
  LocalMappingOptions options;
  options.noise.max_depth_baselines = 10000.0;
  return options;
}

}  // namespace

Surface MakeWall(double from_x, double to_x, double y, double half_height, std::uint64_t seed, double magnification) {
  constexpr double kTexel = 0.01;  // metres, before magnification
  Surface wall;
  wall.corner = {from_x, y, half_height};
  wall.along = {to_x - from_x, 0.0, 0.0};
  wall.across = {0.0, 0.0, -2.0 * half_height};
  wall.texture = PaintMaterial(Material::kConcrete, MixSeed(seed, 0), (to_x - from_x) / magnification,
                               2.0 * half_height / magnification, kTexel, LightGrid{2, 2, {1.0F, 1.0F, 1.0F, 1.0F}});
  return wall;
}

Rigid3d LookingAtTheWalls(double x) {
  Eigen::Matrix3d axes;  // columns: the camera's right, down and forward
  axes << 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0;
  return {Eigen::Quaterniond(axes), {x, 0.0, 0.0}};
}

RenderedFlight::RenderedFlight(std::vector<Surface> surfaces, const TrackingOptions& options, SessionId session,
                               std::uint64_t seed)
    : session_(session),
      surfaces_(std::move(surfaces)),
      camera_(Camera()),
      renderer_(std::make_shared<const RayTable>(Lens())),
      sensor_(camera_.width, camera_.height, {}),
      tracker_(session, camera_, options, OpenVocabulary().value(), seed),
      builder_(camera_, options.ForCamera(camera_).orb, options.stereo),
      mapper_(session, ExactRig()),
      snapshot_(std::make_shared<const Atlas>()) {}

TrackingResult RenderedFlight::Fly(const Rigid3d& world_from_camera) {
  truth_.push_back({stamp_ns_, world_from_camera});
  return Track(Draw(world_from_camera), [&](StageRecorder&) {
    return Draw(world_from_camera * Rigid3d(Eigen::Quaterniond::Identity(), {camera_.baseline, 0.0, 0.0}));
  });
}

TrackingResult RenderedFlight::FlyInTheDark() {
  return Track(sensor_.Dark(++pictures_), [&](StageRecorder&) { return sensor_.Dark(++pictures_); });
}

std::vector<TrackingResult> RenderedFlight::FlyAlong(double from, double to, double step) {
  std::vector<TrackingResult> results;
  const int frames = static_cast<int>(std::lround(std::abs(to - from) / step));
  for (int i = 0; i < frames; ++i) results.push_back(Fly(LookingAtTheWalls(from + (to - from) * i / frames)));
  return results;
}

TrackingResult RenderedFlight::Track(const cv::Mat& left, const RightImage& right) {
  NoStageRecorder stages;
  TrackingResult result = tracker_.Track(stamp_ns_, left, right, snapshot_, stages);
  const bool keyframe = result.root || result.keyframe;
  if (result.root) mapper_.Insert(*result.root, stages);
  if (result.keyframe) mapper_.Insert(builder_.Build(*result.keyframe, stages), stages);
  if (result.tracked) mapper_.AddFrames(std::vector{TrackedFrame{result.reference, result.pose}});
  if (keyframe) frames_until_seen_ = lag_;
  if (frames_until_seen_ && (*frames_until_seen_)-- == 0) {
    snapshot_ = std::make_shared<const Atlas>(mapper_.atlas());
    frames_until_seen_.reset();
  }
  stamp_ns_ += kFramePeriod;
  return result;
}

std::optional<KeyframeId> RenderedFlight::Land() {
  const auto closing = tracker_.TakeClosingKeyframe();
  if (!closing) return std::nullopt;
  NoStageRecorder stages;
  mapper_.Insert(builder_.Build(*closing, stages), stages);
  return closing->id;
}

void RenderedFlight::Absorb(const AgentCorrection& correction) {
  mapper_.Absorb(correction, Atlas(mapper_.atlas()));
  snapshot_ = std::make_shared<const Atlas>(mapper_.atlas());
}

cv::Mat RenderedFlight::Draw(const Rigid3d& world_from_camera) {
  cv::Mat light;
  renderer_.Render(surfaces_, world_from_camera.Inverse(), light);
  return sensor_.Expose(light, 1.0, ++pictures_);
}

std::map<MapId, std::vector<StampedPose>> RenderedFlight::Trajectories() const {
  std::map<MapId, std::vector<StampedPose>> trajectories;
  for (const TrajectoryPose& pose : SessionTrajectory(mapper_.atlas(), session_)) {
    trajectories[pose.map].push_back({pose.stamp_ns, pose.map_from_camera});
  }
  return trajectories;
}

double RenderedFlight::PositionError() const {
  double squares = 0.0;
  std::size_t count = 0;
  for (const auto& [map, trajectory] : Trajectories()) {
    EvaluatedTrajectory evaluated;
    evaluated.estimate = trajectory;
    evaluated.truth = truth_;
    const auto error = EvaluateAbsoluteError(std::vector{evaluated});
    PANGAEA_CHECK(error.has_value());
    squares += error->error.rms * error->error.rms * static_cast<double>(error->error.count);
    count += error->error.count;
  }
  return std::sqrt(squares / static_cast<double>(count));
}

}  // namespace pangaea::testing
