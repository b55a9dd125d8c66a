#include "common/features/corner_detector.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "common/base/check.h"

namespace pangaea {
namespace {

constexpr int kLanes = 16;
// 16 pixels at once, by the compilers' vector extension: SSE2, NEON or plain code.
using Lanes = std::uint8_t __attribute__((vector_size(kLanes)));

inline Lanes Load(const std::uint8_t* pixels) {
  Lanes lanes;
  std::memcpy(&lanes, pixels, sizeof(lanes));
  return lanes;
}
inline Lanes Min(Lanes a, Lanes b) { return a < b ? a : b; }
inline Lanes Max(Lanes a, Lanes b) { return a > b ? a : b; }
inline Lanes SubtractSaturated(Lanes a, Lanes b) { return Max(a, b) - b; }

inline bool AnySet(Lanes lanes) {
  std::array<std::uint64_t, 2> words;
  std::memcpy(words.data(), &lanes, sizeof(words));
  return (words[0] | words[1]) != 0;
}

// The circle of radius 3, clockwise from the top.
using Circle = std::array<std::ptrdiff_t, 16>;
Circle CircleOffsets(std::ptrdiff_t stride) {
  return {-3 * stride,     -3 * stride + 1, -2 * stride + 2, -stride + 3,    3,          stride + 3, 2 * stride + 2,
          3 * stride + 1,  3 * stride,      3 * stride - 1,  2 * stride - 2, stride - 3, -3,         -stride - 3,
          -2 * stride - 2, -3 * stride - 1};
}

// max over the 16 arcs of 9 of the least pixel in the arc (with Least = Min, Most = Max; swapped: the darkest arc).
// Two neighbouring arcs share 8 pixels: min(arc) of the better is min(shared, max(the two ends)).
template <Lanes (*Least)(Lanes, Lanes), Lanes (*Most)(Lanes, Lanes)>
inline Lanes BestArc(const std::array<Lanes, 16>& ring) {
  std::array<Lanes, 8> pair, quad;
  for (std::size_t k = 0; k < 8; ++k) pair[k] = Least(ring[2 * k + 1], ring[(2 * k + 2) % 16]);
  for (std::size_t k = 0; k < 8; ++k) quad[k] = Least(pair[k], pair[(k + 1) % 8]);
  Lanes best;
  for (std::size_t k = 0; k < 8; ++k) {
    const Lanes shared = Least(quad[k], quad[(k + 2) % 8]);
    const Lanes arc = Least(shared, Most(ring[2 * k], ring[(2 * k + 9) % 16]));
    best = k == 0 ? arc : Most(best, arc);
  }
  return best;
}

// An arc of 9 holds at least one of the top and bottom pixel, and one of the left and right.
inline bool MayHoldCorner(const std::uint8_t* center, const Circle& circle, Lanes pixels, Lanes threshold) {
  const Lanes top = Load(center + circle[0]), right = Load(center + circle[4]);
  const Lanes bottom = Load(center + circle[8]), left = Load(center + circle[12]);
  const Lanes brightest = Min(Max(top, bottom), Max(right, left));
  const Lanes darkest = Max(Min(top, bottom), Min(right, left));
  const Lanes difference = Max(SubtractSaturated(brightest, pixels), SubtractSaturated(pixels, darkest));
  return AnySet(SubtractSaturated(difference, threshold));
}

inline Lanes Scores(const std::uint8_t* center, const Circle& circle, Lanes pixels, Lanes threshold) {
  std::array<Lanes, 16> ring;
  for (std::size_t i = 0; i < ring.size(); ++i) ring[i] = Load(center + circle[i]);
  const Lanes brighter = SubtractSaturated(BestArc<Min, Max>(ring), pixels);
  const Lanes darker = SubtractSaturated(pixels, BestArc<Max, Min>(ring));
  const Lanes score = Max(brighter, darker);
  return score > threshold ? score : Lanes{};
}

void ScoreRow(const std::uint8_t* row, const Circle& circle, int threshold, int begin, int end, std::uint8_t* scores) {
  const Lanes least = Lanes{} + static_cast<std::uint8_t>(threshold);
  for (int x = begin; x < end; x += kLanes) {
    x = std::min(x, end - kLanes);  // the last block overlaps the one before
    const Lanes pixels = Load(row + x);
    Lanes score{};
    if (MayHoldCorner(row + x, circle, pixels, least)) score = Scores(row + x, circle, pixels, least);
    std::memcpy(scores + x, &score, sizeof(score));
  }
}

// Of equal neighbours the first in reading order wins.
void CollectMaxima(const std::uint8_t* above, const std::uint8_t* scores, const std::uint8_t* below, int y, int begin,
                   int end, std::vector<Corner>& corners) {
  for (int x = begin; x < end; x += kLanes) {
    const Lanes score = Load(scores + x);
    if (!AnySet(score)) continue;
    const Lanes before = Max(Max(Load(above + x - 1), Load(above + x)), Max(Load(above + x + 1), Load(scores + x - 1)));
    const Lanes after = Max(Max(Load(below + x - 1), Load(below + x)), Max(Load(below + x + 1), Load(scores + x + 1)));
    const Lanes kept = (score > before ? score : Lanes{}) & (score >= after ? score : Lanes{});
    if (!AnySet(kept)) continue;
    for (int i = 0; i < kLanes && x + i < end; ++i) {
      if (kept[i] == 0) continue;
      corners.push_back({static_cast<std::int16_t>(x + i), static_cast<std::int16_t>(y), kept[i]});
    }
  }
}

}  // namespace

void CornerDetector::Detect(const cv::Mat& image, int threshold, int border, std::vector<Corner>& corners) {
  PANGAEA_CHECK(image.type() == CV_8UC1 && border >= 4 && threshold > 0 && threshold < 255);
  corners.clear();
  const int begin = border, end = image.cols - border;
  if (end - begin < kLanes || image.rows <= 2 * border) return;
  const std::size_t row_bytes = static_cast<std::size_t>(image.cols + 2 * kLanes);  // room for reads past the end
  scores_.assign(3 * row_bytes, 0);
  const auto score_row = [&](int y) { return scores_.data() + static_cast<std::size_t>((y + 3) % 3) * row_bytes; };
  const Circle circle = CircleOffsets(static_cast<std::ptrdiff_t>(image.step));
  const int last = image.rows - border - 1;
  for (int y = border; y <= last + 1; ++y) {
    if (y <= last) {
      ScoreRow(image.ptr<std::uint8_t>(y), circle, threshold, begin, end, score_row(y));
    } else {
      std::memset(score_row(y), 0, row_bytes);
    }
    if (y > border) CollectMaxima(score_row(y - 2), score_row(y - 1), score_row(y), y - 1, begin, end, corners);
  }
}

}  // namespace pangaea
