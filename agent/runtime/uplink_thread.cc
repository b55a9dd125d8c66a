#include "agent/runtime/uplink_thread.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <future>
#include <optional>
#include <thread>
#include <utility>
#include <variant>

#include "agent/runtime/answer_slot.h"
#include "agent/runtime/downlink.h"
#include "agent/runtime/forgetting_advice.h"
#include "agent/runtime/spill_file.h"
#include "agent/runtime/uplink_endpoints.h"
#include "agent/uplink/envelope_sender.h"
#include "common/base/bounded_queue.h"
#include "common/base/mutex.h"
#include "common/dds/waiter.h"
#include "common/map/digest.h"
#include "common/wire/edit_ack.h"
#include "common/wire/envelope.h"

namespace pangaea {
namespace {

using Clock = std::chrono::steady_clock;

// How long the announcement of the end may take to reach the server.
constexpr std::chrono::milliseconds kGoodbye{500};
// Two that do not agree after so many complete corrections never will.
constexpr std::uint64_t kMostCompleteCorrections = 3;

struct FlushRequest {
  UplinkBatch batch;
  Clock::time_point deadline;
  std::shared_ptr<std::promise<Result<std::vector<MapEdit>>>> done;
};
struct WhereRequest {
  std::uint64_t request;
  std::shared_ptr<const KeyframeData> frame;
};
struct HurryRequest {};
struct StopRequest {};
using Event = std::variant<UplinkBatch, FlushRequest, EditAck, CorrectionPart, WhereRequest, MatchChange, HurryRequest,
                           StopRequest>;

class UplinkLoop final : public UplinkThread {
 public:
  UplinkLoop(SessionAnnouncement session, UplinkOptions options, UplinkEndpoints endpoints,
             std::unique_ptr<Waiter> waiter)
      : options_(std::move(options)),
        session_(std::move(session)),
        endpoints_(std::move(endpoints)),
        events_(options_.queue_batches),
        spill_(options_.spill_path),
        stream_(session_.session, options_.edits, &spill_),
        advice_(session_.session, options_.memory),
        sender_([this](const Envelope& envelope) { return endpoints_.edits.Write(envelope); }, &Clock::now),
        waiter_(std::move(waiter)) {}
  ~UplinkLoop() override { Stop(); }

  Status Begin() {
    Status status = waiter_->OnSample<EditAck>(endpoints_.acks, [this](Sample<EditAck> sample) {
      if (sample.alive && sample.value.session == session_.session) (void)events_.Push(std::move(sample.value));
    });
    if (!status) return status;
    status = waiter_->OnSample<CorrectionPart>(endpoints_.corrections, [this](Sample<CorrectionPart> sample) {
      if (sample.alive && sample.value.session == session_.session) (void)events_.Push(std::move(sample.value));
    });
    if (!status) return status;
    status = waiter_->OnSample<RelocalizationAnswer>(endpoints_.answers, [this](Sample<RelocalizationAnswer> sample) {
      // On the thread that waits for DDS: tracking does not wait for the uplink.
      if (sample.alive && sample.value.session == session_.session) answer_.Put(sample.value);
    });
    if (!status) return status;
    status = waiter_->OnMatch(endpoints_.edits, [this](const MatchChange& change) { (void)events_.Push(change); });
    if (!status) return status;
    if (status = endpoints_.session.Write(session_); !status) return status;
    waiter_->Start();
    thread_ = std::thread([this] { Run(); });
    return {};
  }

  bool Submit(UplinkBatch batch) override { return events_.Push(std::move(batch)); }

  Result<std::vector<MapEdit>> Flush(UplinkBatch batch, std::chrono::milliseconds patience) override {
    auto done = std::make_shared<std::promise<Result<std::vector<MapEdit>>>>();
    auto result = done->get_future();
    if (!events_.Push(FlushRequest{std::move(batch), Clock::now() + patience, std::move(done)})) {
      return Fail(ErrorCode::kUnavailable, "the uplink was stopped");
    }
    return result.get();
  }

