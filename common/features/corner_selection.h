#pragma once

#include <cstdint>
#include <opencv2/core/types.hpp>
#include <span>
#include <vector>

#include "common/features/corner_detector.h"

namespace pangaea {

// An order that spreads corners over an image: divide it into square cells, a quarter as many as corners are wanted;
// first come the best of every cell, then the second best of every cell, and so on; cells with `occupied` points wait a
// round for each. Corners up to `high_threshold` only help to fill a cell's fair share.
std::vector<Corner> OrderBySpread(std::span<const Corner> corners, cv::Size image, int wanted, int high_threshold,
                                  std::span<const cv::Point2f> occupied);

// Points in the plane, for "is there one near?".
class NeighborIndex {
 public:
  // Points are looked for at up to about `typical_radius` pixels; larger radii work but are slower.
  NeighborIndex(cv::Size image, float typical_radius);

  void Add(cv::Point2f point, int tag);
  // Is there a point closer than `radius` for which accept(tag) holds?
  template <typename Accept>
  bool HasNeighbor(cv::Point2f point, float radius, Accept&& accept) const {
    if (!(radius > 0.0F)) return false;
    const int last_row = Row(point.y + radius), last_column = Column(point.x + radius);
    for (int row = Row(point.y - radius); row <= last_row; ++row) {
      for (int column = Column(point.x - radius); column <= last_column; ++column) {
        for (std::int32_t i = heads_[Bucket(column, row)]; i >= 0; i = entries_[static_cast<std::size_t>(i)].next) {
          const Entry& entry = entries_[static_cast<std::size_t>(i)];
          const cv::Point2f offset = entry.point - point;
          if (offset.dot(offset) < radius * radius && accept(entry.tag)) return true;
        }
      }
    }
    return false;
  }

 private:
  struct Entry {
    cv::Point2f point;
    int tag = 0;
    std::int32_t next = -1;  // the next of the bucket in entries_, -1 at the end
  };
  int Column(float x) const;
  int Row(float y) const;
  std::size_t Bucket(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
  }

  float bucket_size_;
  int columns_;
  int rows_;
  std::vector<std::int32_t> heads_;
  std::vector<Entry> entries_;
};

}  // namespace pangaea
