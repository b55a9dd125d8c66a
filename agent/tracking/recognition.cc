#include "agent/tracking/recognition.h"

#include <algorithm>
#include <utility>

namespace pangaea {

Recognition::Recognition(const IdealCamera& camera, const RecognitionOptions& options,
                         std::shared_ptr<const VocabularyTree> vocabulary, std::uint64_t seed)
    : camera_(camera), options_(options), seed_(seed), memory_(std::move(vocabulary)) {}

std::vector<KeyframeId> Recognition::Candidates(const Features& features, std::span<const KeyframeId> nearby,
                                                const InvertedIndex::Admits& admits) const {
  std::vector<KeyframeId> candidates = memory_.Candidates(features.descriptors, options_.place_candidates, admits);
  for (const KeyframeId id : nearby.first(std::min(nearby.size(), options_.local_candidates))) {
    if (std::find(candidates.begin(), candidates.end(), id) == candidates.end()) candidates.push_back(id);
  }
  return candidates;
}

std::optional<RecognisedFrame> Recognition::Locate(const Features& features, const Atlas& atlas,
                                                   std::span<const KeyframeId> candidates,
                                                   const Surroundings& surroundings, const Trust& trust) const {
  return LocateBy(1, features, atlas, candidates, surroundings, trust);
}

std::optional<RecognisedFrame> Recognition::LocateWidely(const Features& features, const Atlas& atlas,
                                                         std::span<const KeyframeId> candidates,
                                                         const Surroundings& surroundings, const Trust& trust) const {
  auto found = Locate(features, atlas, candidates, surroundings, trust);
  return found ? std::move(found) : LocateBy(options_.window, features, atlas, candidates, surroundings, trust);
}

std::optional<RecognisedFrame> Recognition::LocateBy(std::size_t window, const Features& features, const Atlas& atlas,
                                                     std::span<const KeyframeId> candidates,
                                                     const Surroundings& surroundings, const Trust& trust) const {
  const auto poses = Relocalize(camera_, features, atlas, candidates, window, options_.relocalization, seed_);
  for (std::size_t i = 0; i < std::min(poses.size(), options_.verified); ++i) {
    auto found = LocateNear(features, atlas, poses[i].keyframe, poses[i].camera_from_map, surroundings, trust);
    if (found) return found;
  }
  return std::nullopt;
}

std::optional<RecognisedFrame> Recognition::LocateNear(const Features& features, const Atlas& atlas,
                                                       KeyframeId keyframe, const Rigid3d& rough_camera_from_map,
                                                       const Surroundings& surroundings, const Trust& trust) const {
  LocalMap local_map = surroundings(keyframe);
  auto frame = LocateByDescriptors(camera_, features, atlas, rough_camera_from_map, local_map, options_.guided);
  if (!frame || !trust(*frame, local_map)) return std::nullopt;
  return RecognisedFrame{atlas.FindKeyframe(keyframe)->map, std::move(*frame), std::move(local_map)};
}

}  // namespace pangaea
