#include "common/estimation/pose_kernel.h"

#include <algorithm>
#include <array>
#include <cmath>

// Compiled with -fno-math-errno -fno-trapping-math (see CMakeLists.txt): otherwise compilers do not vectorise the
// square root and the selections below.

namespace pangaea {
namespace {

constexpr int kLanes = 8;
using Lanes = double[kLanes];

// Observations gathered for one vector pass; lanes without one have weight 0.
struct Block {
  Lanes x{}, y{}, z{};        // the point in the map
  Lanes u{}, v{}, u_right{};  // the measurement
  Lanes squared_weight{};     // inverse_sigma^2
  Lanes stereo{};             // 1 or 0
  // Of the kernel. Positive also where there is no observation: it is a divisor.
  Lanes bend = {1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0};
};

// The sums, lane by lane. The translation part of the information has no (x, y) entry: rows u and v share no axis.
struct Sums {
  Lanes cost{};
  std::array<Lanes, 3> translation_gradient{};
  std::array<Lanes, 3> rotation_gradient{};
  Lanes xx{}, xz{}, yy{}, yz{}, zz{};
  std::array<std::array<Lanes, 3>, 3> cross{};  // translation rows, rotation columns
  Lanes r00{}, r01{}, r02{}, r11{}, r12{}, r22{};
};

struct Projection {
  std::array<double, 9> rotation;  // row by row
  std::array<double, 3> translation;
  double focal_x, focal_y, center_x, center_y, baseline;
};

Projection MakeProjection(const IdealCamera& camera, const Rigid3d& camera_from_map) {
  Projection projection{};
  const Eigen::Matrix3d rotation = camera_from_map.rotation().toRotationMatrix();
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(projection.rotation.data()) = rotation;
  Eigen::Map<Eigen::Vector3d>(projection.translation.data()) = camera_from_map.translation();
  projection.focal_x = camera.focal_x;
  projection.focal_y = camera.focal_y;
  projection.center_x = camera.center_x;
  projection.center_y = camera.center_y;
  projection.baseline = camera.baseline;
  return projection;
}

// With g a row of the projection's derivative by the point p in the camera, the row by the perturbation is
// (g, p x g); A = sum w g g' then gives the blocks A, rows p x A_i, and columns p x of those.
[[gnu::always_inline]] inline void AddBlock(const Projection& c, const Block& __restrict block, Sums& __restrict sums) {
  const double r00 = c.rotation[0], r01 = c.rotation[1], r02 = c.rotation[2];
  const double r10 = c.rotation[3], r11 = c.rotation[4], r12 = c.rotation[5];
  const double r20 = c.rotation[6], r21 = c.rotation[7], r22 = c.rotation[8];
  const double tx = c.translation[0], ty = c.translation[1], tz = c.translation[2];
  const double focal_x = c.focal_x, focal_y = c.focal_y, center_x = c.center_x, center_y = c.center_y;
  const double baseline = c.baseline;
  for (int i = 0; i < kLanes; ++i) {
    const double x = r00 * block.x[i] + r01 * block.y[i] + r02 * block.z[i] + tx;
    const double y = r10 * block.x[i] + r11 * block.y[i] + r12 * block.z[i] + ty;
    const double z = r20 * block.x[i] + r21 * block.y[i] + r22 * block.z[i] + tz;
    const double inverse_depth = 1.0 / (z > kMinDepth ? z : kMinDepth);
    const double slope = z > kMinDepth ? inverse_depth : 0.0;
    const double a = focal_x * inverse_depth;
    const double b = focal_y * inverse_depth;
    const double du = -a * x * slope;
    const double dv = -b * y * slope;
    const double dr = -a * (x - baseline) * slope;
    const double error_u = a * x + center_x - block.u[i];
    const double error_v = b * y + center_y - block.v[i];
    const double error_r = block.stereo[i] * (a * (x - baseline) + center_x - block.u_right[i]);

    const double squared = block.squared_weight[i] * (error_u * error_u + error_v * error_v + error_r * error_r);
    const double bend = block.bend[i];
    const bool beyond = squared > bend;
    const double root = std::sqrt(bend / (beyond ? squared : bend));  // 1 inside the bend
    const double w = block.squared_weight[i] * root;
    sums.cost[i] += beyond ? 2.0 * root * squared - bend : squared;

    const double wa = w * a;
    const double s = block.stereo[i];
    const double xx = wa * a * (1.0 + s);
    const double xz = wa * (du + s * dr);
    const double yy = w * b * b;
    const double yz = w * b * dv;
    const double zz = w * (du * du + dv * dv + s * dr * dr);
    const double gx = wa * (error_u + error_r);
    const double gy = w * b * error_v;
    const double gz = w * (du * error_u + dv * error_v + dr * error_r);
    sums.translation_gradient[0][i] += gx;
    sums.translation_gradient[1][i] += gy;
    sums.translation_gradient[2][i] += gz;
    sums.rotation_gradient[0][i] += y * gz - z * gy;
    sums.rotation_gradient[1][i] += z * gx - x * gz;
    sums.rotation_gradient[2][i] += x * gy - y * gx;
    sums.xx[i] += xx;
    sums.xz[i] += xz;
    sums.yy[i] += yy;
    sums.yz[i] += yz;
    sums.zz[i] += zz;
    const double c00 = y * xz, c01 = z * xx - x * xz, c02 = -y * xx;
    const double c10 = y * yz - z * yy, c11 = -x * yz, c12 = x * yy;
    const double c20 = y * zz - z * yz, c21 = z * xz - x * zz, c22 = x * yz - y * xz;
    sums.cross[0][0][i] += c00;
    sums.cross[0][1][i] += c01;
    sums.cross[0][2][i] += c02;
    sums.cross[1][0][i] += c10;
    sums.cross[1][1][i] += c11;
    sums.cross[1][2][i] += c12;
    sums.cross[2][0][i] += c20;
    sums.cross[2][1][i] += c21;
    sums.cross[2][2][i] += c22;
    sums.r00[i] += y * c20 - z * c10;
    sums.r01[i] += y * c21 - z * c11;
    sums.r02[i] += y * c22 - z * c12;
    sums.r11[i] += z * c01 - x * c21;
    sums.r12[i] += z * c02 - x * c22;
    sums.r22[i] += x * c12 - y * c02;
  }
}

void AddBlockBaseline(const Projection& projection, const Block& block, Sums& sums) {
  AddBlock(projection, block, sums);
}

#if defined(__x86_64__)
__attribute__((target("avx2,fma"))) void AddBlockAvx2(const Projection& projection, const Block& block, Sums& sums) {
  AddBlock(projection, block, sums);
}
#endif

using AddBlockFunction = void (*)(const Projection&, const Block&, Sums&);

AddBlockFunction ChooseAddBlock() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return AddBlockAvx2;
#endif
  return AddBlockBaseline;
}

void SetLane(Block& block, int lane, const PoseObservation& observation, bool stereo, const KernelBends& bends) {
  block.x[lane] = observation.point_in_map.x();
  block.y[lane] = observation.point_in_map.y();
  block.z[lane] = observation.point_in_map.z();
  block.u[lane] = observation.measurement.x();
  block.v[lane] = observation.measurement.y();
  block.u_right[lane] = observation.measurement.z();
  block.squared_weight[lane] = observation.inverse_sigma * observation.inverse_sigma;
  block.stereo[lane] = stereo ? 1.0 : 0.0;
  block.bend[lane] = stereo ? bends.stereo : bends.monocular;
}

double Sum(const Lanes& lanes) {
  double sum = 0.0;
  for (const double lane : lanes) sum += lane;
  return sum;
}

PoseNormalEquations Reduce(const Sums& sums) {
  PoseNormalEquations equations;
  equations.cost = Sum(sums.cost);
  Matrix6d& h = equations.information;
  h(0, 0) = Sum(sums.xx);
  h(0, 2) = Sum(sums.xz);
  h(1, 1) = Sum(sums.yy);
  h(1, 2) = Sum(sums.yz);
  h(2, 2) = Sum(sums.zz);
  for (int row = 0; row < 3; ++row) {
    equations.gradient(row) = Sum(sums.translation_gradient[row]);
    equations.gradient(row + 3) = Sum(sums.rotation_gradient[row]);
    for (int column = 0; column < 3; ++column) h(row, column + 3) = Sum(sums.cross[row][column]);
  }
  h(3, 3) = Sum(sums.r00);
  h(3, 4) = Sum(sums.r01);
  h(3, 5) = Sum(sums.r02);
  h(4, 4) = Sum(sums.r11);
  h(4, 5) = Sum(sums.r12);
  h(5, 5) = Sum(sums.r22);
  h.triangularView<Eigen::StrictlyLower>() = h.transpose();
  return equations;
}

}  // namespace

PoseNormalEquations AccumulatePose(const IdealCamera& camera, const Rigid3d& camera_from_map,
                                   std::span<const PoseObservation> observations, std::span<const std::uint8_t> active,
                                   const KernelBends& bends) {
  static const AddBlockFunction add_block = ChooseAddBlock();
  const Projection projection = MakeProjection(camera, camera_from_map);
  const bool has_right = camera.is_stereo();
  Sums sums;
  Block block;
  int lane = 0;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (active[i] == 0) continue;
    SetLane(block, lane, observations[i], has_right && IsStereo(observations[i].measurement), bends);
    if (++lane < kLanes) continue;
    add_block(projection, block, sums);
    lane = 0;
  }
  for (int rest = lane; rest < kLanes && lane > 0; ++rest) block.squared_weight[rest] = 0.0;
  if (lane > 0) add_block(projection, block, sums);
  return Reduce(sums);
}

}  // namespace pangaea
