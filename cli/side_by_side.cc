#include "cli/side_by_side.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <utility>

namespace pangaea {
namespace {

constexpr double kPictureAspect = 1.5;  // width to height of the part of the picture that the map fills
// Around each scene's trajectories, as a part of their longest extent.
constexpr double kFrame = 0.08;
constexpr double kSmallestFrame = 2.0;  // metres
// Landmarks beside the way widen it, up to this part of the longest extent; the farthest ones on either side do not.
constexpr double kLongestWidening = 0.35;
constexpr double kFarLandmarks = 0.05;

void Transform(PlotScene& scene, const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& transform) {
  const auto apply = [&](std::vector<Eigen::Vector3d>& points) {
    for (Eigen::Vector3d& point : points) point = transform(point);
  };
  for (PlotTrajectory& trajectory : scene.trajectories) {
    for (auto& piece : trajectory.pieces) apply(piece);
    apply(trajectory.keyframes);
    apply(trajectory.truth);
  }
  apply(scene.landmarks);
}

std::vector<Eigen::Vector3d> Ways(const PlotScene& scene) {
  std::vector<Eigen::Vector3d> points;
  for (const PlotTrajectory& trajectory : scene.trajectories) {
    for (const auto& piece : trajectory.pieces) points.insert(points.end(), piece.begin(), piece.end());
    points.insert(points.end(), trajectory.truth.begin(), trajectory.truth.end());
  }
  return points;
}

// z upwards, the longest horizontal extent along x.
void Level(PlotScene& scene) {
  const Eigen::Quaterniond level =
      Eigen::Quaterniond::FromTwoVectors(scene.up.value_or(Eigen::Vector3d::UnitZ()), Eigen::Vector3d::UnitZ());
  Transform(scene, [&](const Eigen::Vector3d& point) { return Eigen::Vector3d(level * point); });
  const std::vector<Eigen::Vector3d> ways = Ways(scene);
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Eigen::Vector3d& point : ways) mean += point.head<2>() / static_cast<double>(ways.size());
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  for (const Eigen::Vector3d& point : ways) {
    covariance += (point.head<2>() - mean) * (point.head<2>() - mean).transpose();
  }
  const Eigen::Vector2d along = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(covariance).eigenvectors().col(1);
  const Eigen::AngleAxisd turn(-std::atan2(along.y(), along.x()), Eigen::Vector3d::UnitZ());
  Transform(scene, [&](const Eigen::Vector3d& point) { return Eigen::Vector3d(turn * point); });
}

struct Extent {
  Eigen::Vector2d low = Eigen::Vector2d::Zero();
  Eigen::Vector2d high = Eigen::Vector2d::Zero();
  Eigen::Vector2d size() const { return high - low; }
};

void WidenForLandmarks(const std::vector<Eigen::Vector3d>& landmarks, double limit, Extent& extent) {
  for (int axis = 0; axis < 2 && !landmarks.empty(); ++axis) {
    std::vector<double> values;
    for (const Eigen::Vector3d& landmark : landmarks) values.push_back(landmark[axis]);
    std::ranges::sort(values);
    const auto far = static_cast<std::size_t>(kFarLandmarks * static_cast<double>(values.size()));
    extent.low[axis] = std::clamp(values[far], extent.low[axis] - limit, extent.low[axis]);
    extent.high[axis] = std::clamp(values[values.size() - 1 - far], extent.high[axis], extent.high[axis] + limit);
  }
}

Extent ExtentOf(const PlotScene& scene) {
  const std::vector<Eigen::Vector3d> ways = Ways(scene);
  Extent extent;
  if (!ways.empty()) extent.low = extent.high = ways.front().head<2>();
  for (const Eigen::Vector3d& point : ways) {
    extent.low = extent.low.cwiseMin(point.head<2>());
    extent.high = extent.high.cwiseMax(point.head<2>());
  }
  const double longest = extent.size().maxCoeff();
  WidenForLandmarks(scene.landmarks, std::max(kLongestWidening * longest, kSmallestFrame), extent);
  const double frame = std::max(kFrame * longest, kSmallestFrame);
  extent.low.array() -= frame;
  extent.high.array() += frame;
  return extent;
}

// Where the low corners of the extents go in rows of `columns`, the first row on top; and the size of it all.
struct Grid {
  std::vector<Eigen::Vector2d> corners;
  Eigen::Vector2d size = Eigen::Vector2d::Zero();
};

Grid LayOut(const std::vector<Extent>& extents, std::size_t columns) {
  Grid grid;
  for (std::size_t first = 0; first < extents.size(); first += columns) {
    double x = 0.0;
    double height = 0.0;
    const std::size_t end = std::min(first + columns, extents.size());
    for (std::size_t i = first; i < end; ++i) height = std::max(height, extents[i].size().y());
    grid.size.y() += height;
    for (std::size_t i = first; i < end; ++i) {
      grid.corners.emplace_back(x, -grid.size.y() + 0.5 * (height - extents[i].size().y()));
      x += extents[i].size().x();
    }
    grid.size.x() = std::max(grid.size.x(), x);
  }
  return grid;
}

// The grid that can be drawn largest.
Grid BestGrid(const std::vector<Extent>& extents) {
  const auto magnification = [](const Grid& grid) {
    return std::min(kPictureAspect / grid.size.x(), 1.0 / grid.size.y());
  };
  Grid best = LayOut(extents, 1);
  for (std::size_t columns = 2; columns <= extents.size(); ++columns) {
    Grid grid = LayOut(extents, columns);
    if (magnification(grid) > magnification(best)) best = std::move(grid);
  }
  return best;
}

}  // namespace

PlotScene PlaceSideBySide(std::vector<PlotScene> scenes) {
  if (scenes.empty()) return {};
  if (scenes.size() == 1) return std::move(scenes.front());
  std::vector<Extent> extents;
  for (PlotScene& scene : scenes) {
    Level(scene);
    extents.push_back(ExtentOf(scene));
  }
  const Grid grid = BestGrid(extents);
  PlotScene joined;
  joined.title = scenes[0].title;
  joined.subtitle = scenes[0].subtitle;
  joined.up = Eigen::Vector3d::UnitZ();
  joined.right = Eigen::Vector3d::UnitX();
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const Eigen::Vector2d shift = grid.corners[i] - extents[i].low;
    Transform(scenes[i], [&](const Eigen::Vector3d& point) {
      return Eigen::Vector3d(point + Eigen::Vector3d(shift.x(), shift.y(), 0.0));
    });
    std::ranges::move(scenes[i].trajectories, std::back_inserter(joined.trajectories));
    std::ranges::copy(scenes[i].landmarks, std::back_inserter(joined.landmarks));
  }
  return joined;
}

}  // namespace pangaea
