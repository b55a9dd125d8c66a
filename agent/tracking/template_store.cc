#include "agent/tracking/template_store.h"

namespace pangaea {

std::span<const PatchTemplate> TemplateStore::Find(LandmarkId landmark) const {
  const auto found = templates_.find(landmark);
  if (found == templates_.end()) return {};
  return found->second;
}

void TemplateStore::Add(LandmarkId landmark, const PatchTemplate& view) {
  auto [entry, is_new] = templates_.try_emplace(landmark);
  std::vector<PatchTemplate>& views = entry->second;
  if (views.size() >= kViewsPerLandmark) views.erase(views.begin() + 1);
  views.push_back(view);
  if (!is_new) return;
  order_.push_back(landmark);
  if (order_.size() <= max_landmarks_) return;
  templates_.erase(order_.front());
  order_.pop_front();
}

void TemplateStore::Clear() {
  templates_.clear();
  order_.clear();
}

}  // namespace pangaea
