#include "server/optimization/pose_graph.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <unordered_map>

#include "common/base/check.h"
#include "common/estimation/ceres_run.h"
#include "common/map/spanning_tree.h"
#include "server/optimization/essential_graph.h"
#include "server/optimization/median_depth.h"
#include "server/optimization/pose_graph_cost.h"

namespace pangaea {
namespace {

class PoseGraph {
 public:
  PoseGraph(const Atlas& after_seam, MapId map, const std::map<KeyframeId, double>& held,
            const PoseGraphOptions& options)
      : atlas_(after_seam), map_(map), held_(held), options_(options), tree_(ParentsFirst(after_seam, map)) {
    for (const KeyframeId id : tree_) {
      const auto holding = held.find(id);
      cameras_[id] = ToParameters(Start(*atlas_.FindKeyframe(id), holding == held.end() ? 1.0 : holding->second));
      drifts_in_scale_ = drifts_in_scale_ || IsScaleFree(id);
    }
  }

  void AddEdges(const std::vector<PoseGraphEdge>& edges) {
    const double depth = MedianDepth(atlas_, map_);
    for (const PoseGraphEdge& edge : edges) {
      // What n landmarks measure has a variance that goes with 1 / n; a rotation of one radian displaces what is seen
      // as much as a motion by its depth does, or a scale of e.
      const double weight = std::sqrt(std::max(edge.shared_landmarks, options_.few_landmarks));
      const PoseGraphWeights weights{.translation = weight / depth, .rotation = weight, .scale = weight};
      problem_.AddResidualBlock(MakePoseGraphCost(edge.to_from_from, weights, drifts_in_scale_).release(), nullptr,
                                cameras_.at(edge.from).data(), cameras_.at(edge.to).data());
    }
    for (auto& [id, camera] : cameras_) {
      if (!problem_.HasParameterBlock(camera.data())) continue;
      if (IsHeld(id)) {
        problem_.SetParameterBlockConstant(camera.data());
      } else {
        problem_.SetManifold(camera.data(), IsScaleFree(id) ? &similarities_ : &motions_);
      }
    }
  }

  ceres::Solver::Summary Solve(CeresStopCallback& stop) {
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    options.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
    options.max_num_iterations = options_.iterations;
    options.function_tolerance = options_.cost_tolerance;
    options.num_threads = options_.threads;
    if (options_.max_seconds > 0.0) options.max_solver_time_in_seconds = options_.max_seconds;
    options.logging_type = ceres::SILENT;
    options.callbacks.push_back(&stop);
    SilenceCeresWarnings();
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem_, &summary);
    return summary;
  }

  std::vector<CorrectedKeyframe> Keyframes() const {
    std::vector<CorrectedKeyframe> keyframes;
    for (const KeyframeId id : tree_) {
      if (IsHeld(id)) continue;
      const Similarity3d camera_from_map = ToSimilarity(cameras_.at(id).data());
      // In its own lengths the camera sees what it saw; those of the map are 1 / scale times as long.
      const double scale = IsScaleFree(id) ? 1.0 / camera_from_map.scale() : 1.0;
      keyframes.push_back({id, Rigid3d(camera_from_map.rotation(), scale * camera_from_map.translation()), scale});
    }
    return keyframes;
  }

 private:
  static ceres::Problem::Options ProblemOptions() {
    ceres::Problem::Options options;
    options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    return options;
  }

  // The lengths around it have been multiplied by `scale` since the measurements.
  static Similarity3d Start(const Keyframe& keyframe, double scale) {
    const Rigid3d& camera_from_map = keyframe.camera_from_map;
    return Similarity3d(1.0 / scale, camera_from_map.rotation(), camera_from_map.translation() / scale);
  }

  bool IsHeld(KeyframeId id) const { return held_.empty() ? id == tree_.front() : held_.contains(id); }
  bool IsScaleFree(KeyframeId id) const { return !atlas_.FindKeyframe(id)->data->camera.is_stereo(); }

  const Atlas& atlas_;
  const MapId map_;
  const std::map<KeyframeId, double>& held_;
  const PoseGraphOptions& options_;
  const std::vector<KeyframeId> tree_;
  std::map<KeyframeId, SimilarityParameters> cameras_;
  bool drifts_in_scale_ = false;
  SimilarityManifold motions_{false};
  SimilarityManifold similarities_{true};
  ceres::Problem problem_{ProblemOptions()};
};

}  // namespace

Status PoseGraphOptions::Check() const {
  const auto refuse = [](const char* what) {
    return Fail(ErrorCode::kInvalidArgument, std::string("pose graph: ") + what);
  };
  if (strong_covisibility < 1) return refuse("strong_covisibility must be >= 1");
  if (few_landmarks < 1) return refuse("few_landmarks must be >= 1");
  if (iterations < 1) return refuse("iterations must be >= 1");
  if (!(cost_tolerance >= 0.0)) return refuse("cost_tolerance must be >= 0");
  if (threads < 1) return refuse("threads must be >= 1");
  if (!(max_seconds >= 0.0)) return refuse("max_seconds must be >= 0");
  return {};
}

std::optional<PoseGraphResult> OptimizePoseGraph(const Atlas& before_seam, const Atlas& after_seam, MapId map,
                                                 const std::map<KeyframeId, double>& held,
                                                 const PoseGraphOptions& options, std::stop_token stop) {
  PANGAEA_CHECK(options.Check().has_value());
  if (after_seam.FindMap(map) == nullptr || stop.stop_requested()) return std::nullopt;
  const std::vector<PoseGraphEdge> edges = EssentialGraph(before_seam, after_seam, map, options.strong_covisibility);
  PoseGraphResult result{.correction = {.base = after_seam, .map = map, .keyframes = {}, .landmarks = {}},
                         .edges = edges.size()};
  if (edges.empty()) return result;
  PoseGraph graph(after_seam, map, held, options);
  graph.AddEdges(edges);
  CeresStopCallback callback(std::move(stop));
  const ceres::Solver::Summary summary = graph.Solve(callback);
  if (callback.stopped() || !summary.IsSolutionUsable()) return std::nullopt;
  result.initial_cost = summary.initial_cost;
  result.final_cost = summary.final_cost;
  result.iterations = summary.num_successful_steps + summary.num_unsuccessful_steps - 1;
  result.correction.keyframes = graph.Keyframes();
  return result;
}

}  // namespace pangaea
