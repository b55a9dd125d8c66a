// A frame of the agent beside a frame of the usual front end, on the same rectified images of one run. They come from
// the built-in simulator, or are the first ones of the dataset that PANGAEA_BENCHMARK_DATASET names.
#include <benchmark/benchmark.h>

#include <cstdlib>
#include <opencv2/features2d.hpp>

#include "agent/mapping/local_mapper.h"
#include "agent/tracking/tracker.h"
#include "common/base/check.h"
#include "common/place/vocabulary_file.h"
#include "common/sensor/dataset.h"
#include "common/sensor/frame_reader.h"
#include "common/simulation/recording.h"

namespace pangaea {
namespace {

constexpr int kFrames = 200;

struct BenchmarkFrame {
  std::int64_t stamp_ns = 0;
  cv::Mat left;
  cv::Mat right;
};

struct BenchmarkFlight {
  IdealCamera camera;
  std::vector<BenchmarkFrame> frames;
};

BenchmarkFlight ReadFlight(const char* folder) {
  const Dataset dataset = OpenDataset(folder, SensorKind::kStereo).value();
  const FrameReader reader = FrameReader::Create(dataset.rig, SensorKind::kStereo).value();
  BenchmarkFlight flight{reader.rectifier().camera(), {}};
  for (const DatasetFrame& frame : dataset.frames) {
    if (flight.frames.size() == kFrames) break;
    flight.frames.push_back({frame.stamp_ns, reader.ReadLeft(frame).value(), reader.ReadRight(frame).value()});
  }
  return flight;
}

BenchmarkFlight SimulateFlight() {
  RecordingOptions options;
  options.sessions = 1;
  options.seconds = kFrames / options.rate;
  const Recording recording(options);
  const Rectifier rectifier = Rectifier::Create(recording.rig(), SensorKind::kStereo).value();
  FramePainter painter(recording);
  BenchmarkFlight flight{rectifier.camera(), {}};
  for (int i = 0; i < kFrames; ++i) {
    const StereoPicture picture = painter.Paint(0, i);
    flight.frames.push_back(
        {recording.FrameStamp(0, i), rectifier.RectifyLeft(picture.left), rectifier.RectifyRight(picture.right)});
  }
  return flight;
}

const BenchmarkFlight& Flight() {
  static const BenchmarkFlight flight = [] {
    cv::setNumThreads(1);
    const char* folder = std::getenv("PANGAEA_BENCHMARK_DATASET");
    return folder != nullptr ? ReadFlight(folder) : SimulateFlight();
  }();
  return flight;
}

IdealCamera CameraFor(bool stereo) {
  IdealCamera camera = Flight().camera;
  if (!stereo) camera.baseline = 0.0;
  return camera;
}

// The whole of tracking, keyframes and the map's beginning included; local mapping runs between the frames, untimed.
void TrackFrame(benchmark::State& state) {
  const bool stereo = state.range(0) != 0;
  NoStageRecorder stages;
  int tracked = 0;
  std::size_t keyframes = 0;
  for (auto _ : state) {
    state.PauseTiming();
    Tracker tracker(1, CameraFor(stereo), {}, OpenVocabulary().value(), 1);
    LocalMapper mapper(1, {});
    auto snapshot = std::make_shared<const Atlas>();
    for (const BenchmarkFrame& frame : Flight().frames) {
      const RightImage right = stereo ? RightImage([&] { return frame.right; }) : RightImage();
      state.ResumeTiming();
      const TrackingResult result = tracker.Track(frame.stamp_ns, frame.left, right, snapshot, stages);
      state.PauseTiming();
      tracked += result.tracked ? 1 : 0;
      if (result.opening) mapper.Open(*result.opening, stages);
      if (result.keyframe) mapper.Insert(*result.keyframe, stages);
      if (result.opening || result.keyframe) snapshot = std::make_shared<const Atlas>(mapper.atlas());
    }
    keyframes += snapshot->keyframe_count();
    state.ResumeTiming();
  }
  const auto runs = static_cast<double>(state.iterations());
  state.counters["a_frame"] = benchmark::Counter(runs * static_cast<double>(Flight().frames.size()),
                                                 benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  state.counters["tracked"] = tracked / runs;
  state.counters["keyframes"] = static_cast<double>(keyframes) / runs;
}
BENCHMARK(TrackFrame)->ArgName("stereo")->Arg(1)->Arg(0)->Unit(benchmark::kMillisecond)->Iterations(2);

// What the usual front end does at each frame: cv::ORB on each image, as many features as the reference uses, and
// cv::BFMatcher to the other image and to the frame before. No pose comes of it yet.
void ExtractAndMatchByOpenCv(benchmark::State& state) {
  const bool stereo = state.range(0) != 0;
  const auto orb = cv::ORB::create(stereo ? 1200 : 1000);
  const cv::BFMatcher matcher(cv::NORM_HAMMING);
  std::vector<cv::KeyPoint> keypoints;
  std::vector<cv::DMatch> matches;
  Flight();
  for (auto _ : state) {
    cv::Mat before;
    for (const BenchmarkFrame& frame : Flight().frames) {
      cv::Mat left, right;
      orb->detectAndCompute(frame.left, cv::noArray(), keypoints, left);
      if (!before.empty() && !left.empty()) matcher.match(left, before, matches);
      before = left;
      if (!stereo) continue;
      orb->detectAndCompute(frame.right, cv::noArray(), keypoints, right);
      if (!left.empty() && !right.empty()) matcher.match(left, right, matches);
    }
  }
  state.counters["a_frame"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * static_cast<double>(Flight().frames.size()),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(ExtractAndMatchByOpenCv)->ArgName("stereo")->Arg(1)->Arg(0)->Unit(benchmark::kMillisecond)->Iterations(2);

}  // namespace
}  // namespace pangaea
