#include "server/place_recognition/place_verification.h"

#include <algorithm>
#include <utility>

#include "server/place_recognition/place_agreement.h"
#include "server/place_recognition/place_alignment.h"

namespace pangaea {
namespace {

// Of a pair of keyframes, whatever was asked before.
std::uint64_t SeedOf(std::uint64_t seed, KeyframeId query, KeyframeId candidate) {
  const std::uint64_t ids = std::hash<KeyframeId>()(query) * 0x9e3779b97f4a7c15ULL ^ std::hash<KeyframeId>()(candidate);
  return seed ^ ids;
}

}  // namespace

PlaceVerification::PlaceVerification(const Atlas& atlas, const Keyframe& query, const PlaceRecognitionOptions& options,
                                     StageRecorder& stages)
    : atlas_(atlas),
      query_(query),
      options_(options),
      stages_(stages),
      view_(MakePlaceView(atlas, query, options.geometry.covisible)) {}

PlaceVerdict PlaceVerification::Compare(const PlaceCandidate& candidate) const {
  PlaceVerdict verdict;
  PlaceTrial& trial = verdict.trial;
  trial.candidate = candidate.keyframe;
  trial.score = candidate.score;
  stages_.Begin("place.align");
  const PlaceView view = MakePlaceView(atlas_, *atlas_.FindKeyframe(candidate.keyframe), options_.geometry.covisible);
  const auto motion =
      FindMotion(view_, view, options_.geometry, SeedOf(options_.seed, query_.id, candidate.keyframe), trial.counts);
  stages_.End("place.align");
  if (!motion) {
    trial.outcome =
        trial.counts.matches < options_.geometry.min_matches ? PlaceOutcome::kFewMatches : PlaceOutcome::kNoMotion;
    return verdict;
  }
  stages_.Begin("place.refine");
  const auto alignment = RefineAlignment(view_, view, *motion, options_.geometry, trial.counts);
  stages_.End("place.refine");
  trial.outcome = PlaceOutcome::kFewInliers;
  if (alignment) Finish(view, *alignment, verdict);
  return verdict;
}

PlaceVerdict PlaceVerification::Confirm(const PlaceHypothesis& hypothesis) const {
  PlaceVerdict verdict;
  verdict.trial.candidate = hypothesis.candidate;
  verdict.trial.outcome = PlaceOutcome::kFewInliers;
  const Keyframe& earlier = *atlas_.FindKeyframe(hypothesis.query);
  const Rigid3d earlier_from_query = earlier.camera_from_map * query_.camera_from_map.Inverse();
  const Similarity3d candidate_from_query = hypothesis.candidate_from_query * Similarity3d(earlier_from_query);
  stages_.Begin("place.refine");
  const PlaceView view = MakePlaceView(atlas_, *atlas_.FindKeyframe(hypothesis.candidate), options_.geometry.covisible);
  const auto alignment = RefineAlignment(view_, view, candidate_from_query, options_.geometry, verdict.trial.counts);
  stages_.End("place.refine");
  if (!alignment) return verdict;
  verdict.agreeing = hypothesis.agreeing;
  Finish(view, *alignment, verdict);
  return verdict;
}

// The geometry is verified: asks the others.
void PlaceVerification::Finish(const PlaceView& candidate, const PlaceAlignment& alignment,
                               PlaceVerdict& verdict) const {
  const StageScope stage(stages_, "place.agree");
  std::vector<KeyframeId>& agreeing = verdict.agreeing;
  PlaceTrial& trial = verdict.trial;
  const Keyframe& other = *atlas_.FindKeyframe(candidate.center().id);
  trial.witnesses = AskCovisibleKeyframes(atlas_, query_, other, alignment.candidate_from_query, options_);
  agreeing.push_back(query_.id);
  for (const PlaceWitness& witness : trial.witnesses) {
    if (witness.vote == PlaceVote::kYes) agreeing.push_back(witness.keyframe);
    if (witness.vote == PlaceVote::kNo) ++trial.contradicting;
  }
  std::ranges::sort(agreeing);
  agreeing.erase(std::unique(agreeing.begin(), agreeing.end()), agreeing.end());
  trial.agreeing = agreeing.size();
  trial.outcome = PlaceOutcome::kRecognized;
  if (trial.agreeing < options_.agreement.keyframes) trial.outcome = PlaceOutcome::kFewAgreeing;
  if (trial.contradicting > 0) trial.outcome = PlaceOutcome::kContradicted;
  verdict.match = MakeMatch(candidate, alignment, trial);
}

PlaceMatch PlaceVerification::MakeMatch(const PlaceView& candidate, const PlaceAlignment& alignment,
                                        const PlaceTrial& trial) const {
  PlaceMatch match;
  match.query = query_.id;
  match.candidate = candidate.center().id;
  match.candidate_from_query = alignment.candidate_from_query;
  match.metric = IsMetric(view_, candidate);
  for (const Match& pair : alignment.pairs) {
    match.landmarks.emplace_back(view_.landmarks[pair.query].id, candidate.landmarks[pair.train].id);
  }
  match.evidence = {.score = trial.score,
                    .matches = alignment.candidates,
                    .inliers = alignment.pairs.size(),
                    .agreeing = trial.agreeing,
                    .rms_pixels = alignment.rms_sigmas};
  return match;
}

}  // namespace pangaea
