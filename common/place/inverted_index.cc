#include "common/place/inverted_index.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "common/base/check.h"

namespace pangaea {
namespace {

// As if there were one keyframe more, in which every word was shown half: no word is infinitely rare. In an index of a
// few keyframes all words are still common, so that scores are low there: nobody knows yet what tells places apart.
constexpr double kUnseenKeyframes = 1.0;
constexpr double kUnseenShowings = 0.5;

}  // namespace

Status PlaceQueryOptions::Check() const {
  if (candidates == 0 || rescored < candidates) {
    return Fail(ErrorCode::kInvalidArgument, "place query: candidates must be 1 to rescored");
  }
  if (!(min_score >= 0.0 && min_score <= 1.0)) {
    return Fail(ErrorCode::kInvalidArgument, "place query: min_score must be 0 to 1");
  }
  if (posting_budget == 0) return Fail(ErrorCode::kInvalidArgument, "place query: posting_budget must be at least 1");
  return {};
}

void InvertedIndex::Add(const KeyframeId& keyframe, BagOfWords bag) {
  Remove(keyframe);
  if (free_slots_.empty()) {
    free_slots_.push_back(static_cast<Slot>(documents_.size()));
    documents_.emplace_back();
  }
  const Slot slot = free_slots_.back();
  free_slots_.pop_back();
  slots_[keyframe] = slot;
  for (const WordWeight& entry : bag) {
    PANGAEA_CHECK(entry.word < postings_.size());
    postings_[entry.word].push_back({slot, entry.weight});
  }
  documents_[slot] = {keyframe, std::move(bag)};
}

bool InvertedIndex::Remove(const KeyframeId& keyframe) {
  const auto found = slots_.find(keyframe);
  if (found == slots_.end()) return false;
  const Slot slot = found->second;
  slots_.erase(found);
  for (const WordWeight& entry : documents_[slot].bag) {
    std::vector<Posting>& postings = postings_[entry.word];
    const auto posting = std::ranges::find(postings, slot, &Posting::slot);
    *posting = postings.back();  // the order of postings carries no meaning
    postings.pop_back();
  }
  documents_[slot] = {};
  free_slots_.push_back(slot);
  return true;
}

const BagOfWords* InvertedIndex::Find(const KeyframeId& keyframe) const {
  const auto found = slots_.find(keyframe);
  return found == slots_.end() ? nullptr : &documents_[found->second].bag;
}

std::vector<KeyframeId> InvertedIndex::Keyframes() const {
  std::vector<KeyframeId> keyframes;
  keyframes.reserve(slots_.size());
  for (const auto& [keyframe, slot] : slots_) keyframes.push_back(keyframe);
  std::ranges::sort(keyframes);
  return keyframes;
}

PlaceCandidates InvertedIndex::Query(const BagOfWords& bag, const PlaceQueryOptions& options,
                                     const Admits& admits) const {
  PlaceCandidates answer;
  const std::vector<float> rarities = Rarities(bag);
  const std::vector<float> scores = Accumulate(bag, rarities, options.posting_budget, answer.postings_read);
  for (const Slot slot : BestSlots(scores, options.rescored, admits)) {
    double score = 0.0;
    ForEachCommonWord(bag, documents_[slot].bag, [&](std::size_t i, float smaller) {
      score += static_cast<double>(smaller) * static_cast<double>(rarities[i]);
    });
    if (score >= options.min_score) answer.ranked.push_back({documents_[slot].keyframe, score});
  }
  std::ranges::sort(answer.ranked, [](const PlaceCandidate& a, const PlaceCandidate& b) {
    return a.score != b.score ? a.score > b.score : a.keyframe < b.keyframe;
  });
  if (answer.ranked.size() > options.candidates) answer.ranked.resize(options.candidates);
  return answer;
}

// The inverse document frequency of each word of the bag in this index, as a share of that of a word never seen.
std::vector<float> InvertedIndex::Rarities(const BagOfWords& bag) const {
  const double keyframes = static_cast<double>(size()) + kUnseenKeyframes;
  const double highest = std::log(keyframes / kUnseenShowings);
  std::vector<float> rarities;
  rarities.reserve(bag.size());
  for (const WordWeight& entry : bag) {
    PANGAEA_CHECK(entry.word < postings_.size());
    const double showings = static_cast<double>(postings_[entry.word].size()) + kUnseenShowings;
    rarities.push_back(static_cast<float>(std::log(keyframes / showings) / highest));
  }
  return rarities;
}

// Scores by slot, over the rarest words of the bag.
std::vector<float> InvertedIndex::Accumulate(const BagOfWords& bag, const std::vector<float>& rarities,
                                             std::size_t budget, std::size_t& postings_read) const {
  std::vector<std::uint32_t> rarest_first(bag.size());
  std::iota(rarest_first.begin(), rarest_first.end(), 0U);
  std::ranges::stable_sort(rarest_first, {}, [&](std::uint32_t i) { return postings_[bag[i].word].size(); });
  std::vector<float> scores(documents_.size(), 0.0F);
  for (const std::uint32_t i : rarest_first) {
    const std::vector<Posting>& postings = postings_[bag[i].word];
    if (postings.size() > budget - postings_read) break;
    postings_read += postings.size();
    for (const Posting& posting : postings) {
      scores[posting.slot] += std::min(posting.weight, bag[i].weight) * rarities[i];
    }
  }
  return scores;
}

std::vector<InvertedIndex::Slot> InvertedIndex::BestSlots(const std::vector<float>& scores, std::size_t count,
                                                          const Admits& admits) const {
  const auto worse = [&](Slot a, Slot b) {
    return scores[a] != scores[b] ? scores[a] < scores[b] : documents_[a].keyframe > documents_[b].keyframe;
  };
  std::vector<Slot> heap;
  for (Slot slot = 0; slot < scores.size(); ++slot) {
    if (scores[slot] > 0.0F) heap.push_back(slot);
  }
  std::ranges::make_heap(heap, worse);
  std::vector<Slot> best;
  while (!heap.empty() && best.size() < count) {
    std::ranges::pop_heap(heap, worse);
    if (!admits || admits(documents_[heap.back()].keyframe)) best.push_back(heap.back());
    heap.pop_back();
  }
  return best;
}

}  // namespace pangaea
