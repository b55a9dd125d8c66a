#include "common/sensor/rectifier.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "common/base/check.h"

namespace pangaea {
namespace {

constexpr int kBorderSamples = 64;  // along each side of the source image
// Right of the left camera within 45 degrees: beyond, the cameras see too little in common.
constexpr double kMinSideways = 0.7;
// At least this much larger than nothing, metres: stereo needs a baseline.
constexpr double kMinBaseline = 1e-4;
// Where no source pixel is: outside of every image, so that remapping gives black there.
constexpr float kNowhere = -16.0F;

// One source camera and the rotation from its frame to the ideal camera's.
struct Source {
  const LensModel& lens;
  Eigen::Matrix3d ideal_from_source;
};

// The largest rectangle (normalised coordinates of the ideal camera, sides along its axes) that the sources cover.
struct Field {
  double left = -std::numeric_limits<double>::infinity();
  double right = std::numeric_limits<double>::infinity();
  double top = -std::numeric_limits<double>::infinity();
  double bottom = std::numeric_limits<double>::infinity();
};

// Where a source pixel lies in the ideal camera. Nothing behind it: such a border does not limit the field.
std::optional<Eigen::Vector2d> IdealFromPixel(const Source& source, const Eigen::Vector2d& pixel) {
  const auto normalised = source.lens.Unproject(pixel);
  if (!normalised) return std::nullopt;
  const Eigen::Vector3d ray = source.ideal_from_source * normalised->homogeneous();
  if (ray.z() <= 0.0) return std::nullopt;
  return Eigen::Vector2d(ray.head<2>() / ray.z());
}

// Shrinks the field to the inside of what one source covers, judged by points on its border.
void Intersect(const Source& source, Field& field) {
  const double last_column = source.lens.width - 1;
  const double last_row = source.lens.height - 1;
  for (int i = 0; i <= kBorderSamples; ++i) {
    const double x = last_column * i / kBorderSamples;
    const double y = last_row * i / kBorderSamples;
    if (const auto p = IdealFromPixel(source, {0.0, y})) field.left = std::max(field.left, p->x());
    if (const auto p = IdealFromPixel(source, {last_column, y})) field.right = std::min(field.right, p->x());
    if (const auto p = IdealFromPixel(source, {x, 0.0})) field.top = std::max(field.top, p->y());
    if (const auto p = IdealFromPixel(source, {x, last_row})) field.bottom = std::min(field.bottom, p->y());
  }
}

// The centre of the image in one direction: the middle of the covered field where that limits it, else the axis kept
// as near the middle as the shorter side allows.
double CenterAlong(double low, double high, double focal, int size) {
  const double middle = 0.5 * (size - 1);
  if (!std::isfinite(low) || !std::isfinite(high)) return middle;
  return middle - focal * 0.5 * (low + high);
}

// Square pixels, so that a rotation of the camera is a rotation of the patches that features describe.
IdealCamera ChooseCamera(const std::vector<Source>& sources, const RectifierOptions& options) {
  Field field;
  double real_focal = 0.0;
  for (const Source& source : sources) {
    Intersect(source, field);
    real_focal = std::max({real_focal, source.lens.focal_x, source.lens.focal_y});
  }
  const LensModel& lens = sources.front().lens;
  const double covering =
      std::max((lens.width - 1) / (field.right - field.left), (lens.height - 1) / (field.bottom - field.top));
  IdealCamera camera;
  camera.width = lens.width;
  camera.height = lens.height;
  camera.focal_x = camera.focal_y = std::max(covering, options.min_focal_ratio * real_focal);
  camera.center_x = CenterAlong(field.left, field.right, camera.focal_x, camera.width);
  camera.center_y = CenterAlong(field.top, field.bottom, camera.focal_y, camera.height);
  return camera;
}

// body_from_ideal of a stereo pair: x along the baseline, z the mean of both optical axes made square to it, so that
// both images turn as little as they can (Fusiello, Trucco and Verri, "A compact algorithm for rectification of stereo
// pairs", 2000, with Bouguet's choice of the third axis).
Result<Rigid3d> RectifiedPose(const CameraRig& rig) {
  const Eigen::Vector3d left_in_body = rig.body_from_left.translation();
  const Eigen::Vector3d baseline = rig.body_from_right.translation() - left_in_body;
  const Eigen::Vector3d left_axis = rig.body_from_left.rotation() * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d right_axis = rig.body_from_right.rotation() * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d left_sideways = rig.body_from_left.rotation() * Eigen::Vector3d::UnitX();
  if (!(baseline.norm() > kMinBaseline)) {
    return Fail(ErrorCode::kInvalidArgument,
                "calibration: the two cameras are at the same place, so they see no depth");
  }
  const Eigen::Vector3d x = baseline.normalized();
  if (x.dot(left_sideways) < kMinSideways) {
    return Fail(ErrorCode::kInvalidArgument,
                "calibration: the second camera is not to the right of the first one (within 45 degrees)");
  }
  const Eigen::Vector3d mean_axis = left_axis + right_axis;
  const Eigen::Vector3d y = mean_axis.cross(x);
  if (left_axis.dot(right_axis) < kMinSideways || y.norm() < kMinSideways) {
    return Fail(ErrorCode::kInvalidArgument, "calibration: the two cameras look into different directions");
  }
  Eigen::Matrix3d body_from_ideal;
  body_from_ideal << x, y.normalized(), x.cross(y.normalized());
  return Rigid3d(Eigen::Quaterniond(body_from_ideal), left_in_body);
}

Status CheckRig(const CameraRig& rig, SensorKind kind) {
  if (auto status = rig.left.Check("calibration of the left camera"); !status) return status;
  if (!rig.body_from_left.AllFinite()) return Fail(ErrorCode::kInvalidArgument, "calibration: a pose is not finite");
  if (kind == SensorKind::kMonocular) return {};
  if (!rig.right) return Fail(ErrorCode::kInvalidArgument, "stereo was asked for, but there is only one camera");
  if (auto status = rig.right->Check("calibration of the right camera"); !status) return status;
  if (!rig.body_from_right.AllFinite()) return Fail(ErrorCode::kInvalidArgument, "calibration: a pose is not finite");
  if (rig.left.width != rig.right->width || rig.left.height != rig.right->height) {
    return Fail(ErrorCode::kUnsupported, "calibration: the images of the two cameras have different sizes");
  }
  return {};
}

IdealCamera UndistortedCamera(const LensModel& lens) {
  return {.width = lens.width,
          .height = lens.height,
          .focal_x = lens.focal_x,
          .focal_y = lens.focal_y,
          .center_x = lens.center_x,
          .center_y = lens.center_y,
          .baseline = 0.0};
}

}  // namespace

// Fills the private parts of a Rectifier.
class RectifierBuilder {
 public:
  static Rectifier Identity(const CameraRig& rig, SensorKind kind) {
    Rectifier rectifier;
    rectifier.camera_ = UndistortedCamera(rig.left);
    rectifier.body_from_camera_ = rig.body_from_left;
    if (kind == SensorKind::kStereo) {
      const Rigid3d left_from_right = rig.body_from_left.Inverse() * rig.body_from_right;
      rectifier.camera_.baseline = left_from_right.translation().x();
    }
    return rectifier;
  }

