#include "common/sensor/euroc_calibration.h"

#include "common/base/config.h"
#include "common/sensor/camera_calibration.h"

namespace pangaea {

Result<EurocCamera> ReadEurocCamera(const std::filesystem::path& sensor_yaml) {
  auto reader = ConfigReader::Open(sensor_yaml);
  if (!reader) return tl::make_unexpected(reader.error());
  EurocCamera camera;
  RequirePose(*reader, "T_BS.data", camera.body_from_camera);
  RequireLens(*reader, LensKeys{}, camera.lens);
  if (auto status = reader->FinishIgnoringUnknown(); !status) return tl::make_unexpected(status.error());
  return camera;
}

}  // namespace pangaea
