#pragma once

#include <cstdint>
#include <string>

#include "common/geometry/ideal_camera.h"
#include "common/geometry/rigid3.h"
#include "common/map/ids.h"
#include "common/sensor/sensor_kind.h"

namespace pangaea {

// What an agent says about itself, once when it starts and once (closed) when it ends in order. The topic keeps the
// last one for servers that come later.
struct SessionAnnouncement {
  SessionId session = 0;
  std::string name;
  std::string site;
  SensorKind sensor_kind = SensorKind::kStereo;
  IdealCamera ideal_camera;
  Rigid3d body_from_camera;  // camera frame of the ideal camera to the agent's body frame
  std::string software_version;
  std::uint32_t wire_version = 0;
  std::int64_t epoch_ns = 0;  // when the session began, by the agent's system clock
  bool closed = false;        // nothing more will come
};

}  // namespace pangaea