  static Rectifier Build(const std::vector<Source>& sources, const Rigid3d& body_from_camera, double baseline,
                         const RectifierOptions& options) {
    Rectifier rectifier;
    rectifier.camera_ = ChooseCamera(sources, options);
    rectifier.camera_.baseline = baseline;
    rectifier.body_from_camera_ = body_from_camera;
    rectifier.left_ = MakeTable(sources.front(), rectifier.camera_);
    if (sources.size() > 1) rectifier.right_ = MakeTable(sources.back(), rectifier.camera_);
    return rectifier;
  }

 private:
  static Rectifier::RemapTable MakeTable(const Source& source, const IdealCamera& camera) {
    const Eigen::Matrix3d source_from_ideal = source.ideal_from_source.transpose();
    const double folding_radius = source.lens.FoldingRadius();
    cv::Mat positions(camera.height, camera.width, CV_32FC2);
    for (int row = 0; row < camera.height; ++row) {
      auto* out = positions.ptr<cv::Vec2f>(row);
      for (int column = 0; column < camera.width; ++column) {
        const Eigen::Vector3d ray = source_from_ideal * camera.Unproject(Eigen::Vector2d(column, row));
        const bool seen = ray.z() > 0.0 && ray.head<2>().norm() < folding_radius * ray.z();
        const Eigen::Vector2d pixel = seen ? source.lens.Project(ray) : Eigen::Vector2d(kNowhere, kNowhere);
        const Eigen::Vector2d bounded =
            pixel.cwiseMax(double{kNowhere}).cwiseMin(std::max(source.lens.width, source.lens.height) - kNowhere);
        out[column] = cv::Vec2f(static_cast<float>(bounded.x()), static_cast<float>(bounded.y()));
      }
    }
    Rectifier::RemapTable table;
    cv::convertMaps(positions, cv::noArray(), table.whole, table.fraction, CV_16SC2);
    return table;
  }
};

Status RectifierOptions::Check() const {
  if (min_focal_ratio > 0.0 && min_focal_ratio <= 4.0) return {};
  return Fail(ErrorCode::kInvalidArgument, "min_focal_ratio: allowed: greater than 0, to 4");
}

Result<Rectifier> Rectifier::Create(const CameraRig& rig, SensorKind kind, const RectifierOptions& options) {
  if (auto status = options.Check(); !status) return tl::make_unexpected(status.error());
  if (auto status = CheckRig(rig, kind); !status) return tl::make_unexpected(status.error());
  const bool unchanged = kind == SensorKind::kMonocular ? !rig.left.is_distorted() : rig.already_rectified;
  if (kind == SensorKind::kMonocular) {
    if (unchanged) return RectifierBuilder::Identity(rig, kind);
    return RectifierBuilder::Build({{rig.left, Eigen::Matrix3d::Identity()}}, rig.body_from_left, 0.0, options);
  }
  const auto body_from_ideal = RectifiedPose(rig);
  if (!body_from_ideal) return tl::make_unexpected(body_from_ideal.error());
  if (unchanged) return RectifierBuilder::Identity(rig, kind);
  const Eigen::Quaterniond ideal_from_body = body_from_ideal->rotation().conjugate();
  const Eigen::Matrix3d ideal_from_left = (ideal_from_body * rig.body_from_left.rotation()).toRotationMatrix();
  const Eigen::Matrix3d ideal_from_right = (ideal_from_body * rig.body_from_right.rotation()).toRotationMatrix();
  const double baseline = (rig.body_from_right.translation() - rig.body_from_left.translation()).norm();
  return RectifierBuilder::Build({{rig.left, ideal_from_left}, {*rig.right, ideal_from_right}}, *body_from_ideal,
                                 baseline, options);
}

cv::Mat Rectifier::Remap(const cv::Mat& image, const RemapTable& table) const {
  PANGAEA_CHECK(image.type() == CV_8UC1 && image.cols == camera_.width && image.rows == camera_.height);
  if (table.whole.empty()) return image;
  cv::Mat rectified;
  cv::remap(image, rectified, table.whole, table.fraction, cv::INTER_LINEAR, cv::BORDER_CONSTANT, cv::Scalar(0));
  return rectified;
}

}  // namespace pangaea
