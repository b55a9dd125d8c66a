#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "common/base/mutex.h"
#include "server/runtime/atlas_service.h"
#include "tests/server/flight.h"
#include "tests/server/temporary_store.h"

namespace pangaea {

// An atlas service without a network; what it answers is written down here.
class ServiceHarness {
 public:
  // `changed` is called on the atlas thread.
  explicit ServiceHarness(
      const std::filesystem::path& store, const ServiceOptions& options = {}, std::function<void()> changed = [] {}) {
    auto opened = AtlasService::Open(store, "hall", options);
    EXPECT_TRUE(opened) << opened.error().message;
    if (!opened) return;
    service = std::move(*opened);
    service->Start({[this](const EditAck& ack) { OnAck(ack); }, [this](const AtlasEvent& event) { OnEvent(event); },
                    std::move(changed), [](const Error& error) { ADD_FAILURE() << error.message; }});
  }

  void Send(Envelope envelope) { service->Submit(EnvelopeArrived{std::move(envelope), {1, 100}}); }
  // Waits until everything up to `sequence` was acknowledged.
  EditAck WaitForAck(SessionId session, std::uint64_t sequence) EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    changed_.wait(mutex_, [&]() REQUIRES(mutex_) { return acks_[session].up_to >= sequence; });
    return acks_[session];
  }
  void WaitForEvent(AtlasEventKind kind) EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    changed_.wait(mutex_, [&]() REQUIRES(mutex_) { return events_[kind] > 0; });
  }
  std::uint64_t AcknowledgedOf(SessionId session) EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    return acks_[session].up_to;
  }

  void OnEvent(const AtlasEvent& event) EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    ++events_[event.kind];
    changed_.notify_all();
  }

 private:
  void OnAck(const EditAck& ack) EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    acks_[ack.session] = ack;
    changed_.notify_all();
  }
  Mutex mutex_;
  ConditionVariable changed_;
  std::map<SessionId, EditAck> acks_ GUARDED_BY(mutex_);
  std::map<AtlasEventKind, int> events_ GUARDED_BY(mutex_);

 public:
  // Last: its threads use what is above until it is gone.
  std::unique_ptr<AtlasService> service;
};

}  // namespace pangaea
