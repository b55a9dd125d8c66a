#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>

#include "agent/uplink/retained_edits.h"
#include "common/base/result.h"

namespace pangaea {

// Envelopes in one file, each as header and octets. Started anew when nothing in it is needed any more;
// deleted with this object when it is empty, left behind when it is not.
class SpillFile final : public SpillSink {
 public:
  // The file is made, or emptied, at the first Append: without need there is none.
  explicit SpillFile(std::filesystem::path path) : path_(std::move(path)) {}
  ~SpillFile() override;
  SpillFile(const SpillFile&) = delete;
  SpillFile& operator=(const SpillFile&) = delete;

  Status Append(const Envelope& envelope) override;
  Result<Envelope> Read(std::uint64_t sequence) override;
  void Discard(std::uint64_t sequence) override;

  const std::filesystem::path& path() const { return path_; }
  bool empty() const { return offsets_.empty(); }

 private:
  Status OpenEmpty();

  std::filesystem::path path_;
  std::fstream file_;
  std::uint64_t end_ = 0;
  std::map<std::uint64_t, std::uint64_t> offsets_;  // sequence to position
};

}  // namespace pangaea
