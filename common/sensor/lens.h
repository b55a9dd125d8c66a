#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string_view>

#include "common/base/result.h"

namespace pangaea {

enum class LensKind {
  kRadialTangential,  // Brown-Conrady: coefficients k1, k2, p1, p2, k3
  kEquidistant,       // Kannala and Brandt 2006, four terms: coefficients k1, k2, k3, k4, unused
};

// A real camera: how a ray of its frame (z forward, x right, y down) becomes a pixel. Pixels have their centre at
// integer coordinates. "Normalised" points are those of a ray at z = 1; "distorted" ones what the lens makes of them.
struct LensModel {
  LensKind kind = LensKind::kRadialTangential;
  int width = 0;          // pixels
  int height = 0;         // pixels
  double focal_x = 0.0;   // pixels
  double focal_y = 0.0;   // pixels
  double center_x = 0.0;  // pixels
  double center_y = 0.0;  // pixels
  std::array<double, 5> coefficients{};

  bool is_distorted() const;
  Eigen::Vector2d Distort(const Eigen::Vector2d& normalised) const;
  // The inverse of Distort on the part of the plane where the lens does not fold over. Nothing where no such point
  // exists, in particular 90 degrees and more off the axis.
  std::optional<Eigen::Vector2d> Undistort(const Eigen::Vector2d& distorted) const;
  // Pixel of a point in the camera frame; z must be > 0.
  Eigen::Vector2d Project(const Eigen::Vector3d& point_in_camera) const;
  // The normalised point whose image is `pixel`; nothing where Undistort gives nothing.
  std::optional<Eigen::Vector2d> Unproject(const Eigen::Vector2d& pixel) const;
  // Beyond this distance from the axis (of a normalised point) the radial function stops growing, so pixels there show
  // something else. Infinity for a lens that never folds.
  double FoldingRadius() const;

  // Sizes and focal lengths positive, everything finite. `place` (a file) opens the message.
  Status Check(std::string_view place) const;
  bool operator==(const LensModel&) const = default;
};

}  // namespace pangaea
