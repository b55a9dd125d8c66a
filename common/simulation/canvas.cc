#include "common/simulation/canvas.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "common/simulation/random.h"

namespace pangaea {
namespace {

constexpr int kDiscCorners = 14;

float LatticeValue(std::uint64_t seed, int x, int y) {
  const auto key = static_cast<std::uint64_t>(static_cast<std::uint32_t>(y)) << 32 | static_cast<std::uint32_t>(x);
  return static_cast<float>(MixSeed(seed, key) >> 40) * 0x1.0p-23F - 1.0F;
}

// Without the library's call that std::lround is.
int Round(double x) { return static_cast<int>(std::floor(x + 0.5)); }

float SmoothStep(float x) { return x * x * (3.0F - 2.0F * x); }

}  // namespace

Canvas::Canvas(int width, int height, double size_x, double size_y, std::uint8_t value)
    : width_(width),
      height_(height),
      size_x_(size_x),
      size_y_(size_y),
      per_metre_x_(width / size_x),
      per_metre_y_(height / size_y),
      texels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), value) {}

void Canvas::FillSpan(int row, int from, int to, int value, int cover_256) {
  std::uint8_t* texel = texels_.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(width_);
  from = std::max(from, 0);
  to = std::min(to, width_);
  for (int x = from; x < to; ++x) {
    texel[x] = static_cast<std::uint8_t>(texel[x] + (((value - texel[x]) * cover_256) >> 8));
  }
}

void Canvas::FillRectangle(double x, double y, double size_x, double size_y, int value, double cover) {
  const int top = std::max(Round(y * per_metre_y_), 0);
  const int bottom = std::min(Round((y + size_y) * per_metre_y_), height_);
  const int left = Round(x * per_metre_x_);
  const int right = Round((x + size_x) * per_metre_x_);
  const int cover_256 = Round(cover * 256.0);
  for (int row = top; row < bottom; ++row) FillSpan(row, left, right, std::clamp(value, 0, 255), cover_256);
}

void Canvas::FillConvex(const Point* corners, int count, int value, double cover) {
  double low = corners[0].y;
  double high = corners[0].y;
  for (int i = 1; i < count; ++i) {
    low = std::min(low, corners[i].y);
    high = std::max(high, corners[i].y);
  }
  const int top = std::max(static_cast<int>(std::ceil(low * per_metre_y_ - 0.5)), 0);
  const int bottom = std::min(static_cast<int>(std::ceil(high * per_metre_y_ - 0.5)), height_);
  const int cover_256 = Round(cover * 256.0);
  for (int row = top; row < bottom; ++row) {
    const double y = (row + 0.5) / per_metre_y_;
    double left = size_x_;
    double right = 0.0;
    for (int i = 0; i < count; ++i) {
      const Point& a = corners[i];
      const Point& b = corners[(i + 1) % count];
      if ((a.y <= y) == (b.y <= y)) continue;
      const double x = a.x + (b.x - a.x) * (y - a.y) / (b.y - a.y);
      left = std::min(left, x);
      right = std::max(right, x);
    }
    FillSpan(row, Round(std::max(left, 0.0) * per_metre_x_), Round(right * per_metre_x_), std::clamp(value, 0, 255),
             cover_256);
  }
}

void Canvas::FillTurnedRectangle(Point center, double size_x, double size_y, double angle, int value, double cover) {
  const double c = 0.5 * std::cos(angle);
  const double s = 0.5 * std::sin(angle);
  const Point a{c * size_x - s * size_y, s * size_x + c * size_y};
  const Point b{c * size_x + s * size_y, s * size_x - c * size_y};
  const std::array<Point, 4> corners = {Point{center.x + a.x, center.y + a.y}, Point{center.x + b.x, center.y + b.y},
                                        Point{center.x - a.x, center.y - a.y}, Point{center.x - b.x, center.y - b.y}};
  FillConvex(corners.data(), 4, value, cover);
}

void Canvas::FillDisc(Point center, double radius, int value, double cover) {
  std::array<Point, kDiscCorners> corners;
  for (int i = 0; i < kDiscCorners; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kDiscCorners;
    corners[static_cast<std::size_t>(i)] = {center.x + radius * std::cos(angle), center.y + radius * std::sin(angle)};
  }
  FillConvex(corners.data(), kDiscCorners, value, cover);
}

void Canvas::FillGlyph(Point corner, double size_x, double size_y, std::uint32_t pattern, int value, double cover) {
  constexpr int kColumns = 4;
  constexpr int kRows = 6;
  for (int i = 0; i < kColumns * kRows; ++i) {
    if ((pattern >> i & 1U) == 0) continue;
    FillRectangle(corner.x + size_x * (i % kColumns) / kColumns, corner.y + size_y * (i / kColumns) / kRows,
                  size_x / kColumns, size_y / kRows, value, cover);
  }
}

void Canvas::AddNoise(int cell, double amplitude, std::uint64_t seed) {
  const int columns = width_ / cell + 2;
  std::vector<float> weight(static_cast<std::size_t>(cell));
  for (int i = 0; i < cell; ++i) {
    weight[static_cast<std::size_t>(i)] = SmoothStep((static_cast<float>(i) + 0.5F) / static_cast<float>(cell));
  }
  std::vector<float> upper(static_cast<std::size_t>(columns));
  std::vector<float> lower(upper.size());
  std::vector<float> blended(upper.size());
  const auto scale = static_cast<float>(amplitude);
  const auto fill = [&](std::vector<float>& lattice, int y) {
    for (int x = 0; x < columns; ++x) lattice[static_cast<std::size_t>(x)] = scale * LatticeValue(seed, x, y);
  };
  fill(lower, 0);
  for (int row = 0; row < height_; ++row) {
    if (row % cell == 0) {
      upper.swap(lower);
      fill(lower, row / cell + 1);
    }
    const float v = weight[static_cast<std::size_t>(row % cell)];
    for (std::size_t x = 0; x < blended.size(); ++x) blended[x] = upper[x] + v * (lower[x] - upper[x]);
    std::uint8_t* texel = texels_.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(width_);
    for (int x = 0, lattice = 0; x < width_; x += cell, ++lattice) {
      const float from = blended[static_cast<std::size_t>(lattice)];
      const float change = blended[static_cast<std::size_t>(lattice) + 1] - from;
      const int end = std::min(cell, width_ - x);
      for (int i = 0; i < end; ++i) {
        const float value = static_cast<float>(texel[x + i]) + from + weight[static_cast<std::size_t>(i)] * change;
        texel[x + i] = static_cast<std::uint8_t>(std::clamp(static_cast<int>(value + 0.5F), 0, 255));
      }
    }
  }
}

}  // namespace pangaea
