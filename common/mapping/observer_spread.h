#pragma once

#include <Eigen/Core>
#include <unordered_map>

#include "common/map/atlas.h"

namespace pangaea {

// What the positions of a landmark's observers say about its depth.
struct ObserverSpread {
  int observations = 0;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  // of the observers, map frame
  double squares = 0.0;  // sum of squared distances from it, stereo baselines included (map units squared)
};

// Variance of a landmark's predicted pixel in units of a single observation's variance, for a camera at
// `camera_in_map`: 1 for the observation itself, and what the landmark's own uncertainty adds. A line fitted to the
// observers predicts well between them and ever worse away from them, as in any linear regression.
double PredictionVariance(const ObserverSpread& observers, const Eigen::Vector3d& camera_in_map);

// Measures the spreads of many landmarks of one atlas, each observer's position looked up once.
class ObserverCenters {
 public:
  explicit ObserverCenters(const Atlas& atlas) : atlas_(atlas) {}

  // Of a landmark that is alive in the atlas.
  ObserverSpread SpreadOf(const Landmark& landmark);

 private:
  struct Observer {
    const Keyframe* keyframe = nullptr;
    Eigen::Vector3d center = Eigen::Vector3d::Zero();
    // Of a second observer, a baseline away, about the centre of both: half of its square. 0: one camera.
    double stereo_squares = 0.0;
  };
  const Observer& Find(KeyframeId id);

  const Atlas& atlas_;
  std::unordered_map<KeyframeId, Observer> observers_;
};

}  // namespace pangaea
