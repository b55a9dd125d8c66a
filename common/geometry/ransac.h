#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>
#include <random>
#include <span>
#include <vector>

#include "common/base/check.h"

namespace pangaea {

struct RansacOptions {
  std::size_t sample_size = 0;  // data a minimal solution needs
  int max_iterations = 300;
  // Where a sample of inliers alone may still be far from the best model, because noise moves what so few data leave
  // open.
  int min_iterations = 1;
  // The search ends when a sample of inliers alone has been drawn with this probability, at the best inlier ratio so
  // far.
  double confidence = 0.999;
};

// How well a model explains the data. A model with a lower cost is better; its inliers steer the iteration count.
struct RansacScore {
  double cost = std::numeric_limits<double>::infinity();
  std::size_t inliers = 0;
};

template <typename Model>
struct RansacResult {
  Model model;
  RansacScore score;
  std::vector<std::uint8_t> inliers;  // per datum, 0 or 1
  int iterations = 0;                 // samples drawn
};

// Draws distinct indices below `count`, the same ones from the same seed on every platform.
class SampleDrawer {
 public:
  SampleDrawer(std::size_t count, std::uint64_t seed) : order_(count), random_(seed) {
    std::iota(order_.begin(), order_.end(), std::size_t{0});
  }
  // A partial Fisher-Yates shuffle; the span is valid until the next draw.
  std::span<const std::size_t> Draw(std::size_t size) {
    PANGAEA_CHECK(size <= order_.size());
    for (std::size_t i = 0; i < size; ++i) std::swap(order_[i], order_[i + random_() % (order_.size() - i)]);
    return {order_.data(), size};
  }

 private:
  std::vector<std::size_t> order_;
  std::mt19937_64 random_;
};

// Samples needed so that one is free of outliers with probability `confidence`.
inline int RequiredIterations(double inlier_ratio, std::size_t sample_size, double confidence, int max_iterations) {
  const double clean_sample = std::pow(inlier_ratio, static_cast<double>(sample_size));
  if (clean_sample >= 1.0) return 1;
  if (clean_sample <= 0.0) return max_iterations;
  const double needed = std::ceil(std::log1p(-confidence) / std::log1p(-clean_sample));
  return needed < max_iterations ? std::max(1, static_cast<int>(needed)) : max_iterations;
}

// Random sample consensus (Fischler and Bolles 1981) over `data_size` data, with local optimisation of each new best
// model (Chum et al. 2003). The callables:
//   solve(std::span<const std::size_t> sample, std::vector<Model>& models)  appends the models of a minimal sample;
//   score(const Model&, std::span<std::uint8_t> inliers) -> RansacScore     judges a model, sets every datum's flag;
//   improve(const Model&, std::span<const std::uint8_t> inliers) -> std::optional<Model>   fits to the inliers.
// Nothing when there are fewer data than a sample needs, or no sample gave a model of finite cost.
template <typename Model, typename Solve, typename Score, typename Improve>
std::optional<RansacResult<Model>> Ransac(std::size_t data_size, const RansacOptions& options, std::uint64_t seed,
                                          Solve&& solve, Score&& score, Improve&& improve) {
  PANGAEA_CHECK(options.sample_size > 0);
  if (data_size < options.sample_size) return std::nullopt;
  SampleDrawer drawer(data_size, seed);
  std::optional<RansacResult<Model>> best;
  std::vector<Model> models;
  std::vector<std::uint8_t> flags(data_size);
  const auto keep_if_better = [&](const Model& model) {
    const RansacScore judged = score(model, std::span<std::uint8_t>(flags));
    if (!std::isfinite(judged.cost) || (best && judged.cost >= best->score.cost)) return false;
    best = RansacResult<Model>{model, judged, flags, 0};
    return true;
  };
  int needed = options.max_iterations;
  const int least = std::min(options.min_iterations, options.max_iterations);
  int iteration = 0;
  for (; iteration < needed; ++iteration) {
    models.clear();
    solve(drawer.Draw(options.sample_size), models);
    bool improved = false;
    for (const Model& model : models) improved = keep_if_better(model) || improved;
    if (!improved) continue;
    const std::optional<Model> optimised = improve(best->model, std::span<const std::uint8_t>(best->inliers));
    if (optimised) keep_if_better(*optimised);
    const double inlier_ratio = static_cast<double>(best->score.inliers) / static_cast<double>(data_size);
    needed = std::min(needed, std::max(std::max(iteration + 1, least),
                                       RequiredIterations(inlier_ratio, options.sample_size, options.confidence,
                                                          options.max_iterations)));
  }
  if (best) best->iterations = iteration;
  return best;
}

}  // namespace pangaea
