#include "common/map/covisibility_count.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace pangaea {

void CovisibilityCount::Add(std::span<const Observation> observations) {
  const auto landmark = static_cast<std::uint32_t>(begins_.size() - 1);
  for (const Observation& observation : observations) {
    const std::uint32_t keyframe = IndexOf(observation.keyframe);
    observers_.push_back(keyframe);
    keyframes_[keyframe].landmarks.push_back(landmark);
  }
  begins_.push_back(observers_.size());
}

std::uint32_t CovisibilityCount::IndexOf(KeyframeId id) {
  const auto [found, is_new] = index_.try_emplace(id, static_cast<std::uint32_t>(keyframes_.size()));
  if (is_new) keyframes_.push_back({id, {}});
  return found->second;
}

std::vector<std::uint32_t> CovisibilityCount::Ascending() const {
  std::vector<std::uint32_t> order(keyframes_.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::sort(order, {}, [this](std::uint32_t keyframe) { return keyframes_[keyframe].id; });
  return order;
}

std::vector<Covisibility> CovisibilityCount::Of(std::uint32_t keyframe, std::span<const std::uint32_t> order,
                                                std::vector<std::uint32_t>& shared) const {
  std::size_t edges = 0;
  for (const std::uint32_t landmark : keyframes_[keyframe].landmarks) {
    for (std::size_t i = begins_[landmark]; i < begins_[landmark + 1]; ++i) {
      if (shared[observers_[i]]++ == 0) ++edges;
    }
  }
  std::vector<Covisibility> covisible;
  covisible.reserve(edges);
  for (const std::uint32_t other : order) {
    const std::uint32_t weight = std::exchange(shared[other], 0U);
    if (weight > 0 && other != keyframe) covisible.push_back({keyframes_[other].id, weight});
  }
  return covisible;
}

}  // namespace pangaea
