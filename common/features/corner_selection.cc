#include "common/features/corner_selection.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace pangaea {
namespace {

// Wanted corners per cell. One spreads more strictly but takes many weak corners that are not found again: with four, a
// fifth more corners are matched after a change of view.
constexpr std::size_t kFairShare = 4;
constexpr std::size_t kKeptPerCell = 16;
constexpr float kLeastCellSize = 8.0F;  // pixels

// The best corners of a cell, the best first; of equal scores the first in reading order.
struct Cell {
  std::array<Corner, kKeptPerCell> corners;
  std::size_t size = 0;
  std::size_t occupied = 0;

  void Insert(const Corner& corner) {
    std::size_t i = size;
    while (i > 0 && corners[i - 1].score < corner.score) --i;
    if (i == kKeptPerCell) return;
    size = std::min(size + 1, kKeptPerCell);
    std::move_backward(corners.begin() + static_cast<std::ptrdiff_t>(i),
                       corners.begin() + static_cast<std::ptrdiff_t>(size) - 1,
                       corners.begin() + static_cast<std::ptrdiff_t>(size));
    corners[i] = corner;
  }
};

class CellGrid {
 public:
  CellGrid(cv::Size image, int wanted)
      : cell_size_(
            std::max(kLeastCellSize, std::sqrt(static_cast<float>(kFairShare) * static_cast<float>(image.area()) /
                                               static_cast<float>(std::max(1, wanted))))),
        columns_(1 + static_cast<int>(static_cast<float>(image.width) / cell_size_)),
        rows_(1 + static_cast<int>(static_cast<float>(image.height) / cell_size_)),
        cells_(static_cast<std::size_t>(columns_ * rows_)) {}

  Cell& at(float x, float y) {
    const int column = std::clamp(static_cast<int>(x / cell_size_), 0, columns_ - 1);
    const int row = std::clamp(static_cast<int>(y / cell_size_), 0, rows_ - 1);
    return cells_[static_cast<std::size_t>(row * columns_ + column)];
  }
  const std::vector<Cell>& cells() const { return cells_; }

 private:
  float cell_size_;
  int columns_;
  int rows_;
  std::vector<Cell> cells_;
};

}  // namespace

std::vector<Corner> OrderBySpread(std::span<const Corner> corners, cv::Size image, int wanted, int high_threshold,
                                  std::span<const cv::Point2f> occupied) {
  CellGrid grid(image, wanted);
  for (const Corner& corner : corners) grid.at(corner.x, corner.y).Insert(corner);
  for (const cv::Point2f& point : occupied) ++grid.at(point.x, point.y).occupied;
  std::vector<std::vector<Corner>> rounds(kKeptPerCell);
  for (const Cell& cell : grid.cells()) {
    for (std::size_t rank = 0; rank < cell.size; ++rank) {
      const bool strong = cell.corners[rank].score > high_threshold;
      const std::size_t round = rank + cell.occupied;
      if (round < kKeptPerCell && (strong || round < kFairShare)) rounds[round].push_back(cell.corners[rank]);
    }
  }
  std::vector<Corner> ordered;
  for (std::vector<Corner>& round : rounds) {
    std::stable_sort(round.begin(), round.end(), [](const Corner& a, const Corner& b) { return a.score > b.score; });
    ordered.insert(ordered.end(), round.begin(), round.end());
  }
  return ordered;
}

NeighborIndex::NeighborIndex(cv::Size image, float typical_radius)
    : bucket_size_(std::max(1.0F, typical_radius)),
      columns_(1 + static_cast<int>(static_cast<float>(image.width) / bucket_size_)),
      rows_(1 + static_cast<int>(static_cast<float>(image.height) / bucket_size_)),
      heads_(static_cast<std::size_t>(columns_ * rows_), -1) {}

int NeighborIndex::Column(float x) const { return std::clamp(static_cast<int>(x / bucket_size_), 0, columns_ - 1); }
int NeighborIndex::Row(float y) const { return std::clamp(static_cast<int>(y / bucket_size_), 0, rows_ - 1); }

void NeighborIndex::Add(cv::Point2f point, int tag) {
  std::int32_t& head = heads_[Bucket(Column(point.x), Row(point.y))];
  entries_.push_back({point, tag, head});
  head = static_cast<std::int32_t>(entries_.size()) - 1;
}

}  // namespace pangaea
