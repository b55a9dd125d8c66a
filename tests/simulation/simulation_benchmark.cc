#include <benchmark/benchmark.h>

#include <opencv2/imgcodecs.hpp>

#include "common/simulation/recording.h"

namespace pangaea {
namespace {

const Recording& OneSession() {
  static const Recording recording([] {
    RecordingOptions options;
    options.sessions = 1;
    return options;
  }());
  return recording;
}

void PaintStereoPair(benchmark::State& state) {
  FramePainter painter(OneSession());
  int frame = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(painter.Paint(0, frame));
    frame = (frame + 37) % OneSession().frame_count();
  }
  state.counters["pairs/s"] = benchmark::Counter(static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}
BENCHMARK(PaintStereoPair)->Unit(benchmark::kMillisecond);

void EncodePng(benchmark::State& state) {
  const cv::Mat image = FramePainter(OneSession()).Paint(0, 0).left;
  std::vector<unsigned char> bytes;
  for (auto _ : state) {
    cv::imencode(".png", image, bytes, {cv::IMWRITE_PNG_STRATEGY, cv::IMWRITE_PNG_STRATEGY_HUFFMAN_ONLY});
    benchmark::DoNotOptimize(bytes);
  }
  state.counters["bytes"] = static_cast<double>(bytes.size());
}
BENCHMARK(EncodePng)->Unit(benchmark::kMillisecond);

void BuildWholeHall(benchmark::State& state) {
  HallOptions options;
  for (auto _ : state) {
    benchmark::DoNotOptimize(BuildHall(options).surfaces.size());
    ++options.seed;
  }
}
BENCHMARK(BuildWholeHall)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace pangaea
