#include "common/evaluation/plot_view.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace pangaea {
namespace {

// Landmarks decide the view only where trajectories do not, as on a straight road.
constexpr double kLandmarkWeight = 0.02;
// This part of the landmarks on either side may lie outside of the picture: a few are always far away.
constexpr double kOutlierPart = 0.015;
// Landmarks widen the picture at most to this multiple of what the trajectories need, and by this much.
constexpr double kMaxWidening = 2.6;
constexpr double kWideningAllowance = 4.0;  // metres
constexpr double kMargin = 1.06;
constexpr double kSmallestExtent = 0.5;  // metres: a still camera still makes a picture

struct Cloud {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

Cloud Describe(const std::vector<Eigen::Vector3d>& points) {
  Cloud cloud;
  if (points.empty()) return cloud;
  const auto count = static_cast<double>(points.size());
  for (const Eigen::Vector3d& point : points) cloud.mean += point / count;
  for (const Eigen::Vector3d& point : points) {
    cloud.covariance += (point - cloud.mean) * (point - cloud.mean).transpose() / count;
  }
  return cloud;
}

std::vector<Eigen::Vector3d> Positions(const PlotScene& scene) {
  std::vector<Eigen::Vector3d> positions;
  const auto add = [&](const std::vector<Eigen::Vector3d>& points) {
    std::ranges::copy_if(points, std::back_inserter(positions), [](const auto& point) { return point.allFinite(); });
  };
  for (const PlotTrajectory& trajectory : scene.trajectories) {
    for (const auto& piece : trajectory.pieces) add(piece);
    add(trajectory.truth);
  }
  return positions;
}

// The largest entry becomes positive: of the two directions of an axis, always the same one.
Eigen::Vector3d Directed(const Eigen::Vector3d& axis) {
  Eigen::Index largest = 0;
  axis.cwiseAbs().maxCoeff(&largest);
  return axis[largest] < 0.0 ? Eigen::Vector3d(-axis) : axis;
}

Eigen::Matrix3d ChooseAxes(Eigen::Matrix3d covariance, const PlotScene& scene) {
  const std::optional<Eigen::Vector3d>& up = scene.up;
  const bool has_up = up && up->allFinite() && up->norm() > 0.0;
  if (has_up) {
    const Eigen::Vector3d direction = up->normalized();
    const Eigen::Matrix3d flat = Eigen::Matrix3d::Identity() - direction * direction.transpose();
    covariance = flat * covariance * flat;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  const Eigen::Vector3d toward = has_up ? up->normalized() : Directed(solver.eigenvectors().col(0));
  Eigen::Vector3d right = scene.right.value_or(solver.eigenvectors().col(2));
  right -= toward * toward.dot(right);
  if (right.norm() < 1e-6) right = toward.unitOrthogonal();
  right = Directed(right.normalized());
  Eigen::Matrix3d axes;
  axes << right, toward.cross(right), toward;
  return axes;
}

double Quantile(std::vector<double> values, double part) {
  const auto index = static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, values.begin() + index);
  return values[static_cast<std::size_t>(index)];
}

}  // namespace

PlotView::PlotView(const PlotScene& scene, const Box& box) : box_(box) {
  const std::vector<Eigen::Vector3d> positions = Positions(scene);
  std::vector<Eigen::Vector3d> landmarks;
  std::ranges::copy_if(scene.landmarks, std::back_inserter(landmarks), [](const auto& p) { return p.allFinite(); });
  const Cloud path = Describe(positions);
  center_ = positions.empty() ? Describe(landmarks).mean : path.mean;
  axes_ = ChooseAxes(path.covariance + kLandmarkWeight * Describe(landmarks).covariance, scene);
  Eigen::Vector2d low = Eigen::Vector2d::Constant(-0.5 * kSmallestExtent);
  Eigen::Vector2d high = -low;
  for (const Eigen::Vector3d& position : positions) {
    low = low.cwiseMin(ToPlane(position).head<2>());
    high = high.cwiseMax(ToPlane(position).head<2>());
  }
  const double widening = std::max((kMaxWidening - 1.0) * (high - low).maxCoeff(), kWideningAllowance) / 2.0;
  for (int axis = 0; axis < 2 && !landmarks.empty(); ++axis) {
    std::vector<double> values;
    for (const Eigen::Vector3d& landmark : landmarks) values.push_back(ToPlane(landmark)[axis]);
    low[axis] = std::clamp(Quantile(values, kOutlierPart), low[axis] - widening, low[axis]);
    high[axis] = std::clamp(Quantile(values, 1.0 - kOutlierPart), high[axis], high[axis] + widening);
  }
  middle_ = 0.5 * (low + high);
  const Eigen::Vector2d extent = kMargin * (high - low);
  pixels_per_metre_ = std::min(box.width / extent.x(), box.height / extent.y());
}

Eigen::Vector2d PlotView::ToPixel(const Eigen::Vector2d& in_plane) const {
  const Eigen::Vector2d offset = (in_plane - middle_) * pixels_per_metre_;
  return {box_.left + 0.5 * box_.width + offset.x(), box_.top + 0.5 * box_.height - offset.y()};
}

bool PlotView::Contains(const Eigen::Vector2d& pixel) const {
  return pixel.x() >= box_.left && pixel.y() >= box_.top && pixel.x() <= box_.left + box_.width &&
         pixel.y() <= box_.top + box_.height;
}

}  // namespace pangaea
