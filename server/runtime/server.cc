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
  AtlasService& atlas = *server->service_;
  auto link =
      DdsLink::Open(options.domain, options.site, [&atlas](IngestInput input) { atlas.Submit(std::move(input)); });
  if (!link) return tl::make_unexpected(link.error());
  server->link_ = std::move(*link);
  server->status_ = std::make_unique<StatusThread>(options.status, [raw = server.get()] { raw->PublishStatus(); });
  DdsLink& dds = *server->link_;
  StatusThread& status = *server->status_;
  const auto report = [&dds](const AtlasEvent& event) {
    LogEvent(event);
    dds.Report(event);
  };
  if (options.work.enabled) {
    auto work = AtlasWork::Create(atlas, options.work, report);
    if (!work) return tl::make_unexpected(work.error());
    server->work_ = std::move(*work);
  }
  const auto changed = [&status, work = server->work_.get()] {
    status.Notify();
    if (work != nullptr) work->Notify();
  };
  atlas.Start({[&dds](const EditAck& ack) { dds.Acknowledge(ack); }, report, changed, std::move(fail)});
  server->ReportStart();
  if (server->work_ != nullptr) server->work_->Start();
  status.Start();
  dds.Start();
  return server;
}

Server::Server(const ServerOptions& options, std::unique_ptr<AtlasService> service)
    : options_(options), service_(std::move(service)) {}

Server::~Server() {
  if (link_ != nullptr) link_->Stop();
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
