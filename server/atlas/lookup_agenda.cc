#include "server/atlas/lookup_agenda.h"

#include <algorithm>

namespace pangaea {
namespace {

std::size_t LandmarkCount(const Atlas& atlas, KeyframeId id) {
  const Keyframe* keyframe = atlas.FindKeyframe(id);
  if (keyframe == nullptr) return 0;
  return static_cast<std::size_t>(std::ranges::count_if(keyframe->landmarks, &LandmarkId::valid));
}

}  // namespace

Status LookupOptions::Check() const {
  if (recent >= 1) return {};
  return Fail(ErrorCode::kInvalidArgument, "recent is 0; at least 1 is needed");
}

std::vector<KeyframeId> LookupAgenda::Update(const Atlas& atlas) {
  std::vector<KeyframeId> vanished = DropVanished(atlas);
  ResumeDeferred(atlas);
  if (known_.size() == atlas.keyframe_count()) return vanished;
  atlas.ForEachKeyframe([this](const Keyframe& keyframe) {
    if (known_.insert(keyframe.id).second) Enter(keyframe.id);
  });
  return vanished;
}

std::vector<KeyframeId> LookupAgenda::DropVanished(const Atlas& atlas) {
  std::vector<KeyframeId> vanished;
  std::erase_if(known_, [&](KeyframeId id) {
    if (atlas.FindKeyframe(id) != nullptr) return false;
    vanished.push_back(id);
    return true;
  });
  if (vanished.empty()) return vanished;
  const auto unknown = [this](KeyframeId id) { return !known_.contains(id); };
  std::erase_if(backlog_, unknown);
  std::erase_if(deferred_, [&](const auto& entry) { return unknown(entry.first); });
  for (auto& [session, ids] : recent_) std::erase_if(ids, unknown);
  std::erase_if(recent_, [](const auto& session) { return session.second.empty(); });
  return vanished;
}

// Landmarks travel behind their keyframe, often in a later envelope.
void LookupAgenda::ResumeDeferred(const Atlas& atlas) {
  std::erase_if(deferred_, [&](const auto& entry) {
    if (LandmarkCount(atlas, entry.first) <= entry.second) return false;
    backlog_.push_front(entry.first);
    return true;
  });
}

void LookupAgenda::Defer(const Atlas& atlas, KeyframeId id) {
  if (known_.contains(id)) deferred_[id] = LandmarkCount(atlas, id);
}

void LookupAgenda::Enter(KeyframeId id) {
  std::deque<KeyframeId>& recent = recent_[id.session];
  recent.push_back(id);
  if (recent.size() <= options_.recent) return;
  backlog_.push_back(recent.front());
  recent.pop_front();
}

std::optional<KeyframeId> LookupAgenda::Next() {
  if (!recent_.empty()) {
    auto session = recent_.upper_bound(served_);
    if (session == recent_.end()) session = recent_.begin();
    served_ = session->first;
    const KeyframeId id = session->second.front();
    session->second.pop_front();
    if (session->second.empty()) recent_.erase(session);
    return id;
  }
  if (backlog_.empty()) return std::nullopt;
  const KeyframeId id = backlog_.back();
  backlog_.pop_back();
  return id;
}

std::size_t LookupAgenda::waiting() const {
  std::size_t waiting = backlog_.size();
  for (const auto& [session, ids] : recent_) waiting += ids.size();
  return waiting;
}

}  // namespace pangaea
