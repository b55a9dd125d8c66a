#include "agent/tracking/place_inquiry.h"

#include <algorithm>

namespace pangaea {
namespace {

// Consecutive frames show the same, and the server needs its time.
constexpr std::int64_t kBetweenRequestsNs = 150'000'000;
// An answer that is not here by then may have been lost, or the frame was superseded.
constexpr std::int64_t kPatienceNs = 500'000'000;
// After the server knew the place: half a megabyte of it is on its way and has to be absorbed.
constexpr std::int64_t kForThePlaceNs = 1'000'000'000;

}  // namespace

std::optional<std::uint64_t> PlaceInquiry::Ask(std::int64_t stamp_ns) {
  const std::int64_t wait_ns = known_ ? kForThePlaceNs : answered_ ? kBetweenRequestsNs : kPatienceNs;
  if (asked_ns_ && stamp_ns - *asked_ns_ < wait_ns) return std::nullopt;
  asked_ns_ = stamp_ns;
  answered_ = known_ = false;
  return ++asked_;
}

std::optional<PlaceHint> PlaceInquiry::Take(const RelocalizationAnswer& answer) {
  if (answer.request <= ended_ || answer.request > asked_) return std::nullopt;
  answered_ = answered_ || answer.request == asked_;
  if (!answer.found) return std::nullopt;
  known_ = true;
  return PlaceHint{answer.reference, answer.camera_from_reference};
}

void PlaceInquiry::End() {
  ended_ = asked_;
  asked_ns_.reset();
  answered_ = known_ = false;
}

}  // namespace pangaea
