#include "common/simulation/recording_writer.h"

#include <atomic>
#include <cstdio>
#include <fstream>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "common/base/mutex.h"
#include "common/sensor/png_encoder.h"

namespace pangaea {
namespace {

namespace fs = std::filesystem;

template <typename... Values>
std::string Format(const char* format, Values... values) {
  std::vector<char> text(1024);
  const int length = std::snprintf(text.data(), text.size(), format, values...);
  return std::string(text.data(), static_cast<std::size_t>(length));
}

Status WriteFile(const fs::path& path, std::string_view octets) {
  std::ofstream file(path, std::ios::binary);
  file << octets;
  file.close();
  if (!file) return Fail(ErrorCode::kUnavailable, "cannot write " + path.string());
  return {};
}

Status MakeFolder(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) return Fail(ErrorCode::kUnavailable, "cannot create " + path.string() + ": " + error.message());
  return {};
}

fs::path CameraFolder(const fs::path& session, int camera) { return session / "mav0" / Format("cam%d", camera); }

std::string SensorYaml(const LensModel& lens, const Rigid3d& body_from_camera, int camera, double rate) {
  const Eigen::Matrix4d t = body_from_camera.Matrix();
  std::string text = "# General sensor definitions.\nsensor_type: camera\n";
  text += Format("comment: simulated cam%d\n\n# Sensor extrinsics wrt. the body-frame.\n", camera);
  text += "T_BS:\n  cols: 4\n  rows: 4\n  data: [";
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      text += Format("%.17g", t(row, column)) + (column < 3 ? ", " : row < 3 ? ",\n         " : "]\n");
    }
  }
  const auto& k = lens.coefficients;
  text += Format("\n# Camera specific definitions.\nrate_hz: %.17g\nresolution: [%d, %d]\ncamera_model: pinhole\n",
                 rate, lens.width, lens.height);
  text += Format("intrinsics: [%.17g, %.17g, %.17g, %.17g] #fu, fv, cu, cv\n", lens.focal_x, lens.focal_y,
                 lens.center_x, lens.center_y);
  text += "distortion_model: radial-tangential\n";
  text += Format("distortion_coefficients: [%.17g, %.17g, %.17g, %.17g]\n", k[0], k[1], k[2], k[3]);
  return text;
}

std::string ImageName(std::int64_t stamp_ns) { return std::to_string(stamp_ns) + ".png"; }

std::string ImageList(const Recording& recording, int session) {
  std::string text = "#timestamp [ns],filename\n";
  for (int frame = 0; frame < recording.total_frame_count(); ++frame) {
    const std::string picture = ImageName(recording.FrameStamp(session, recording.PictureOf(frame)));
    text += std::to_string(recording.FrameStamp(session, frame)) + "," + picture + "\n";
  }
  return text;
}

std::string TruthTable(const Recording& recording, int session) {
  std::string text =
      "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z [], "
      "v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], v_RS_R_z [m s^-1], b_w_RS_S_x [rad s^-1], b_w_RS_S_y [rad s^-1], "
      "b_w_RS_S_z [rad s^-1], b_a_RS_S_x [m s^-2], b_a_RS_S_y [m s^-2], b_a_RS_S_z [m s^-2]\n";
  for (const TruthSample& sample : recording.GroundTruth(session)) {
    const Eigen::Vector3d& p = sample.world_from_body.translation();
    const Eigen::Quaterniond& q = sample.world_from_body.rotation();
    const Eigen::Vector3d& v = sample.velocity_in_world;
    text += std::to_string(sample.stamp_ns) +
            Format(",%.12f,%.12f,%.12f,%.15f,%.15f,%.15f,%.15f,%.9f,%.9f,%.9f,0,0,0,0,0,0\n", p.x(), p.y(), p.z(),
                   q.w(), q.x(), q.y(), q.z(), v.x(), v.y(), v.z());
  }
  return text;
}

