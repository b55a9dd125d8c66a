#include "common/simulation/recording.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>
#include <string>

#include "common/base/check.h"
#include "common/simulation/random.h"

namespace pangaea {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::int64_t kFirstStamp = 1'700'000'000 * kSecond;
constexpr std::int64_t kBetweenSessions = 7200 * kSecond;
constexpr std::int64_t kTruthPeriod = kSecond / 200;
constexpr double kExposurePeriod = 13.0;  // seconds, of the drift
// Parts of the seed.
constexpr std::uint64_t kHallSeed = 1;
constexpr std::uint64_t kFlightSeed = 2;
constexpr std::uint64_t kNoiseSeed = 3;

// x right, y down, z forward from x forward, y left, z up; then `pitch` radians down and a small turn by chance of
// assembly.
Eigen::Quaterniond BodyFromCamera(double pitch, const Eigen::Vector3d& turn) {
  Eigen::Matrix3d axes;
  axes << 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0;
  return Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) * Eigen::Quaterniond(axes) * ExpSo3(turn);
}

Status Refuse(const std::string& what) { return Fail(ErrorCode::kInvalidArgument, what); }

}  // namespace

Status RecordingOptions::Check() const {
  if (sessions < 1 || sessions > 100) return Refuse("sessions must be 1 to 100");
  if (laps < 1 || laps > 100'000) return Refuse("laps must be 1 to 100000");
  if (!(seconds > 0.0 && seconds * laps <= 7000.0)) {
    return Refuse("seconds must be above 0, and at most 7000 in all laps together");
  }
  if (!(rate >= 1.0 && rate <= 200.0)) return Refuse("rate must be 1 to 200 images a second");
  if (blur < 1 || blur > 64) return Refuse("blur must be 1 to 64 pictures");
  if (!(exposure_drift >= 0.0 && exposure_drift <= 0.9)) return Refuse("exposure drift must be 0 to 0.9");
  if (!(exposure_time > 0.0 && exposure_time <= 1.0 / rate)) return Refuse("exposure time must fit between two images");
  if (occluders < 0 || occluders > 50) return Refuse("occluders must be 0 to 50");
  if (!(speed >= 0.1 && speed <= 3.0)) return Refuse("speed must be 0.1 to 3 m/s");
  if (!(coarseness >= 1.0 && coarseness <= 10.0)) return Refuse("coarseness must be 1 to 10");
  if (jobs < 1 || jobs > 256) return Refuse("jobs must be 1 to 256");
  for (const auto& [from, to] : blackouts) {
    if (!(from >= 0.0 && to > from)) return Refuse("a blackout must end after it begins, both in seconds from 0");
  }
  return {};
}

CameraRig SimulatedRig(SensorKind sensor) {
  constexpr double kPitch = 0.09;
  CameraRig rig;
  rig.left = {LensKind::kRadialTangential,
              752,
              480,
              461.237,
              460.118,
              372.614,
              243.087,
              {-0.28714, 0.07683, 0.00021, -0.00013, 0.0}};
  rig.body_from_left = Rigid3d(BodyFromCamera(kPitch, {0.0061, -0.0143, 0.0112}), {0.0713, 0.0552, 0.0187});
  if (sensor == SensorKind::kMonocular) return rig;
  rig.right = LensModel{LensKind::kRadialTangential,
                        752,
                        480,
                        459.406,
                        458.772,
                        377.905,
                        249.731,
                        {-0.28533, 0.07517, -0.00017, 0.00008, 0.0}};
  rig.body_from_right = Rigid3d(BodyFromCamera(kPitch, {0.0128, -0.0041, 0.0089}), {0.0704, -0.0549, 0.0201});
  return rig;
}

Recording::Recording(const RecordingOptions& options) : options_(options), rig_(SimulatedRig(options.sensor)) {
  PANGAEA_CHECK(options.Check().has_value());
  scene_ = BuildHall(
      {MixSeed(options.seed, kHallSeed), options.repetitive, options.occluders, options.coarseness, options.jobs});
  for (int session = 0; session < options.sessions; ++session) {
    FlightOptions flight;
    flight.seed = MixSeed(options.seed, kFlightSeed);
    flight.session = session;
    flight.speed = options.speed;
    flights_.emplace_back(scene_, flight);
  }
}

int Recording::frame_count() const {
  return std::max(static_cast<int>(std::floor(options_.seconds * options_.rate + 1e-9)), 1);
}

int Recording::total_frame_count() const { return options_.laps * (frame_count() - 1) + 1; }

int Recording::PictureOf(int frame) const {
  const int steps = frame_count() - 1;
  if (steps == 0) return 0;
  const int phase = frame % (2 * steps);
  return phase <= steps ? phase : 2 * steps - phase;
}

// The time of the first lap at which the camera was where it is `seconds` after the first image.
double Recording::SecondsOfFlight(double seconds) const {
  const double lap = (frame_count() - 1) / options_.rate;
  if (options_.laps == 1 || lap == 0.0) return seconds;
  const double phase = std::fmod(seconds, 2.0 * lap);
  return phase <= lap ? phase : 2.0 * lap - phase;
}

std::int64_t Recording::FrameStamp(int session, int frame) const {
  return kFirstStamp + session * kBetweenSessions +
         std::llround(static_cast<double>(frame) * static_cast<double>(kSecond) / options_.rate);
}

double Recording::Seconds(int session, std::int64_t stamp_ns) const {
  return static_cast<double>(stamp_ns - FrameStamp(session, 0)) / static_cast<double>(kSecond);
}

std::vector<TruthSample> Recording::GroundTruth(int session) const {
  std::vector<std::int64_t> stamps;
  const std::int64_t last = FrameStamp(session, total_frame_count() - 1);
  for (std::int64_t stamp = FrameStamp(session, 0); stamp <= last; stamp += kTruthPeriod) stamps.push_back(stamp);
  for (int frame = 0; frame < total_frame_count(); ++frame) stamps.push_back(FrameStamp(session, frame));
  std::sort(stamps.begin(), stamps.end());
  stamps.erase(std::unique(stamps.begin(), stamps.end()), stamps.end());
  std::vector<TruthSample> samples;
  for (const std::int64_t stamp : stamps) {
    const double seconds = Seconds(session, stamp);
    const double there = SecondsOfFlight(seconds);
    const double direction = there == seconds || SecondsOfFlight(seconds + 1e-6) > there ? 1.0 : -1.0;
    samples.push_back({stamp, flight(session).WorldFromBody(there), direction * flight(session).Velocity(there)});
  }
  return samples;
}

bool Recording::IsBlackedOut(double seconds) const {
  return std::any_of(options_.blackouts.begin(), options_.blackouts.end(),
                     [seconds](const auto& span) { return seconds >= span.first && seconds < span.second; });
}

double Recording::Exposure(int session, double seconds) const {
  const double angle = 2.0 * std::numbers::pi * seconds / kExposurePeriod + session;
  return 1.0 + options_.exposure_drift * std::sin(angle);
}

FramePainter::FramePainter(const Recording& recording) : recording_(recording) {
  const CameraRig& rig = recording.rig();
  const auto add = [this](const LensModel& lens, const Rigid3d& body_from_camera) {
    cameras_.push_back({body_from_camera.Inverse(), Renderer(std::make_shared<const RayTable>(lens)),
                        ImageSensor(lens.width, lens.height, {})});
  };
  add(rig.left, rig.body_from_left);
  if (rig.right) add(*rig.right, rig.body_from_right);
  surfaces_ = recording.scene().surfaces;
}

StereoPicture FramePainter::Paint(int session, int frame) {
  const double seconds = recording_.Seconds(session, recording_.FrameStamp(session, frame));
  std::uint64_t seed = MixSeed(recording_.options().seed, kNoiseSeed);
  seed = MixSeed(MixSeed(seed, static_cast<std::uint64_t>(session)), static_cast<std::uint64_t>(frame));
  StereoPicture picture;
  picture.left = PaintCamera(cameras_[0], session, seconds, MixSeed(seed, 0));
  if (cameras_.size() > 1) picture.right = PaintCamera(cameras_[1], session, seconds, MixSeed(seed, 1));
  return picture;
}

cv::Mat FramePainter::PaintCamera(Camera& camera, int session, double seconds, std::uint64_t noise_seed) {
  if (recording_.IsBlackedOut(seconds)) return camera.sensor.Dark(noise_seed);
  const RecordingOptions& options = recording_.options();
  for (int i = 0; i < options.blur; ++i) {
    const double at = seconds + ((i + 0.5) / options.blur - 0.5) * options.exposure_time;
    surfaces_.resize(recording_.scene().surfaces.size());
    const Rigid3d world_from_body = recording_.flight(session).WorldFromBody(at);
    for (const Occluder& occluder : recording_.scene().occluders) {
      occluder.AppendSurfaces(at, world_from_body.translation(), surfaces_);
    }
    camera.renderer.Render(surfaces_, camera.camera_from_body * world_from_body.Inverse(), i == 0 ? sum_ : light_);
    if (i > 0) cv::add(sum_, light_, sum_);
  }
  return camera.sensor.Expose(sum_, recording_.Exposure(session, seconds) / options.blur, noise_seed);
}

}  // namespace pangaea
