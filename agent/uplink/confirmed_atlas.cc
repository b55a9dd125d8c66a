#include "agent/uplink/confirmed_atlas.h"

#include <utility>

#include "agent/absorption/absorption.h"
#include "common/map/map_edit.h"

namespace pangaea {
namespace {

// Decoded payload is a copy of what the agent holds already: tens of kilobytes a keyframe.
void SharePayload(MapEdit& edit, const Atlas& mirror) {
  auto* added = std::get_if<AddKeyframe>(&edit);
  if (added == nullptr) return;
  const Keyframe* keyframe = mirror.FindKeyframe(added->id);
  if (keyframe != nullptr && !IsForgotten(*keyframe)) added->data = keyframe->data;
}

// Whether all fit.
bool ApplyWhatFits(std::span<const MapEdit> edits, Atlas& atlas) {
  bool all_fit = true;
  for (const MapEdit& edit : edits) all_fit = pangaea::Apply(edit, atlas).has_value() && all_fit;
  return all_fit;
}

}  // namespace

std::optional<std::vector<MapEdit>> ConfirmedAtlas::Apply(const Envelope& envelope, const Atlas& mirror, Atlas& atlas,
                                                          bool& all_fit) const {
  auto edits = DecodeEdits(envelope.edits);
  all_fit = false;
  if (!edits) return std::nullopt;
  for (MapEdit& edit : *edits) SharePayload(edit, mirror);
  Atlas changed = atlas;
  all_fit = ApplyWhatFits(*edits, changed);
  if (!all_fit && !corrected_) return std::nullopt;
  atlas = std::move(changed);
  return std::move(*edits);
}

bool ConfirmedAtlas::Take(const Envelope& envelope, const Atlas& mirror) {
  bool all_fit = false;
  auto edits = Apply(envelope, mirror, atlas_, all_fit);
  if (!edits) return false;
  Remember({envelope.sequence, std::move(*edits), {}});
  return all_fit;
}

void ConfirmedAtlas::Forget(std::uint64_t sequence, std::vector<ForgottenKeyframe> keyframes) {
  forgetting_.push_back({sequence, {}, std::move(keyframes)});
  ComeTo(sequence_);
}

void ConfirmedAtlas::ComeTo(std::uint64_t sequence) {
  sequence_ = sequence;
  while (!forgetting_.empty() && forgetting_.front().sequence <= sequence) {
    pangaea::Forget(atlas_, forgetting_.front().forgotten);
    Remember(std::move(forgetting_.front()));
    forgetting_.pop_front();
  }
}

void ConfirmedAtlas::Remember(Taken taken) {
  recent_edits_ += taken.edits.size();
  recent_.push_back(std::move(taken));
  while (recent_edits_ > kMostRecentEdits) AdvanceBase();
}

bool ConfirmedAtlas::Expect(const Envelope& envelope, const Atlas& mirror, Atlas& atlas) const {
  bool all_fit = false;
  const bool counts = Apply(envelope, mirror, atlas, all_fit).has_value();
  for (const Taken& later : forgetting_) {
    if (later.sequence == envelope.sequence) pangaea::Forget(atlas, later.forgotten);
  }
  return counts && all_fit;
}

void ConfirmedAtlas::Replay(const Taken& taken, Atlas& atlas) {
  ApplyWhatFits(taken.edits, atlas);
  if (!taken.forgotten.empty()) pangaea::Forget(atlas, taken.forgotten);
}

void ConfirmedAtlas::AdvanceBase() {
  Replay(recent_.front(), base_);
  base_sequence_ = recent_.front().sequence;
  recent_edits_ -= recent_.front().edits.size();
  recent_.pop_front();
}

std::optional<Atlas> ConfirmedAtlas::At(std::uint64_t sequence) {
  if (!Reaches(sequence)) return std::nullopt;
  while (!recent_.empty() && recent_.front().sequence <= sequence) AdvanceBase();
  return base_;
}

bool ConfirmedAtlas::Absorb(const AgentCorrection& correction) {
  const auto base = At(correction.acknowledged);
  if (!base) return false;
  const AbsorptionInput input{correction.session, correction.version, *base, correction.pieces, correction.complete};
  base_ = PlanAbsorption(*base, input).after;
  corrected_ = true;
  atlas_ = base_;
  for (const Taken& taken : recent_) Replay(taken, atlas_);
  return true;
}

}  // namespace pangaea
