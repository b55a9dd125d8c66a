#include "common/simulation/flight.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "common/base/check.h"
#include "common/simulation/random.h"

namespace pangaea {
namespace {

using Eigen::Vector3d;

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr int kControlPoints = 48;
constexpr int kRelaxations = 160;
constexpr int kAttempts = 40;
// Sessions start this far apart along the round: 20 s of each then overlap with the next one's first third.
constexpr double kStartSpacing = 0.31;  // turns
constexpr double kLookAhead = 1.6;      // metres: the nose points at where the body will be
// How the speed swings about its mean.
constexpr double kSpeedSwing = 0.22;
constexpr double kSpeedPeriod = 7.3;  // seconds
// Offset from the round, never the same twice because the periods share no multiple.
constexpr double kWobble = 0.05;  // metres per axis; within what min_clearance leaves

double Swing(double seconds, double period, double phase) { return std::sin(kTurn * seconds / period + phase); }

// An ellipse through the aisle with a few gentle bulges, evenly spaced.
std::vector<Vector3d> RoughRound(Random& random) {
  const double radius_x = random.Uniform(6.5, 7.2);
  const double radius_y = random.Uniform(4.2, 4.7);
  const double height = random.Uniform(1.45, 2.0);
  const double bulge_phase = random.Uniform(0.0, kTurn);
  const double height_phase = random.Uniform(0.0, kTurn);
  std::vector<Vector3d> points;
  for (int i = 0; i < kControlPoints; ++i) {
    const double angle = kTurn * i / kControlPoints;
    const double bulge = 1.0 + 0.04 * std::sin(3.0 * angle + bulge_phase);
    points.emplace_back(bulge * radius_x * std::cos(angle), bulge * radius_y * std::sin(angle),
                        height + 0.3 * std::sin(2.0 * angle + height_phase));
  }
  return points;
}

Vector3d ClearanceGradient(const Scene& scene, const Vector3d& point) {
  constexpr double kStep = 0.02;
  Vector3d gradient;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d step = kStep * Vector3d::Unit(axis);
    gradient[axis] = (scene.Clearance(point + step) - scene.Clearance(point - step)) / (2.0 * kStep);
  }
  return gradient;
}

// An elastic band (Quinlan and Khatib 1993): neighbours pull straight, obstacles push away, the first shape holds.
std::vector<Vector3d> Relax(const Scene& scene, const std::vector<Vector3d>& rough, double wanted_clearance) {
  constexpr double kTension = 0.25;
  constexpr double kHold = 0.03;
  constexpr double kPush = 0.8;
  std::vector<Vector3d> points = rough;
  const std::size_t n = points.size();
  for (int iteration = 0; iteration < kRelaxations; ++iteration) {
    for (std::size_t i = 0; i < n; ++i) {
      const Vector3d middle = 0.5 * (points[(i + 1) % n] + points[(i + n - 1) % n]);
      Vector3d moved = points[i] + kTension * (middle - points[i]) + kHold * (rough[i] - points[i]);
      const double missing = wanted_clearance - scene.Clearance(moved);
      if (missing > 0.0) moved += kPush * missing * ClearanceGradient(scene, moved);
      points[i] = moved;
    }
  }
  return points;
}

// A closed uniform cubic B-spline; `turns` of any size.
Vector3d OnSpline(const std::vector<Vector3d>& points, double turns) {
  const auto n = static_cast<double>(points.size());
  const double at = (turns - std::floor(turns)) * n;
  const double whole = std::floor(at);
  const double u = at - whole;
  const double v = 1.0 - u;
  const std::array<double, 4> weights = {v * v * v / 6.0, (3.0 * u * u * u - 6.0 * u * u + 4.0) / 6.0,
                                         (3.0 * v * v * v - 6.0 * v * v + 4.0) / 6.0, u * u * u / 6.0};
  Vector3d sum = Vector3d::Zero();
  for (std::size_t i = 0; i < weights.size(); ++i) {
    sum += weights[i] * points[(static_cast<std::size_t>(whole) + i) % points.size()];
  }
  return sum;
}

double SmallestClearance(const Scene& scene, const std::vector<Vector3d>& points) {
  constexpr int kSamples = 8 * kControlPoints;
  double smallest = scene.half_size.x();
  for (int i = 0; i < kSamples; ++i) {
    smallest = std::min(smallest, scene.Clearance(OnSpline(points, static_cast<double>(i) / kSamples)));
  }
  return smallest;
}

double Length(const std::vector<Vector3d>& points) {
  constexpr int kSamples = 8 * kControlPoints;
  double length = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    length += (OnSpline(points, (i + 1.0) / kSamples) - OnSpline(points, static_cast<double>(i) / kSamples)).norm();
  }
  return length;
}

