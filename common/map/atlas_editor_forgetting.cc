// How AtlasEditor takes from an atlas what it is to forget.
#include <algorithm>
#include <map>
#include <utility>

#include "common/map/atlas_editor.h"

namespace pangaea {
namespace {

// Which blocks of landmark ids hold none that lives.
class DeadBlocks {
 public:
  void Count(std::uint32_t counter, bool used, bool alive) {
    if (used) newest_ = std::max(newest_, counter);
    bool& lives = lives_[counter / kBlock];
    lives = lives || alive;
  }
  bool Holds(std::uint32_t counter) const { return !IsRecent(counter / kBlock) && !lives_.at(counter / kBlock); }
  // A quarter: to give them back costs a copy of all the others.
  bool AreMany() const {
    const auto dead = std::count_if(lives_.begin(), lives_.end(),
                                    [this](const auto& block) { return !block.second && !IsRecent(block.first); });
    return dead > 0 && 4 * static_cast<std::size_t>(dead) >= lives_.size();
  }

 private:
  static constexpr std::uint32_t kBlock = 32;     // as the table's chunks: half a chunk frees nothing
  static constexpr std::uint32_t kLately = 2048;  // ids: what a late edit may still speak of, about ten keyframes'

  bool IsRecent(std::uint32_t block) const { return (block + 1) * kBlock + kLately > newest_; }

  std::map<std::uint32_t, bool> lives_;
  std::uint32_t newest_ = 0;
};

}  // namespace

void AtlasEditor::ForgetKeyframe(KeyframeId id) {
  const std::vector<LandmarkId> landmarks = atlas_.FindKeyframe(id)->landmarks;
  UnobserveAll(id);
  for (const LandmarkId landmark : landmarks) {
    if (landmark.valid() && atlas_.FindLandmark(landmark) == nullptr) WriteSlot(landmark) = std::monostate();
  }
  Keyframe& keyframe = WriteKeyframe(id);
  auto place = std::make_shared<KeyframeData>();
  place->stamp_ns = keyframe.data->stamp_ns;
  place->camera = keyframe.data->camera;
  place->vergence = keyframe.data->vergence;
  place->arrival = keyframe.data->arrival;
  keyframe.data = std::move(place);
  keyframe.landmarks = {};
  keyframe.covisible = {};
}

void AtlasEditor::RecallKeyframe(KeyframeId id, std::shared_ptr<const KeyframeData> data) {
  Keyframe& keyframe = WriteKeyframe(id);
  keyframe.data = std::move(data);
  keyframe.landmarks.resize(keyframe.data->features.keypoints.size());
}

void AtlasEditor::DropFormerLandmarks() {
  for (Atlas::Part& part : atlas_.parts_) {
    using Slot = Atlas::LandmarkSlot;
    DeadBlocks dead;
    part.landmarks.ForEach([&](std::uint32_t counter, const Slot& slot) {
      dead.Count(counter, !std::holds_alternative<std::monostate>(slot), std::holds_alternative<Landmark>(slot));
    });
    if (!dead.AreMany()) continue;
    decltype(part.landmarks) kept;
    part.landmarks.ForEach([&](std::uint32_t counter, const Slot& slot) {
      const bool used = !std::holds_alternative<std::monostate>(slot);
      if (used && !dead.Holds(counter)) kept.Write(counter, atlas_.mark_) = slot;
    });
    part.landmarks = std::move(kept);
  }
  DropForwardsToNothing();
}

void AtlasEditor::DropForwardsToNothing() {
  std::vector<LandmarkId> dangling;
  do {
    dangling.clear();
    atlas_.ForEachFormerLandmark([&](LandmarkId id, LandmarkId absorber) {
      if (absorber.valid() && !atlas_.Knows(absorber)) dangling.push_back(id);
    });
    for (const LandmarkId id : dangling) WriteSlot(id) = std::monostate();
  } while (!dangling.empty());
}

}  // namespace pangaea
