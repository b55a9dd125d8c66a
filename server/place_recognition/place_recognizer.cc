#include "server/place_recognition/place_recognizer.h"

#include <algorithm>
#include <unordered_set>
#include <utility>

#include "common/base/check.h"
#include "server/place_recognition/place_candidates.h"

namespace pangaea {
namespace {

bool AreCovisible(const Keyframe& a, KeyframeId b) {
  return a.id == b || std::ranges::binary_search(a.covisible, b, {}, &Covisibility::keyframe);
}

// Whether a match for the candidate's map is known already.
bool IsMatched(const Atlas& atlas, const std::vector<PlaceMatch>& matches, const Keyframe& candidate) {
  return std::ranges::any_of(
      matches, [&](const PlaceMatch& match) { return atlas.FindKeyframe(match.candidate)->map == candidate.map; });
}

}  // namespace

PlaceRecognizer::PlaceRecognizer(std::shared_ptr<const VocabularyTree> vocabulary,
                                 const PlaceRecognitionOptions& options)
    : vocabulary_(std::move(vocabulary)), options_(options), index_(vocabulary_->words()) {
  PANGAEA_CHECK(options_.Check());
}

void PlaceRecognizer::Synchronize(const Atlas& atlas) {
  for (const KeyframeId id : index_.Keyframes()) {
    if (atlas.FindKeyframe(id) == nullptr) index_.Remove(id);
  }
  atlas.ForEachKeyframe([&](const Keyframe& keyframe) {
    if (index_.Find(keyframe.id) == nullptr) Add(keyframe);
  });
}

void PlaceRecognizer::Add(const Keyframe& keyframe) {
  index_.Add(keyframe.id, vocabulary_->Bag(keyframe.data->features.descriptors));
}

bool PlaceRecognizer::Remove(KeyframeId keyframe) { return index_.Remove(keyframe); }

PlaceRecognition PlaceRecognizer::Recognize(const Atlas& snapshot, KeyframeId query, StageRecorder& stages) {
  PlaceRecognition recognition;
  const Keyframe* keyframe = snapshot.FindKeyframe(query);
  if (keyframe == nullptr) return recognition;
  if (index_.Find(query) == nullptr) {
    const StageScope stage(stages, "place.bag");
    Add(*keyframe);
  }
  AgeHypotheses(snapshot, *keyframe);
  recognition.report.outcome = PlaceOutcome::kFewLandmarks;
  PlaceVerification verification(snapshot, *keyframe, options_, stages);
  if (!verification.possible()) return recognition;
  recognition.report.outcome = PlaceOutcome::kNoCandidate;
  ConfirmHypotheses(snapshot, *keyframe, verification, recognition);
  CompareCandidates(snapshot, *keyframe, verification, stages, recognition);
  for (const PlaceTrial& trial : recognition.report.trials) {
    recognition.report.outcome = std::max(recognition.report.outcome, trial.outcome);
  }
  return recognition;
}

// Forgets those that waited too long, and those whose keyframes are gone.
void PlaceRecognizer::AgeHypotheses(const Atlas& atlas, const Keyframe& query) {
  std::erase_if(hypotheses_, [&](PlaceHypothesis& hypothesis) {
    const Keyframe* earlier = atlas.FindKeyframe(hypothesis.query);
    if (earlier == nullptr || atlas.FindKeyframe(hypothesis.candidate) == nullptr) return true;
    return earlier->map == query.map && ++hypothesis.age > options_.agreement.patience;
  });
}

void PlaceRecognizer::ConfirmHypotheses(const Atlas& atlas, const Keyframe& query, PlaceVerification& verification,
                                        PlaceRecognition& recognition) {
  const std::vector<PlaceHypothesis> waiting = hypotheses_;
  for (const PlaceHypothesis& hypothesis : waiting) {
    const Keyframe& candidate = *atlas.FindKeyframe(hypothesis.candidate);
    if (!AreCovisible(query, hypothesis.query) || AreCovisible(query, candidate.id)) continue;
    if (IsMatched(atlas, recognition.matches, candidate)) continue;
    Take(atlas, verification.Confirm(hypothesis), recognition);
  }
}

void PlaceRecognizer::CompareCandidates(const Atlas& atlas, const Keyframe& query, PlaceVerification& verification,
                                        StageRecorder& stages, PlaceRecognition& recognition) {
  stages.Begin("place.query");
  const std::unordered_set<KeyframeId> surroundings = Surroundings(atlas, query, options_.candidates);
  const PlaceCandidates found = index_.Query(
      *index_.Find(query.id), options_.candidates.query,
      [&](const KeyframeId& id) { return !surroundings.contains(id) && atlas.FindKeyframe(id) != nullptr; });
  stages.End("place.query");
  recognition.report.postings_read = found.postings_read;
  recognition.report.candidates = found.ranked.size();
  for (const PlaceCandidate& candidate : BestOfEachPlace(atlas, found.ranked, options_.candidates)) {
    if (IsMatched(atlas, recognition.matches, *atlas.FindKeyframe(candidate.keyframe))) continue;
    Take(atlas, verification.Compare(candidate), recognition);
  }
}

// Keeps a match, or what may become one.
void PlaceRecognizer::Take(const Atlas& atlas, PlaceVerdict verdict, PlaceRecognition& recognition) {
  recognition.report.trials.push_back(verdict.trial);
  if (!verdict.match) return;
  const PlaceMatch& match = *verdict.match;
  const Keyframe& candidate = *atlas.FindKeyframe(match.candidate);
  const Keyframe& query = *atlas.FindKeyframe(match.query);
  // Whatever was believed of these two places, this verdict knows better.
  std::erase_if(hypotheses_, [&](const PlaceHypothesis& hypothesis) {
    return AreCovisible(query, hypothesis.query) && AreCovisible(candidate, hypothesis.candidate);
  });
  if (verdict.trial.outcome == PlaceOutcome::kFewAgreeing) {
    hypotheses_.push_back({match.query, match.candidate, match.candidate_from_query, std::move(verdict.agreeing), 0});
  }
  if (verdict.trial.outcome == PlaceOutcome::kRecognized) recognition.matches.push_back(std::move(*verdict.match));
}

}  // namespace pangaea