  std::optional<ReadyCorrection> TakeCorrection() override { return downlink_.Take(); }

  std::vector<KeyframeId> TakeForgettable() override { return advice_.Take(); }

  bool AwaitCorrection(std::chrono::milliseconds patience) override {
    if (downlink_.Await(Clock::now() + patience)) return true;
    if (!downlink_.agrees()) spdlog::warn("the server did not say in time that it holds the same map");
    return false;
  }

  void AskWhere(std::uint64_t request, std::shared_ptr<const KeyframeData> frame) override {
    (void)events_.Push(WhereRequest{request, std::move(frame)});
  }

  std::optional<RelocalizationAnswer> TakeAnswer() override { return answer_.Take(); }

  void Tell(const AgentState& state) override { (void)endpoints_.state.Write(state); }

  void Hurry() override {
    downlink_.EndWaiting();
    (void)events_.Push(HurryRequest{});
  }

  void Stop() override EXCLUDES(stop_mutex_) {
    MutexLock lock(stop_mutex_);
    if (!thread_.joinable()) return;
    downlink_.EndWaiting();
    waiter_->Stop();
    (void)events_.Push(StopRequest{});
    events_.Close();
    thread_.join();
  }

  UplinkCounters counters() const override EXCLUDES(counters_mutex_) {
    MutexLock lock(counters_mutex_);
    return counters_;
  }

 private:
  void Run() {
    while (!stopping_) {
      std::optional<Event> event;
      if (const auto wake = NextDeadline()) {
        event = events_.PopUntil(*wake);
      } else {
        event = events_.Pop();
      }
      if (event) std::visit([this](auto& e) { Handle(e); }, *event);
      stream_.retained().OnTime(Clock::now());
      Continue();
      downlink_.Offer(stream_);
      if (!stopping_) NoteFailure(sender_.Send(stream_.retained()));
      FinishFlush();
      PublishCounters();
    }
    Leave();
  }

  std::optional<Clock::time_point> NextDeadline() const {
    std::optional<Clock::time_point> wake = stream_.retained().deadline();
    const auto sooner = [&](Clock::time_point time) { wake = wake ? std::min(*wake, time) : time; };
    if (const auto retry = sender_.deadline()) sooner(*retry);
    if (flush_) sooner(flush_->deadline);
    return wake;
  }

  void Handle(UplinkBatch& batch) { TakeBatch(batch, PlanKind::kOngoing); }

  void TakeBatch(UplinkBatch& batch, PlanKind kind) {
    if (batch.absorbed != nullptr) {
      stream_.Absorb(*batch.absorbed);
      downlink_.OnAbsorbed(stream_.version());
      ++local_.corrections;
      local_.complete_corrections += batch.absorbed->complete ? 1 : 0;
      in_vain_ += batch.absorbed->complete ? 1 : 0;
    }
    reference_ = batch.reference;
    local_.forgotten += batch.forgotten.size();
    if (const auto interest =
            advice_.NextInterest(*batch.snapshot, stream_.confirmed(), batch.reference, stream_.version())) {
      NoteFailure(endpoints_.interest.Write(*interest));
    }
    // From what is certain before this batch: what it brings is not sent yet.
    if (kind == PlanKind::kOngoing) advice_.Choose(*batch.snapshot, stream_.confirmed(), batch.reference);
    NoteFailure(stream_.Take(std::move(batch.snapshot), batch.applied_since, kind, std::move(batch.forgotten)));
  }

  void Handle(FlushRequest& request) {
    if (flush_) EndFlush(Fail(ErrorCode::kRefused, "another flush took its place"));
    TakeBatch(request.batch, PlanKind::kFlush);
    flush_ = std::move(request);
  }

  void Handle(CorrectionPart& part) {
    local_.bytes_received += part.octets.size();
    NoteFailure(downlink_.Receive(std::move(part), stream_));
  }

