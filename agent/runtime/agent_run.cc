#include "agent/runtime/agent_run.h"

#include <spdlog/spdlog.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "agent/runtime/camera_input.h"
#include "agent/runtime/flight_record.h"
#include "agent/runtime/frame_loop.h"
#include "agent/runtime/mapping_worker.h"
#include "agent/runtime/state_teller.h"
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

// What a run takes from outside before it begins.
struct RunInputs {
  std::shared_ptr<const VocabularyTree> vocabulary;
  std::optional<LcmOutput> lcm;  // none: not asked for
  CameraInput camera;
  Rectifier rectifier;
};

Result<RunInputs> OpenInputs(const AgentOptions& options, const std::stop_token& stop) {
  // Before the camera: a live one does not wait.
  auto vocabulary = OpenVocabulary(options.vocabulary.string());
  if (!vocabulary) return Fail(vocabulary.error().code, "--vocabulary: " + vocabulary.error().message);
  auto lcm = OpenLcmOutput(options);
  if (!lcm) return tl::make_unexpected(lcm.error());
  auto camera = OpenCameraInput(options, stop);
  if (!camera) return tl::make_unexpected(camera.error());
  for (const std::string& warning : camera->warnings) spdlog::warn("{}", warning);
  auto rectifier = Rectifier::Create(camera->rig, options.sensor);
  if (!rectifier) return tl::make_unexpected(rectifier.error());
  return RunInputs{std::move(*vocabulary), std::move(*lcm), std::move(*camera), std::move(*rectifier)};
}

// A server closes loops itself, knows places by their looks and says where everything is then: two that move a whole
// map would only send each other the difference, and an agent is to hold on to what the server's map says.
LocalMappingOptions MappingOptionsFor(const AgentOptions& options) {
  LocalMappingOptions mapping = options.mapping;
  mapping.wide_adjustment.enabled &= !options.use_server;
  if (options.use_server) mapping.bundle_adjustment.visits.reset();
  return mapping;
}

KeyframeBuilder BuilderFor(const AgentOptions& options, const IdealCamera& camera) {
  const TrackingOptions tracking = options.tracking.ForCamera(camera);
  return {camera, tracking.orb, tracking.stereo};
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
  auto inputs = OpenInputs(options, stop);
  if (!inputs) return tl::make_unexpected(inputs.error());
  const Rectifier& rectifier = inputs->rectifier;
  AgentRun run;
  run.session = RandomSessionId();
  run.name = options.name.empty() ? inputs->camera.name : options.name;
  run.body_from_camera = rectifier.body_from_camera();
  auto link = OpenLink(options, run, rectifier);
  if (!link) return tl::make_unexpected(link.error());
  const auto frame_count = inputs->camera.frames->frame_count();
  spdlog::info("{}: session {}, {} frames, {}, {}", run.name, ToString(run.session),
               frame_count ? std::to_string(*frame_count) : "unknown", inputs->camera.kind,
               options.use_server ? "site " + options.site : "without a server");
  MappingWorker worker(run.session, BuilderFor(options, rectifier.camera()), MappingOptionsFor(options),
                       link->uplink.get());
  const Rigid3d camera_from_body = rectifier.body_from_camera().Inverse();
  Tracker tracker(run.session, rectifier.camera(), options.tracking, inputs->vocabulary, options.seed);
  FlightRecorder recorder(run.session, run.name, frame_count, camera_from_body);
  StateTeller teller(run.session, camera_from_body, link->uplink.get(), inputs->lcm ? &*inputs->lcm : nullptr);
  FrameLoop loop(options, rectifier, tracker, worker, link->uplink.get(), recorder, teller);
  FrameSource source(*inputs->camera.frames, options.rate);
  {
    const std::stop_callback stop_source(stop, [&source] { source.Stop(); });
    loop.Run(source);
  }
  teller.TellEnd();
  worker.Finish(hurry);
  CloseLink(options, hurry, *link, worker, run);
  run.source = source.counters();
  run.source.skipped += loop.doubles();
  run.flight = recorder.record();
  run.atlas = worker.snapshot();
  StageClock stages;
  for (const StageClock* clock : {&source.stages(), &loop.stages(), &worker.stages()}) stages.Add(*clock);
  run.stages = stages.Statistics();
  run.wall_seconds = std::chrono::duration<double>(Clock::now() - start).count();
  MeasureProcess(run);
  return run;
}

}  // namespace pangaea
