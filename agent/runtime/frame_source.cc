#include "agent/runtime/frame_source.h"

#include <spdlog/spdlog.h>

#include <condition_variable>
#include <mutex>
#include <utility>

#include "common/sensor/image.h"

namespace pangaea {
namespace {

// One frame waits while the agent works; at full speed a few are decoded ahead.
constexpr std::size_t kWaitingFrames = 1;
constexpr std::size_t kFramesAhead = 4;

}  // namespace

FrameSource::FrameSource(const Dataset& dataset, PlayRate rate)
    : dataset_(dataset),
      rate_(rate),
      queue_(rate.waits_for_agent() ? kFramesAhead : kWaitingFrames),
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
  const auto start = std::chrono::steady_clock::now();
  counters_.frames = dataset_.frames.size();
  const ImageSize size{dataset_.rig.left.width, dataset_.rig.left.height};
  for (const DatasetFrame& entry : dataset_.frames) {
    if (!WaitUntilDue(entry.stamp_ns, start, stop)) break;
    Result<cv::Mat> image = [&] {
      StageScope scope(stages_, StageClock::kDecode);
      return ReadGrayImage(entry.left, size);
    }();
    if (image) {
      Deliver(SourceFrame{entry.stamp_ns, std::move(*image), entry.right});
      continue;
    }
    if (counters_.skipped++ == 0)
      spdlog::warn("skipping frames that cannot be read; the first: {}", image.error().message);
  }
  if (counters_.skipped > 0) spdlog::warn("{} frames skipped: their images cannot be read", counters_.skipped);
  queue_.Close();
}

void FrameSource::Deliver(SourceFrame frame) {
  if (!rate_.waits_for_agent()) {
    counters_.dropped += queue_.PushNewest(std::move(frame));
  } else if (!queue_.Push(std::move(frame))) {
    return;  // stopped
  }
}

bool FrameSource::WaitUntilDue(std::int64_t stamp_ns, std::chrono::steady_clock::time_point start,
                               const std::stop_token& stop) {
  if (stop.stop_requested()) return false;
  if (rate_.waits_for_agent()) return true;
  const double elapsed_ns = static_cast<double>(stamp_ns - dataset_.frames.front().stamp_ns) / rate_.speed;
  const auto due = start + std::chrono::nanoseconds(static_cast<std::int64_t>(elapsed_ns));
  std::mutex mutex;
  std::condition_variable_any stopped;
  std::unique_lock lock(mutex);
  // Woken by the stop alone.
  return !stopped.wait_until(lock, stop, due, [] { return false; }) && !stop.stop_requested();
}

}  // namespace pangaea
