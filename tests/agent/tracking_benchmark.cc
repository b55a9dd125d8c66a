// A frame of the agent beside a frame of the usual front end, on the same rectified images of one run. They come from
// the built-in simulator, or are the first ones of the dataset that PANGAEA_BENCHMARK_DATASET names.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdlib>
#include <opencv2/features2d.hpp>

#include "agent/mapping/local_mapper.h"
#include "agent/tracking/template_harvest.h"
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

// The agent on one thread without what local mapping makes of keyframes; that runs between the frames.
class FlyingAgent {
 public:
  explicit FlyingAgent(bool stereo) : camera_(CameraFor(stereo)), options_(TrackingOptions().ForCamera(camera_)) {}

  // Everything that tracking does, and what a keyframe shows.
  void Take(const BenchmarkFrame& frame) {
    const RightImage right =
        camera_.is_stereo() ? RightImage([&](StageRecorder&) { return frame.right; }) : RightImage();
    result_ = tracker_.Track(frame.stamp_ns, frame.left, right, snapshot_, stages_);
    tracked_ += result_.tracked ? 1 : 0;
    candidate_ = result_.keyframe ? builder_.Build(*result_.keyframe, stages_) : std::move(result_.root);
  }
  void Map() {
    if (result_.opening) mapper_.Open(*result_.opening, stages_);
    if (candidate_) mapper_.Insert(*candidate_, stages_);
    if (result_.opening || candidate_) snapshot_ = std::make_shared<const Atlas>(mapper_.atlas());
  }

  const Atlas& atlas() const { return *snapshot_; }
  int tracked() const { return tracked_; }

 private:
  const IdealCamera camera_;
  const TrackingOptions options_;
  NoStageRecorder stages_;
  Tracker tracker_{1, camera_, options_, OpenVocabulary().value(), 1};
  KeyframeBuilder builder_{camera_, options_.orb, options_.stereo};
  LocalMapper mapper_{1, {}};
  std::shared_ptr<const Atlas> snapshot_ = std::make_shared<const Atlas>();
  TrackingResult result_;
  std::optional<KeyframeCandidate> candidate_;
  int tracked_ = 0;
};

// The whole of tracking, keyframes and the map's beginning included; local mapping is not timed.
void TrackFrame(benchmark::State& state) {
  int tracked = 0;
  std::size_t keyframes = 0;
  for (auto _ : state) {
    state.PauseTiming();
    FlyingAgent agent(state.range(0) != 0);
    for (const BenchmarkFrame& frame : Flight().frames) {
      state.ResumeTiming();
      agent.Take(frame);
      state.PauseTiming();
      agent.Map();
    }
    tracked += agent.tracked();
    keyframes += agent.atlas().keyframe_count();
    state.ResumeTiming();
  }
  const auto runs = static_cast<double>(state.iterations());
  state.counters["a_frame"] = benchmark::Counter(runs * static_cast<double>(Flight().frames.size()),
                                                 benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  state.counters["tracked"] = tracked / runs;
  state.counters["keyframes"] = static_cast<double>(keyframes) / runs;
}
BENCHMARK(TrackFrame)->ArgName("stereo")->Arg(1)->Arg(0)->Unit(benchmark::kMillisecond)->Iterations(2);

// What a frame costs on top when a snapshot of the map has come: the templates of the newest keyframe's landmarks and
// the landmarks around it.
void AdoptKeyframe(benchmark::State& state) {
  const bool stereo = state.range(0) != 0;
  FlyingAgent agent(stereo);
  TemplateStore templates(TrackingOptions().max_templates);
  KeyframeId newest;
  for (const BenchmarkFrame& frame : Flight().frames) {
    agent.Take(frame);
    agent.Map();
  }
  ImagePyramid image;
  TemplateStore before(TrackingOptions().max_templates);
  agent.atlas().ForEachKeyframe([&](const Keyframe& keyframe) {
    const auto is_its = [&](const BenchmarkFrame& frame) { return frame.stamp_ns == keyframe.data->stamp_ns; };
    const auto frame = std::find_if(Flight().frames.begin(), Flight().frames.end(), is_its);
    BuildImagePyramid(frame->left, TrackingOptions().pyramid_levels, image);
    before = templates;
    HarvestTemplates(agent.atlas(), keyframe.id, image, TrackingOptions().new_view_angle, templates);
    newest = keyframe.id;
  });
  LocalMap local_map;
  for (auto _ : state) {
    state.PauseTiming();
    templates = before;
    state.ResumeTiming();
    HarvestTemplates(agent.atlas(), newest, image, TrackingOptions().new_view_angle, templates);
    local_map = CollectLocalMap(agent.atlas(), newest, templates, local_map, {});
  }
  state.counters["landmarks"] = static_cast<double>(local_map.landmarks.size());
}
BENCHMARK(AdoptKeyframe)->ArgName("stereo")->Arg(1)->Arg(0)->Unit(benchmark::kMillisecond);

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
