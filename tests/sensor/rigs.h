#pragma once

#include "common/sensor/camera_rig.h"

namespace pangaea::testing {

// A stereo head like that of the EuRoC drone: 11 cm, strong barrel distortion, cameras turned against each other.
inline CameraRig DroneRig() {
  CameraRig rig;
  rig.left = {.kind = LensKind::kRadialTangential,
              .width = 752,
              .height = 480,
              .focal_x = 458.654,
              .focal_y = 457.296,
              .center_x = 367.215,
              .center_y = 248.375,
              .coefficients = {-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05, 0.0}};
  rig.right = {.kind = LensKind::kRadialTangential,
               .width = 752,
               .height = 480,
               .focal_x = 457.587,
               .focal_y = 456.134,
               .center_x = 379.999,
               .center_y = 255.238,
               .coefficients = {-0.28368365, 0.07451284, -0.00010473, -3.555907e-05, 0.0}};
  // The cameras are mounted turned by a quarter about the optical axis.
  const Eigen::Quaterniond mounted(Eigen::AngleAxisd(1.5707963, Eigen::Vector3d::UnitZ()));
  const Eigen::Quaterniond left_turn(Eigen::AngleAxisd(0.026, Eigen::Vector3d(1.0, 0.2, 0.1).normalized()));
  const Eigen::Quaterniond right_turn(Eigen::AngleAxisd(0.024, Eigen::Vector3d(-0.5, 1.0, 0.3).normalized()));
  rig.body_from_left = Rigid3d(mounted * left_turn, {-0.0216, -0.0647, 0.0098});
  rig.body_from_right = Rigid3d(mounted * right_turn, {-0.0198, 0.0454, 0.0079});
  return rig;
}

// A stereo head of fisheye lenses like that of TUM-VI: equidistant, more than 180 degrees across the diagonal.
inline CameraRig FisheyeRig() {
  CameraRig rig;
  rig.left = {.kind = LensKind::kEquidistant,
              .width = 512,
              .height = 512,
              .focal_x = 190.978,
              .focal_y = 190.973,
              .center_x = 254.931,
              .center_y = 256.897,
              .coefficients = {0.0034823894, 0.0007150348, -0.0020532361, 0.00020293673, 0.0}};
  rig.right = rig.left;
  rig.right->focal_x = 190.442;
  rig.right->center_x = 252.597;
  rig.right->coefficients = {0.0034003171, 0.0017669271, -0.0026631290, 0.00032994822, 0.0};
  rig.body_from_left = Rigid3d(Eigen::Quaterniond(Eigen::AngleAxisd(0.02, Eigen::Vector3d::UnitY())), {0.0, 0.07, 0.0});
  rig.body_from_right =
      Rigid3d(Eigen::Quaterniond(Eigen::AngleAxisd(0.03, Eigen::Vector3d::UnitX())), {0.1, 0.071, 0.001});
  return rig;
}

}  // namespace pangaea::testing
