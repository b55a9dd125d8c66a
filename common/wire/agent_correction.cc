#include "common/wire/agent_correction.h"

#include <algorithm>
#include <string>
#include <tuple>
#include <utility>

#include "common/base/hash.h"

namespace pangaea {

std::vector<CorrectionPart> SplitCorrection(const AgentCorrection& correction, std::size_t part_bytes) {
  const std::vector<std::byte> octets = EncodePieces(correction.pieces);
  const std::uint64_t checksum = Hash64(octets);
  const std::size_t count = std::max<std::size_t>(1, (octets.size() + part_bytes - 1) / part_bytes);
  std::vector<CorrectionPart> parts;
  for (std::size_t i = 0; i < count; ++i) {
    const auto begin = octets.begin() + static_cast<std::ptrdiff_t>(i * part_bytes);
    const auto end = octets.begin() + static_cast<std::ptrdiff_t>(std::min(octets.size(), (i + 1) * part_bytes));
    parts.push_back({correction.session,
                     correction.server_incarnation,
                     correction.version,
                     correction.acknowledged,
                     static_cast<std::uint32_t>(i),
                     static_cast<std::uint32_t>(count),
                     checksum,
                     {begin, end},
                     correction.complete});
  }
  return parts;
}

Result<std::optional<AgentCorrection>> CorrectionAssembly::Take(CorrectionPart part) {
  const auto name = [](const CorrectionPart& p) {
    return std::tie(p.session, p.server_incarnation, p.version, p.acknowledged, p.parts, p.checksum, p.complete);
  };
  if (part.part == 0) {
    next_ = 0;
    gathered_ = std::move(part);
  } else {
    const bool follows = gathered_ && part.part == next_ && name(part) == name(*gathered_);
    if (!follows) return std::optional<AgentCorrection>();
    if (gathered_->octets.size() + part.octets.size() > kMaxCorrectionBytes) {
      gathered_.reset();
      return Fail(ErrorCode::kInvalidArgument, "a correction is larger than " + std::to_string(kMaxCorrectionBytes));
    }
    gathered_->octets.insert(gathered_->octets.end(), part.octets.begin(), part.octets.end());
  }
  if (++next_ < gathered_->parts) return std::optional<AgentCorrection>();
  return Finish();
}

Result<std::optional<AgentCorrection>> CorrectionAssembly::Finish() {
  const CorrectionPart whole = std::move(*gathered_);
  gathered_.reset();
  const std::string name = "correction " + std::to_string(whole.version);
  if (Hash64(whole.octets) != whole.checksum) {
    return Fail(ErrorCode::kCorrupt, "the checksum of " + name + " is wrong");
  }
  auto pieces = DecodePieces(whole.octets);
  if (!pieces) return Fail(pieces.error().code, name + ": " + pieces.error().message);
  return std::optional(AgentCorrection{whole.session, whole.server_incarnation, whole.version, whole.acknowledged,
                                       std::move(*pieces), whole.complete});
}

}  // namespace pangaea
