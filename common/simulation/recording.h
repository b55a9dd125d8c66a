#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "common/base/result.h"
#include "common/sensor/camera_rig.h"
#include "common/sensor/sensor_kind.h"
#include "common/simulation/flight.h"
#include "common/simulation/hall.h"
#include "common/simulation/image_sensor.h"
#include "common/simulation/renderer.h"

namespace pangaea {

struct RecordingOptions {
  int sessions = 3;
  double seconds = 20.0;  // of each session's flight
  // How often it is flown, to and fro: later laps show the pictures of the first, every other one in reverse, under
  // later stamps. An hour costs no more pictures than its first lap.
  int laps = 1;
  std::uint64_t seed = 1;
  double rate = 20.0;  // images a second
  SensorKind sensor = SensorKind::kStereo;
  int blur = 1;                                      // pictures averaged over the exposure; 1 is a sharp picture
  double exposure_time = 0.012;                      // seconds, over which the blur goes
  double exposure_drift = 0.0;                       // how far the exposure swings, as a share of it
  std::vector<std::pair<double, double>> blackouts;  // seconds from and to: dark noise
  int occluders = 0;
  bool repetitive = false;
  double speed = 1.0;       // metres a second
  double coarseness = 1.0;  // of the hall's pictures, see HallOptions
  int jobs = 1;             // threads; the result does not depend on it

  Status Check() const;
};

// The rig that all sessions fly with: two cameras 0.11 m apart, slightly turned against each other, looking forward
// and a little down. Without `right` for a monocular sensor.
CameraRig SimulatedRig(SensorKind sensor);

struct StereoPicture {
  cv::Mat left;   // 8-bit grey
  cv::Mat right;  // empty for a monocular sensor
};

struct TruthSample {
  std::int64_t stamp_ns = 0;
  Rigid3d world_from_body;
  Eigen::Vector3d velocity_in_world;  // metres a second
};

// The sessions of one hall: which picture every stamp has, and the truth. Constant after construction: any thread may
// ask, each with its own FramePainter.
class Recording {
 public:
  // `options` must pass its Check.
  explicit Recording(const RecordingOptions& options);

  const RecordingOptions& options() const { return options_; }
  const CameraRig& rig() const { return rig_; }
  const Scene& scene() const { return scene_; }
  const Flight& flight(int session) const { return flights_[static_cast<std::size_t>(session)]; }
  int frame_count() const;  // of one lap: so many pictures there are
  int total_frame_count() const;
  // The picture that a frame of any lap shows.
  int PictureOf(int frame) const;
  std::int64_t FrameStamp(int session, int frame) const;
  // Seconds since the session's first image.
  double Seconds(int session, std::int64_t stamp_ns) const;
  // At 200 Hz, and at every image stamp exactly; ascending.
  std::vector<TruthSample> GroundTruth(int session) const;
  bool IsBlackedOut(double seconds) const;
  double Exposure(int session, double seconds) const;

 private:
  double SecondsOfFlight(double seconds) const;

  RecordingOptions options_;
  CameraRig rig_;
  Scene scene_;
  std::vector<Flight> flights_;
};

// Draws the pictures of a recording. One per thread; the recording must outlive it.
class FramePainter {
 public:
  explicit FramePainter(const Recording& recording);

  // A function of the recording, session and frame alone.
  StereoPicture Paint(int session, int frame);

 private:
  struct Camera {
    Rigid3d camera_from_body;
    Renderer renderer;
    ImageSensor sensor;
  };
  cv::Mat PaintCamera(Camera& camera, int session, double seconds, std::uint64_t noise_seed);

  const Recording& recording_;
  std::vector<Camera> cameras_;
  std::vector<Surface> surfaces_;  // of the hall, then of the occluders of the moment
  cv::Mat light_;
  cv::Mat sum_;
};

}  // namespace pangaea
