#include "agent/runtime/agent_run.h"

#include <spdlog/spdlog.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "agent/runtime/camera_input.h"
#include "agent/runtime/mapping_worker.h"
#include "agent/runtime/process_memory.h"
#include "agent/tracking/odometry.h"
#include "common/base/version.h"
#include "common/lcm/lcm_output.h"
#include "common/place/vocabulary_file.h"
#include "common/sensor/rectifier.h"
#include "common/wire/envelope.h"
#include "common/wire/session_id.h"

namespace pangaea {
namespace {

using Clock = std::chrono::steady_clock;

double SecondsOf(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

bool BeginsMap(const TrackingResult& result) {
  return result.opening != nullptr || (result.keyframe && !result.keyframe->reference.valid());
}

// The part of a run that frames flow through, one by one.
class FrameLoop {
 public:
  FrameLoop(std::optional<std::size_t> frame_count, const Rectifier& rectifier, const AgentOptions& options,
            std::shared_ptr<const VocabularyTree> vocabulary, AgentRun& run, MappingWorker& worker,
            UplinkThread* uplink, LcmOutput* lcm)
      : frame_count_(frame_count),
        rectifier_(rectifier),
        options_(options),
        run_(run),
        worker_(worker),
        uplink_(uplink),
        lcm_(lcm),
        odometry_(rectifier.body_from_camera().Inverse()),
        camera_from_body_(rectifier.body_from_camera().Inverse()),
        tracker_(run.session, rectifier.camera(), options.tracking, std::move(vocabulary), options.seed) {}

  void Run(FrameSource& source) {
    std::optional<MappingThread> thread;
    if (!options_.deterministic) thread.emplace(worker_);
    while (auto frame = source.Next()) {
      const auto atlas = worker_.snapshot();
      const auto begin = Clock::now();
      TakeAnswer();
      TrackingResult result = Track(*frame, atlas);
      Record(frame->stamp_ns, result);
      AskWhere(result);
      if (is_heard()) TellState(*frame, result, *atlas, Clock::now() - begin);
      const bool keyframe = result.keyframe.has_value();
      const bool new_map = BeginsMap(result);
      MappingInput input = MappingInputOf(std::move(result));
      if (!thread) {
        worker_.AllowCorrections(++frames_ % options_.frames_between_corrections == 0);
        worker_.Process(std::move(input));
        continue;
      }
      thread->Push(std::move(input));
      // A new map has nothing to track before its first keyframe is mapped. At full speed mapping sets the pace, as it
      // does in real time.
      if (new_map || (keyframe && options_.rate.waits_for_agent())) thread->WaitUntilIdle();
    }
  }

  // After the last frame.
  void TellEnd() {
    if (!is_heard()) return;
    told_.tracking = AgentTracking::kFinished;
    Tell(told_);
  }

  const StageClock& stages() const { return stages_; }

 private:
  bool is_heard() const { return uplink_ != nullptr || lcm_ != nullptr; }

  TrackingResult Track(const SourceFrame& frame, const std::shared_ptr<const Atlas>& atlas) {
    cv::Mat left;
    {
      StageScope scope(stages_, "rectification");
      left = rectifier_.RectifyLeft(frame.left);
    }
    return tracker_.Track(
        frame.stamp_ns, left, [&] { return ReadRight(frame); }, atlas, stages_);
  }

  // An empty image where there is none to be had: the keyframe is then without depth.
  cv::Mat ReadRight(const SourceFrame& frame) {
    if (!frame.right) return {};
    Result<cv::Mat> image = [&] {
      StageScope scope(stages_, StageClock::kDecode);
      return frame.right();
    }();
    if (image) return rectifier_.RectifyRight(*image);
    if (unreadable_++ == 0) spdlog::warn("keyframe without depth: {}", image.error().message);
    return {};
  }

  void Record(std::int64_t stamp_ns, const TrackingResult& result) {
    ++(result.tracked ? run_.tracked : run_.lost);
    // Known now, not then.
    run_.tracked += result.earlier_frames.size();
    run_.lost -= result.earlier_frames.size();
    if (result.tracked) {
      run_.live_trajectory.push_back({stamp_ns, result.camera_from_map.Inverse() * camera_from_body_});
    }
    if (result.state == TrackingState::kLost && state_ != TrackingState::kLost) spdlog::warn("lost the camera");
    if (result.state == TrackingState::kTracking && state_ == TrackingState::kStarting) {
      spdlog::info("started the first map");
    }
    if (result.state == TrackingState::kTracking && state_ == TrackingState::kLost) {
      spdlog::info(BeginsMap(result) ? "started a new map" : "found the camera again");
    }
    state_ = result.state;
    SampleMemory(stamp_ns);
    if (Clock::now() - latest_progress_ < std::chrono::seconds(10)) return;
    latest_progress_ = Clock::now();
    const auto atlas = worker_.snapshot();
    const std::string total = frame_count_ ? " of " + std::to_string(*frame_count_) : "";
    spdlog::info("{}: frame {}{}, {} tracked, {} keyframes, {} landmarks", run_.name, run_.tracked + run_.lost, total,
                 run_.tracked, atlas->keyframe_count(), atlas->landmark_count());
  }

  void SampleMemory(std::int64_t stamp_ns) {
    constexpr double kBetweenSamples = 30.0;
    if (!first_stamp_ns_) first_stamp_ns_ = stamp_ns;
    const double seconds = 1e-9 * static_cast<double>(stamp_ns - *first_stamp_ns_);
    if (seconds < kBetweenSamples * static_cast<double>(run_.memory.size())) return;
    run_.memory.push_back({seconds, ResidentMib()});
  }

  void TakeAnswer() {
    const auto answer = uplink_ == nullptr ? std::nullopt : uplink_->TakeAnswer();
    const auto hint = answer ? inquiry_.Take(*answer) : std::nullopt;
    if (!hint) return;
    spdlog::info("the server knows the place: keyframe {} ({} landmarks)", ToString(hint->keyframe), answer->inliers);
    tracker_.Suggest(*hint);
  }

  void AskWhere(const TrackingResult& result) {
    if (uplink_ == nullptr) return;
    if (result.tracked) inquiry_.End();
    if (result.unrecognised == nullptr) return;
    if (const auto request = inquiry_.Ask(result.unrecognised->stamp_ns)) {
      uplink_->AskWhere(*request, result.unrecognised);
    }
  }

  void TellState(const SourceFrame& frame, const TrackingResult& result, const Atlas& atlas, Clock::duration took) {
    AgentState state;
    if (result.tracked) odometry_.Update(result.camera_from_map, result.current_from_previous, ScaleOf(atlas, result));
    const OdometryState& odometry = odometry_.state();
    state.session = run_.session;
    state.stamp_ns = frame.stamp_ns;
    state.tracking = result.tracked                         ? AgentTracking::kTracking
                     : result.state == TrackingState::kLost ? AgentTracking::kLost
                                                            : AgentTracking::kInitializing;
    state.discontinuity = result.tracked && odometry.discontinuity;
    state.map_counter = result.map.counter;
    state.odom_from_body = odometry.odom_from_body;
    state.map_from_odom = odometry.map_from_odom;
    state.frames = run_.tracked + run_.lost;
    state.tracked = run_.tracked;
    state.dropped = frame.dropped;
    state.keyframes = static_cast<std::uint32_t>(atlas.keyframe_count());
    state.landmarks = static_cast<std::uint32_t>(atlas.landmark_count());
    state.tracking_ms = std::chrono::duration<float, std::milli>(took).count();
    state.memory_mib = ResidentMib();
    if (uplink_ != nullptr) {
      const UplinkCounters uplink = uplink_->counters();
      state.bytes_sent = uplink.bytes_sent;
      state.retained_edits = uplink.last_sequence - uplink.acknowledged;
    }
    Tell(state);
  }

  // To the server's site, and to LCM where that was asked for.
  void Tell(const AgentState& state) {
    told_ = state;
    if (uplink_ != nullptr) uplink_->Tell(state);
    if (lcm_ == nullptr) return;
    const Status status = lcm_->Publish(state);
    if (!status && untold_++ == 0) spdlog::warn("the state cannot be told on LCM: {}", status.error().message);
  }

  static double ScaleOf(const Atlas& atlas, const TrackingResult& result) {
    const Keyframe* reference = atlas.FindKeyframe(atlas.Resolve(result.reference));
    return reference == nullptr ? 1.0 : reference->scale;
  }

  const std::optional<std::size_t> frame_count_;
  const Rectifier& rectifier_;
  const AgentOptions& options_;
  AgentRun& run_;
  MappingWorker& worker_;
  UplinkThread* uplink_;  // nullptr: without a server
  LcmOutput* lcm_;        // nullptr: not asked for
  AgentState told_;       // the latest
  std::size_t untold_ = 0;
  Odometry odometry_;
  int frames_ = 0;
  PlaceInquiry inquiry_;
  const Rigid3d camera_from_body_;
  Tracker tracker_;
  StageClock stages_;
  TrackingState state_ = TrackingState::kStarting;
  std::optional<std::int64_t> first_stamp_ns_;
  Clock::time_point latest_progress_ = Clock::now();
  std::size_t unreadable_ = 0;
};

SessionAnnouncement Announce(const AgentOptions& options, const AgentRun& run, const Rectifier& rectifier) {
  SessionAnnouncement session;
  session.session = run.session;
  session.name = run.name;
  session.site = options.site;
  session.sensor_kind = options.sensor;
  session.ideal_camera = rectifier.camera();
  session.body_from_camera = rectifier.body_from_camera();
  session.software_version = kVersion;
  session.wire_version = kWireVersion;
  session.epoch_ns =
      std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch()).count();
  return session;
}

// The agent's end of the link to the server; everything null when it runs without one.
struct ServerLink {
  std::optional<Domain> domain;
  std::optional<Participant> participant;
  std::unique_ptr<UplinkThread> uplink;
};

Result<ServerLink> OpenLink(const AgentOptions& options, const AgentRun& run, const Rectifier& rectifier) {
  ServerLink link;
  if (!options.use_server) return link;
  auto domain = Domain::Open(options.domain);
  if (!domain) return tl::make_unexpected(domain.error());
  link.domain.emplace(std::move(*domain));
  auto participant = Participant::Open(*link.domain, options.site);
  if (!participant) return tl::make_unexpected(participant.error());
  link.participant.emplace(std::move(*participant));
  auto uplink = UplinkThread::Start(*link.participant, Announce(options, run, rectifier), options.uplink);
  if (!uplink) return tl::make_unexpected(uplink.error());
  link.uplink = std::move(*uplink);
  return link;
}

void CloseLink(const AgentOptions& options, const std::stop_token& hurry, ServerLink& link, MappingWorker& worker,
               AgentRun& run) {
  if (link.uplink == nullptr) return;
  const bool seen = link.uplink->counters().server_seen;
  const auto patience = seen ? options.flush_patience : std::min(options.flush_patience, options.discovery_patience);
  const std::stop_callback hurry_uplink(hurry, [&link] { link.uplink->Hurry(); });
  spdlog::info("waiting up to {:.0f} s for the server to acknowledge everything (Ctrl-C: no longer)",
               std::chrono::duration<double>(patience).count());
  const Status flushed = worker.Flush(patience, seen ? options.correction_patience : std::chrono::milliseconds(0));
  run.acknowledged = flushed.has_value();
  if (!flushed) run.unconfirmed = flushed.error();
  link.uplink->Stop();
  run.uplink = link.uplink->counters();
}

Result<std::optional<LcmOutput>> OpenLcmOutput(const AgentOptions& options) {
  if (options.lcm_output.empty()) return std::nullopt;
  auto output = LcmOutput::Open(options.lcm_output, options.lcm);
  if (!output) return tl::make_unexpected(output.error());
  return std::move(*output);
}

void MeasureProcess(AgentRun& run) {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  run.cpu_seconds = SecondsOf(usage.ru_utime) + SecondsOf(usage.ru_stime);
  run.peak_rss_mib = static_cast<double>(usage.ru_maxrss) / 1024.0;
}

}  // namespace

Result<AgentRun> RunAgent(const AgentOptions& options, const std::stop_token& stop, const std::stop_token& hurry) {
  const auto start = Clock::now();
  // Before the input: a live one does not wait.
  auto vocabulary = OpenVocabulary(options.vocabulary.string());
  if (!vocabulary) return Fail(vocabulary.error().code, "--vocabulary: " + vocabulary.error().message);
  auto lcm = OpenLcmOutput(options);
  if (!lcm) return tl::make_unexpected(lcm.error());
  const auto input = OpenCameraInput(options, stop);
  if (!input) return tl::make_unexpected(input.error());
  for (const std::string& warning : input->warnings) spdlog::warn("{}", warning);
  const auto rectifier = Rectifier::Create(input->rig, options.sensor);
  if (!rectifier) return tl::make_unexpected(rectifier.error());

  AgentRun run;
  run.session = RandomSessionId();
  run.name = options.name.empty() ? input->name : options.name;
  run.body_from_camera = rectifier->body_from_camera();
  auto link = OpenLink(options, run, *rectifier);
  if (!link) return tl::make_unexpected(link.error());
  const auto frame_count = input->frames->frame_count();
  spdlog::info("{}: session {}, {} frames, {}, {}", run.name, ToString(run.session),
               frame_count ? std::to_string(*frame_count) : "unknown", input->kind,
               options.use_server ? "site " + options.site : "without a server");
  MappingWorker worker(run.session, options.mapping, link->uplink.get());
  FrameLoop loop(frame_count, *rectifier, options, std::move(*vocabulary), run, worker, link->uplink.get(),
                 *lcm ? &**lcm : nullptr);
  FrameSource source(*input->frames, options.rate);
  {
    const std::stop_callback stop_source(stop, [&source] { source.Stop(); });
    loop.Run(source);
  }
  loop.TellEnd();
  worker.Finish();
  CloseLink(options, hurry, *link, worker, run);
  run.source = source.counters();
  run.atlas = worker.snapshot();
  StageClock stages;
  for (const StageClock* clock : {&source.stages(), &loop.stages(), &worker.stages()}) stages.Add(*clock);
  run.stages = stages.Statistics();
  run.wall_seconds = std::chrono::duration<double>(Clock::now() - start).count();
  MeasureProcess(run);
  return run;
}

}  // namespace pangaea
