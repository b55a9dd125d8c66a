#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <random>

#include "cli/vocabulary.h"
#include "common/base/text.h"
#include "tests/sensor/temporary_folder.h"

namespace pangaea {
namespace {

using ::testing::HasSubstr;

class VocabularyCommandTest : public ::testing::Test {
 protected:
  VocabularyCommandTest() {
    std::filesystem::create_directories(folder_.path() / "images/below");
    for (int i = 0; i < 6; ++i) WriteImage("images/below/" + std::to_string(i) + ".png", i);
    WriteImage("images/7.JPG", 7);
    EXPECT_TRUE(WriteTextFile(folder_.path() / "images/notes.txt", "no image"));
  }

  // Blocks of random grey: corners everywhere.
  void WriteImage(const std::string& name, int seed) {
    std::mt19937 random(static_cast<unsigned>(seed));
    cv::Mat image(240, 320, CV_8UC1);
    for (int y = 0; y < image.rows; y += 16) {
      for (int x = 0; x < image.cols; x += 16) image(cv::Rect(x, y, 16, 16)).setTo(static_cast<double>(random() % 256));
    }
    cv::imwrite(Path(name), image);
  }
  std::string Path(const std::string& name) const { return (folder_.path() / name).string(); }

  int Run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"pangaea", "vocabulary"});
    std::vector<const char*> argv;
    for (const std::string& argument : arguments) argv.push_back(argument.c_str());
    ::testing::internal::CaptureStdout();
    ::testing::internal::CaptureStderr();
    const int code = RunCommandLine({VocabularyCommand()}, static_cast<int>(argv.size()), argv.data());
    out_ = ::testing::internal::GetCapturedStdout();
    err_ = ::testing::internal::GetCapturedStderr();
    return code;
  }
  int Train(const std::string& images, const std::string& out) {
    return Run({"train", "--images", images, "--out", Path(out), "--depth", "2", "--features", "200"});
  }

  testing::TemporaryFolder folder_;
  std::string out_, err_;
};

TEST_F(VocabularyCommandTest, ImagesOfFoldersBelowAreFoundAndTheSameImagesGiveTheSameFile) {
  ASSERT_EQ(Train(Path("images"), "a.bin"), 0) << err_;
  EXPECT_THAT(out_, HasSubstr("7 images"));
  ASSERT_EQ(Train(Path("images"), "b.bin"), 0) << err_;
  EXPECT_EQ(ReadTextFile(Path("a.bin")).value(), ReadTextFile(Path("b.bin")).value());
  ASSERT_EQ(Run({"info", Path("a.bin")}), 0) << err_;
  EXPECT_THAT(out_, HasSubstr("fingerprint"));
}

TEST_F(VocabularyCommandTest, AStepTakesEveryNthImageOfEachFolder) {
  ASSERT_EQ(Train(Path("images") + ":4", "a.bin"), 0) << err_;
  EXPECT_THAT(out_, HasSubstr("3 images"));
  EXPECT_EQ(Train(Path("images") + ":0", "a.bin"), 2);
}

TEST_F(VocabularyCommandTest, WhatIsWrongIsSaidWithItsFile) {
  EXPECT_EQ(Train(Path("nowhere"), "a.bin"), 1);
  EXPECT_THAT(err_, HasSubstr("nowhere"));
  EXPECT_TRUE(WriteTextFile(Path("images/broken.png"), "not a picture"));
  EXPECT_EQ(Train(Path("images"), "a.bin"), 1);
  EXPECT_THAT(err_, HasSubstr("broken.png"));
  EXPECT_EQ(Run({"info", Path("images/notes.txt")}), 1);
  EXPECT_THAT(err_, HasSubstr("notes.txt"));
  EXPECT_EQ(Run({}), 2);
}

TEST_F(VocabularyCommandTest, AVocabularyOfDbow2IsConverted) {
  std::string text = "2 1 0 0\n";
  for (const char* byte : {" 0", " 255"}) {
    text += "0 1";
    for (int i = 0; i < 32; ++i) text += byte;
    text += " 1.25\n";
  }
  EXPECT_TRUE(WriteTextFile(Path("dbow2.txt"), text));
  ASSERT_EQ(Run({"import", "--dbow2", Path("dbow2.txt"), "--out", Path("c.bin")}), 0) << err_;
  ASSERT_EQ(Run({"info", Path("c.bin")}), 0) << err_;
  EXPECT_THAT(out_, HasSubstr("words        2"));
  EXPECT_EQ(Run({"import", "--dbow2", Path("images/notes.txt"), "--out", Path("c.bin")}), 1);
  EXPECT_THAT(err_, HasSubstr("line 1"));
}

}  // namespace
}  // namespace pangaea
