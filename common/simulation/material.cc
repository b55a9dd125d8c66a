#include "common/simulation/material.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "common/simulation/canvas.h"
#include "common/simulation/random.h"

namespace pangaea {
namespace {

constexpr int kMaxLevels = 7;

// What distinguishes the ground of one material from another's.
struct Look {
  int low, high;         // grey level of the ground, drawn per surface
  double noise;          // grey levels, of the coarsest octave of noise
  double leaf_contrast;  // grey levels, standard deviation of the shapes against the ground
  double leaf_density;   // share of the surface that the shapes of each octave of size cover
  double largest_leaf;   // metres
  double turned;         // share of the shapes that are not aligned with the edges
};

Look LookOf(Material material) {
  switch (material) {
    case Material::kPlaster:
      return {150, 170, 16.0, 34.0, 0.10, 0.50, 0.5};
    case Material::kFloor:
      return {105, 120, 14.0, 34.0, 0.14, 0.40, 0.7};
    case Material::kCeiling:
      return {160, 180, 12.0, 38.0, 0.12, 0.60, 0.4};
    case Material::kConcrete:
      return {110, 150, 20.0, 36.0, 0.16, 0.30, 0.6};
    case Material::kWood:
      return {90, 165, 12.0, 36.0, 0.12, 0.20, 0.3};
    case Material::kCarton:
      return {120, 180, 10.0, 40.0, 0.10, 0.12, 0.3};
    case Material::kMetal:
      return {80, 190, 10.0, 36.0, 0.11, 0.20, 0.4};
    case Material::kFabric:
      return {60, 150, 18.0, 34.0, 0.20, 0.10, 0.8};
    case Material::kBook:
      return {50, 215, 6.0, 44.0, 0.12, 0.06, 0.1};
    case Material::kPoster:
      return {40, 235, 18.0, 60.0, 0.22, 0.35, 0.6};
    case Material::kWindow:
      return {205, 230, 10.0, 30.0, 0.12, 0.40, 0.5};
    case Material::kDoor:
      return {90, 150, 10.0, 32.0, 0.10, 0.15, 0.3};
    case Material::kLamp:
      return {235, 250, 4.0, 20.0, 0.06, 0.10, 0.2};
  }
  return {};
}

int Shade(Random& random, double mean, double deviation) {
  return static_cast<int>(std::clamp(mean + deviation * random.Gaussian(), 8.0, 250.0));
}

// A glyph's pattern with three of four cells filled.
std::uint32_t Letter(Random& random) {
  const std::uint64_t cells = random.Next();
  return static_cast<std::uint32_t>(cells | random.Next());
}

void PaintGlyphs(Canvas& canvas, Random& random, Canvas::Point corner, double size_x, double glyph, int lines,
                 int value) {
  for (int line = 0; line < lines; ++line) {
    const double end = corner.x + size_x * random.Uniform(0.5, 1.0);
    for (double x = corner.x; x + 0.7 * glyph < end; x += glyph * random.Uniform(0.75, 1.1)) {
      if (random.Chance(0.16)) continue;
      canvas.FillGlyph({x, corner.y + line * 1.5 * glyph}, 0.65 * glyph, glyph, Letter(random), value);
    }
  }
}

void PaintLeaf(Canvas& canvas, Random& random, double size, int value, const Look& look) {
  const Canvas::Point center{random.Uniform(0.0, canvas.size_x()), random.Uniform(0.0, canvas.size_y())};
  const double cover = random.Uniform(0.6, 1.0);
  const double size_x = size * random.Uniform(0.6, 1.6);
  const double size_y = size * random.Uniform(0.6, 1.6);
  const double angle = random.Chance(look.turned) ? random.Uniform(0.0, std::numbers::pi) : 0.0;
  switch (random.Index(6)) {
    case 0:
      canvas.FillDisc(center, 0.5 * size, value, cover);
      break;
    case 1: {
      std::array<Canvas::Point, 3> corners;
      for (std::size_t i = 0; i < corners.size(); ++i) {
        const double at = angle + 2.1 * static_cast<double>(i) + random.Uniform(-0.5, 0.5);
        corners[i] = {center.x + 0.7 * size_x * std::cos(at), center.y + 0.7 * size_y * std::sin(at)};
      }
      canvas.FillConvex(corners.data(), 3, value, cover);
      break;
    }
    case 2:
      canvas.FillGlyph({center.x - 0.4 * size, center.y - 0.6 * size}, 0.8 * size, 1.2 * size, Letter(random), value,
                       cover);
      break;
    case 3:  // a long stroke
      canvas.FillTurnedRectangle(center, 2.5 * size_x, 0.3 * size_y, angle, value, cover);
      break;
    default:
      canvas.FillTurnedRectangle(center, size_x, size_y, angle, value, cover);
      break;
  }
}

// Shapes from large to small, each octave covering the same share: corners at every scale.
void PaintLeaves(Canvas& canvas, Random& random, const Look& look, double mean, double texel) {
  const double area = canvas.size_x() * canvas.size_y();
  const double largest = std::min(look.largest_leaf, 0.5 * std::max(canvas.size_x(), canvas.size_y()));
  for (double size = largest; size > 2.5 * texel; size *= 0.6) {
    const double expected = look.leaf_density * area / (size * size);
    const int count = static_cast<int>(expected) + (random.Chance(expected - std::floor(expected)) ? 1 : 0);
    for (int i = 0; i < count; ++i) {
      const double leaf = size * random.Uniform(0.8, 1.25);
      PaintLeaf(canvas, random, leaf, Shade(random, mean, look.leaf_contrast), look);
    }
  }
}

// Boards or slabs in rows, each of its own shade, with dark seams.
void PaintBoards(Canvas& canvas, Random& random, double mean, double row_size, double board_size, double deviation) {
  constexpr double kSeam = 0.012;
  for (double y = 0.0; y < canvas.size_y();) {
    const double height = row_size * random.Uniform(0.85, 1.15);
    for (double x = -board_size * random.Unit(); x < canvas.size_x();) {
      const double width = board_size * random.Uniform(0.6, 1.4);
      canvas.FillRectangle(x, y, width, height, Shade(random, mean, deviation));
      canvas.FillRectangle(x, y, kSeam, height, static_cast<int>(0.45 * mean));
      x += width;
    }
    canvas.FillRectangle(0.0, y, canvas.size_x(), kSeam, static_cast<int>(0.45 * mean));
    y += height;
  }
}

void PaintFrame(Canvas& canvas, double size, int value) {
  canvas.FillRectangle(0.0, 0.0, canvas.size_x(), size, value);
  canvas.FillRectangle(0.0, canvas.size_y() - size, canvas.size_x(), size, value);
  canvas.FillRectangle(0.0, 0.0, size, canvas.size_y(), value);
  canvas.FillRectangle(canvas.size_x() - size, 0.0, size, canvas.size_y(), value);
}

void PaintPoster(Canvas& canvas, Random& random, double mean) {
  const double width = canvas.size_x();
  const double height = canvas.size_y();
  const int ink = mean > 130.0 ? random.Index(70) : 185 + random.Index(65);
  const double title = random.Uniform(0.10, 0.2) * height;
  PaintGlyphs(canvas, random, {0.06 * width, 0.05 * height}, 0.9 * width, title, 1, ink);
  // A picture in the middle, text below.
  canvas.FillRectangle(0.08 * width, 0.32 * height, 0.84 * width, 0.36 * height, Shade(random, 255.0 - mean, 30.0));
  for (int i = 0; i < 14; ++i) {
    const double size = height * random.Uniform(0.02, 0.16);
    const Canvas::Point center{width * random.Uniform(0.12, 0.88), height * random.Uniform(0.36, 0.64)};
    const double other_size = size * random.Uniform(0.4, 1.5);
    const double angle = random.Uniform(0.0, 3.0);
    canvas.FillTurnedRectangle(center, size, other_size, angle, 20 + random.Index(220));
  }
  PaintGlyphs(canvas, random, {0.08 * width, 0.72 * height}, 0.84 * width, 0.04 * height, 4, ink);
  PaintFrame(canvas, 0.015, ink);
}

void PaintWindow(Canvas& canvas, Random& random) {
  // Roofs and trees under a bright sky.
  for (double x = 0.0; x < canvas.size_x();) {
    const double width = random.Uniform(0.15, 0.5);
    const double top = canvas.size_y() * random.Uniform(0.35, 0.85);
    const int wall = 90 + random.Index(100);
    canvas.FillRectangle(x, top, width, canvas.size_y() - top, wall);
    for (int i = 0; i < 10; ++i) {
      const double left = x + width * random.Uniform(0.05, 0.85);
      const double height = random.Uniform(0.03, 0.8);
      canvas.FillRectangle(left, top + height, 0.1 * width, 0.05, wall + (random.Chance(0.5) ? 50 : -50));
    }
    x += width;
  }
}

void PaintDoor(Canvas& canvas, Random& random, double mean) {
  const double width = canvas.size_x();
  const double height = canvas.size_y();
  for (int i = 0; i < 3; ++i) {
    canvas.FillRectangle(0.15 * width, height * (0.08 + 0.3 * i), 0.7 * width, 0.24 * height,
                         Shade(random, mean, 25.0));
  }
  canvas.FillRectangle(0.84 * width, 0.5 * height, 0.08 * width, 0.03 * height, 235);
  PaintGlyphs(canvas, random, {0.3 * width, 0.16 * height}, 0.5 * width, 0.05 * height, 2, 240);
  PaintFrame(canvas, 0.05, static_cast<int>(0.5 * mean));
}

void PaintCarton(Canvas& canvas, Random& random, double mean) {
  const double width = canvas.size_x();
  const double height = canvas.size_y();
  canvas.FillRectangle(0.0, random.Uniform(0.4, 0.55) * height, width, 0.08 * height, static_cast<int>(mean + 35.0));
  const double label = random.Uniform(0.3, 0.5);
  const Canvas::Point corner{width * random.Uniform(0.05, 0.5), height * random.Uniform(0.05, 0.5)};
  canvas.FillRectangle(corner.x, corner.y, label * width, label * height, 225);
  PaintGlyphs(canvas, random, {corner.x + 0.03 * width, corner.y + 0.04 * height}, (label - 0.06) * width,
              0.09 * height, 3, 30);
  PaintFrame(canvas, 0.008, static_cast<int>(0.6 * mean));
}

void PaintBook(Canvas& canvas, Random& random, double mean) {
  const double height = canvas.size_y();
  const int ink = mean > 130.0 ? 30 : 225;
  for (int i = 0; i < 3; ++i) {
    const double stripe = height * random.Unit();
    canvas.FillRectangle(0.0, stripe, canvas.size_x(), 0.05 * height, Shade(random, mean, 60.0));
  }
  PaintGlyphs(canvas, random, {0.15 * canvas.size_x(), 0.2 * height}, 0.8 * canvas.size_x(),
              0.3 * std::min(canvas.size_x(), height), 2, ink);
}

void PaintStructure(Canvas& canvas, Random& random, Material material, double mean) {
  switch (material) {
    case Material::kFloor:
      return PaintBoards(canvas, random, mean, 0.45, 1.3, 16.0);
    case Material::kCeiling:
      return PaintBoards(canvas, random, mean, 1.2, 1.2, 12.0);
    case Material::kWood:
      return PaintBoards(canvas, random, mean, 0.14, 0.9, 18.0);
    case Material::kConcrete:
      return PaintBoards(canvas, random, mean, 0.7, 0.9, 14.0);
    case Material::kPlaster:
      // A darker dado below, as halls have.
      return canvas.FillRectangle(0.0, 0.75 * canvas.size_y(), canvas.size_x(), canvas.size_y(),
                                  static_cast<int>(0.7 * mean));
    case Material::kMetal:
      return PaintFrame(canvas, 0.02, static_cast<int>(0.6 * mean));
    case Material::kWindow:
      return PaintWindow(canvas, random);
    case Material::kLamp:
      return PaintFrame(canvas, 0.02, 120);
    default:
      return;
  }
}

// What must stay readable is painted over the shapes.
void PaintForeground(Canvas& canvas, Random& random, Material material, double mean) {
  switch (material) {
    case Material::kPoster:
      return PaintPoster(canvas, random, mean);
    case Material::kDoor:
      return PaintDoor(canvas, random, mean);
    case Material::kCarton:
      return PaintCarton(canvas, random, mean);
    case Material::kBook:
      return PaintBook(canvas, random, mean);
    default:
      return;
  }
}

int LevelsFor(int shorter_side) {
  int levels = 1;
  while (levels < kMaxLevels && (2 << levels) <= shorter_side) ++levels;
  return levels;
}

int RoundUp(int value, int multiple) { return (value + multiple - 1) / multiple * multiple; }

}  // namespace

std::shared_ptr<const Texture> PaintMaterial(Material material, std::uint64_t seed, double size_x, double size_y,
                                             double texel, const LightGrid& light) {
  const int wanted_width = std::max(static_cast<int>(std::ceil(size_x / texel)), 4);
  const int wanted_height = std::max(static_cast<int>(std::ceil(size_y / texel)), 4);
  const int levels = LevelsFor(std::min(wanted_width, wanted_height));
  const int multiple = 1 << (levels - 1);
  Random random(seed);
  const Look look = LookOf(material);
  const double mean = random.Uniform(look.low, look.high);
  Canvas canvas(RoundUp(wanted_width, multiple), RoundUp(wanted_height, multiple), size_x, size_y,
                static_cast<std::uint8_t>(mean));
  PaintStructure(canvas, random, material, mean);
  canvas.AddNoise(128, look.noise, random.Next());
  canvas.AddNoise(24, 0.7 * look.noise, random.Next());
  PaintLeaves(canvas, random, look, mean, texel);
  PaintForeground(canvas, random, material, mean);
  canvas.AddNoise(5, 0.6 * look.noise, random.Next());
  ApplyLight(canvas, light);
  return std::make_shared<const Texture>(canvas.width(), canvas.height(), levels, canvas.texels());
}

}  // namespace pangaea
