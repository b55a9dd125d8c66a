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
    : atlas_(atlas), query_(query), options_(options), stages_(stages), own_(OwnAppearances(query)) {}

const PlaceView& PlaceVerification::View() {
  if (!view_) view_ = MakePlaceView(atlas_, query_, options_.geometry.covisible);
  return *view_;
}

PlaceVerdict PlaceVerification::Compare(const PlaceCandidate& candidate) {
  PlaceVerdict verdict;
  verdict.trial.candidate = candidate.keyframe;
  verdict.trial.score = candidate.score;
  const Keyframe& keyframe = *atlas_.FindKeyframe(candidate.keyframe);
  const std::vector<Match> own_matches = MatchOwnLandmarks(keyframe, verdict.trial);
  if (own_matches.size() < options_.geometry.min_own_matches) return verdict;
  const PlaceView view = MakePlaceView(atlas_, keyframe, options_.geometry.covisible);
  const auto motion = Align(view, own_matches, verdict.trial);
  if (motion) Refine(view, *motion, verdict);
  return verdict;
}

PlaceVerdict PlaceVerification::Confirm(const PlaceHypothesis& hypothesis) {
  PlaceVerdict verdict;
  verdict.trial.candidate = hypothesis.candidate;
  verdict.agreeing = hypothesis.agreeing;
  const Keyframe& earlier = *atlas_.FindKeyframe(hypothesis.query);
  const Rigid3d earlier_from_query = earlier.camera_from_map * query_.camera_from_map.Inverse();
  const Keyframe& candidate = *atlas_.FindKeyframe(hypothesis.candidate);
  Refine(MakePlaceView(atlas_, candidate, options_.geometry.covisible),
         hypothesis.candidate_from_query * Similarity3d(earlier_from_query), verdict);
  return verdict;
}

// Landmarks of the query itself and others that look alike, and are turned by the same angle.
std::vector<Match> PlaceVerification::MatchOwn(std::span<const Keypoint> keypoints,
                                               std::span<const Descriptor> descriptors) const {
  const auto matches = MatchBruteForce(own_.descriptors, descriptors, options_.geometry.matching);
  return FilterByRotation(matches, own_.keypoints, keypoints);
}

std::vector<Match> PlaceVerification::MatchOwnLandmarks(const Keyframe& candidate, PlaceTrial& trial) const {
  const StageScope stage(stages_, "place.compare");
  const LandmarkAppearances others = OwnAppearances(candidate);
  auto matches = MatchOwn(others.keypoints, others.descriptors);
  trial.outcome = PlaceOutcome::kFewMatches;
  trial.counts.own_matches = matches.size();
  return matches;
}

std::optional<Similarity3d> PlaceVerification::Align(const PlaceView& candidate, std::span<const Match> matches,
                                                     PlaceTrial& trial) {
  const StageScope stage(stages_, "place.align");
  // The two keyframes' own landmarks first, then those around the candidate as well. A keyframe's own come first in its
  // view, on either side: indices keep their meaning.
  auto motion = FindMotionOf(candidate, matches, trial);
  if (!motion) motion = FindMotionOf(candidate, MatchOwn(candidate.keypoints, candidate.descriptors), trial);
  return motion;
}

std::optional<Similarity3d> PlaceVerification::FindMotionOf(const PlaceView& candidate, std::span<const Match> matches,
                                                            PlaceTrial& trial) {
  trial.counts.matches = matches.size();
  if (matches.size() < options_.geometry.min_matches) return std::nullopt;
  trial.outcome = PlaceOutcome::kNoMotion;
  const std::uint64_t seed = SeedOf(options_.seed, query_.id, candidate.center().id);
  return FindMotion(View(), candidate, matches, options_.geometry, seed, trial.counts.aligned);
}

void PlaceVerification::Refine(const PlaceView& candidate, const Similarity3d& candidate_from_query,
                               PlaceVerdict& verdict) {
  stages_.Begin("place.refine");
  PlaceTrial& trial = verdict.trial;
  const auto alignment = RefineAlignment(View(), candidate, candidate_from_query, options_.geometry, trial.counts);
  stages_.End("place.refine");
  trial.outcome = PlaceOutcome::kFewInliers;
  if (!alignment) return;
  trial.candidate_from_query = alignment->candidate_from_query;
  Ask(candidate.center().id, alignment->candidate_from_query, verdict);
  verdict.match = MakeMatch(candidate, *alignment, trial);
}

// The geometry is verified: what do the keyframes around the query say?
void PlaceVerification::Ask(KeyframeId candidate, const Similarity3d& candidate_from_query, PlaceVerdict& verdict) {
  const StageScope stage(stages_, "place.agree");
  PlaceTrial& trial = verdict.trial;
  std::vector<KeyframeId>& agreeing = verdict.agreeing;
  trial.witnesses = AskSurroundings(atlas_, query_, *atlas_.FindKeyframe(candidate), candidate_from_query, options_);
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
}

PlaceMatch PlaceVerification::MakeMatch(const PlaceView& candidate, const PlaceAlignment& alignment,
                                        const PlaceTrial& trial) {
  PlaceMatch match;
  match.query = query_.id;
  match.candidate = candidate.center().id;
  match.candidate_from_query = alignment.candidate_from_query;
  match.metric = IsMetric(View(), candidate);
  for (const Match& pair : alignment.pairs) {
    match.landmarks.emplace_back(View().landmarks[pair.query].id, candidate.landmarks[pair.train].id);
  }
  match.evidence = {.score = trial.score,
                    .matches = alignment.candidates,
                    .inliers = alignment.pairs.size(),
                    .agreeing = trial.agreeing,
                    .rms_pixels = alignment.rms_sigmas};
  return match;
}

}  // namespace pangaea
