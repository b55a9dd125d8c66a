#include "agent/runtime/frame_loop.h"

#include <spdlog/spdlog.h>

#include <chrono>
#include <optional>
#include <utility>

namespace pangaea {

void FrameLoop::Run(FrameSource& source) {
  std::optional<MappingThread> thread;
  if (!options_.deterministic) thread.emplace(worker_);
  while (auto frame = source.Next()) {
    if (!Admit(*frame)) continue;
    TrackingResult result = TakeFrame(*frame);
    const bool keyframe = result.keyframe.has_value();
    const bool new_map = BeginsMap(result);
    MappingInput input = MappingInputOf(std::move(result));
    if (!thread) {
      MapBetweenFrames(std::move(input));
      continue;
    }
    thread->Push(std::move(input));
    // A new map has nothing to track before its first keyframe is mapped. At full speed mapping sets the pace, as it
    // does in real time.
    if (new_map || (keyframe && options_.rate.waits_for_agent())) thread->WaitUntilIdle();
  }
  auto closing = tracker_.TakeClosingKeyframe();
  if (!closing) return;
  MappingInput input;
  input.keyframe = std::make_shared<const RawKeyframe>(std::move(*closing));
  if (thread) return thread->Push(std::move(input));
  worker_.AllowCorrections(false);  // they had their turn at the last frame
  worker_.Process(std::move(input));
}

// False for a double. The picture of a stuck camera becomes a dark one.
bool FrameLoop::Admit(SourceFrame& frame) {
  const FrozenPicture::Verdict verdict = frozen_.Judge(frame.left);
  if (verdict == FrozenPicture::Verdict::kDouble) ++doubles_;
  if (verdict == FrozenPicture::Verdict::kStuck) {
    if (stuck_++ == 0) spdlog::warn("the camera repeats one picture; it counts as dark until the picture changes");
    frame.left = cv::Mat::zeros(frame.left.size(), frame.left.type());
  }
  return verdict != FrozenPicture::Verdict::kDouble;
}

void FrameLoop::MapBetweenFrames(MappingInput input) {
  worker_.AllowCorrections(++mapped_frames_ % options_.frames_between_corrections == 0);
  worker_.Process(std::move(input));
}

TrackingResult FrameLoop::TakeFrame(const SourceFrame& frame) {
  using Clock = std::chrono::steady_clock;
  const auto atlas = worker_.snapshot();
  const auto begin = Clock::now();
  TakeAnswer();
  TrackingResult result = Track(frame, atlas);
  recorder_.Take(frame.stamp_ns, result, *atlas);
  AskWhere(result);
  teller_.TellFrame(frame.stamp_ns, result, *atlas, recorder_.record(), frame.dropped, Clock::now() - begin);
  return result;
}

TrackingResult FrameLoop::Track(const SourceFrame& frame, const std::shared_ptr<const Atlas>& atlas) {
  cv::Mat left;
  {
    StageScope scope(stages_, "rectification");
    left = rectifier_.RectifyLeft(frame.left);
  }
  return tracker_.Track(frame.stamp_ns, left, RightImageOf(frame), atlas, stages_);
}

// Outlives the frame, not the loop. An empty image where there is none to be had: the keyframe is then without depth.
RightImage FrameLoop::RightImageOf(const SourceFrame& frame) {
  if (!frame.right) return {};
  return [this, load = frame.right](StageRecorder& stages) -> cv::Mat {
    Result<cv::Mat> image = [&] {
      const StageScope scope(stages, StageClock::kDecode);
      return load();
    }();
    if (image) return rectifier_.RectifyRight(*image);
    if (!warned_of_unreadable_.exchange(true)) spdlog::warn("keyframe without depth: {}", image.error().message);
    return {};
  };
}

void FrameLoop::TakeAnswer() {
  const auto answer = uplink_ == nullptr ? std::nullopt : uplink_->TakeAnswer();
  const auto hint = answer ? inquiry_.Take(*answer) : std::nullopt;
  if (!hint) return;
  spdlog::info("the server knows the place: keyframe {} ({} landmarks)", ToString(hint->keyframe), answer->inliers);
  tracker_.Suggest(*hint);
}

void FrameLoop::AskWhere(const TrackingResult& result) {
  if (uplink_ == nullptr) return;
  if (result.tracked) inquiry_.End();
  if (result.unrecognised == nullptr) return;
  if (const auto request = inquiry_.Ask(result.unrecognised->stamp_ns)) {
    uplink_->AskWhere(*request, result.unrecognised);
  }
}

}  // namespace pangaea
