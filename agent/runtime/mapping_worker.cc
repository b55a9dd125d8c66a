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
  input.keyframe = std::move(result.keyframe);
  if (result.tracked) input.frame = TrackedFrame{result.reference, result.pose};
  return input;
}

MappingWorker::MappingWorker(SessionId session, const LocalMappingOptions& options, UplinkThread* uplink)
    : session_(session), mapper_(session, options), uplink_(uplink), snapshot_(std::make_shared<const Atlas>()) {}

void MappingWorker::Process(MappingInput input) {
  if (input.keyframe) {
    AddWaitingFrames();
    mapper_.Insert(*input.keyframe, stages_);
  }
  if (input.frame) waiting_frames_.push_back(*input.frame);
  if (waiting_frames_.size() >= kFramesPerBatch) AddWaitingFrames();
  if (input.keyframe) Publish();
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