  void Handle(WhereRequest& request) {
    NoteFailure(endpoints_.where.Write({session_.session, request.request, std::move(request.frame)}));
  }

  void Handle(EditAck& ack) {
    downlink_.OnAck(ack);
    local_.agreed = claims_ > 0 && ack.agreed_claim == claims_;
    if (local_.agreed) in_vain_ = 0;
    for (const Rejection& rejection : stream_.OnAck(ack, Clock::now())) {
      local_.last_error = "the server rejected envelope " + std::to_string(rejection.sequence) + ": " + rejection.text;
      if (local_.rejections++ == 0) spdlog::warn("{}; what it lacks is sent anew", local_.last_error);
    }
    sender_.EndPause();
  }

  void Continue() {
    NoteFailure(stream_.Continue());
    if (stream_.gave_up() && !std::exchange(told_refused_, true)) spdlog::error("{}", Refused().value().message);
  }

  // A reader that is new has none of what was sent to others, even where the lease of a killed one still runs.
  void Handle(MatchChange& change) {
    if (change.change > 0) stream_.retained().OnServerPresent(false);
    stream_.retained().OnServerPresent(change.current > 0);
    const bool was_present = std::exchange(local_.server_present, change.current > 0);
    if (local_.server_present && !was_present) spdlog::info("connected to the server of site {}", session_.site);
    if (!local_.server_present) downlink_.OnServerLost();
    if (!local_.server_present && was_present) spdlog::warn("lost the server; edits are kept until it is back");
    local_.server_seen = local_.server_seen || local_.server_present;
    sender_.EndPause();
  }

  void Handle(HurryRequest&) { hurried_ = true; }

  void Handle(StopRequest&) { stopping_ = true; }

  void NoteFailure(const Status& status) {
    if (!status) local_.last_error = status.error().message;
  }

  void FinishFlush() {
    if (!flush_) return;
    if (stream_.finished() && stream_.gave_up()) return EndFlush(Refused());
    if (stream_.finished()) {
      Claim();
      return EndFlush(stream_.own_edits());
    }
    if (hurried_ || Clock::now() >= flush_->deadline) EndFlush(Unsent("in time"));
  }

  // That both hold the same now.
  void Claim() {
    local_.agreed = false;
    if (!local_.server_present) return;  // nobody is there to agree
    if (in_vain_ >= kMostCompleteCorrections) {
      downlink_.OnClaim(0);
      if (std::exchange(told_differ_, true)) return;
      local_.last_error = "the server's map still differs from this agent's after complete corrections";
      return spdlog::warn("{}", local_.last_error);
    }
    const DigestClaim claim{++claims_, stream_.retained().last_sequence(),
                            DigestOfSession(stream_.snapshot(), session_.session)};
    const auto interest =
        advice_.NextInterest(stream_.snapshot(), stream_.confirmed(), reference_, stream_.version(), claim);
    downlink_.OnClaim(claim.number);
    NoteFailure(endpoints_.interest.Write(*interest));  // there is one: no two claims are the same
  }

  void EndFlush(Result<std::vector<MapEdit>> result) {
    PublishCounters();  // whoever waits may ask at once
    flush_->done->set_value(std::move(result));
    flush_.reset();
  }

  tl::unexpected<Error> Refused() const {
    return Fail(ErrorCode::kRefused,
                "the server goes on rejecting edits and lacks part of this map (" + std::to_string(local_.rejections) +
                    " rejections, " + std::to_string(stream_.repairs()) + " repairs); the last: " + local_.last_error);
  }

