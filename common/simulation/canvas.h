#pragma once

#include <cstdint>
#include <vector>

namespace pangaea {

// A grey picture being painted. Lengths are metres from the upper left corner; what lies outside is cut off. Values are
// grey levels, `cover` is how much of what was there a shape hides (0 to 1).
class Canvas {
 public:
  struct Point {
    double x, y;
  };

  // `width` x `height` texels that cover `size_x` x `size_y` metres.
  Canvas(int width, int height, double size_x, double size_y, std::uint8_t value);

  int width() const { return width_; }
  int height() const { return height_; }
  double size_x() const { return size_x_; }
  double size_y() const { return size_y_; }
  std::vector<std::uint8_t>& texels() { return texels_; }

  void FillRectangle(double x, double y, double size_x, double size_y, int value, double cover = 1.0);
  // Corners in order, either way round.
  void FillConvex(const Point* corners, int count, int value, double cover = 1.0);
  void FillTurnedRectangle(Point center, double size_x, double size_y, double angle, int value, double cover = 1.0);
  void FillDisc(Point center, double radius, int value, double cover = 1.0);
  // A letter of an alphabet without end: the bits of `pattern` on a grid of 4 x 6 cells.
  void FillGlyph(Point corner, double size_x, double size_y, std::uint32_t pattern, int value, double cover = 1.0);
  // Adds smooth noise (Perlin's "value noise"): random values -amplitude..amplitude every `cell` texels.
  void AddNoise(int cell, double amplitude, std::uint64_t seed);

 private:
  void FillSpan(int row, int from, int to, int value, int cover_256);

  int width_, height_;
  double size_x_, size_y_;
  double per_metre_x_, per_metre_y_;
  std::vector<std::uint8_t> texels_;
};

}  // namespace pangaea
