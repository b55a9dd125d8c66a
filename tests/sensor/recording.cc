#include "tests/sensor/recording.h"

#include <gtest/gtest.h>

#include <cstdio>

#include "common/base/text.h"
#include "common/sensor/png_encoder.h"

namespace pangaea::testing {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSensorYaml = R"(# General sensor definitions.
sensor_type: camera
comment: a camera of a test

T_BS:
  cols: 4
  rows: 4
  data: [1.0, 0.0, 0.0, OFFSET,
         0.0, 1.0, 0.0, 0.0,
         0.0, 0.0, 1.0, 0.0,
         0.0, 0.0, 0.0, 1.0]

rate_hz: 20
resolution: [64, 48]
camera_model: pinhole
intrinsics: [60.0, 60.5, 31.0, 24.0] #fu, fv, cu, cv
distortion_model: radial-tangential
distortion_coefficients: [-0.2, 0.05, 0.0001, 0.0002]
)";

void WriteCamera(const fs::path& folder, const std::string& offset) {
  fs::create_directories(folder / "data");
  WriteText(folder / "sensor.yaml", kSensorYaml);
  Replace(folder / "sensor.yaml", "OFFSET", offset);
  std::string list = "#timestamp [ns],filename\n";
  for (int i = 0; i < kRecordedFrames; ++i) {
    const std::string stamp = std::to_string(RecordedStamp(i));
    list += stamp + "," + stamp + ".png\n";
    WriteImage(folder / "data" / (stamp + ".png"), kRecordedWidth, kRecordedHeight);
  }
  WriteText(folder / "data.csv", list);
}

}  // namespace

std::int64_t RecordedStamp(int frame) { return 1403715273262142976 + 50'000'000LL * frame; }

void WriteText(const fs::path& path, const std::string& text) { EXPECT_TRUE(WriteTextFile(path, text)); }

void WriteImage(const fs::path& path, const cv::Mat& gray) {
  const std::vector<std::byte> png = EncodeGrayPng(gray);
  WriteText(path, {reinterpret_cast<const char*>(png.data()), png.size()});
}

void WriteImage(const fs::path& path, int width, int height) {
  cv::Mat image(height, width, CV_8UC1);
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) image.at<std::uint8_t>(v, u) = static_cast<std::uint8_t>(50 + 3 * u + u * v);
  }
  WriteImage(path, image);
}

void Replace(const fs::path& path, const std::string& from, const std::string& to) {
  std::string text = ReadTextFile(path).value_or("");
  const std::size_t at = text.find(from);
  ASSERT_NE(at, std::string::npos) << from;
  WriteText(path, text.substr(0, at) + to + text.substr(at + from.size()));
}

void WriteEurocRecording(const fs::path& folder) {
  WriteCamera(folder / "mav0" / "cam0", "0.0");
  WriteCamera(folder / "mav0" / "cam1", "0.11");
  const fs::path truth = folder / "mav0" / "state_groundtruth_estimate0";
  fs::create_directories(truth);
  std::string rows =
      "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []\n";
  for (int i = 0; i < kRecordedFrames; ++i) {
    rows += std::to_string(RecordedStamp(i)) + "," + std::to_string(0.1 * i) + ",2,3,0.5,0.5,0.5,0.5,9,9,9\n";
  }
  WriteText(truth / "data.csv", rows);
}

void WriteKittiRecording(const fs::path& folder) {
  std::string times;
  std::string poses;
  for (int i = 0; i < kRecordedFrames; ++i) {
    char name[32];
    std::snprintf(name, sizeof(name), "%06d.png", i);
    for (const char* camera : {"image_0", "image_1"}) {
      fs::create_directories(folder / camera);
      WriteImage(folder / camera / name, kRecordedWidth, kRecordedHeight);
    }
    char number[32];
    std::snprintf(number, sizeof(number), "%e", 0.1 * i);
    times += std::string(number) + "\n";
    poses += "1 0 0 0 0 1 0 0 0 0 1 " + std::string(number) + "\n";
  }
  WriteText(folder / "times.txt", times);
  WriteText(folder / "poses.txt", poses);
  WriteText(folder / "calib.txt", "P0: 60 0 31 0 0 60 24 0 0 0 1 0\nP1: 60 0 31 -30 0 60 24 0 0 0 1 0\n");
}

}  // namespace pangaea::testing
