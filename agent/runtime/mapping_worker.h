#pragma once

#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "agent/mapping/local_mapper.h"
#include "agent/runtime/stage_clock.h"
#include "agent/runtime/uplink_thread.h"
#include "agent/tracking/tracker.h"
#include "common/base/bounded_queue.h"
#include "common/base/published.h"

namespace pangaea {

// What one tracked frame means for the map.
struct MappingInput {
  std::shared_ptr<const RawKeyframe> keyframe;
  std::shared_ptr<const KeyframeCandidate> root;
  std::shared_ptr<const MapOpening> opening;
  std::vector<TrackedFrame> frames;  // ascending by stamp
};
MappingInput MappingInputOf(TrackingResult result);

// The owner of the agent's map: computes what raw keyframes show, feeds local mapping, publishes snapshots and hands
// every edit to the uplink. Process and Finish belong to one thread; snapshot() may be called from any.
class MappingWorker {
 public:
  // `uplink` may be null (no server); it outlives the worker.
  MappingWorker(SessionId session, KeyframeBuilder builder, const LocalMappingOptions& options, UplinkThread* uplink);

  // Stage "local_mapping" around everything that a keyframe causes, with the parts of KeyframeBuilder and LocalMapper.
  void Process(MappingInput input);
  // Whether Process takes in corrections. For runs that are to be the same every time: they choose the frames.
  void AllowCorrections(bool allow) { absorbs_ = allow; }
  // Closes the session's maps, which until then the camera may come back to, each adjusted once more unless `hurry` is
  // requested, and hands on what is still waiting. Afterwards the atlas changes no more.
  void Finish(const std::stop_token& hurry);
  // Sends everything exactly, and adopts what the uplink asks for. Then waits, at most so long in turn, for what the
  // server still corrects. After Finish.
  Status Flush(std::chrono::milliseconds patience, std::chrono::milliseconds correction_patience);

  std::shared_ptr<const Atlas> snapshot() const { return snapshot_.Get(); }
  const StageClock& stages() const { return stages_; }

 private:
  // What the input means for keyframes. Returns whether there was something.
  bool MapKeyframes(const MappingInput& input);
  void AddWaitingFrames();
  // What the server says, where there is something new. Returns whether there was.
  bool AbsorbCorrection();
  // Whether the camera is near to another keyframe than before.
  bool NoteReference(KeyframeId reference);
  // What is far from the camera and safe at the server. Returns whether there was something.
  bool ForgetFarKeyframes();
  Status FlushOnce(std::chrono::milliseconds patience);
  void Publish();
  UplinkBatch TakeBatch();

  const SessionId session_;
  KeyframeBuilder builder_;
  LocalMapper mapper_;
  UplinkThread* uplink_;
  StageClock stages_;
  std::vector<TrackedFrame> waiting_frames_;
  std::size_t frames_since_return_ = 0;              // of memory to the system
  std::shared_ptr<const AgentCorrection> absorbed_;  // since the last batch
  std::vector<ForgottenKeyframe> forgotten_;         // since the last batch
  KeyframeId reference_;                             // what the camera is near to
  bool absorbs_ = true;
  Published<Atlas> snapshot_;
};

// Runs a MappingWorker on a thread of its own. Push, WaitUntilIdle: the tracking thread alone.
class MappingThread {
 public:
  explicit MappingThread(MappingWorker& worker);
  ~MappingThread();

  // Waits when many inputs are waiting already: frames are cheap, and keyframes are held back by the tracker while
  // mapping is busy, so this is rare.
  void Push(MappingInput input);
  // Waits until everything that was pushed is processed.
  void WaitUntilIdle();

 private:
  void Run();

  MappingWorker& worker_;
  BoundedQueue<MappingInput> queue_;
  Mutex mutex_;
  ConditionVariable idle_;
  std::size_t waiting_ GUARDED_BY(mutex_) = 0;
  std::jthread thread_;  // last: it uses all the others
};

}  // namespace pangaea