  // Writes what the server may not have into the spill file.
  tl::unexpected<Error> Unsent(const std::string& when) {
    Status spilled = stream_.PlanRest();
    RetainedEdits& retained = stream_.retained();
    if (spilled) spilled = retained.SpillAll();
    const std::uint64_t count = retained.last_sequence() - retained.acknowledged();
    std::string message = "the server did not acknowledge " + std::to_string(count) + " envelopes " + when;
    message += spilled ? "; they are in " + spill_.path().string() : "; " + spilled.error().message;
    local_.last_error = message;
    return Fail(ErrorCode::kUnavailable, message);
  }

  void Leave() {
    Result<std::vector<MapEdit>> result = Fail(ErrorCode::kUnavailable, "the uplink was stopped");
    if (!stream_.finished()) result = Unsent("before the end");
    if (flush_) EndFlush(std::move(result));
    while (auto event = events_.TryPop()) {
      if (auto* late = std::get_if<FlushRequest>(&*event)) {
        late->done->set_value(Fail(ErrorCode::kUnavailable, "the uplink was stopped"));
      }
    }
    session_.closed = true;
    if (endpoints_.session.Write(session_)) NoteFailure(endpoints_.session.WaitForAcks(kGoodbye));
    PublishCounters();
  }

  void PublishCounters() EXCLUDES(counters_mutex_) {
    const RetainedEdits& retained = stream_.retained();
    local_.envelopes_sent = sender_.envelopes();
    local_.bytes_sent = sender_.bytes();
    local_.last_sequence = retained.last_sequence();
    local_.acknowledged = retained.acknowledged();
    local_.resends = retained.resends();
    local_.repairs = stream_.repairs();
    local_.correction_version = stream_.version();
    MutexLock lock(counters_mutex_);
    counters_ = local_;
  }

  const UplinkOptions options_;
  // Below, the uplink thread's own, once it runs.
  SessionAnnouncement session_;
  UplinkEndpoints endpoints_;
  BoundedQueue<Event> events_;
  SpillFile spill_;
  EditStream stream_;
  Downlink downlink_;
  ForgettingAdvice advice_;
  EnvelopeSender sender_;
  std::optional<FlushRequest> flush_;
  KeyframeId reference_;  // of the newest batch
  std::uint64_t claims_ = 0;
  std::uint64_t in_vain_ = 0;  // complete corrections since the server last agreed
  UplinkCounters local_;
  bool told_refused_ = false;
  bool told_differ_ = false;
  bool hurried_ = false;
  bool stopping_ = false;

  mutable Mutex counters_mutex_;
  UplinkCounters counters_ GUARDED_BY(counters_mutex_);
  AnswerSlot answer_;
  Mutex stop_mutex_;
  std::thread thread_;
  std::unique_ptr<Waiter> waiter_;  // its callbacks use all of the above
};

}  // namespace

Status UplinkOptions::Check() const {
  if (Status status = edits.Check(); !status) return status;
  if (Status status = memory.Check(); !status) return status;
  if (queue_batches > 0) return {};
  return Fail(ErrorCode::kInvalidArgument, "uplink: queue_batches is 0, allowed is 1 or more");
}

Result<std::unique_ptr<UplinkThread>> UplinkThread::Start(const Participant& participant, SessionAnnouncement session,
                                                          UplinkOptions options) {
  if (const Status status = options.Check(); !status) return tl::make_unexpected(status.error());
  if (options.spill_path.empty()) options.spill_path = "pangaea-" + ToString(session.session) + ".spill";
  auto endpoints = OpenUplinkEndpoints(participant);
  if (!endpoints) return tl::make_unexpected(endpoints.error());
  auto waiter = Waiter::Create(participant);
  if (!waiter) return tl::make_unexpected(waiter.error());
  session.site = participant.site();
  session.wire_version = kWireVersion;
  session.closed = false;
  auto loop =
      std::make_unique<UplinkLoop>(std::move(session), std::move(options), std::move(*endpoints), std::move(*waiter));
  if (const Status status = loop->Begin(); !status) return tl::make_unexpected(status.error());
  return std::unique_ptr<UplinkThread>(std::move(loop));
}

}  // namespace pangaea
