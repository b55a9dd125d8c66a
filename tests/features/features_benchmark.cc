// Feature extraction and matching on a synthetic textured image of 752 x 480, or on the image named by the environment
// variable PANGAEA_BENCHMARK_IMAGE.
#include <benchmark/benchmark.h>

#include <cstdlib>
#include <opencv2/features2d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "common/features/corner_detector.h"
#include "common/features/matching.h"
#include "common/features/orb_descriptor.h"
#include "common/features/orb_extractor.h"
#include "common/features/patch_pyramid.h"
#include "common/features/scale_pyramid.h"
#include "common/features/stereo_matcher.h"

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

// The right image is the left one moved by 20 pixels: every step of the matcher is taken.
void MatchStereo(benchmark::State& state) {
  const cv::Mat left = BenchmarkImage();
  const cv::Mat shift = (cv::Mat_<double>(2, 3) << 1.0, 0.0, -20.25, 0.0, 1.0, 0.0);
  cv::Mat right;
  cv::warpAffine(left, right, shift, left.size(), cv::INTER_LINEAR, cv::BORDER_REFLECT_101);
  IdealCamera camera;
  camera.width = left.cols, camera.height = left.rows;
  camera.focal_x = camera.focal_y = 450.0;
  camera.baseline = 0.11;
  std::vector<Keypoint> keypoints = OrbExtractor().Extract(left).keypoints;
  StereoMatcher matcher;
  StereoStatistics statistics;
  for (auto _ : state) statistics = matcher.Match(left, right, camera, keypoints);
  state.counters["keypoints"] = static_cast<double>(keypoints.size());
  state.counters["matched"] = statistics.matched;
}
BENCHMARK(MatchStereo)->Unit(benchmark::kMicrosecond);

std::vector<Descriptor> SomeDescriptors() { return OrbExtractor().Extract(BenchmarkImage()).descriptors; }

void MatchAllWithAll(benchmark::State& state) {
  const std::vector<Descriptor> descriptors = SomeDescriptors();
  for (auto _ : state) benchmark::DoNotOptimize(MatchBruteForce(descriptors, descriptors));
}
BENCHMARK(MatchAllWithAll)->Unit(benchmark::kMicrosecond);

void MatchAllWithAllByOpenCv(benchmark::State& state) {
  std::vector<Descriptor> descriptors = SomeDescriptors();
  const cv::Mat rows(static_cast<int>(descriptors.size()), 32, CV_8UC1, descriptors.data());
  const cv::BFMatcher matcher(cv::NORM_HAMMING);
  std::vector<std::vector<cv::DMatch>> matches;
  for (auto _ : state) matcher.knnMatch(rows, rows, matches, 2);
}
BENCHMARK(MatchAllWithAllByOpenCv)->Unit(benchmark::kMicrosecond);

void MatchInWindows(benchmark::State& state) {
  const Features features = OrbExtractor().Extract(BenchmarkImage());
  std::vector<ProjectionQuery> queries;
  for (std::size_t i = 0; i < features.keypoints.size(); ++i) {
    const Keypoint& keypoint = features.keypoints[i];
    queries.push_back({.u = keypoint.u, .v = keypoint.v, .radius = 15.0F, .descriptor = features.descriptors[i]});
  }
  for (auto _ : state) {
    const FeatureGrid grid(features.keypoints);
    benchmark::DoNotOptimize(MatchByProjection(queries, grid, features.descriptors));
  }
}
BENCHMARK(MatchInWindows)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace pangaea
