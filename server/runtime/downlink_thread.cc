#include "server/runtime/downlink_thread.h"

#include <spdlog/spdlog.h>

#include "server/runtime/thread_priority.h"

namespace pangaea {
namespace {

constexpr int kNice = 5;
// What changes within this time goes into one correction.
constexpr std::chrono::milliseconds kGather{200};
// A correction that is not applied by then is taken for lost.
constexpr std::chrono::seconds kPatience{5};
constexpr std::chrono::milliseconds kLongestSleep{1000};
constexpr std::size_t kMostWaiting = 1000;  // a sender may invent sessions

}  // namespace

DownlinkThread::DownlinkThread(AtlasService& service, const GuestOptions& options, Links links)
    : service_(service), options_(options), links_(std::move(links)) {}

void DownlinkThread::Start() {
  thread_ = std::jthread([this](const std::stop_token& stop) { Run(stop); });
}

void DownlinkThread::Stop() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
}

void DownlinkThread::Take(MapInterest interest) {
  {
    MutexLock lock(mutex_);
    news_[interest.session].interest = std::move(interest);
  }
  bell_.Ring();
}

void DownlinkThread::Show(SessionId session, KeyframeId place) {
  {
    MutexLock lock(mutex_);
    news_[session].place = place;
  }
  bell_.RingNow();
}

void DownlinkThread::Complete(EditAck& ack) const {
  const auto state = service_.State();
  const Said said = SayTo(ack.session, state->ingest);
  ack.correction_version = said.version;
  ack.working = said.working;
  ack.agreed_claim = said.agreed_claim;
}

DownlinkThread::Said DownlinkThread::SayTo(SessionId session, const IngestState& state) const {
  Said said{0, links_.is_working(state.atlas.version()), 0};
  MutexLock lock(mutex_);
  const auto progress = progress_.find(session);
  if (progress == progress_.end()) return said;
  said.version = progress->second.version;
  said.agreed_claim = progress->second.claim;
  // What is done may not have been told yet.
  said.working = said.working || progress->second.correction < state.correction;
  return said;
}

void DownlinkThread::Run(const std::stop_token& stop) {
  StandBack(kNice);
  while (bell_.WaitFor(stop, kLongestSleep)) {
    TakeNews();
    SendAll();
    SayWhatChanged();
    if (!bell_.Rest(stop, kGather)) return;
  }
}

void DownlinkThread::TakeNews() {
  std::map<SessionId, News> all;
  {
    MutexLock lock(mutex_);
    all.swap(news_);
  }
  for (const auto& [session, news] : all) {
    SessionDownlink& downlink =
        lines_.try_emplace(session, Line{SessionDownlink(session, options_)}).first->second.downlink;
    if (news.interest) downlink.Take(*news.interest);
    if (news.place.valid()) downlink.Show(news.place);
  }
}

void DownlinkThread::SendAll() {
  const auto state = service_.State();
  std::size_t waiting = 0;
  for (auto line = lines_.begin(); line != lines_.end();) {
    const auto session = state->ingest.sessions.find(line->first);
    const bool alive = session != state->ingest.sessions.end() && session->second.alive();
    if (alive) {
      line->second.was_alive = true;
      SendTo(line->first, line->second, state->ingest);
    }
    // What an agent is interested in may come before its session: it is not said again while the camera rests.
    const bool waits = !alive && !line->second.was_alive && ++waiting <= kMostWaiting;
    line = alive || waits ? std::next(line) : lines_.erase(line);
  }
}

void DownlinkThread::SendTo(SessionId session, Line& line, const IngestState& state) {
  const Clock::time_point now = Clock::now();
  if (line.downlink.waits_for_agent() && now - line.sent > kPatience) line.downlink.Forget();
  const std::uint64_t acknowledged = state.sessions.at(session).record().acknowledged;
  auto correction = line.downlink.Next({state.atlas, state.position, state.correction, acknowledged});
  {
    MutexLock lock(mutex_);
    if (correction) progress_[session].version = correction->version;
    if (correction || !line.downlink.waits_for_agent()) progress_[session].correction = state.correction;
    progress_[session].claim = line.downlink.agreed_claim();
  }
  if (!correction) return;
  line.sent = now;
  correction->server_incarnation = service_.incarnation();
  std::size_t bytes = 0;
  for (const CorrectionPart& part : SplitCorrection(*correction)) {
    bytes += part.octets.size();
    links_.send(part);
  }
  spdlog::debug("correction {} for session {}: {} bytes, {} maps", correction->version, ToString(session), bytes,
                correction->pieces.size());
  if (correction->complete) {
    spdlog::warn("session {} and the atlas differed; told it all of its map anew, {} bytes", ToString(session), bytes);
  }
}

void DownlinkThread::SayWhatChanged() {
  const auto state = service_.State();
  std::map<SessionId, Said> now;
  bool news = false;
  for (const auto& [id, session] : state->ingest.sessions) {
    if (!session.alive()) continue;
    const Said said = SayTo(id, state->ingest);
    const Said before = said_[id];
    news = news || said.version != before.version || said.agreed_claim != before.agreed_claim ||
           (before.working && !said.working);
    now[id] = said;
  }
  // Else it is news the next time.
  if (!news || service_.AcknowledgeAgain()) said_ = std::move(now);
}

}  // namespace pangaea
