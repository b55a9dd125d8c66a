// Feature extraction and matching on a synthetic textured image of 752 x 480, or on the image named by the environment
// variable PANGAEA_BENCHMARK_IMAGE.
#include <benchmark/benchmark.h>

#include <cstdlib>
#include <opencv2/features2d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "common/features/corner_detector.h"
#include "common/features/orb_descriptor.h"
#include "common/features/orb_extractor.h"
#include "common/features/patch_pyramid.h"
#include "common/features/scale_pyramid.h"

namespace pangaea {
namespace {

cv::Mat BenchmarkImage() {
  cv::setNumThreads(1);
  if (const char* path = std::getenv("PANGAEA_BENCHMARK_IMAGE")) return cv::imread(path, cv::IMREAD_GRAYSCALE);
  cv::Mat small(160, 250, CV_8UC1), image;
  cv::RNG rng(1);
  rng.fill(small, cv::RNG::UNIFORM, 0, 256);
  cv::resize(small, image, {752, 480}, 0.0, 0.0, cv::INTER_CUBIC);
  return image;
}

void BuildPatchPyramid(benchmark::State& state) {
  const cv::Mat image = BenchmarkImage();
  ImagePyramid pyramid;
  for (auto _ : state) BuildImagePyramid(image, kMaxPyramidLevels, pyramid);
}
BENCHMARK(BuildPatchPyramid)->Unit(benchmark::kMicrosecond);

void BuildScalePyramid(benchmark::State& state) {
  const cv::Mat image = BenchmarkImage();
  ScalePyramid pyramid;
  for (auto _ : state) pyramid.Build(image);
}
BENCHMARK(BuildScalePyramid)->Unit(benchmark::kMicrosecond);

void DetectCornersOfAllOctaves(benchmark::State& state) {
  ScalePyramid pyramid;
  pyramid.Build(BenchmarkImage());
  CornerDetector detector;
  std::vector<Corner> corners;
  for (auto _ : state) {
    for (int o = 0; o < kOctaves; ++o) detector.Detect(pyramid.octave(o), 7, 16, corners);
  }
}
BENCHMARK(DetectCornersOfAllOctaves)->Unit(benchmark::kMicrosecond);

void DetectCornersOfAllOctavesByOpenCv(benchmark::State& state) {
  ScalePyramid pyramid;
  pyramid.Build(BenchmarkImage());
  std::vector<cv::KeyPoint> corners;
  for (auto _ : state) {
    for (int o = 0; o < kOctaves; ++o) cv::FAST(pyramid.octave(o), corners, 7, true);
  }
}
BENCHMARK(DetectCornersOfAllOctavesByOpenCv)->Unit(benchmark::kMicrosecond);

void SmoothAllOctaves(benchmark::State& state) {
  ScalePyramid pyramid;
  pyramid.Build(BenchmarkImage());
  for (auto _ : state) {
    for (int o = 0; o < kOctaves; ++o) {
      cv::Mat smoothed(pyramid.padded(o).size(), CV_8UC1);
      SmoothForBrief(pyramid.padded(o), smoothed);
    }
  }
}
BENCHMARK(SmoothAllOctaves)->Unit(benchmark::kMicrosecond);

void ExtractOrb(benchmark::State& state) {
  const cv::Mat image = BenchmarkImage();
  OrbExtractor extractor;
  std::size_t keypoints = 0;
  for (auto _ : state) keypoints = extractor.Extract(image).keypoints.size();
  state.counters["keypoints"] = static_cast<double>(keypoints);
}
BENCHMARK(ExtractOrb)->Unit(benchmark::kMicrosecond);

void ExtractOrbByOpenCv(benchmark::State& state) {
  const cv::Mat image = BenchmarkImage();
  const auto orb = cv::ORB::create(1000);
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;
  for (auto _ : state) orb->detectAndCompute(image, cv::noArray(), keypoints, descriptors);
  state.counters["keypoints"] = static_cast<double>(keypoints.size());
}
BENCHMARK(ExtractOrbByOpenCv)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace pangaea
