#include "agent/mapping/vergence_check.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "common/estimation/vergence_estimate.h"
#include "common/map/covisibility.h"
#include "common/map/forgetting.h"
#include "common/map/limits.h"
#include "common/mapping/bundle_window.h"

namespace pangaea {
namespace {

// Far points, whose depth is mostly the calibration's error, tell the most about that.
constexpr double kAnyDepth = 1e9;  // baselines

// Moved against the oldest, which alone is held: its neighbours have the scale that wrong disparities gave them.
BundleWindow WindowOf(const Atlas& atlas, KeyframeId newest, std::size_t keyframes) {
  BundleWindow window;
  window.free = GrowWindow(atlas, newest, keyframes);
  std::erase_if(window.free,
                [&](KeyframeId id) { return id.session != newest.session || IsForgotten(*atlas.FindKeyframe(id)); });
  if (window.free.empty()) return window;
  window.landmarks = LandmarksSeenBy(atlas, window.free);
  const auto oldest = std::ranges::min_element(window.free);
  window.fixed.push_back(*oldest);
  window.free.erase(oldest);
  return window;
}

}  // namespace

std::optional<double> FindBetterVergence(const Atlas& atlas, KeyframeId newest, const VergenceOptions& options,
                                         const MeasurementNoiseOptions& noise, const std::stop_token& stop) {
  const KeyframeData& data = *atlas.FindKeyframe(newest)->data;
  if (!data.camera.is_stereo()) return std::nullopt;
  const BundleWindow window = WindowOf(atlas, newest, options.window_keyframes);
  if (window.free.size() + 1 < options.first_keyframes) return std::nullopt;
  BundleOptions solver;
  solver.iterations = options.iterations;
  solver.cost_tolerance = options.cost_tolerance;
  solver.stop = stop;
  MeasurementNoiseOptions all = noise;
  all.max_depth_baselines = kAnyDepth;
  const auto estimate = EstimateVergence(BuildWindowBundle(atlas, window, all).problem, solver);
  if (!estimate) return std::nullopt;
  const double change = std::abs(estimate->vergence);
  const bool worth_it =
      change * data.camera.focal_x >= options.min_shift && change >= options.min_sigmas * estimate->sigma;
  const double vergence = data.vergence + estimate->vergence;
  if (!worth_it || std::abs(vergence) > kMaxVergence) return std::nullopt;
  return vergence;
}

}  // namespace pangaea
