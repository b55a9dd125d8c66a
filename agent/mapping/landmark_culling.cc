#include "agent/mapping/landmark_culling.h"

#include <algorithm>

#include "common/mapping/view_prediction.h"

namespace pangaea {
namespace {

bool Observes(const Landmark& landmark, KeyframeId keyframe) {
  return std::any_of(landmark.observations.begin(), landmark.observations.end(),
                     [&](const Observation& observation) { return observation.keyframe == keyframe; });
}

bool HasDepth(const Atlas& atlas, const Observation& observation) {
  return atlas.FindKeyframe(observation.keyframe)->data->features.keypoints[observation.keypoint].has_depth();
}

}  // namespace

void LandmarkTrials::Begin(std::span<const MapEdit> edits) {
  for (const MapEdit& edit : edits) {
    if (const auto* added = std::get_if<AddLandmark>(&edit)) trials_.push_back({.landmark = added->id});
  }
}

void LandmarkTrials::CountChances(const Atlas& atlas, const Keyframe& keyframe, double max_view_angle) {
  const Viewpoint viewpoint(keyframe);
  for (Trial& trial : trials_) {
    const Landmark* landmark = atlas.FindLandmark(trial.landmark);
    // Its own creation is no chance.
    if (landmark == nullptr || landmark->reference == keyframe.id || atlas.MapOf(*landmark) != keyframe.map) continue;
    ++trial.keyframes;
    if (Observes(*landmark, keyframe.id)) {
      ++trial.chances;
      ++trial.found;
    } else if (PredictView(atlas, *landmark, viewpoint, max_view_angle)) {
      ++trial.chances;
    }
  }
}

LandmarkTrials::Verdict LandmarkTrials::JudgeOne(const Atlas& atlas, const Landmark& landmark,
                                                 const Trial& trial) const {
  const bool stereo = std::any_of(landmark.observations.begin(), landmark.observations.end(),
                                  [&](const Observation& observation) { return HasDepth(atlas, observation); });
  const std::size_t wanted = stereo ? options_.min_observers_stereo : options_.min_observers_monocular;
  const bool enough = landmark.observations.size() >= wanted;
  const bool over = trial.keyframes >= options_.max_keyframes || trial.chances >= options_.trial_chances;
  if (over) return enough ? Verdict::kTrusted : Verdict::kFailed;
  if (trial.chances >= options_.first_verdict_chances && !enough) return Verdict::kFailed;
  if (trial.chances >= options_.first_verdict_chances && trial.found < options_.min_found_ratio * trial.chances) {
    return Verdict::kFailed;
  }
  return Verdict::kOpen;
}

std::vector<MapEdit> LandmarkTrials::Judge(const Atlas& atlas) {
  std::vector<MapEdit> edits;
  std::erase_if(trials_, [&](const Trial& trial) {
    const Landmark* landmark = atlas.FindLandmark(trial.landmark);
    if (landmark == nullptr) return true;  // fused or removed meanwhile
    const Verdict verdict = JudgeOne(atlas, *landmark, trial);
    if (verdict == Verdict::kFailed) edits.push_back(RemoveLandmark{.id = trial.landmark});
    return verdict != Verdict::kOpen;
  });
  return edits;
}

}  // namespace pangaea
