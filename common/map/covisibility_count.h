#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "common/map/keyframe.h"
#include "common/map/landmark.h"

namespace pangaea {

// Counts the covisibility of a whole atlas at once: each pair of observers costs one addition, where changing it edge
// by edge costs two searches.
class CovisibilityCount {
 public:
  // Expects that each landmark is added once.
  void Add(std::span<const Observation> observations);
  // visit(keyframe id, its covisibility as Keyframe holds it) for each keyframe that observes anything.
  template <typename Visit>
  void ForEach(Visit&& visit) const {
    const std::vector<std::uint32_t> order = Ascending();
    std::vector<std::uint32_t> shared(keyframes_.size(), 0);
    for (const std::uint32_t keyframe : order) visit(keyframes_[keyframe].id, Of(keyframe, order, shared));
  }

 private:
  struct Observer {
    KeyframeId id;
    std::vector<std::uint32_t> landmarks;  // index into begins_
  };

  std::uint32_t IndexOf(KeyframeId id);
  std::vector<std::uint32_t> Ascending() const;  // indices of keyframes, by id
  // `shared` is zero, and so it is left.
  std::vector<Covisibility> Of(std::uint32_t keyframe, std::span<const std::uint32_t> order,
                               std::vector<std::uint32_t>& shared) const;

  std::unordered_map<KeyframeId, std::uint32_t> index_;
  std::vector<Observer> keyframes_;
  std::vector<std::size_t> begins_{0};    // of each landmark's run of observers_, and the end of the last
  std::vector<std::uint32_t> observers_;  // index into keyframes_
};

}  // namespace pangaea