Status WriteCameraTables(const Recording& recording, int session, const fs::path& folder) {
  const CameraRig& rig = recording.rig();
  for (int camera = 0; camera < (rig.is_stereo() ? 2 : 1); ++camera) {
    const fs::path of_camera = CameraFolder(folder, camera);
    if (Status made = MakeFolder(of_camera / "data"); !made) return made;
    const std::string yaml = camera == 0 ? SensorYaml(rig.left, rig.body_from_left, 0, recording.options().rate)
                                         : SensorYaml(*rig.right, rig.body_from_right, 1, recording.options().rate);
    if (Status written = WriteFile(of_camera / "sensor.yaml", yaml); !written) return written;
    if (Status written = WriteFile(of_camera / "data.csv", ImageList(recording, session)); !written) return written;
  }
  return {};
}

Status WriteTables(const Recording& recording, int session, const fs::path& folder) {
  if (Status written = WriteCameraTables(recording, session, folder); !written) return written;
  const fs::path truth = folder / "mav0" / "state_groundtruth_estimate0";
  if (Status made = MakeFolder(truth); !made) return made;
  return WriteFile(truth / "data.csv", TruthTable(recording, session));
}

Status WriteImage(const fs::path& path, const cv::Mat& image) {
  const std::vector<std::byte> png = EncodeGrayPng(image);
  return WriteFile(path, {reinterpret_cast<const char*>(png.data()), png.size()});
}

fs::path SessionFolder(const fs::path& folder, int session) { return folder / Format("session_%d", session + 1); }

Status WriteFrame(const Recording& recording, FramePainter& painter, int session, int frame, const fs::path& folder) {
  const StereoPicture picture = painter.Paint(session, frame);
  const std::string name = ImageName(recording.FrameStamp(session, frame));
  const fs::path of_session = SessionFolder(folder, session);
  if (Status left = WriteImage(CameraFolder(of_session, 0) / "data" / name, picture.left); !left) return left;
  if (picture.right.empty()) return {};
  return WriteImage(CameraFolder(of_session, 1) / "data" / name, picture.right);
}

// What the writing threads share. Any thread.
class WritingBoard {
 public:
  WritingBoard(int total, const WritingProgress& progress) : total_(total), progress_(progress) {}

  // The next frame of all sessions, or the total when there is none or one has failed.
  int Next() { return failed_ ? total_ : std::min(next_++, total_); }
  void Report(const Status& status) EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    if (!status && status_) status_ = status;
    if (!status) failed_ = true;
    ++done_;
    if (status && progress_) progress_(done_, total_);
  }
  Status status() const EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    return status_;
  }

 private:
  const int total_;
  const WritingProgress& progress_;
  std::atomic<int> next_ = 0;
  std::atomic<bool> failed_ = false;
  mutable Mutex mutex_;
  Status status_ GUARDED_BY(mutex_);
  int done_ GUARDED_BY(mutex_) = 0;
};

Status WriteFrames(const Recording& recording, const fs::path& folder, const WritingProgress& progress) {
  const int frames = recording.frame_count();
  const int total = frames * recording.options().sessions;
  WritingBoard board(total, progress);
  const auto work = [&] {
    FramePainter painter(recording);
    for (int i = board.Next(); i < total; i = board.Next()) {
      board.Report(WriteFrame(recording, painter, i / frames, i % frames, folder));
    }
  };
  {
    std::vector<std::jthread> threads;
    for (int i = 0; i < recording.options().jobs; ++i) threads.emplace_back(work);
  }
  return board.status();
}

}  // namespace

Status WriteRecording(const Recording& recording, const fs::path& folder, const WritingProgress& progress) {
  for (int session = 0; session < recording.options().sessions; ++session) {
    if (Status written = WriteTables(recording, session, SessionFolder(folder, session)); !written) return written;
  }
  return WriteFrames(recording, folder, progress);
}

}  // namespace pangaea
