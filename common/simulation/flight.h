#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "common/geometry/rigid3.h"
#include "common/simulation/scene.h"

namespace pangaea {

struct FlightOptions {
  std::uint64_t seed = 1;
  int session = 0;             // different sessions start at different places and take different, overlapping rounds
  double speed = 1.0;          // metres a second, on average; the flight varies it by a third
  double min_clearance = 0.7;  // metres to any surface; 0.1 more than a view needs, for the wobble of later rounds
};

// A smooth flight round the hall, for ever: a closed cubic B-spline that an elastic band pushed clear of everything,
// with a slow wobble so that no two rounds are alike. Evaluating it at any time costs the same.
class Flight {
 public:
  // Aborts when the hall leaves no way round, which is a mistake of the hall.
  Flight(const Scene& scene, const FlightOptions& options);

  // x forward, y left, z up. Any `seconds` >= 0; twice differentiable.
  Rigid3d WorldFromBody(double seconds) const;
  // Of the body, in the world, metres a second.
  Eigen::Vector3d Velocity(double seconds) const;
  double round_seconds() const { return round_seconds_; }

 private:
  Eigen::Vector3d OnBand(double turns) const;
  Eigen::Vector3d Position(double seconds) const;
  double Turns(double seconds) const;

  std::vector<Eigen::Vector3d> control_points_;  // closed, evenly spaced
  double round_length_ = 1.0;                    // metres
  double round_seconds_ = 1.0;
  double start_turns_ = 0.0;
  double yaw_phase_ = 0.0;
  double wobble_phase_ = 0.0;
};

}  // namespace pangaea
