#pragma once

#include <chrono>
#include <functional>
#include <memory>

#include "common/base/result.h"
#include "server/runtime/atlas_service.h"
#include "server/runtime/atlas_work.h"
#include "server/runtime/dds_link.h"
#include "server/runtime/downlink_thread.h"
#include "server/runtime/server_options.h"
#include "server/runtime/status_json.h"
#include "server/runtime/status_thread.h"
#include "server/runtime/undo_thread.h"

namespace pangaea {

// A running server: the atlas service between the DDS topics and the store.
class Server {
 public:
  // Recovers the store and begins to serve. `fail` is called from another thread when it cannot go on.
  static Result<std::unique_ptr<Server>> Start(const ServerOptions& options, std::function<void(const Error&)> fail);
  // Takes no more, commits and answers what it has, publishes a last status, and closes the store.
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

 private:
  Server(const ServerOptions& options, std::unique_ptr<AtlasService> service);
  Status CreateWork(const std::function<void(const AtlasEvent&)>& report);
  Result<std::string> Undo(const std::string& cause);
  void Acknowledge(EditAck ack);
  void Changed();
  void PublishStatus();
  void ReportStart();

  const ServerOptions options_;
  const std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();
  DigestCache digests_;  // of the status thread
  std::unique_ptr<AtlasService> service_;
  // None where the server does nothing by itself.
  std::unique_ptr<AtlasWork> work_;
  std::unique_ptr<DownlinkThread> downlink_;
  std::unique_ptr<DdsLink> link_;
  std::unique_ptr<StatusThread> status_;
  std::unique_ptr<UndoThread> undo_;
};

}  // namespace pangaea
