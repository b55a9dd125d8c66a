#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <opencv2/core/mat.hpp>

#include "agent/runtime/agent_options.h"
#include "agent/runtime/flight_record.h"
#include "agent/runtime/frame_source.h"
#include "agent/runtime/frozen_picture.h"
#include "agent/runtime/mapping_worker.h"
#include "agent/runtime/stage_clock.h"
#include "agent/runtime/state_teller.h"
#include "agent/runtime/uplink_thread.h"
#include "agent/tracking/place_inquiry.h"
#include "agent/tracking/tracker.h"
#include "common/sensor/rectifier.h"

namespace pangaea {

// The part of a run that frames flow through, one by one, on the thread that tracks.
class FrameLoop {
 public:
  // All of it outlives the loop. `uplink` is null without a server.
  FrameLoop(const AgentOptions& options, const Rectifier& rectifier, Tracker& tracker, MappingWorker& worker,
            UplinkThread* uplink, FlightRecorder& recorder, StateTeller& teller)
      : options_(options),
        rectifier_(rectifier),
        tracker_(tracker),
        worker_(worker),
        uplink_(uplink),
        recorder_(recorder),
        teller_(teller) {}

  // Until the source has no more; the last frame then becomes a keyframe, where it was tracked. Mapping runs on a
  // thread of its own meanwhile, unless options.deterministic.
  void Run(FrameSource& source);

  const StageClock& stages() const { return stages_; }
  // Frames that were left out because they repeat the one before.
  std::size_t doubles() const { return doubles_; }

 private:
  bool Admit(SourceFrame& frame);
  void MapBetweenFrames(MappingInput input);
  TrackingResult TakeFrame(const SourceFrame& frame);
  TrackingResult Track(const SourceFrame& frame, const std::shared_ptr<const Atlas>& atlas);
  RightImage RightImageOf(const SourceFrame& frame);
  void TakeAnswer();
  void AskWhere(const TrackingResult& result);

  const AgentOptions& options_;
  const Rectifier& rectifier_;
  Tracker& tracker_;
  MappingWorker& worker_;
  UplinkThread* uplink_;
  FlightRecorder& recorder_;
  StateTeller& teller_;
  PlaceInquiry inquiry_;
  FrozenPicture frozen_;
  std::size_t doubles_ = 0;
  std::size_t stuck_ = 0;  // frames
  StageClock stages_;
  int mapped_frames_ = 0;                           // between frames, on this thread
  std::atomic<bool> warned_of_unreadable_ = false;  // right images are read where they are needed, in mapping too
};

}  // namespace pangaea
