#include "common/features/orb_descriptor.h"

#include <cmath>
#include <cstddef>
#include <numbers>

#include "common/base/check.h"
#include "common/features/brief_pattern.h"

namespace pangaea {
namespace {

constexpr int kSpan = 2 * kBriefRadius + 2;  // columns of the centroid's patch: one more than needed, a multiple of 16

// Weights of the moments: the offset inside the disc of kBriefRadius, 0 outside of it.
struct MomentWeights {
  std::array<std::array<std::int16_t, kSpan>, kSpan> x{}, y{};
};

constexpr MomentWeights MakeMomentWeights() {
  MomentWeights weights;
  for (int row = 0; row < kSpan; ++row) {
    for (int column = 0; column < kSpan; ++column) {
      const int x = column - kBriefRadius, y = row - kBriefRadius;
      if (x * x + y * y > kBriefRadius * kBriefRadius) continue;
      weights.x[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)] = static_cast<std::int16_t>(x);
      weights.y[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)] = static_cast<std::int16_t>(y);
    }
  }
  return weights;
}
constexpr MomentWeights kMomentWeights = MakeMomentWeights();

// Taps of the smoothing filter, a quarter of its sum of 64 at the centre: round(64 * Gaussian(sigma = 2)).
constexpr std::array<std::uint16_t, 4> kTaps = {14, 12, 8, 5};  // centre, +-1, +-2, +-3
constexpr int kTapShift = 6;

void SmoothColumns(const std::uint8_t* row, std::ptrdiff_t stride, int width, std::uint8_t* out) {
  for (int x = 0; x < width; ++x) {
    const std::uint8_t* p = row + x;
    // 16 bits hold every sum; saying so lets the compiler use 16-bit lanes.
    const auto near = static_cast<std::uint16_t>(kTaps[0] * p[0] + kTaps[1] * (p[-stride] + p[stride]));
    const auto far = static_cast<std::uint16_t>(kTaps[2] * (p[-2 * stride] + p[2 * stride]) +
                                                kTaps[3] * (p[-3 * stride] + p[3 * stride]));
    const auto rounded = static_cast<std::uint16_t>(near + far + (1 << (kTapShift - 1)));
    out[x] = static_cast<std::uint8_t>(rounded >> kTapShift);
  }
}

}  // namespace

void SmoothForBrief(const cv::Mat& image, cv::Mat& smoothed) {
  PANGAEA_CHECK(image.type() == CV_8UC1 && image.cols > 6 && image.rows > 6);
  PANGAEA_CHECK(smoothed.size() == image.size() && smoothed.type() == CV_8UC1);
  std::vector<std::uint8_t> columns(static_cast<std::size_t>(image.cols));
  const auto stride = static_cast<std::ptrdiff_t>(image.step);
  for (int y = 3; y < image.rows - 3; ++y) {
    SmoothColumns(image.ptr<std::uint8_t>(y), stride, image.cols, columns.data());
    SmoothColumns(columns.data() + 3, 1, image.cols - 6, smoothed.ptr<std::uint8_t>(y) + 3);
  }
}

std::uint8_t PatchAngle(const std::uint8_t* center, int stride) {
  std::int32_t moment_x = 0, moment_y = 0;
  for (int row = 0; row < kSpan - 1; ++row) {
    const std::uint8_t* pixels = center + static_cast<std::ptrdiff_t>(row - kBriefRadius) * stride - kBriefRadius;
    const auto& weights_x = kMomentWeights.x[static_cast<std::size_t>(row)];
    const auto& weights_y = kMomentWeights.y[static_cast<std::size_t>(row)];
    for (std::size_t i = 0; i < kSpan; ++i) {
      moment_x += weights_x[i] * pixels[i];
      moment_y += weights_y[i] * pixels[i];
    }
  }
  const double turns = std::atan2(moment_y, moment_x) / (2.0 * std::numbers::pi);
  return static_cast<std::uint8_t>(static_cast<int>(std::lround(turns * 256.0)) & 255);
}

RotatedBrief::RotatedBrief(int stride) : stride_(stride), turned_(256) {
  for (std::size_t angle = 0; angle < turned_.size(); ++angle) {
    const double radians = 2.0 * std::numbers::pi * static_cast<double>(angle) / 256.0;
    const double cosine = std::cos(radians), sine = std::sin(radians);
    const auto offset = [&](int x, int y) {
      return static_cast<std::int32_t>(std::lround(sine * x + cosine * y) * stride +
                                       std::lround(cosine * x - sine * y));
    };
    for (std::size_t i = 0; i < kBriefTests.size(); ++i) {
      const BriefTest& test = kBriefTests[i];
      turned_[angle][i] = {offset(test.ax, test.ay), offset(test.bx, test.by)};
    }
  }
}

Descriptor RotatedBrief::Describe(const std::uint8_t* center, std::uint8_t angle) const {
  const auto& tests = turned_[angle];
  Descriptor descriptor;
  for (std::size_t w = 0; w < descriptor.words.size(); ++w) {
    std::uint64_t word = 0;
    for (std::size_t bit = 0; bit < 64; ++bit) {
      const TestOffsets& test = tests[64 * w + bit];
      word |= static_cast<std::uint64_t>(center[test.a] < center[test.b]) << bit;
    }
    descriptor.words[w] = word;
  }
  return descriptor;
}

}  // namespace pangaea
