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
  recent_edits_ += edits->size();
  recent_.push_back({envelope.sequence, std::move(*edits)});
  while (recent_edits_ > kMostRecentEdits) AdvanceBase();
  return all_fit;
}

bool ConfirmedAtlas::Expect(const Envelope& envelope, const Atlas& mirror, Atlas& atlas) const {
  bool all_fit = false;
  return Apply(envelope, mirror, atlas, all_fit) && all_fit;
}

void ConfirmedAtlas::AdvanceBase() {
  ApplyWhatFits(recent_.front().edits, base_);
  base_sequence_ = recent_.front().sequence;
  recent_edits_ -= recent_.front().edits.size();
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
