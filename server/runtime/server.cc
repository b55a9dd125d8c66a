#include "server/runtime/server.h"

#include <spdlog/spdlog.h>

#include <utility>

#include "server/runtime/unix_clock.h"

namespace pangaea {
namespace {

void LogEvent(const AtlasEvent& event) {
  const bool trouble = event.kind == AtlasEventKind::kRejected || event.kind == AtlasEventKind::kStoreFailed;
  spdlog::log(trouble ? spdlog::level::warn : spdlog::level::info, "session {}: {}", ToString(event.session),
              event.text);
}

}  // namespace

Result<std::unique_ptr<Server>> Server::Start(const ServerOptions& options, std::function<void(const Error&)> fail) {
  if (auto status = options.Check(); !status) return tl::make_unexpected(status.error());
  auto service = AtlasService::Open(options.store, options.site, options.service);
  if (!service) return tl::make_unexpected(service.error());
  std::unique_ptr<Server> server(new Server(options, std::move(*service)));
  Server* const raw = server.get();
  const auto report = [raw](const AtlasEvent& event) {
    LogEvent(event);
    raw->link_->Report(event);
  };
  const DdsLink::Sinks sinks{[raw](IngestInput input) { raw->service_->Submit(std::move(input)); },
                             [raw](MapInterest interest) { raw->downlink_->Take(std::move(interest)); },
                             [raw](PlaceQuestion question) {
                               if (raw->work_ != nullptr) raw->work_->Ask(std::move(question));
                             },
                             [raw, report](const Error& error) {
                               report({raw->options_.site, AtlasEventKind::kRejected,
                                       "a request to be located: " + error.message, 0, UnixNanoseconds()});
                             },
                             [raw](UndoRequest request) { raw->undo_->Take(std::move(request)); }};
  auto link = DdsLink::Open(options.domain, options.site, sinks);
  if (!link) return tl::make_unexpected(link.error());
  server->link_ = std::move(*link);
  server->status_ = std::make_unique<StatusThread>(options.status, [raw] { raw->PublishStatus(); });
  server->undo_ =
      std::make_unique<UndoThread>(UndoThread::Links{[raw](const std::string& cause) { return raw->Undo(cause); },
                                                     [raw](const UndoAnswer& answer) { raw->link_->Answer(answer); }});
  server->downlink_ = std::make_unique<DownlinkThread>(
      *server->service_, options.guests,
      DownlinkThread::Links{[raw](const CorrectionPart& part) { raw->link_->Send(part); },
                            [raw](std::uint64_t atlas_version) {
                              return raw->work_ != nullptr && raw->work_->report().IsUnderWay(atlas_version);
                            }});
  if (auto created = server->CreateWork(report); !created) return tl::make_unexpected(created.error());
  server->service_->Start(
      {[raw](const EditAck& ack) { raw->Acknowledge(ack); }, report, [raw] { raw->Changed(); }, std::move(fail)});
  server->ReportStart();
  if (server->work_ != nullptr) server->work_->Start();
  server->downlink_->Start();
  server->status_->Start();
  server->undo_->Start();
  server->link_->Start();
  return server;
}

Status Server::CreateWork(const std::function<void(const AtlasEvent&)>& report) {
  if (!options_.work.enabled) return {};
  const auto answer = [this](const RelocalizationAnswer& found) {
    link_->Answer(found);
    if (found.found) downlink_->Show(found.session, found.reference);
  };
  auto work = AtlasWork::Create(*service_, options_.work, {report, [this] { downlink_->Notify(); }, answer});
  if (!work) return tl::make_unexpected(work.error());
  work_ = std::move(*work);
  return {};
}

// What the work had planned was planned on an atlas that is no more: it starts anew.
Result<std::string> Server::Undo(const std::string& cause) {
  if (work_ != nullptr) work_->Stop();
  const auto report = service_->Undo(cause);
  if (work_ != nullptr) {
    if (report) work_->Separate(report->separations);
    work_->Start();
  }
  if (!report) return tl::make_unexpected(report.error());
  return Describe(cause, *report);
}

void Server::Acknowledge(EditAck ack) {
  downlink_->Complete(ack);
  link_->Acknowledge(ack);
}

void Server::Changed() {
  status_->Notify();
  if (work_ != nullptr) work_->Notify();
  downlink_->Notify();
}

Server::Server(const ServerOptions& options, std::unique_ptr<AtlasService> service)
    : options_(options), service_(std::move(service)) {}

Server::~Server() {
  if (link_ != nullptr) link_->Stop();
  if (undo_ != nullptr) undo_->Stop();
  if (downlink_ != nullptr) downlink_->Stop();
  if (work_ != nullptr) work_->Stop();
  service_->Stop();
  if (status_ != nullptr) status_->Stop();
}

void Server::PublishStatus() {
  service_->Tick();
  const auto state = service_->State();
  const std::chrono::duration<double> uptime = std::chrono::steady_clock::now() - started_;
  ServerFacts facts{options_.site,      service_->store_path().string(), service_->incarnation(), uptime.count(),
                    service_->queued(), options_.service.queue_capacity, service_->LastSnapshot()};
  if (work_ != nullptr) facts.work = {work_->report(), work_->vocabulary().fingerprint()};
  link_->Publish({options_.site, facts.incarnation, UnixNanoseconds(), StatusJson(*state, facts, digests_)});
}

void Server::ReportStart() {
  const auto state = service_->State();
  const std::string text = "server started, incarnation " + std::to_string(service_->incarnation()) + ", " +
                           std::to_string(state->ingest.sessions.size()) + " sessions, " +
                           std::to_string(state->ingest.atlas.keyframe_count()) + " keyframes recovered";
  spdlog::info("site {}, store {}: {}", options_.site, service_->store_path().string(), text);
  link_->Report({options_.site, AtlasEventKind::kServerStarted, text, 0, UnixNanoseconds()});
}

}  // namespace pangaea
