#include "common/sensor/camera_calibration.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

namespace pangaea {
namespace {

constexpr Range<double> kImageSide{16.0, 16384.0};  // pixels
constexpr Range<double> kIntrinsic{1e-3, 1e5};      // pixels
constexpr Range<double> kCoefficient{-1e4, 1e4};    // of the distortion polynomials
constexpr Range<double> kPoseEntry{-1e4, 1e4};      // of a 4 x 4 matrix, metres in the last column
constexpr double kRotationTolerance = 1e-3;         // calibration files are rounded

struct DistortionName {
  std::string_view name;
  LensKind kind;
};
constexpr std::array kDistortionNames = {
    DistortionName{"radial-tangential", LensKind::kRadialTangential},
    DistortionName{"radtan", LensKind::kRadialTangential}, DistortionName{"plumb_bob", LensKind::kRadialTangential},
    DistortionName{"none", LensKind::kRadialTangential}, DistortionName{"equidistant", LensKind::kEquidistant}};

void RequireDistortion(ConfigReader& reader, const LensKeys& keys, LensModel& lens) {
  std::string name;
  reader.Require(keys.distortion_model, &name);
  if (name.empty()) return;
  const auto found = std::ranges::find(kDistortionNames, name, &DistortionName::name);
  if (found == kDistortionNames.end()) {
    reader.Refuse(keys.distortion_model, "is '" + name + "'", "radial-tangential (or radtan), equidistant or none");
    return;
  }
  lens.kind = found->kind;
  if (name == "none") return;
  std::vector<double> coefficients;
  if (lens.kind == LensKind::kRadialTangential) {
    reader.RequireList(keys.distortion_coefficients, &coefficients, {4, 5}, kCoefficient);
  } else {
    reader.RequireList(keys.distortion_coefficients, &coefficients, {4}, kCoefficient);
  }
  std::ranges::copy(coefficients, lens.coefficients.begin());
}

void RequireSizeAndFocalLength(ConfigReader& reader, const LensKeys& keys, LensModel& lens) {
  std::vector<double> resolution;
  reader.RequireList(keys.resolution, &resolution, {2}, kImageSide);
  if (resolution.size() == 2) {
    lens.width = static_cast<int>(resolution[0]);
    lens.height = static_cast<int>(resolution[1]);
  }
  std::vector<double> intrinsics;
  reader.RequireList(keys.intrinsics, &intrinsics, {4}, kIntrinsic);
  if (intrinsics.size() == 4) {
    lens.focal_x = intrinsics[0];
    lens.focal_y = intrinsics[1];
    lens.center_x = intrinsics[2];
    lens.center_y = intrinsics[3];
  }
}

}  // namespace

void RequireLens(ConfigReader& reader, const LensKeys& keys, LensModel& lens) {
  std::string model = "pinhole";
  reader.Read(keys.camera_model, &model);
  if (model != "pinhole") reader.Refuse(keys.camera_model, "is '" + model + "'", "pinhole");
  RequireSizeAndFocalLength(reader, keys, lens);
  RequireDistortion(reader, keys, lens);
}

void RequirePose(ConfigReader& reader, const std::string& key, Rigid3d& pose) {
  std::vector<double> numbers;
  reader.RequireList(key, &numbers, {16}, kPoseEntry);
  if (numbers.empty()) return;
  const Eigen::Matrix4d matrix = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(numbers.data());
  const Eigen::Matrix3d rotation = matrix.topLeftCorner<3, 3>();
  const bool is_rotation =
      (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm() < kRotationTolerance &&
      rotation.determinant() > 0.0;
  if (!is_rotation || (matrix.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).norm() > kRotationTolerance) {
    reader.Refuse(key, "is not a rigid motion", "a rotation matrix, a translation (metres) and the row 0 0 0 1");
    return;
  }
  pose = Rigid3d(Eigen::Quaterniond(rotation), matrix.topRightCorner<3, 1>());
}

}  // namespace pangaea
