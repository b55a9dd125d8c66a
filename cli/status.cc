#include "cli/status.h"

#include <chrono>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "cli/status_table.h"
#include "common/base/mutex.h"
#include "common/dds/participant.h"
#include "common/dds/reader.h"
#include "common/dds/waiter.h"

namespace pangaea {
namespace {

struct StatusOptions {
  std::string site = "default";
  DomainOptions domain;
  bool watch = false;
  bool json = false;
  double timeout_seconds = 10.0;
  double until_idle_seconds = 0.0;  // 0: does not wait for that
};

// The newest status that was not yet looked at.
class StatusInbox {
 public:
  // Any thread.
  void Put(AtlasStatus status) EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    newest_ = std::move(status);
    arrived_.notify_one();
  }
  // Nothing when none comes in time.
  std::optional<AtlasStatus> Wait(std::chrono::duration<double> timeout) EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    arrived_.wait_for(mutex_, timeout, [this]() REQUIRES(mutex_) { return newest_.has_value(); });
    return std::exchange(newest_, std::nullopt);
  }

 private:
  Mutex mutex_;
  ConditionVariable arrived_;
  std::optional<AtlasStatus> newest_ GUARDED_BY(mutex_);
};

Status Show(const AtlasStatus& status, const StatusOptions& options) {
  if (options.json) {
    std::cout << status.json << std::endl;
    return {};
  }
  const auto table = StatusTable(status);
  if (!table) return tl::make_unexpected(table.error());
  // Clears the screen, cursor to the top.
  if (options.watch) std::cout << "\033[2J\033[H";
  std::cout << *table << std::flush;
  return {};
}

// Waits for a status of a server that has nothing more to recognise, weld or optimise, or until the time is over. The
// first one does not count: it is what the topic retained, and may be older than what the user waits for the end of.
Result<AtlasStatus> WaitUntilIdle(StatusInbox& inbox, AtlasStatus first, const StatusOptions& options) {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::duration<double>(options.until_idle_seconds);
  AtlasStatus status = std::move(first);
  while (true) {
    const std::chrono::duration<double> left = end - Clock::now();
    if (left.count() <= 0.0) return status;
    auto newer = inbox.Wait(left);
    if (!newer) continue;
    status = std::move(*newer);
    const auto under_way = IsUnderWay(status);
    if (!under_way) return tl::make_unexpected(under_way.error());
    if (!*under_way) return status;
  }
}

Status ShowWhatComes(StatusInbox& inbox, const StatusOptions& options) {
  do {
    auto status = inbox.Wait(std::chrono::duration<double>(options.timeout_seconds));
    if (!status) {
      return Fail(ErrorCode::kUnavailable, "no server of site '" + options.site + "' in DDS domain " +
                                               std::to_string(options.domain.id) + " answers within " +
                                               std::to_string(options.timeout_seconds) + " s");
    }
    if (options.until_idle_seconds > 0.0) {
      auto settled = WaitUntilIdle(inbox, std::move(*status), options);
      if (!settled) return tl::make_unexpected(settled.error());
      status = std::move(*settled);
    }
    if (auto shown = Show(*status, options); !shown) return shown;
  } while (options.watch);
  return {};
}

Status Run(const StatusOptions& options) {
  auto domain = Domain::Open(options.domain);
  if (!domain) return tl::make_unexpected(domain.error());
  auto participant = Participant::Open(*domain, options.site);
  if (!participant) return tl::make_unexpected(participant.error());
  auto reader = Reader<AtlasStatus>::Open(*participant);
  if (!reader) return tl::make_unexpected(reader.error());
  auto waiter = Waiter::Create(*participant);
  if (!waiter) return tl::make_unexpected(waiter.error());
  StatusInbox inbox;
  const auto arrived = [&inbox](Sample<AtlasStatus> sample) {
    if (sample.alive) inbox.Put(std::move(sample.value));
  };
  if (auto status = (*waiter)->OnSample<AtlasStatus>(*reader, arrived); !status) return status;
  (*waiter)->Start();
  const Status status = ShowWhatComes(inbox, options);
  (*waiter)->Stop();
  return status;
}

CommandBody Declare(CLI::App& app) {
  auto options = std::make_shared<StatusOptions>();
  app.add_option("--site", options->site, "Name of the site")->capture_default_str();
  app.add_option("--domain", options->domain.id, "DDS domain, 0 to 230")->capture_default_str();
  app.add_flag("--watch", options->watch, "Show it anew whenever it changes, until Ctrl-C");
  app.add_flag("--json", options->json, "The whole status as one line of JSON instead of a table");
  app.add_option("--timeout", options->timeout_seconds, "Seconds to wait for a server (0.1 to 3600)")
      ->capture_default_str()
      ->check(CLI::Range(0.1, 3600.0));
  app.add_option(
         "--until-idle", options->until_idle_seconds,
         "First wait until the server has nothing more to recognise, merge or optimise, at most so many seconds "
         "(0 to 86400)")
      ->check(CLI::Range(0.0, 86400.0));
  return [options] { return Run(*options); };
}

}  // namespace

Command StatusCommand() { return {"status", "Show the atlas of a site: maps, sessions, store, queues", Declare}; }

}  // namespace pangaea
