#include "cli/undo_request.h"

#include <chrono>
#include <optional>
#include <utility>

#include "common/base/mutex.h"
#include "common/dds/reader.h"
#include "common/dds/waiter.h"
#include "common/dds/writer.h"
#include "common/wire/session_id.h"

namespace pangaea {
namespace {

using Clock = std::chrono::steady_clock;

// What the DDS thread tells the waiting one.
class UndoInbox {
 public:
  explicit UndoInbox(std::uint64_t request) : request_(request) {}

  // Any thread.
  void Put(UndoAnswer answer) EXCLUDES(mutex_) {
    if (answer.request != request_) return;  // to somebody else
    MutexLock lock(mutex_);
    answer_ = std::move(answer);
    news_.notify_one();
  }
  void SetServers(bool takes_requests, std::uint32_t count) EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    (takes_requests ? takes_requests_ : answers_) = count > 0;
    news_.notify_one();
  }
  // False when none is there in time.
  bool WaitForServer(Clock::time_point deadline) EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    return news_.wait_for(mutex_, deadline - Clock::now(),
                          [this]() REQUIRES(mutex_) { return takes_requests_ && answers_; });
  }
  std::optional<UndoAnswer> WaitForAnswer(Clock::time_point deadline) EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    (void)news_.wait_for(mutex_, deadline - Clock::now(), [this]() REQUIRES(mutex_) { return answer_.has_value(); });
    return answer_;
  }

 private:
  const std::uint64_t request_;
  Mutex mutex_;
  ConditionVariable news_;
  bool takes_requests_ GUARDED_BY(mutex_) = false;
  bool answers_ GUARDED_BY(mutex_) = false;
  std::optional<UndoAnswer> answer_ GUARDED_BY(mutex_);
};

tl::unexpected<Error> NoServer(const UndoServer& server) {
  return Fail(ErrorCode::kUnavailable, "no server of site '" + server.site + "' in DDS domain " +
                                           std::to_string(server.domain.id) + " takes requests within " +
                                           std::to_string(server.timeout_seconds) + " s");
}

}  // namespace

Result<UndoAnswer> AskToUndo(const std::string& cause, const UndoServer& server) {
  const auto deadline =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(server.timeout_seconds));
  auto domain = Domain::Open(server.domain);
  if (!domain) return tl::make_unexpected(domain.error());
  auto participant = Participant::Open(*domain, server.site);
  if (!participant) return tl::make_unexpected(participant.error());
  auto answers = Reader<UndoAnswer>::Open(*participant);
  if (!answers) return tl::make_unexpected(answers.error());
  auto requests = Writer<UndoRequest>::Open(*participant);
  if (!requests) return tl::make_unexpected(requests.error());
  auto waiter = Waiter::Create(*participant);
  if (!waiter) return tl::make_unexpected(waiter.error());
  const UndoRequest request{RandomSessionId(), cause};
  UndoInbox inbox(request.request);
  const auto answered = [&inbox](Sample<UndoAnswer> sample) {
    if (sample.alive) inbox.Put(std::move(sample.value));
  };
  if (auto status = (*waiter)->OnSample<UndoAnswer>(*answers, answered); !status) {
    return tl::make_unexpected(status.error());
  }
  const auto reads = [&inbox](const MatchChange& change) { inbox.SetServers(true, change.current); };
  if (auto status = (*waiter)->OnMatch(*requests, reads); !status) return tl::make_unexpected(status.error());
  const auto writes = [&inbox](const MatchChange& change) { inbox.SetServers(false, change.current); };
  if (auto status = (*waiter)->OnMatch(*answers, writes); !status) return tl::make_unexpected(status.error());
  (*waiter)->Start();
  Result<UndoAnswer> result = NoServer(server);
  if (inbox.WaitForServer(deadline)) {
    const Status written = requests->Write(request);
    auto answer = written ? inbox.WaitForAnswer(deadline) : std::nullopt;
    if (answer) {
      result = std::move(*answer);
    } else {
      result = written ? Fail(ErrorCode::kUnavailable, "the server did not answer in time; it may still do it")
                       : tl::make_unexpected(written.error());
    }
  }
  (*waiter)->Stop();
  return result;
}

}  // namespace pangaea
