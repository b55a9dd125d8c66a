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
  Lanes x{}, y{}, z{};          // the point in the map
  Lanes u{}, v{}, disparity{};  // the measurement
  Lanes squared_weight{};       // inverse_sigma^2
  Lanes stereo{};               // 1 or 0
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

// One observation: where the camera sees the point, and the sums over its rows of the projection's derivative by that
// point, w g g' and w g e.
struct Terms {
  double x, y, z;  // in the camera
  double cost;
  double xx, xz, yy, yz, zz;  // w g g'; xy is 0
  double gx, gy, gz;          // w g e
};

[[gnu::always_inline]] inline Terms Evaluate(const Projection& c, const Block& __restrict block, int i) {
  const auto& r = c.rotation;
  const double x = r[0] * block.x[i] + r[1] * block.y[i] + r[2] * block.z[i] + c.translation[0];
  const double y = r[3] * block.x[i] + r[4] * block.y[i] + r[5] * block.z[i] + c.translation[1];
  const double z = r[6] * block.x[i] + r[7] * block.y[i] + r[8] * block.z[i] + c.translation[2];
  const double inverse_depth = 1.0 / (z > kMinDepth ? z : kMinDepth);
  const double slope = z > kMinDepth ? inverse_depth : 0.0;
  const double a = c.focal_x * inverse_depth;
  const double b = c.focal_y * inverse_depth;
  const double du = -a * x * slope;
  const double dv = -b * y * slope;
  const double dd = -kDisparityPrecision * a * c.baseline * slope;
  const double s = block.stereo[i];
  const double error_u = a * x + c.center_x - block.u[i];
  const double error_v = b * y + c.center_y - block.v[i];
  const double error_d = s * kDisparityPrecision * (a * c.baseline - block.disparity[i]);

  const double squared = block.squared_weight[i] * (error_u * error_u + error_v * error_v + error_d * error_d);
  const double bend = block.bend[i];
  const bool beyond = squared > bend;
  const double root = std::sqrt(bend / (beyond ? squared : bend));  // 1 inside the bend
  const double w = block.squared_weight[i] * root;
  const double wa = w * a;
  return {.x = x,
          .y = y,
          .z = z,
          .cost = beyond ? 2.0 * root * squared - bend : squared,
          .xx = wa * a,
          .xz = wa * du,
          .yy = w * b * b,
          .yz = w * b * dv,
          .zz = w * (du * du + dv * dv + s * dd * dd),
          .gx = wa * error_u,
          .gy = w * b * error_v,
          .gz = w * (du * error_u + dv * error_v + dd * error_d)};
}

[[gnu::always_inline]] inline void AddTranslation(const Terms& t, Sums& __restrict sums, int i) {
  sums.cost[i] += t.cost;
  sums.translation_gradient[0][i] += t.gx;
  sums.translation_gradient[1][i] += t.gy;
  sums.translation_gradient[2][i] += t.gz;
  sums.xx[i] += t.xx;
  sums.xz[i] += t.xz;
  sums.yy[i] += t.yy;
  sums.yz[i] += t.yz;
  sums.zz[i] += t.zz;
}

// With g a row of the projection's derivative by the point p in the camera, the row by the perturbation is
// (g, p x g); A = sum w g g' then gives the blocks A, rows p x A_i, and columns p x of those.
[[gnu::always_inline]] inline void AddRotation(const Terms& t, Sums& __restrict sums, int i) {
  sums.rotation_gradient[0][i] += t.y * t.gz - t.z * t.gy;
  sums.rotation_gradient[1][i] += t.z * t.gx - t.x * t.gz;
  sums.rotation_gradient[2][i] += t.x * t.gy - t.y * t.gx;
  const double c00 = t.y * t.xz, c01 = t.z * t.xx - t.x * t.xz, c02 = -t.y * t.xx;
  const double c10 = t.y * t.yz - t.z * t.yy, c11 = -t.x * t.yz, c12 = t.x * t.yy;
  const double c20 = t.y * t.zz - t.z * t.yz, c21 = t.z * t.xz - t.x * t.zz, c22 = t.x * t.yz - t.y * t.xz;
  sums.cross[0][0][i] += c00;
  sums.cross[0][1][i] += c01;
  sums.cross[0][2][i] += c02;
  sums.cross[1][0][i] += c10;
  sums.cross[1][1][i] += c11;
  sums.cross[1][2][i] += c12;
  sums.cross[2][0][i] += c20;
  sums.cross[2][1][i] += c21;
  sums.cross[2][2][i] += c22;
  sums.r00[i] += t.y * c20 - t.z * c10;
  sums.r01[i] += t.y * c21 - t.z * c11;
  sums.r02[i] += t.y * c22 - t.z * c12;
  sums.r11[i] += t.z * c01 - t.x * c21;
  sums.r12[i] += t.z * c02 - t.x * c22;
  sums.r22[i] += t.x * c12 - t.y * c02;
}

// The projection by value: read through a reference, its numbers would be loaded anew for each lane, and none
// vectorised.
[[gnu::always_inline]] inline void AddBlock(Projection c, const Block& __restrict block, Sums& __restrict sums) {
  for (int i = 0; i < kLanes; ++i) {
    const Terms terms = Evaluate(c, block, i);
    AddTranslation(terms, sums, i);
    AddRotation(terms, sums, i);
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
  block.disparity[lane] = observation.measurement.x() - observation.measurement.z();
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
