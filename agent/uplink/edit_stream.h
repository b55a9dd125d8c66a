#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "agent/uplink/confirmed_atlas.h"
#include "agent/uplink/retained_edits.h"
#include "agent/uplink/uplink_planner.h"
#include "common/base/result.h"
#include "common/map/atlas.h"
#include "common/wire/edit_packing.h"

namespace pangaea {

struct EditStreamOptions {
  UplinkPlannerOptions planner;
  RetainedEditsOptions retained;
  std::size_t envelope_bytes = kEnvelopeBytes;  // edits are split at about this size
  // After so many repairs in a row of which the server took nothing, what is left is refused for good. The second and
  // the third of them send ever smaller envelopes, so that one bad edit does not take others with it.
  int fruitless_repairs = 3;
  int repairs = 50;  // in the life of the session, whatever came of them

  Status Check() const;
};

// From the agent's map to numbered envelopes and, by way of the acks, to certainty of what the server has. An envelope
// that the server rejects is missing there, and what builds on it may be rejected too. The stream then makes no new
// envelopes until everything sent is answered, and plans anew from what the server truly has: what is missing travels
// in full. Not thread-safe; owned by the uplink thread.
class EditStream {
 public:
  using Time = RetainedEdits::Time;

  // `spill` may be null: then memory is not bounded. It outlives this object.
  EditStream(SessionId session, const EditStreamOptions& options, SpillSink* spill)
      : session_(session), options_(options), planner_(options.planner, session), retained_(options.retained, spill) {}

  // `snapshot` is the agent's atlas after `applied_since`, the edits applied to it since the previous call's snapshot,
  // and after it has forgotten `forgotten`: so does what is known here of the server's, once it has come as far.
  // Everything is taken in any case; an error says that the spill sink refused envelopes, which stay in memory.
  Status Take(std::shared_ptr<const Atlas> snapshot, std::span<const MapEdit> applied_since, PlanKind kind,
              std::vector<ForgottenKeyframe> forgotten = {});
  // Returns the rejections that are new.
  std::vector<Rejection> OnAck(const EditAck& ack, Time now);
  // What the server had of this session, as far as is known here, when it made the correction: what PlanAbsorption
  // needs to know. Nothing while the acks are not that far yet, and where it was too long ago (IsTooOld).
  std::optional<Atlas> BaseOf(const AgentCorrection& correction);
  bool IsTooOld(const AgentCorrection& correction) const {
    return correction.version <= version_ || correction.acknowledged < absorbed_at_ ||
           !confirmed_.Reaches(correction.acknowledged);
  }
  // The agent's atlas has absorbed the correction: so does what is known of the server's. BaseOf gave something before.
  // Follow it with Take of the atlas that absorbed it.
  void Absorb(const AgentCorrection& correction);
  // The agent's atlas: of the newest Take, with own_edits(). There was one.
  const Atlas& snapshot() const { return *snapshot_; }
  // What the server has once it took everything sent, as far as is known here.
  const Atlas& mirror() const { return planner_.mirror(); }
  // What it has for certain.
  const Atlas& confirmed() const { return confirmed_.atlas(); }
  // Of the newest correction absorbed; 0 before any.
  std::uint64_t version() const { return version_; }

  // What has to wait until everything sent is answered: the repair that rejections made necessary, then the closing of
  // maps. Does nothing before. Call after OnAck and Take. Errors as Take.
  Status Continue();
  // The same at once, by what the server would make of the envelopes it has not answered: before the end of the agent.
  Status PlanRest();

  // Nothing is left to do: the server acknowledged everything, or gave_up().
  // Call Continue() first.
  bool finished() const { return retained_.all_acknowledged() && (in_step_ || gave_up_); }
  // The server refuses something for good: it lacks that, and what builds on it.
  bool gave_up() const { return gave_up_; }
  std::uint64_t repairs() const { return repairs_; }
  // After Take with kFlush, once finished: what the agent applies to its own atlas (UplinkPlan::own_edits).
  const std::vector<MapEdit>& own_edits() const { return own_edits_; }

  RetainedEdits& retained() { return retained_; }
  const RetainedEdits& retained() const { return retained_; }

 private:
  bool repair_due() const { return !in_step_ && !gave_up_; }
  void Confirm(const EditAck& ack);
  Status Repair();
  // What the server has once it took everything sent.
  Atlas Expected();
  bool CountRepair();
  Status PlanAll(std::span<const MapEdit> applied_since, std::size_t envelope_bytes,
                 std::span<const ForgottenKeyframe> forgotten = {});
  Status Retain(std::span<const MapEdit> edits, std::size_t envelope_bytes);

  SessionId session_;
  EditStreamOptions options_;
  UplinkPlanner planner_;
  RetainedEdits retained_;
  ConfirmedAtlas confirmed_;
  std::shared_ptr<const Atlas> snapshot_;  // the newest
  PlanKind kind_ = PlanKind::kOngoing;     // of the newest Take
  std::vector<MapEdit> own_edits_;
  // Whether the planner's mirror is what the server has once it took everything sent.
  bool in_step_ = true;
  bool gave_up_ = false;
  std::uint64_t version_ = 0;
  std::uint64_t absorbed_at_ = 0;  // how many envelopes the server had when it made that correction
  std::uint64_t takes_ = 0;
  std::uint64_t repairs_ = 0;
  int fruitless_ = 0;  // repairs in a row of which the server took nothing
  std::uint64_t confirmed_before_repair_ = 0;
};

}  // namespace pangaea
