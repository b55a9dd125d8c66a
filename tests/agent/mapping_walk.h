#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>

#include "agent/mapping/local_mapper.h"
#include "common/estimation/bundle_adjustment.h"
#include "common/geometry/horn.h"
#include "common/map/map_edit.h"
#include "common/mapping/measurement_noise.h"
#include "tests/agent/mapping_synthetic_world.h"

namespace pangaea::testing {

inline constexpr SessionId kSession = 1;

// The synthetic rig is calibrated exactly, so that depth may be believed at any distance.
inline LocalMappingOptions ExactRig() {
  LocalMappingOptions options;
  options.noise.max_depth_baselines = 10000.0;
  return options;
}

// Counts how often a stage began.
class StageCounter final : public StageRecorder {
 public:
  void Begin(std::string_view name) override { ++begun[std::string(name)]; }
  void End(std::string_view) override {}

  std::map<std::string, int> begun;
};

// A mapper that walks through a synthetic world.
class Walk {
 public:
  explicit Walk(const SyntheticWorldOptions& world_options = {},
                const LocalMappingOptions& mapping_options = ExactRig())
      : world(world_options), mapper(kSession, mapping_options) {}

  KeyframeId Visit(const Rigid3d& camera_from_world, std::stop_token stop = {}) {
    const KeyframeCandidate candidate = world.NextKeyframe(camera_from_world, mapper.atlas());
    EXPECT_TRUE(mapper.Insert(candidate, stages, std::move(stop)));
    return candidate.id;
  }
  void WalkCircle(int first, int last, int keyframes_of_circle) {
    for (int k = first; k < last; ++k) Visit(CirclePose(k, keyframes_of_circle));
  }

  // Of the camera centres of living keyframes, in the frame of the first, metres.
  double LargestPositionError() const {
    const Rigid3d& world_from_map_inverse = world.true_camera_from_world({kSession, 1});
    double largest = 0.0;
    mapper.atlas().ForEachKeyframe([&](const Keyframe& keyframe) {
      const Rigid3d truth = world.true_camera_from_world(keyframe.id) * world_from_map_inverse.Inverse();
      const Eigen::Vector3d error = truth.Inverse().translation() - keyframe.camera_from_map.Inverse().translation();
      largest = std::max(largest, error.norm());
    });
    return largest;
  }
  // What that would be if every keypoint were known to show its corner and all were adjusted at once, as the mapper
  // adjusts, beginning at the truth: the rest is what the mapper misses or keeps wrongly.
  double LargestPositionErrorOfNoise() const {
    const BundleProblem problem = KnownCorners();
    BundleOptions options;
    options.iterations = 30;
    options.iterations_without_outliers = 30;
    options.cost_tolerance = 1e-9;
    const auto solution = SolveBundle(problem, options);
    EXPECT_TRUE(solution.has_value());
    double largest = 0.0;
    for (std::size_t i = 0; i < problem.poses.size(); ++i) {
      const Eigen::Vector3d truth = problem.poses[i].camera_from_map.Inverse().translation();
      largest = std::max(largest, (solution->poses[i].Inverse().translation() - truth).norm());
    }
    return largest;
  }
  double PositionError(KeyframeId id) const {
    const Keyframe& keyframe = *mapper.atlas().FindKeyframe(id);
    const Rigid3d truth = world.true_camera_from_world(id) * world.true_camera_from_world({kSession, 1}).Inverse();
    return (truth.Inverse().translation() - keyframe.camera_from_map.Inverse().translation()).norm();
  }
  // The corner that a landmark shows, by its first observation.
  int PointOf(const Landmark& landmark) const {
    const Observation& first = landmark.observations.front();
    return world.points_of(first.keyframe)[first.keypoint];
  }
  // Part of the landmarks that show a corner which another landmark shows as well.
  double DuplicateShare() const {
    std::set<int> shown;
    std::size_t duplicates = 0;
    mapper.atlas().ForEachLandmark(
        [&](const Landmark& landmark) { duplicates += shown.insert(PointOf(landmark)).second ? 0 : 1; });
    return static_cast<double>(duplicates) / static_cast<double>(mapper.atlas().landmark_count());
  }
  // Part of the observations that show another corner than their landmark's first one.
  double WrongObservationShare() const {
    std::size_t wrong = 0;
    std::size_t all = 0;
    mapper.atlas().ForEachLandmark([&](const Landmark& landmark) {
      for (const Observation& observation : landmark.observations) {
        wrong += world.points_of(observation.keyframe)[observation.keypoint] == PointOf(landmark) ? 0 : 1;
        ++all;
      }
    });
    return static_cast<double>(wrong) / static_cast<double>(all);
  }

  // Root mean square of the errors of the camera centres after the similarity that makes it smallest, metres.
  double AlignedError() const {
    std::vector<Eigen::Vector3d> truth;
    std::vector<Eigen::Vector3d> estimate;
    mapper.atlas().ForEachKeyframe([&](const Keyframe& keyframe) {
      truth.push_back(world.true_camera_from_world(keyframe.id).Inverse().translation());
      estimate.push_back(keyframe.camera_from_map.Inverse().translation());
    });
    const auto world_from_map = AlignPoints(truth, estimate, true);
    double sum = 0.0;
    for (std::size_t i = 0; i < truth.size(); ++i) sum += (truth[i] - *world_from_map * estimate[i]).squaredNorm();
    return std::sqrt(sum / static_cast<double>(truth.size()));
  }

  SyntheticWorld world;
  LocalMapper mapper;
  StageCounter stages;

 private:
  // The living keyframes and the corners they see, all at the truth.
  BundleProblem KnownCorners() const {
    const Rigid3d& first_from_world = world.true_camera_from_world({kSession, 1});
    const MeasurementNoiseOptions noise = LocalMappingOptions{}.noise;
    BundleProblem problem;
    problem.cameras = {world.camera()};
    std::map<int, int> point_index;  // of the corners
    mapper.atlas().ForEachKeyframe([&](const Keyframe& keyframe) {
      const int pose = static_cast<int>(problem.poses.size());
      const Rigid3d truth = world.true_camera_from_world(keyframe.id) * first_from_world.Inverse();
      problem.poses.push_back({truth, 0, pose == 0});
      const std::vector<int>& corners = world.points_of(keyframe.id);
      for (std::size_t i = 0; i < corners.size(); ++i) {
        const auto [point, added] = point_index.try_emplace(corners[i], static_cast<int>(problem.points.size()));
        if (added) problem.points.push_back({first_from_world * world.point(corners[i]).position});
        const Keypoint& keypoint = keyframe.data->features.keypoints[i];
        problem.observations.push_back({pose, point->second, MeasurementOf(keypoint), 1.0 / SigmaOf(keypoint, noise)});
      }
    });
    return problem;
  }
};

// Worlds whose errors by noise alone reach from 3 to 10 mm.
inline constexpr std::uint64_t kWorlds = 8;

}  // namespace pangaea::testing
