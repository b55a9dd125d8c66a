#pragma once

#include <chrono>
#include <cstdint>

#include "common/base/result.h"
#include "common/dds/entity.h"
#include "common/dds/participant.h"
#include "common/dds/topics.h"

namespace pangaea {

struct WriterOptions {
  // How long a write may block while the peers have not acknowledged the unsent bytes (WhcHigh of the configuration).
  std::chrono::nanoseconds max_blocking_time = std::chrono::milliseconds(500);
};

// What all writers have in common. Any thread may use a writer.
class WriterBase {
 public:
  std::int32_t entity() const { return writer_.get(); }
  // Whether all matched readers acknowledged everything within `timeout`; kUnavailable where not.
  Status WaitForAcks(std::chrono::nanoseconds timeout) const;
  // How many readers are matched now.
  std::uint32_t matched() const;

 protected:
  WriterBase() = default;
  static Result<WriterBase> Open(const Participant& participant, const TopicDescription& topic,
                                 const WriterOptions& options);
  static Status WriteStatus(std::int32_t code, const char* topic);

 private:
  DdsEntity topic_;
  DdsEntity writer_;
};

template <typename Value>
class Writer : public WriterBase {
 public:
  static Result<Writer> Open(const Participant& participant, const WriterOptions& options = {}) {
    auto base = WriterBase::Open(participant, TopicTraits<Value>::Describe(), options);
    if (!base) return tl::make_unexpected(base.error());
    return Writer(std::move(*base));
  }

  // kUnavailable where peers do not take it in time: nothing was written, and it may be tried again.
  Status Write(const Value& value) {
    return WriteStatus(TopicTraits<Value>::Write(entity(), value), TopicTraits<Value>::Describe().name);
  }

 private:
  explicit Writer(WriterBase base) : WriterBase(std::move(base)) {}
};

}  // namespace pangaea
