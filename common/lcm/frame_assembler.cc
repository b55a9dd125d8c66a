#include "common/lcm/frame_assembler.h"

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <utility>

#include "common/lcm/image_codec.h"

namespace pangaea {
namespace {

// Cameras that are triggered together differ by far less, frames by far more.
constexpr std::uint64_t kPairTolerance_ns = 2'000'000;
// Images that may wait for their other half: the two channels run apart by less.
constexpr std::size_t kMaxWaiting = 8;

ImageLoader LoaderOf(pangaea_lcm::image_t&& message, ImageSize size) {
  const auto shared = std::make_shared<const pangaea_lcm::image_t>(std::move(message));
  return [shared, size] { return GrayImageOf(*shared, size); };
}

// Of stamps that may be any numbers.
std::uint64_t Distance(std::int64_t a, std::int64_t b) {
  const auto [low, high] = std::minmax(a, b);
  return static_cast<std::uint64_t>(high) - static_cast<std::uint64_t>(low);
}

}  // namespace

FrameAssembler::FrameAssembler(SensorKind kind, LcmChannels channels, ImageSize size)
    : kind_(kind), channels_(std::move(channels)), size_(size) {}

std::optional<Result<StreamFrame>> FrameAssembler::Add(const LcmMessage& message) {
  auto images = DecodeImages(message.payload);
  if (!images) {
    return Result<StreamFrame>(Fail(images.error().code, message.channel + ": " + images.error().message));
  }
  pangaea_lcm::image_t& left = images->front();
  Count(message.channel, left.sequence);
  const std::int64_t stamp_ns = left.stamp_ns;
  if (kind_ == SensorKind::kMonocular) return StreamFrame{stamp_ns, LoaderOf(std::move(left), size_), {}};
  if (images->size() == 2) {
    return StreamFrame{stamp_ns, LoaderOf(std::move(left), size_), LoaderOf(std::move(images->back()), size_)};
  }
  if (channels_.right_images.empty()) {
    return Result<StreamFrame>(
        Fail(ErrorCode::kInvalidArgument, message.channel + ": carries single images; allowed: pairs, or a second "
                                                            "channel for the right images"));
  }
  return AddHalf({stamp_ns, LoaderOf(std::move(left), size_)}, message.channel == channels_.images);
}

void FrameAssembler::Count(const std::string& channel, std::int64_t sequence) {
  if (sequence < 0) return;
  const auto [latest, is_first] = latest_sequence_.try_emplace(channel, sequence);
  if (!is_first && sequence > latest->second) missing_ += static_cast<std::size_t>(sequence - latest->second - 1);
  latest->second = sequence;  // a camera that was started again counts anew
}

std::optional<Result<StreamFrame>> FrameAssembler::AddHalf(Half half, bool is_left) {
  std::deque<Half>& own = is_left ? left_ : right_;
  std::deque<Half>& others = is_left ? right_ : left_;
  const auto other = std::ranges::find_if(
      others, [&](const Half& candidate) { return Distance(candidate.stamp_ns, half.stamp_ns) <= kPairTolerance_ns; });
  if (other == others.end()) {
    own.push_back(std::move(half));
    if (own.size() > kMaxWaiting) {
      own.pop_front();
      ++missing_;
    }
    return std::nullopt;
  }
  Half& left = is_left ? half : *other;
  Half& right = is_left ? *other : half;
  StreamFrame frame{left.stamp_ns, std::move(left.image), std::move(right.image)};
  others.erase(other);
  return frame;
}

}  // namespace pangaea
