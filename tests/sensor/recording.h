#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>

namespace pangaea::testing {

// Small datasets on disk: eight stereo pairs of 64 x 48 grey PNGs and everything that belongs to them. Tests spoil one
// thing at a time.
inline constexpr int kRecordedFrames = 8;
inline constexpr int kRecordedWidth = 64;
inline constexpr int kRecordedHeight = 48;

// Stamp of a frame of the EuRoC recording: 20 Hz, nanoseconds.
std::int64_t RecordedStamp(int frame);
void WriteEurocRecording(const std::filesystem::path& folder);
// 10 Hz from zero.
void WriteKittiRecording(const std::filesystem::path& folder);
void WriteImage(const std::filesystem::path& path, const cv::Mat& gray);
// A grey PNG of any size.
void WriteImage(const std::filesystem::path& path, int width, int height);
void WriteText(const std::filesystem::path& path, const std::string& text);
// Replaces the first occurrence of `from`, which must be there.
void Replace(const std::filesystem::path& path, const std::string& from, const std::string& to);

}  // namespace pangaea::testing
