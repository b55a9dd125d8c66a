// Chooses the 256 tests of common/features/brief_pattern.cc from photographs:
//   train_brief_pattern [LARGEST_CORRELATION] IMAGE... > brief_pattern.cc
// Every photograph is paired with a turned, scaled and noisy copy. Of 30,000 random tests those are preferred that
// differ between unrelated patches but agree between the two views of a corner; greedily, the best first, a test is
// taken if it correlates with none taken before by more than LARGEST_CORRELATION (the greedy search of Rublee et al.
// 2011, section 4.3, with another order).
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <random>
#include <string>
#include <vector>

#include "common/features/brief_pattern.h"
#include "common/features/orb_descriptor.h"
#include "common/features/orb_extractor.h"
#include "common/features/scale_pyramid.h"

namespace pangaea {
namespace {

constexpr int kCandidates = 30000;
constexpr double kSpread = 6.5;  // standard deviation of the tests' pixels, as Calonder et al. 2010 draw them
constexpr int kSide = 2 * kBriefRadius + 1;

using Patch = std::array<std::uint8_t, kSide * kSide>;  // smoothed, turned upright
using Bits = std::vector<std::uint64_t>;                // of one test, patch by patch

struct PatchPairs {
  std::vector<Patch> first, second;  // two views of the same corners
};

struct Candidate {
  BriefTest test;
  double merit = 0.0;
};

// Smoothed octaves of an image, and upright patches from them.
class PatchSource {
 public:
  explicit PatchSource(const cv::Mat& image) {
    pyramid_.Build(image);
    for (int o = 0; o < kOctaves; ++o) {
      cv::Mat buffer(pyramid_.padded(o).rows, pyramid_.stride(), CV_8UC1);
      cv::Mat smoothed = buffer(cv::Rect({0, 0}, pyramid_.padded(o).size()));
      SmoothForBrief(pyramid_.padded(o), smoothed);
      smoothed_.push_back(
          smoothed(cv::Rect({ScalePyramid::kMargin, ScalePyramid::kMargin}, pyramid_.octave(o).size())));
    }
  }

  bool Take(cv::Point2f pixel, int octave, Patch& patch) const {
    const cv::Mat& image = smoothed_[static_cast<std::size_t>(octave)];
    const cv::Point2f at = pyramid_.ToOctave(pixel, octave);
    const int x = static_cast<int>(std::lround(at.x)), y = static_cast<int>(std::lround(at.y));
    if (x < kSide || y < kSide || x >= image.cols - kSide || y >= image.rows - kSide) return false;
    const std::uint8_t* center = image.ptr<std::uint8_t>(y) + x;
    const double angle = PatchAngle(center, pyramid_.stride()) * 2.0 * std::numbers::pi / 256.0;
    for (int i = 0; i < kSide * kSide; ++i) {
      const int u = i % kSide - kBriefRadius, v = i / kSide - kBriefRadius;
      const long du = std::lround(std::cos(angle) * u - std::sin(angle) * v);
      const long dv = std::lround(std::sin(angle) * u + std::cos(angle) * v);
      const bool inside = u * u + v * v <= kBriefRadius * kBriefRadius;
      patch[static_cast<std::size_t>(i)] = inside ? center[dv * pyramid_.stride() + du] : 0;
    }
    return true;
  }

