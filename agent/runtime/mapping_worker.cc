#include "agent/runtime/mapping_worker.h"

#include <utility>

#include "common/base/check.h"
#include "common/map/map_edit.h"

namespace pangaea {
namespace {

constexpr std::size_t kQueuedInputs = 256;
// Frames enter the map in batches: one by one each would copy its keyframe's list.
constexpr std::size_t kFramesPerBatch = 20;

}  // namespace

MappingInput MappingInputOf(TrackingResult result) {
  MappingInput input;
  if (result.keyframe) input.keyframe = std::make_shared<const KeyframeCandidate>(std::move(*result.keyframe));
  input.opening = std::move(result.opening);
  input.frames = std::move(result.earlier_frames);
  if (result.tracked) input.frames.push_back(TrackedFrame{result.reference, result.pose});
  return input;
}

MappingWorker::MappingWorker(SessionId session, const LocalMappingOptions& options, UplinkThread* uplink)
    : session_(session), mapper_(session, options), uplink_(uplink), snapshot_(std::make_shared<const Atlas>()) {}

void MappingWorker::Process(MappingInput input) {
  if (input.keyframe != nullptr) {
    AddWaitingFrames();
    mapper_.Insert(*input.keyframe, stages_);
  }
  if (input.opening != nullptr) {
    AddWaitingFrames();
    mapper_.Open(*input.opening, stages_);
  }
  waiting_frames_.insert(waiting_frames_.end(), input.frames.begin(), input.frames.end());
  if (waiting_frames_.size() >= kFramesPerBatch) AddWaitingFrames();
  if (input.keyframe != nullptr || input.opening != nullptr) Publish();
}

void MappingWorker::Finish() {
  AddWaitingFrames();
  for (const MapId map : mapper_.atlas().Maps()) {
    if (map.session == session_) mapper_.CloseMap(map);
  }
  Publish();
}

Status MappingWorker::Flush(std::chrono::milliseconds patience) {
  if (uplink_ == nullptr) return {};
  const auto adopted = uplink_->Flush(UplinkBatch{snapshot(), mapper_.TakeEdits()}, patience);
  if (!adopted) return tl::make_unexpected(adopted.error());
  if (adopted->empty()) return {};
  Atlas atlas = *snapshot();
  for (const MapEdit& edit : *adopted) {
    if (const Status status = Apply(edit, atlas); !status) return status;
  }
  snapshot_.Set(std::make_shared<const Atlas>(std::move(atlas)));
  return {};
}

void MappingWorker::AddWaitingFrames() {
  if (waiting_frames_.empty()) return;
  mapper_.AddFrames(waiting_frames_);
  waiting_frames_.clear();
}

void MappingWorker::Publish() {
  snapshot_.Set(std::make_shared<const Atlas>(mapper_.atlas()));
  std::vector<MapEdit> edits = mapper_.TakeEdits();
  if (uplink_ != nullptr) (void)uplink_->Submit(UplinkBatch{snapshot_.Get(), std::move(edits)});
}

MappingThread::MappingThread(MappingWorker& worker)
    : worker_(worker), queue_(kQueuedInputs), thread_([this] { Run(); }) {}

MappingThread::~MappingThread() { queue_.Close(); }

void MappingThread::Push(MappingInput input) {
  {
    MutexLock lock(mutex_);
    ++waiting_;
  }
  PANGAEA_CHECK(queue_.Push(std::move(input)));
}

void MappingThread::WaitUntilIdle() {
  MutexLock lock(mutex_);
  while (waiting_ > 0) idle_.wait(mutex_);
}

void MappingThread::Run() {
  while (auto input = queue_.Pop()) {
    worker_.Process(std::move(*input));
    MutexLock lock(mutex_);
    if (--waiting_ == 0) idle_.notify_all();
  }
}

}  // namespace pangaea
