#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "common/base/result.h"
#include "common/dds/entity.h"
#include "common/dds/participant.h"
#include "common/dds/topics.h"

namespace pangaea {

// Names one writer for as long as it lives, within this process. 0 is none.
using PublicationHandle = std::uint64_t;

template <typename Value>
struct Sample {
  Value value;
  // False: the last writer of this key is gone, or disposed of it; only the key fields of `value` are set.
  bool alive = true;
  PublicationHandle publication = 0;  // the writer it came from
  std::int64_t source_ns = 0;         // the writer's system clock at the write
};

// What all readers have in common. Any thread may use a reader.
class ReaderBase {
 public:
  std::int32_t entity() const { return reader_.get(); }
  // The writers matched now.
  std::vector<PublicationHandle> MatchedPublications() const;
  // Names the participant (in effect: the process) a matched writer belongs to; 0 once the writer is gone.
  std::uint64_t ParticipantOf(PublicationHandle publication) const;

 protected:
  struct RawSample {
    const void* data;
    bool valid_data;
    bool alive;
    PublicationHandle publication;
    std::int64_t source_ns;
  };

  ReaderBase() = default;
  static Result<ReaderBase> Open(const Participant& participant, const TopicDescription& topic);
  // Takes what is there, in the order of each writer.
  void TakeRaw(const std::function<void(const RawSample&)>& visit);

 private:
  DdsEntity topic_;
  DdsEntity reader_;
};

template <typename Value>
class Reader : public ReaderBase {
 public:
  static Result<Reader> Open(const Participant& participant) {
    auto base = ReaderBase::Open(participant, TopicTraits<Value>::Describe());
    if (!base) return tl::make_unexpected(base.error());
    return Reader(std::move(*base));
  }

  // What has arrived since the last call; never waits. Samples with impossible numbers are left out and handed to
  // `refused` as the error that says why.
  std::vector<Sample<Value>> Take(const std::function<void(const Error&)>& refused = {}) {
    std::vector<Sample<Value>> samples;
    TakeRaw([&](const RawSample& raw) {
      using Traits = TopicTraits<Value>;
      Result<Value> value = raw.valid_data ? Traits::FromSample(raw.data) : Traits::KeyFromSample(raw.data);
      if (value) {
        samples.push_back({std::move(*value), raw.valid_data || raw.alive, raw.publication, raw.source_ns});
      } else if (refused) {
        refused(value.error());
      }
    });
    return samples;
  }

 private:
  explicit Reader(ReaderBase base) : ReaderBase(std::move(base)) {}
};

}  // namespace pangaea
