#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <stop_token>
#include <thread>
#include <utility>

#include "common/base/mutex.h"
#include "common/wire/agent_correction.h"
#include "common/wire/edit_ack.h"
#include "common/wire/map_interest.h"
#include "server/downlink/session_downlink.h"
#include "server/runtime/atlas_service.h"
#include "server/runtime/bell.h"

namespace pangaea {

// Tells living agents what concerns them of the atlas: corrections of what they hold, and keyframes of other sessions
// around their cameras. Its queue is the newest interest of each session and the newest state.
class DownlinkThread {
 public:
  struct Links {
    std::function<void(const CorrectionPart&)> send;              // on this thread
    std::function<bool(std::uint64_t atlas_version)> is_working;  // any thread: something may change that atlas yet
  };
  DownlinkThread(AtlasService& service, const GuestOptions& options, Links links);
  ~DownlinkThread() { Stop(); }

  void Start();
  void Stop();
  // Any thread: there is a new state, or work on it came to an end.
  void Notify() { bell_.Ring(); }
  // Any thread.
  void Take(MapInterest interest) EXCLUDES(mutex_);
  // Any thread: the agent was lost and its camera is near to that keyframe. Tells it of the place at once.
  void Show(SessionId session, KeyframeId place) EXCLUDES(mutex_);
  // Any thread: what an ack of this moment says beside numbers.
  void Complete(EditAck& ack) const EXCLUDES(mutex_);

 private:
  using Clock = std::chrono::steady_clock;
  struct Line {
    SessionDownlink downlink;
    Clock::time_point sent{};
    bool was_alive = false;  // its session, since the line is there
  };
  // What came for a session that the thread has not seen yet.
  struct News {
    std::optional<MapInterest> interest;
    KeyframeId place;  // where it was found; none: it was not asked for
  };
  // How far a session was told of the atlas.
  struct Progress {
    std::uint64_t version = 0;     // of its newest correction
    std::uint64_t correction = 0;  // the server's own edits up to here were told, or did not concern it
    std::uint64_t claim = 0;       // the newest of its claims that was found true
  };
  struct Said {
    std::uint64_t version = 0;
    bool working = false;
    std::uint64_t agreed_claim = 0;
  };

  void Run(const std::stop_token& stop);
  void TakeNews() EXCLUDES(mutex_);
  void SendAll();
  void SendTo(SessionId session, Line& line, const IngestState& state);
  Said SayTo(SessionId session, const IngestState& state) const EXCLUDES(mutex_);
  // Has acks repeated where they would say something else by now.
  void SayWhatChanged() EXCLUDES(mutex_);

  AtlasService& service_;
  const GuestOptions options_;
  const Links links_;
  Bell bell_;
  mutable Mutex mutex_;
  std::map<SessionId, News> news_ GUARDED_BY(mutex_);
  std::map<SessionId, Progress> progress_ GUARDED_BY(mutex_);
  // Of the thread.
  std::map<SessionId, Line> lines_;
  std::map<SessionId, Said> said_;
  std::jthread thread_;
};

}  // namespace pangaea
