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
  if (const Keyframe* keyframe = mirror.FindKeyframe(added->id)) added->data = keyframe->data;
}

// Whether all fit.
bool ApplyWhatFits(std::span<const MapEdit> edits, Atlas& atlas) {
  bool all_fit = true;
  for (const MapEdit& edit : edits) all_fit = Apply(edit, atlas).has_value() && all_fit;
  return all_fit;
}

}  // namespace

bool ConfirmedAtlas::Take(const Envelope& envelope, const Atlas& mirror) {
  auto edits = DecodeEdits(envelope.edits);
  if (!edits) return false;
  for (MapEdit& edit : *edits) SharePayload(edit, mirror);
  Atlas changed = atlas_;
  const bool all_fit = ApplyWhatFits(*edits, changed);
  if (!all_fit && !corrected_) return false;
  atlas_ = std::move(changed);
  recent_.push_back({envelope.sequence, std::move(*edits)});
  if (recent_.size() > kMostRecent) AdvanceBase();
  return all_fit;
}

void ConfirmedAtlas::AdvanceBase() {
  ApplyWhatFits(recent_.front().edits, base_);
  base_sequence_ = recent_.front().sequence;
  recent_.pop_front();
}

std::optional<Atlas> ConfirmedAtlas::At(std::uint64_t sequence) {
  if (sequence < base_sequence_) return std::nullopt;
  while (!recent_.empty() && recent_.front().sequence <= sequence) AdvanceBase();
  return base_;
}

bool ConfirmedAtlas::Absorb(const AgentCorrection& correction) {
  const auto base = At(correction.acknowledged);
  if (!base) return false;
  const AbsorptionInput input{correction.session, correction.version, *base, correction.pieces};
  ApplyWhatFits(PlanAbsorption(*base, input), base_);
  corrected_ = true;
  atlas_ = base_;
  for (const Taken& taken : recent_) ApplyWhatFits(taken.edits, atlas_);
  return true;
}

}  // namespace pangaea