std::vector<Vector3d> PlanRound(const Scene& scene, Random& random, double min_clearance) {
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    std::vector<Vector3d> points = Relax(scene, RoughRound(random), min_clearance + 0.25);
    if (SmallestClearance(scene, points) >= min_clearance) return points;
  }
  return {};
}

}  // namespace

Flight::Flight(const Scene& scene, const FlightOptions& options) {
  Random random(MixSeed(options.seed, static_cast<std::uint64_t>(options.session)));
  control_points_ = PlanRound(scene, random, options.min_clearance);
  PANGAEA_CHECK(!control_points_.empty());
  round_length_ = Length(control_points_);
  round_seconds_ = round_length_ / options.speed;
  start_turns_ = kStartSpacing * options.session + random.Uniform(0.0, 0.04);
  yaw_phase_ = random.Uniform(0.0, kTurn);
  wobble_phase_ = random.Uniform(0.0, kTurn);
}

double Flight::Turns(double seconds) const {
  const double swing = kSpeedSwing * kSpeedPeriod / kTurn * Swing(seconds, kSpeedPeriod, wobble_phase_);
  return start_turns_ + (seconds + swing) / round_seconds_;
}

Vector3d Flight::OnBand(double turns) const { return OnSpline(control_points_, turns); }

Vector3d Flight::Position(double seconds) const {
  const Vector3d wobble(Swing(seconds, 11.7, wobble_phase_), Swing(seconds, 13.9, 2.0 * wobble_phase_),
                        Swing(seconds, 8.3, 3.0 * wobble_phase_));
  return OnBand(Turns(seconds)) + kWobble * wobble;
}

Rigid3d Flight::WorldFromBody(double seconds) const {
  const double turns = Turns(seconds);
  const Vector3d ahead = OnBand(turns + kLookAhead / round_length_) - OnBand(turns);
  const double yaw = std::atan2(ahead.y(), ahead.x()) + 0.30 * Swing(seconds, 9.1, yaw_phase_) +
                     0.08 * Swing(seconds, 4.3, 2.0 * yaw_phase_);
  const double pitch = 0.05 * Swing(seconds, 5.7, wobble_phase_) + 0.03 * Swing(seconds, 3.1, yaw_phase_);
  const double roll = 0.05 * Swing(seconds, 6.1, yaw_phase_) + 0.03 * Swing(seconds, 2.7, wobble_phase_);
  const Eigen::Quaterniond rotation = Eigen::AngleAxisd(yaw, Vector3d::UnitZ()) *
                                      Eigen::AngleAxisd(pitch, Vector3d::UnitY()) *
                                      Eigen::AngleAxisd(roll, Vector3d::UnitX());
  return Rigid3d(rotation, Position(seconds));
}

Vector3d Flight::Velocity(double seconds) const {
  constexpr double kStep = 1e-4;  // central differences: good to about 1e-8 m/s here
  return (Position(seconds + kStep) - Position(seconds - kStep)) / (2.0 * kStep);
}

}  // namespace pangaea
