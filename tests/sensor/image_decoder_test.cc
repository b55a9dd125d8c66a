#include "common/sensor/image_decoder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <opencv2/imgcodecs.hpp>
#include <thread>
#include <vector>

#include "common/sensor/image.h"
#include "tests/sensor/recording.h"
#include "tests/sensor/temporary_folder.h"

namespace pangaea {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class ImageDecoderModule : public ::testing::Test {
 protected:
  ImageDecoderModule() {
    EXPECT_TRUE(cv::imwrite(jpeg_.string(), cv::Mat(48, 64, CV_8UC1, cv::Scalar(77))));
    EXPECT_TRUE(cv::imwrite(deep_.string(), cv::Mat(48, 64, CV_16UC1, cv::Scalar(77 * 257))));
    testing::WriteImage(png_, 64, 48);
  }

  testing::TemporaryFolder folder_;
  fs::path jpeg_ = folder_.path() / "a.jpg";
  fs::path deep_ = folder_.path() / "deep.png";
  fs::path png_ = folder_.path() / "a.png";
};

// What a program says about files.
std::string OutputOf(const fs::path& program, const std::vector<fs::path>& files) {
  std::string command = program.string();
  for (const fs::path& file : files) command.append(" ").append(file.string());
  std::string output;
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return "not started";
  std::array<char, 4096> part{};
  while (const std::size_t count = std::fread(part.data(), 1, part.size(), pipe)) output.append(part.data(), count);
  pclose(pipe);
  return output;
}

TEST_F(ImageDecoderModule, ThreadsThatNeedItAtOnceAllGetTheirImage) {
  constexpr int kThreads = 4;
  std::array<Result<cv::Mat>, kThreads> images;
  {
    std::vector<std::jthread> threads;
    for (auto& image : images) threads.emplace_back([&] { image = ReadGrayImage(deep_, {64, 48}); });
  }
  for (const auto& image : images) {
    ASSERT_TRUE(image) << image.error().message;
    EXPECT_NEAR(cv::mean(*image)[0], 77.0, 1.0);
  }
}

// As the decoder itself gives them: nothing is lost on the way through the module.
TEST_F(ImageDecoderModule, ItsPixelsAreThoseOfOpenCv) {
  cv::Mat colours(48, 64, CV_8UC3);
  for (int v = 0; v < colours.rows; ++v) {
    for (int u = 0; u < colours.cols; ++u) colours.at<cv::Vec3b>(v, u) = cv::Vec3b(4 * u, 5 * v, 3 * u + v);
  }
  const std::string path = (folder_.path() / "colours.png").string();
  ASSERT_TRUE(cv::imwrite(path, colours));
  const auto image = ReadGrayImage(path, {64, 48});
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(cv::norm(*image, cv::imread(path, cv::IMREAD_GRAYSCALE), cv::NORM_INF), 0.0);
}

TEST_F(ImageDecoderModule, AJpegWithoutHuffmanTablesAsVideosHaveThemIsLeftToIt) {
  std::vector<std::uint8_t> file;
  ASSERT_TRUE(cv::imencode(".jpg", cv::Mat(48, 64, CV_8UC1, cv::Scalar(77)), file));
  std::vector<std::byte> bare;
  for (std::size_t at = 0; at < file.size();) {
    const bool is_tables = file[at] == 0xFF && at + 3 < file.size() && file[at + 1] == 0xC4;
    if (is_tables) {
      at += 2U + static_cast<std::size_t>(file[at + 2] << 8 | file[at + 3]);
    } else {
      bare.push_back(std::byte{file[at++]});
    }
  }
  ASSERT_LT(bare.size(), file.size());
  const auto image = DecodeGrayImage(bare, {64, 48});
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_NEAR(cv::mean(*image)[0], 77.0, 1.0);
}

TEST_F(ImageDecoderModule, AProgramThatFindsNoneReadsWhatItCanAndSaysWhatTheRestNeeds) {
  const fs::path program = folder_.path() / "bin" / "describe_images";
  fs::create_directory(program.parent_path());
  fs::copy_file(PANGAEA_DESCRIBE_IMAGES, program);
  EXPECT_THAT(
      OutputOf(program, {png_, jpeg_, deep_, png_}),
      AllOf(StartsWith("read\nread\n" + deep_.string() + ": a PNG that is not of 8-bit grey pixels needs a module: "),
            HasSubstr((folder_.path() / "lib" / ImageDecoder::kFile).string()), EndsWith("\nread\n")));
  EXPECT_EQ(OutputOf(PANGAEA_DESCRIBE_IMAGES, {png_, jpeg_, deep_, png_}), "read\nread\nread\nread\n");
}

}  // namespace
}  // namespace pangaea
