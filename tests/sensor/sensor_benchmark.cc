#include <benchmark/benchmark.h>

#include <cstdlib>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "common/sensor/dataset.h"
#include "common/sensor/frame_reader.h"
#include "common/sensor/image.h"
#include "tests/sensor/rigs.h"

namespace pangaea {
namespace {

// A recording of the user's own: PANGAEA_BENCHMARK_DATASET=folder.
Dataset OpenRecording(benchmark::State& state) {
  const char* folder = std::getenv("PANGAEA_BENCHMARK_DATASET");
  auto dataset = OpenDataset(folder != nullptr ? folder : "", SensorKind::kStereo);
  if (!dataset) state.SkipWithError("set PANGAEA_BENCHMARK_DATASET to a stereo dataset");
  return dataset ? std::move(*dataset) : Dataset{};
}

void DecodeImage(benchmark::State& state) {
  const Dataset dataset = OpenRecording(state);
  std::size_t i = 0;
  for (auto _ : state) {
    const auto image = ReadGrayImage(dataset.frames[i].left, {dataset.rig.left.width, dataset.rig.left.height});
    benchmark::DoNotOptimize(image->data);
    i = (i + 1) % std::min<std::size_t>(dataset.frames.size(), 200);
  }
}
BENCHMARK(DecodeImage)->Unit(benchmark::kMillisecond);

void DecodeImageWithOpenCv(benchmark::State& state) {
  const Dataset dataset = OpenRecording(state);
  std::size_t i = 0;
  for (auto _ : state) {
    const cv::Mat image = cv::imread(dataset.frames[i].left, cv::IMREAD_GRAYSCALE);
    benchmark::DoNotOptimize(image.data);
    i = (i + 1) % std::min<std::size_t>(dataset.frames.size(), 200);
  }
}
BENCHMARK(DecodeImageWithOpenCv)->Unit(benchmark::kMillisecond);

void DecodeAndRectify(benchmark::State& state) {
  cv::setNumThreads(1);
  const Dataset dataset = OpenRecording(state);
  const auto reader = FrameReader::Create(dataset.rig, SensorKind::kStereo);
  std::size_t i = 0;
  for (auto _ : state) {
    const auto image = reader->ReadLeft(dataset.frames[i]);
    benchmark::DoNotOptimize(image->data);
    i = (i + 1) % std::min<std::size_t>(dataset.frames.size(), 200);
  }
}
BENCHMARK(DecodeAndRectify)->Unit(benchmark::kMillisecond);

void Rectify(benchmark::State& state) {
  cv::setNumThreads(1);
  const auto rectifier = Rectifier::Create(testing::DroneRig(), SensorKind::kStereo);
  cv::Mat image(480, 752, CV_8UC1);
  cv::randu(image, 0, 255);
  for (auto _ : state) benchmark::DoNotOptimize(rectifier->RectifyLeft(image).data);
}
BENCHMARK(Rectify)->Unit(benchmark::kMillisecond);

void CreateRectifier(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(Rectifier::Create(testing::DroneRig(), SensorKind::kStereo));
}
BENCHMARK(CreateRectifier)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace pangaea
