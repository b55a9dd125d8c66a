#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include "common/base/result.h"
#include "common/dds/entity.h"
#include "common/dds/reader.h"
#include "common/dds/writer.h"

namespace pangaea {

// A peer's endpoint came or went.
struct MatchChange {
  std::uint32_t current = 0;      // endpoints matched now
  std::int32_t change = 0;        // since the last report
  std::uint64_t last_handle = 0;  // the endpoint that changed last: for a reader a PublicationHandle
};

// One thread that sleeps until one of its readers or writers has news and calls what was registered for it. Callbacks
// run on that thread, one at a time, and should only push into queues. Register before Start(); what is registered
// outlives Stop().
class Waiter {
 public:
  static Result<std::unique_ptr<Waiter>> Create(const Participant& participant);
  ~Waiter();
  Waiter(const Waiter&) = delete;
  Waiter& operator=(const Waiter&) = delete;

  template <typename Value>
  Status OnSample(Reader<Value>& reader, std::function<void(Sample<Value>)> callback,
                  std::function<void(const Error&)> refused = {}) {
    return OnData(reader.entity(), [&reader, callback = std::move(callback), refused = std::move(refused)] {
      for (Sample<Value>& sample : reader.Take(refused)) callback(std::move(sample));
    });
  }
  Status OnMatch(const ReaderBase& reader, std::function<void(const MatchChange&)> callback);
  Status OnMatch(const WriterBase& writer, std::function<void(const MatchChange&)> callback);

  void Start();
  // No callback runs after this returned. Not to be called from a callback.
  void Stop();

 private:
  struct Handler {
    std::int32_t condition;  // what the waitset watches
    std::function<void()> run;
  };

  Waiter() = default;
  Status OnData(std::int32_t reader, std::function<void()> run);
  Status OnStatus(std::int32_t entity, std::uint32_t status, std::function<void()> run);
  Status Watch(std::int32_t condition, std::function<void()> run);
  void Run();

  DdsEntity waitset_;
  DdsEntity stop_condition_;
  std::vector<DdsEntity> read_conditions_;
  std::vector<Handler> handlers_;
  std::thread thread_;
};

}  // namespace pangaea
