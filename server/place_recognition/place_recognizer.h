#pragma once

#include <memory>
#include <vector>

#include "common/base/stage_recorder.h"
#include "common/map/atlas.h"
#include "common/place/inverted_index.h"
#include "common/place/vocabulary_tree.h"
#include "server/place_recognition/place_recognition_options.h"
#include "server/place_recognition/place_report.h"
#include "server/place_recognition/place_verification.h"

namespace pangaea {

// Recognises places: from a keyframe that has just entered the atlas to keyframes elsewhere in it that show the same
// place, verified by geometry (Elvira et al. 2019, "Seamless map merging"; Mur-Artal et al. 2015, section VII). One
// index over all maps of a site. One owner; deterministic: the same calls give the same answers.
class PlaceRecognizer {
 public:
  // The options passed Check().
  PlaceRecognizer(std::shared_ptr<const VocabularyTree> vocabulary, const PlaceRecognitionOptions& options);

  // Brings the index up to the atlas: keyframes that are new come in, those that are gone go out. Costs a look at every
  // keyframe; for recovery, and wherever Add and Remove might have missed something.
  void Synchronize(const Atlas& atlas);
  void Add(const Keyframe& keyframe);
  // False where it was not in the index.
  bool Remove(KeyframeId keyframe);

  // Where else is what this keyframe sees? Adds it to the index where it is missing. The snapshot may be older or newer
  // than the index: keyframes in one alone are passed over. A keyframe whose landmarks have not come yet
  // (kFewLandmarks) may be asked again later. Stages: "place.bag", "place.query", "place.compare", "place.align",
  // "place.refine", "place.agree".
  PlaceRecognition Recognize(const Atlas& snapshot, KeyframeId query, StageRecorder& stages);

  const InvertedIndex& index() const { return index_; }
  const VocabularyTree& vocabulary() const { return *vocabulary_; }
  const std::vector<PlaceHypothesis>& hypotheses() const { return hypotheses_; }

 private:
  void AgeHypotheses(const Atlas& atlas, const Keyframe& query);
  void ConfirmHypotheses(const Atlas& atlas, const Keyframe& query, PlaceVerification& verification,
                         PlaceRecognition& recognition);
  void CompareCandidates(const Atlas& atlas, const Keyframe& query, PlaceVerification& verification,
                         StageRecorder& stages, PlaceRecognition& recognition);
  void Take(const Atlas& atlas, PlaceVerdict verdict, PlaceRecognition& recognition);

  std::shared_ptr<const VocabularyTree> vocabulary_;
  PlaceRecognitionOptions options_;
  InvertedIndex index_;
  std::vector<PlaceHypothesis> hypotheses_;  // in the order they came up
};

}  // namespace pangaea
