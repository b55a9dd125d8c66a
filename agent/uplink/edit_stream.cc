#include "agent/uplink/edit_stream.h"

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "common/map/map_edit.h"
#include "common/wire/envelope.h"

namespace pangaea {
namespace {

// How much smaller the envelopes of a repair are, by the number of fruitless ones before it. At the end every edit
// travels alone.
constexpr std::array<std::size_t, 3> kDivisors = {1, 10, kMaxEnvelopeBytes};

}  // namespace

Status EditStreamOptions::Check() const {
  if (Status status = planner.Check(); !status) return status;
  if (Status status = retained.Check(); !status) return status;
  if (envelope_bytes < 1000 || envelope_bytes > kMaxEnvelopeBytes / 2) {
    return Fail(ErrorCode::kInvalidArgument, "uplink: envelope_bytes is " + std::to_string(envelope_bytes) +
                                                 ", allowed is 1000 to " + std::to_string(kMaxEnvelopeBytes / 2));
  }
  if (fruitless_repairs >= 1 && repairs >= 1) return {};
  return Fail(ErrorCode::kInvalidArgument, "uplink: fruitless_repairs and repairs must be >= 1");
}

Status EditStream::Take(std::shared_ptr<const Atlas> snapshot, std::span<const MapEdit> applied_since, PlanKind kind,
                        std::vector<ForgottenKeyframe> forgotten) {
  snapshot_ = std::move(snapshot);
  own_edits_.clear();
  kind_ = kind;
  Status status;
  if (repair_due()) {
    planner_.Note(*snapshot_, applied_since);
  } else {
    status = PlanAll(applied_since, options_.envelope_bytes, forgotten);
  }
  if (!forgotten.empty()) confirmed_.Forget(retained_.last_sequence(), std::move(forgotten));
  constexpr std::uint64_t kTakesBetweenSharing = 10;  // some seconds; only what was added since is compared
  if (++takes_ % kTakesBetweenSharing == 0) {
    planner_.ShareFrames(*snapshot_);
    confirmed_.ShareFrames(*snapshot_);
  }
  return status;
}

std::vector<Rejection> EditStream::OnAck(const EditAck& ack, Time now) {
  const std::uint64_t acknowledged = retained_.acknowledged();
  if (ack.up_to <= retained_.last_sequence()) Confirm(ack);
  std::vector<Rejection> rejections = retained_.OnAck(ack, now);
  // A rejection that was lost on its way with an earlier ack: that envelope counts as taken here, and what the server
  // has cannot be told any more.
  const auto late = [&](const Rejection& rejection) { return rejection.sequence <= acknowledged; };
  if (std::any_of(rejections.begin(), rejections.end(), late)) {
    in_step_ = false;
    gave_up_ = true;
  }
  return rejections;
}

void EditStream::Confirm(const EditAck& ack) {
  std::set<std::uint64_t> rejected;
  for (const Rejection& rejection : ack.rejections) rejected.insert(rejection.sequence);
  for (std::uint64_t sequence = retained_.acknowledged() + 1; sequence <= ack.up_to; ++sequence) {
    const auto envelope = retained_.Find(sequence);
    const bool taken = !rejected.contains(sequence) && envelope && confirmed_.Take(*envelope, planner_.mirror());
    in_step_ = in_step_ && taken;
    confirmed_.ComeTo(sequence);
  }
}

Status EditStream::Continue() {
  if (!retained_.all_acknowledged() || snapshot_ == nullptr) return {};
  if (repair_due()) {
    const Status repaired = Repair();
    // A repair may find that closing a map is all that is missing.
    if (!repaired || !retained_.all_acknowledged()) return repaired;
  }
  Status closed = Retain(planner_.PlanClosing(*snapshot_), options_.envelope_bytes);
  if (!closed || kind_ != PlanKind::kFlush || !retained_.all_acknowledged()) return closed;
  return Retain(planner_.PlanFarewell(), options_.envelope_bytes);
}

Status EditStream::PlanRest() {
  if (snapshot_ == nullptr) return {};
  const Status repaired = Repair();
  const Status closed = Retain(planner_.PlanClosing(*snapshot_), options_.envelope_bytes);
  return repaired ? closed : repaired;
}

Status EditStream::Repair() {
  if (!repair_due() || !CountRepair()) return {};
  planner_.AdoptMirror(Expected());
  in_step_ = true;
  const auto attempt = std::min<std::size_t>(static_cast<std::size_t>(fruitless_), kDivisors.size() - 1);
  return PlanAll({}, options_.envelope_bytes / kDivisors[attempt]);
}

Atlas EditStream::Expected() {
  Atlas expected = confirmed_.atlas();
  for (std::uint64_t sequence = retained_.acknowledged() + 1; sequence <= retained_.last_sequence(); ++sequence) {
    if (const auto envelope = retained_.Find(sequence)) confirmed_.Expect(*envelope, planner_.mirror(), expected);
  }
  return expected;
}

std::optional<Atlas> EditStream::BaseOf(const AgentCorrection& correction) {
  if (IsTooOld(correction) || correction.acknowledged > retained_.acknowledged()) return std::nullopt;
  return confirmed_.At(correction.acknowledged);
}

void EditStream::Absorb(const AgentCorrection& correction) {
  if (!confirmed_.Absorb(correction)) return;
  version_ = correction.version;
  absorbed_at_ = correction.acknowledged;
  // While a repair is due, the mirror is replaced anyway.
  if (!repair_due()) planner_.AdoptMirror(Expected());
}

// False, and given up, when it was tried often enough.
bool EditStream::CountRepair() {
  const std::uint64_t confirmed = confirmed_.atlas().version();
  fruitless_ = repairs_ > 0 && confirmed == confirmed_before_repair_ ? fruitless_ + 1 : 0;
  gave_up_ = fruitless_ >= options_.fruitless_repairs || std::cmp_greater_equal(repairs_, options_.repairs);
  if (gave_up_) return false;
  ++repairs_;
  confirmed_before_repair_ = confirmed;
  return true;
}

Status EditStream::PlanAll(std::span<const MapEdit> applied_since, std::size_t envelope_bytes,
                           std::span<const ForgottenKeyframe> forgotten) {
  UplinkPlan plan = planner_.Plan(*snapshot_, applied_since, kind_, forgotten);
  if (!plan.own_edits.empty()) {
    // The agent will hold what it is asked to: a repair must not take it back.
    Atlas adopted = *snapshot_;
    for (const MapEdit& edit : plan.own_edits) (void)Apply(edit, adopted);
    snapshot_ = std::make_shared<const Atlas>(std::move(adopted));
  }
  own_edits_.insert(own_edits_.end(), plan.own_edits.begin(), plan.own_edits.end());
  return Retain(plan.edits, envelope_bytes);
}

Status EditStream::Retain(std::span<const MapEdit> edits, std::size_t envelope_bytes) {
  Status result;
  for (const auto run : PackEdits(edits, envelope_bytes)) {
    const Status status = retained_.Retain(MakeEnvelope(session_, retained_.next_sequence(), version_, run));
    if (!status) result = status;
  }
  return result;
}

}  // namespace pangaea
