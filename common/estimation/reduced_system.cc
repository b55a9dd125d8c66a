#include "common/estimation/reduced_system.h"

#include <algorithm>

namespace pangaea::local_bundle {
namespace {

void SortUnique(std::vector<int>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

// For each row the columns up to it whose pose shares a point with the row's, ascending.
std::vector<std::vector<int>> SharedColumns(const Layout& layout) {
  const std::size_t rows = layout.free_poses.size();
  std::vector<std::vector<int>> columns(rows);
  std::vector<std::size_t> compact_at(rows, 256);
  for (std::size_t row = 0; row < rows; ++row) columns[row].push_back(static_cast<int>(row));
  for (const Track& track : layout.tracks) {
    if (track.fixed) continue;
    for (int m = track.begin; m < track.free_end; ++m) {
      const auto row = static_cast<std::size_t>(layout.cameras[layout.measurements[m].camera].variable);
      for (int n = track.begin; n < m; ++n) {
        columns[row].push_back(layout.cameras[layout.measurements[n].camera].variable);
      }
      // Most are there already: memory stays within a factor of what is needed.
      if (columns[row].size() < compact_at[row]) continue;
      SortUnique(columns[row]);
      compact_at[row] = std::max(compact_at[row], 2 * columns[row].size());
    }
  }
  for (std::vector<int>& of_row : columns) SortUnique(of_row);
  return columns;
}

}  // namespace

DenseReducedSystem::DenseReducedSystem(const Layout& layout) {
  const auto size = static_cast<Eigen::Index>(6 * layout.free_poses.size());
  matrix_.resize(size, size);
}

bool DenseReducedSystem::Factorize() {
  factor_.compute(matrix_.selfadjointView<Eigen::Lower>());
  return factor_.info() == Eigen::Success;
}

SparseReducedSystem::SparseReducedSystem(const Layout& layout) : columns_(SharedColumns(layout)) {
  column_blocks_.resize(columns_.size());
  for (std::size_t row = 0; row < columns_.size(); ++row) {
    first_block_.push_back(static_cast<int>(blocks_.size()));
    for (const int column : columns_[row]) {
      column_blocks_[static_cast<std::size_t>(column)].emplace_back(row, blocks_.size());
      blocks_.push_back(Matrix6d::Zero());
    }
  }
  MakePattern();
  // A matrix that is not positive definite is an answer here, no fault to report on stderr.
  factor_.cholmod().print = 0;
  factor_.analyzePattern(matrix_);
}

void SparseReducedSystem::SetZero() { std::fill(blocks_.begin(), blocks_.end(), Matrix6d::Zero()); }

Matrix6d& SparseReducedSystem::Block(int row, int column) {
  const std::vector<int>& columns = columns_[static_cast<std::size_t>(row)];
  const auto found = std::lower_bound(columns.begin(), columns.end(), column);
  return blocks_[static_cast<std::size_t>(first_block_[static_cast<std::size_t>(row)] + (found - columns.begin()))];
}

void SparseReducedSystem::MakePattern() {
  const auto size = static_cast<Eigen::Index>(6 * columns_.size());
  matrix_.resize(size, size);
  matrix_.reserve(static_cast<Eigen::Index>(36 * blocks_.size()));
  for (Eigen::Index column = 0; column < size; ++column) {
    matrix_.startVec(column);
    for (const auto& [row, block] : column_blocks_[static_cast<std::size_t>(column / 6)]) {
      const bool diagonal = row == column / 6;
      for (Eigen::Index k = diagonal ? column % 6 : 0; k < 6; ++k) matrix_.insertBack(6 * row + k, column) = 1.0;
    }
  }
  matrix_.finalize();
}

void SparseReducedSystem::CopyValues() {
  double* value = matrix_.valuePtr();
  for (Eigen::Index column = 0; column < matrix_.cols(); ++column) {
    for (const auto& [row, block] : column_blocks_[static_cast<std::size_t>(column / 6)]) {
      const bool diagonal = row == column / 6;
      const Matrix6d& values = blocks_[static_cast<std::size_t>(block)];
      for (Eigen::Index k = diagonal ? column % 6 : 0; k < 6; ++k) *value++ = values(k, column % 6);
    }
  }
}

bool SparseReducedSystem::Factorize() {
  CopyValues();
  factor_.factorize(matrix_);
  return factor_.info() == Eigen::Success;
}

}  // namespace pangaea::local_bundle
