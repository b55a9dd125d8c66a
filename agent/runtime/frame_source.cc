#include "agent/runtime/frame_source.h"

#include <spdlog/spdlog.h>

#include <condition_variable>
#include <mutex>
#include <utility>

namespace pangaea {
namespace {

// One frame waits while the agent works; at full speed a few are decoded ahead.
constexpr std::size_t kWaitingFrames = 1;
constexpr std::size_t kFramesAhead = 4;

}  // namespace

FrameSource::FrameSource(FrameStream& stream, PlayRate rate)
    : stream_(stream),
      rate_(rate),
      queue_(rate.waits_for_agent() ? kFramesAhead : kWaitingFrames),
      start_(std::chrono::steady_clock::now()),
      thread_([this](const std::stop_token& stop) { Play(stop); }) {}

FrameSource::~FrameSource() { Stop(); }

std::optional<SourceFrame> FrameSource::Next() {
  auto frame = queue_.Pop();
  if (!frame && thread_.joinable()) thread_.join();  // its counters are final now
  return frame;
}

void FrameSource::Stop() {
  thread_.request_stop();
  queue_.Close();
}

void FrameSource::Play(const std::stop_token& stop) {
  const auto frame_count = stream_.frame_count();
  if (frame_count) counters_.frames = *frame_count;
  while (auto frame = stream_.Next(stop)) {
    if (!frame_count) ++counters_.frames;
    if (!*frame) {
      Skip(frame->error().message);
      continue;
    }
    if (!WaitUntilDue((*frame)->stamp_ns, stop)) break;
    Handle(**frame);
  }
  counters_.missing = stream_.missing();
  if (counters_.skipped > 0) spdlog::warn("{} frames skipped: their images cannot be read", counters_.skipped);
  if (counters_.missing > 0) spdlog::warn("{} frames were sent and never arrived", counters_.missing);
  queue_.Close();
}

void FrameSource::Handle(const StreamFrame& frame) {
  if (latest_stamp_ns_ && frame.stamp_ns <= *latest_stamp_ns_) {
    return Skip("a frame is not newer than the one before (stamp " + std::to_string(frame.stamp_ns) + " ns after " +
                std::to_string(*latest_stamp_ns_) + " ns)");
  }
  Result<cv::Mat> image = [&] {
    StageScope scope(stages_, StageClock::kDecode);
    return frame.left();
  }();
  if (!image) return Skip(image.error().message);
  latest_stamp_ns_ = frame.stamp_ns;
  Deliver(SourceFrame{frame.stamp_ns, std::move(*image), frame.right, counters_.dropped});
}

void FrameSource::Skip(const std::string& why) {
  if (counters_.skipped++ == 0) spdlog::warn("skipping frames that cannot be read; the first: {}", why);
}

void FrameSource::Deliver(SourceFrame frame) {
  if (!rate_.waits_for_agent()) {
    counters_.dropped += queue_.PushNewest(std::move(frame));
  } else if (!queue_.Push(std::move(frame))) {
    return;  // stopped
  }
}

bool FrameSource::WaitUntilDue(std::int64_t stamp_ns, const std::stop_token& stop) {
  if (stop.stop_requested()) return false;
  if (rate_.waits_for_agent() || stream_.is_live()) return true;
  if (!first_stamp_ns_) first_stamp_ns_ = stamp_ns;
  const double elapsed_ns = static_cast<double>(stamp_ns - *first_stamp_ns_) / rate_.speed;
  const auto due = start_ + std::chrono::nanoseconds(static_cast<std::int64_t>(elapsed_ns));
  std::mutex mutex;
  std::condition_variable_any stopped;
  std::unique_lock lock(mutex);
  // Woken by the stop alone.
  return !stopped.wait_until(lock, stop, due, [] { return false; }) && !stop.stop_requested();
}

}  // namespace pangaea
