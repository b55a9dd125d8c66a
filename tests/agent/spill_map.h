#pragma once

#include <cstdint>
#include <map>

#include "agent/uplink/retained_edits.h"

namespace pangaea::testing {

// A spill sink in memory.
class SpillMap final : public SpillSink {
 public:
  Status Append(const Envelope& envelope) override {
    if (full) return Fail(ErrorCode::kUnavailable, "the disk is full");
    envelopes[envelope.sequence] = envelope;
    return {};
  }
  Result<Envelope> Read(std::uint64_t sequence) override {
    const auto found = envelopes.find(sequence);
    if (found == envelopes.end()) return Fail(ErrorCode::kNotFound, "no such envelope");
    return found->second;
  }
  void Discard(std::uint64_t sequence) override { envelopes.erase(envelopes.begin(), envelopes.upper_bound(sequence)); }

  std::map<std::uint64_t, Envelope> envelopes;
  bool full = false;
};

}  // namespace pangaea::testing