 private:
  ScalePyramid pyramid_;
  std::vector<cv::Mat> smoothed_;
};

void AddPairs(const cv::Mat& image, std::mt19937_64& random, PatchPairs& pairs) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const int octave_shift = static_cast<int>(random() % 5) - 2;
  const double scale = std::pow(kOctaveScale, octave_shift + 0.5 * unit(random));
  cv::Mat affine = cv::getRotationMatrix2D(
      {0.5F * static_cast<float>(image.cols), 0.5F * static_cast<float>(image.rows)}, 40.0 * unit(random), scale);
  affine.at<double>(0, 1) += 0.1 * unit(random);  // a little shear, as from a slanted view
  cv::Mat view, noise(image.size(), CV_16SC1);
  cv::warpAffine(image, view, affine, image.size(), cv::INTER_AREA, cv::BORDER_REFLECT_101);
  cv::RNG(random()).fill(noise, cv::RNG::NORMAL, 10.0 * unit(random), 3.0);
  cv::add(view, noise, view, cv::noArray(), CV_8UC1);
  const PatchSource first(image), second(view);
  for (const Keypoint& keypoint : OrbExtractor().Extract(image).keypoints) {
    const double u = keypoint.u, v = keypoint.v;
    const cv::Point2f moved(
        static_cast<float>(affine.at<double>(0, 0) * u + affine.at<double>(0, 1) * v + affine.at<double>(0, 2)),
        static_cast<float>(affine.at<double>(1, 0) * u + affine.at<double>(1, 1) * v + affine.at<double>(1, 2)));
    const int octave = keypoint.octave + octave_shift;
    Patch a, b;
    if (octave < 0 || octave >= kOctaves) continue;
    if (!first.Take({keypoint.u, keypoint.v}, keypoint.octave, a) || !second.Take(moved, octave, b)) continue;
    pairs.first.push_back(a);
    pairs.second.push_back(b);
  }
}

BriefTest DrawTest(std::mt19937_64& random) {
  std::normal_distribution<double> normal(0.0, kSpread);
  const auto draw = [&](std::int8_t& x, std::int8_t& y) {
    long u = 0, v = 0;
    do {
      u = std::lround(normal(random)), v = std::lround(normal(random));
    } while (u * u + v * v > kBriefRadius * kBriefRadius);
    x = static_cast<std::int8_t>(u), y = static_cast<std::int8_t>(v);
  };
  BriefTest test;
  do {
    draw(test.ax, test.ay), draw(test.bx, test.by);
  } while (test.ax == test.bx && test.ay == test.by);
  return test;
}

Bits Answers(const BriefTest& test, const std::vector<Patch>& patches) {
  const auto index = [](int x, int y) {
    return static_cast<std::size_t>((y + kBriefRadius) * kSide + x + kBriefRadius);
  };
  const std::size_t a = index(test.ax, test.ay), b = index(test.bx, test.by);
  Bits bits(patches.size() / 64);
  for (std::size_t i = 0; i < bits.size() * 64; ++i) {
    bits[i / 64] |= static_cast<std::uint64_t>(patches[i][a] < patches[i][b]) << (i % 64);
  }
  return bits;
}

double ShareOfOnes(const Bits& bits) {
  int ones = 0;
  for (const std::uint64_t word : bits) ones += std::popcount(word);
  return static_cast<double>(ones) / (64.0 * static_cast<double>(bits.size()));
}

double ShareOfDifferences(Bits a, const Bits& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] ^= b[i];
  return ShareOfOnes(a);
}

double Correlation(const Bits& a, const Bits& b) {
  const double p = ShareOfOnes(a), q = ShareOfOnes(b), different = ShareOfDifferences(a, b);
  const double both = 0.5 * (p + q - different);
  return (both - p * q) / std::sqrt(p * (1.0 - p) * q * (1.0 - q) + 1e-12);
}

std::vector<Candidate> RankCandidates(const PatchPairs& pairs, std::mt19937_64& random) {
  std::vector<Candidate> candidates(kCandidates);
  for (Candidate& candidate : candidates) {
    candidate.test = DrawTest(random);
    const Bits first = Answers(candidate.test, pairs.first), second = Answers(candidate.test, pairs.second);
    const double ones = ShareOfOnes(first);
    candidate.merit = 2.0 * ones * (1.0 - ones) - ShareOfDifferences(first, second);
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.merit > b.merit; });
  return candidates;
}

std::vector<BriefTest> Choose(const std::vector<Candidate>& candidates, const PatchPairs& pairs, double largest) {
  std::vector<BriefTest> chosen;
  std::vector<Bits> answers;
  for (const Candidate& candidate : candidates) {
    const Bits bits = Answers(candidate.test, pairs.first);
    const auto alike = [&](const Bits& other) { return std::abs(Correlation(bits, other)) > largest; };
    if (std::any_of(answers.begin(), answers.end(), alike)) continue;
    chosen.push_back(candidate.test);
    answers.push_back(bits);
    if (chosen.size() == kBriefTests.size()) break;
  }
  return chosen;
}

int Run(int argc, char** argv) {
  cv::setNumThreads(1);
  std::mt19937_64 random(1);
  PatchPairs pairs;
  const double largest = argc > 1 ? std::atof(argv[1]) : 0.0;
  for (int i = 2; i < argc; ++i) {
    const cv::Mat image = cv::imread(argv[i], cv::IMREAD_GRAYSCALE);
    if (!image.empty()) AddPairs(image, random, pairs);
  }
  const std::vector<BriefTest> tests = Choose(RankCandidates(pairs, random), pairs, largest);
  std::fprintf(stderr, "%zu pairs of patches, %zu tests\n", pairs.first.size(), tests.size());
  if (tests.size() != kBriefTests.size()) return 1;
  std::printf("#include \"common/features/brief_pattern.h\"\n\nnamespace pangaea {\n\n");
  std::printf("// Chosen by tests/features/train_brief_pattern.cc with a largest correlation of %.2f.\n", largest);
  std::printf("const std::array<BriefTest, 256> kBriefTests = {{\n");
  for (const BriefTest& t : tests) std::printf("    {%d, %d, %d, %d},\n", t.ax, t.ay, t.bx, t.by);
  std::printf("}};\n\n}  // namespace pangaea\n");
  return 0;
}

}  // namespace
}  // namespace pangaea

int main(int argc, char** argv) { return pangaea::Run(argc, argv); }
