#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "common/geometry/similarity3.h"

namespace pangaea {

// The similarity target_from_source that minimises sum |target[i] - result * source[i]|^2, in closed form with unit
// quaternions (Horn, "Closed-form solution of absolute orientation using unit quaternions", 1987). The spans have
// equal lengths, index by index. With `with_scale` false the scale is exactly 1.
// Nothing when the rotation is not determined: fewer than three points, or (nearly) collinear ones, or non-finite
// input.
std::optional<Similarity3d> AlignPoints(std::span<const Eigen::Vector3d> target,
                                        std::span<const Eigen::Vector3d> source, bool with_scale);

}  // namespace pangaea
