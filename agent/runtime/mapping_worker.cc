#include "agent/runtime/mapping_worker.h"

#include <chrono>
#include <utility>

#include "common/base/check.h"
#include "common/base/process_memory.h"

namespace pangaea {
namespace {

constexpr std::size_t kQueuedInputs = 256;
// Frames enter the map in batches: one by one each would copy its keyframe's list.
constexpr std::size_t kFramesPerBatch = 20;

constexpr std::size_t kFramesBetweenReturns = 600;  // of free memory to the system

}  // namespace

MappingInput MappingInputOf(TrackingResult result) {
  MappingInput input;
  if (result.keyframe) input.keyframe = std::make_shared<const RawKeyframe>(std::move(*result.keyframe));
  if (result.root) input.root = std::make_shared<const KeyframeCandidate>(std::move(*result.root));
  input.opening = std::move(result.opening);
  input.frames = std::move(result.earlier_frames);
  if (result.tracked) input.frames.push_back(TrackedFrame{result.reference, result.pose, result.reference_scale});
  return input;
}

MappingWorker::MappingWorker(SessionId session, KeyframeBuilder builder, const LocalMappingOptions& options,
                             UplinkThread* uplink)
    : session_(session),
      builder_(std::move(builder)),
      mapper_(session, options),
      uplink_(uplink),
      snapshot_(std::make_shared<const Atlas>()) {}

void MappingWorker::Process(MappingInput input) {
  const bool absorbed = absorbs_ && AbsorbCorrection();
  const bool mapped = MapKeyframes(input);
  waiting_frames_.insert(waiting_frames_.end(), input.frames.begin(), input.frames.end());
  frames_since_return_ += input.frames.size();
  if (frames_since_return_ >= kFramesBetweenReturns) {
    const StageScope stage(stages_, "mapping.return_memory");
    ReturnFreeMemory();
    frames_since_return_ = 0;
  }
  const bool added = waiting_frames_.size() >= kFramesPerBatch;
  if (added) AddWaitingFrames();
  const bool moved = !input.frames.empty() && NoteReference(input.frames.back().reference);
  const bool forgotten = absorbs_ && ForgetFarKeyframes();
  if (absorbed || forgotten || mapped) return Publish();
  // Also where the camera stands and makes no keyframes: those that it made settle with time.
  if ((moved || added) && uplink_ != nullptr) (void)uplink_->Submit(TakeBatch());
}

bool MappingWorker::MapKeyframes(const MappingInput& input) {
  if (input.keyframe == nullptr && input.root == nullptr && input.opening == nullptr) return false;
  const StageScope stage(stages_, "local_mapping");
  AddWaitingFrames();
  if (input.keyframe != nullptr) {
    mapper_.Insert(builder_.Build(*input.keyframe, stages_), stages_);
    reference_ = input.keyframe->id;
  }
  if (input.root != nullptr) {
    mapper_.Insert(*input.root, stages_);
    reference_ = input.root->id;
  }
  if (input.opening != nullptr) {
    mapper_.Open(*input.opening, stages_);
    reference_ = input.opening->second.id;
  }
  return true;
}

void MappingWorker::Finish(const std::stop_token& hurry) {
  AddWaitingFrames();
  for (const MapId map : mapper_.atlas().Maps()) {
    if (map.session != session_) continue;
    mapper_.AdjustBeforeClosing(map, stages_, hurry);
    mapper_.CloseMap(map);
  }
  Publish();
}

Status MappingWorker::Flush(std::chrono::milliseconds patience, std::chrono::milliseconds correction_patience) {
  if (uplink_ == nullptr) return {};
  Status flushed = FlushOnce(patience);
  const auto deadline = std::chrono::steady_clock::now() + correction_patience;
  while (flushed) {
    const auto left = deadline - std::chrono::steady_clock::now();
    if (!uplink_->AwaitCorrection(std::chrono::duration_cast<std::chrono::milliseconds>(left))) break;
    if (AbsorbCorrection()) flushed = FlushOnce(patience);
  }
  return flushed;
}

Status MappingWorker::FlushOnce(std::chrono::milliseconds patience) {
  const auto adopted = uplink_->Flush(TakeBatch(), patience);
  if (!adopted) return tl::make_unexpected(adopted.error());
  mapper_.Adopt(*adopted);
  snapshot_.Set(std::make_shared<const Atlas>(mapper_.atlas()));
  return {};
}

bool MappingWorker::AbsorbCorrection() {
  if (uplink_ == nullptr) return false;
  auto ready = uplink_->TakeCorrection();
  if (!ready) return false;
  const StageScope stage(stages_, "mapping.absorb");
  AddWaitingFrames();
  mapper_.Absorb(*ready->correction, ready->base);
  absorbed_ = std::move(ready->correction);
  return true;
}

// Also where the camera makes no keyframes, because it knows the place: what to forget and to ask back goes by it.
bool MappingWorker::NoteReference(KeyframeId reference) {
  const KeyframeId living = mapper_.atlas().Resolve(reference);
  return living.valid() && std::exchange(reference_, living) != living;
}

bool MappingWorker::ForgetFarKeyframes() {
  if (uplink_ == nullptr) return false;
  const std::vector<KeyframeId> far = uplink_->TakeForgettable();
  if (far.empty()) return false;
  const StageScope stage(stages_, "mapping.forget");
  AddWaitingFrames();
  forgotten_ = mapper_.Forget(far);
  return true;
}

void MappingWorker::AddWaitingFrames() {
  if (waiting_frames_.empty()) return;
  mapper_.AddFrames(waiting_frames_);
  waiting_frames_.clear();
}

void MappingWorker::Publish() {
  UplinkBatch batch = TakeBatch();
  snapshot_.Set(batch.snapshot);
  if (uplink_ != nullptr) (void)uplink_->Submit(std::move(batch));
}

UplinkBatch MappingWorker::TakeBatch() {
  return {std::make_shared<const Atlas>(mapper_.atlas()), mapper_.TakeEdits(), std::exchange(absorbed_, nullptr),
          reference_, std::exchange(forgotten_, {})};
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
