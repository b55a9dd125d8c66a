#include "agent/runtime/spill_file.h"

#include <array>
#include <system_error>
#include <utility>

namespace pangaea {
namespace {

// session, sequence, base correction version, wire version, checksum, number of octets
using Header = std::array<std::uint64_t, 6>;

}  // namespace

SpillFile::~SpillFile() {
  if (!file_.is_open()) return;
  file_.close();
  std::error_code ignored;
  if (empty()) std::filesystem::remove(path_, ignored);
}

Status SpillFile::OpenEmpty() {
  file_.close();
  file_.clear();
  file_.open(path_, std::ios::in | std::ios::out | std::ios::binary | std::ios::trunc);
  end_ = 0;
  if (file_) return {};
  return Fail(ErrorCode::kUnavailable, "cannot write the spill file " + path_.string());
}

Status SpillFile::Append(const Envelope& envelope) {
  if (offsets_.contains(envelope.sequence)) return {};
  if (offsets_.empty()) {
    if (Status status = OpenEmpty(); !status) return status;
  }
  const Header header = {envelope.session,      envelope.sequence, envelope.base_correction_version,
                         envelope.wire_version, envelope.checksum, envelope.edits.size()};
  file_.clear();
  file_.seekp(static_cast<std::streamoff>(end_));
  file_.write(reinterpret_cast<const char*>(header.data()), sizeof(header));
  file_.write(reinterpret_cast<const char*>(envelope.edits.data()),
              static_cast<std::streamsize>(envelope.edits.size()));
  file_.flush();
  if (!file_) return Fail(ErrorCode::kUnavailable, "writing to the spill file " + path_.string() + " failed");
  offsets_[envelope.sequence] = end_;
  end_ += sizeof(header) + envelope.edits.size();
  return {};
}

Result<Envelope> SpillFile::Read(std::uint64_t sequence) {
  const auto offset = offsets_.find(sequence);
  if (offset == offsets_.end()) return Fail(ErrorCode::kNotFound, "the spill file does not hold this envelope");
  Header header{};
  file_.clear();
  file_.seekg(static_cast<std::streamoff>(offset->second));
  file_.read(reinterpret_cast<char*>(header.data()), sizeof(header));
  Envelope envelope;
  envelope.session = header[0];
  envelope.sequence = header[1];
  envelope.base_correction_version = header[2];
  envelope.wire_version = static_cast<std::uint32_t>(header[3]);
  envelope.checksum = header[4];
  const std::uint64_t size = header[5];
  if (file_ && envelope.sequence == sequence && size <= end_ - offset->second) {
    envelope.edits.resize(size);
    file_.read(reinterpret_cast<char*>(envelope.edits.data()), static_cast<std::streamsize>(size));
    if (file_ && CheckEnvelope(envelope)) return envelope;
  }
  return Fail(ErrorCode::kCorrupt, "envelope " + std::to_string(sequence) + " in " + path_.string() + " is damaged");
}

void SpillFile::Discard(std::uint64_t sequence) { offsets_.erase(offsets_.begin(), offsets_.upper_bound(sequence)); }

}  // namespace pangaea
