#include "agent/mapping/vergence_check.h"

#include <algorithm>
#include <cmath>
#include <span>
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

bool Contains(std::span<const KeyframeId> keyframes, KeyframeId id) {
  return std::ranges::find(keyframes, id) != keyframes.end();
}

// The keyframe's session's keyframes around it, at most so many, without those of `others` and those forgotten.
std::vector<KeyframeId> SessionAround(const Atlas& atlas, KeyframeId id, std::size_t keyframes,
                                      std::span<const KeyframeId> others) {
  std::vector<KeyframeId> around = GrowWindow(atlas, id, atlas.keyframe_count());
  std::erase_if(around, [&](KeyframeId other) {
    return other.session != id.session || IsForgotten(*atlas.FindKeyframe(other)) || Contains(others, other);
  });
  around.resize(std::min(around.size(), keyframes));
  return around;
}

// What the session has flown in this map apart from these keyframes, in order of time; forgotten ones among them.
std::vector<KeyframeId> Elsewhere(const Atlas& atlas, KeyframeId newest, std::span<const KeyframeId> apart) {
  const MapId map = atlas.FindKeyframe(newest)->map;
  std::vector<KeyframeId> elsewhere;
  atlas.ForEachKeyframe(newest.session, [&](const Keyframe& keyframe) {
    if (keyframe.map == map && !Contains(apart, keyframe.id)) elsewhere.push_back(keyframe.id);
  });
  return elsewhere;
}

// So many around the middle of these, as far as they are not forgotten.
std::vector<KeyframeId> WitnessAmong(const Atlas& atlas, std::vector<KeyframeId> elsewhere, std::size_t keyframes,
                                     std::span<const KeyframeId> apart) {
  std::erase_if(elsewhere, [&](KeyframeId id) { return IsForgotten(*atlas.FindKeyframe(id)); });
  if (elsewhere.empty()) return {};
  return SessionAround(atlas, elsewhere[elsewhere.size() / 2], keyframes, apart);
}

// Moved against the oldest, which alone is held: its neighbours have the scale that wrong disparities gave them.
BundleWindow WindowOf(const Atlas& atlas, std::vector<KeyframeId> keyframes) {
  BundleWindow window;
  window.free = std::move(keyframes);
  window.landmarks = LandmarksSeenBy(atlas, window.free);
  const auto oldest = std::ranges::min_element(window.free);
  window.fixed.push_back(*oldest);
  window.free.erase(oldest);
  return window;
}

// How far off the vergence is by what these keyframes saw: 0 where it is not by more than chance and worth a
// correction, none where they cannot tell.
std::optional<double> ErrorSeenBy(const Atlas& atlas, std::vector<KeyframeId> keyframes, const VergenceOptions& options,
                                  const MeasurementNoiseOptions& noise, const std::stop_token& stop) {
  const double focal_x = atlas.FindKeyframe(keyframes.front())->data->camera.focal_x;
  BundleOptions solver;
  solver.iterations = options.iterations;
  solver.cost_tolerance = options.cost_tolerance;
  solver.stop = stop;
  MeasurementNoiseOptions all = noise;
  all.max_depth_baselines = kAnyDepth;
  const auto estimate =
      EstimateVergence(BuildWindowBundle(atlas, WindowOf(atlas, std::move(keyframes)), all).problem, solver);
  if (!estimate) return std::nullopt;
  const double error = std::abs(estimate->vergence);
  if (error * focal_x < options.min_shift || error < options.min_sigmas * estimate->sigma) return 0.0;
  return estimate->vergence;
}

}  // namespace

VergenceFinding FindBetterVergence(const Atlas& atlas, KeyframeId newest, const VergenceOptions& options,
                                   const MeasurementNoiseOptions& noise, const std::stop_token& stop) {
  const VergenceFinding cannot_tell;
  const VergenceFinding none_better{.could_tell = true, .better = std::nullopt};
  const KeyframeData& data = *atlas.FindKeyframe(newest)->data;
  if (!data.camera.is_stereo()) return cannot_tell;
  const std::vector<KeyframeId> window = SessionAround(atlas, newest, options.window_keyframes, {});
  if (window.size() < options.first_keyframes) return cannot_tell;
  std::optional<double> error = ErrorSeenBy(atlas, window, options, noise, stop);
  if (!error) return cannot_tell;
  if (*error == 0.0) return none_better;
  const std::vector<KeyframeId> elsewhere = Elsewhere(atlas, newest, window);
  if (elsewhere.size() < options.first_keyframes) {
    if (std::abs(*error) * data.camera.focal_x < options.min_lone_shift) return none_better;
  } else {
    const std::vector<KeyframeId> witness = WitnessAmong(atlas, elsewhere, options.window_keyframes, window);
    if (witness.size() < options.first_keyframes) return cannot_tell;
    const auto other = ErrorSeenBy(atlas, witness, options, noise, stop);
    if (!other) return cannot_tell;
    if (*other == 0.0 || std::signbit(*other) != std::signbit(*error)) return none_better;
    if (std::abs(*other) < std::abs(*error)) error = other;
  }
  const double vergence = data.vergence + *error;
  if (std::abs(vergence) > kMaxVergence) return none_better;
  return {.could_tell = true, .better = vergence};
}

}  // namespace pangaea
