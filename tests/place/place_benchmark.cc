// What recognition costs at the scale of an atlas: perturbed copies of keyframes, of the recording with revisits where
// it is there, else of random ones.
#include <benchmark/benchmark.h>

#include <cstdlib>
#include <filesystem>

#include "common/place/inverted_index.h"
#include "tests/place/shipped_vocabulary.h"
#include "tests/place/surveyed_recording.h"
#include "tests/place/synthetic_places.h"

namespace pangaea {
namespace {

using namespace testing;

constexpr std::size_t kFeatures = 1000;

std::vector<std::vector<Descriptor>> Originals() {
  const char* shared = std::getenv("PANGAEA_SHARED");
  const std::filesystem::path folder =
      std::filesystem::path(shared != nullptr ? shared : PANGAEA_SOURCE_DIR "/../shared") /
      "data/euroc_V1_01_keyframes";
  std::vector<std::vector<Descriptor>> images;
  if (const auto keyframes = ReadSurveyedKeyframes(folder, kFeatures); keyframes) {
    for (const SurveyedKeyframe& keyframe : *keyframes) images.push_back(keyframe.features.descriptors);
    return images;
  }
  Random random(1);
  return SyntheticPlaces(100, kFeatures, random).corners;
}

// One atlas for all benchmarks of a size: a third of each copy's features are others', the rest have flipped bits.
struct Scene {
  VocabularyTree vocabulary = std::move(ReadShippedVocabulary().value());
  std::vector<std::vector<Descriptor>> originals = Originals();
  InvertedIndex index{vocabulary.words()};
  Random random{2};

  void Grow(std::size_t keyframes) {
    while (index.size() < keyframes) {
      const auto number = static_cast<std::uint32_t>(index.size() + 1);
      index.Add({1, number}, vocabulary.Bag(Copy(number % originals.size())));
    }
  }
  std::vector<Descriptor> Copy(std::size_t image) {
    std::vector<Descriptor> copy;
    for (const Descriptor& descriptor : originals[image]) {
      const auto& other = originals[random() % originals.size()];
      const bool replaced = random() % 3 == 0 && !other.empty();
      copy.push_back(SeenAgain(replaced ? other[random() % other.size()] : descriptor, 16, random));
    }
    return copy;
  }
};

Scene& SharedScene() {
  static Scene scene;
  return scene;
}

void BagOfThousandFeatures(benchmark::State& state) {
  Scene& scene = SharedScene();
  const auto image = scene.Copy(0);
  for (auto _ : state) benchmark::DoNotOptimize(scene.vocabulary.Describe(image, 2));
}

void Query(benchmark::State& state) {
  Scene& scene = SharedScene();
  scene.Grow(static_cast<std::size_t>(state.range(0)));
  std::vector<BagOfWords> queries;
  for (std::size_t i = 0; i < 20; ++i) queries.push_back(scene.vocabulary.Bag(scene.Copy(i * 5)));
  std::size_t next = 0, postings = 0;
  for (auto _ : state) {
    const auto found = scene.index.Query(queries[next++ % queries.size()]);
    postings += found.postings_read;
    benchmark::DoNotOptimize(found);
  }
  state.counters["postings"] = benchmark::Counter(static_cast<double>(postings), benchmark::Counter::kAvgIterations);
}

void AddAndRemove(benchmark::State& state) {
  Scene& scene = SharedScene();
  scene.Grow(static_cast<std::size_t>(state.range(0)));
  const BagOfWords bag = scene.vocabulary.Bag(scene.Copy(1));
  for (auto _ : state) {
    scene.index.Add({9, 1}, bag);
    scene.index.Remove({9, 1});
  }
}

BENCHMARK(BagOfThousandFeatures)->Unit(benchmark::kMillisecond);
// Ascending: the scene only grows.
BENCHMARK(Query)->Arg(200)->Arg(2000)->Arg(20000)->Unit(benchmark::kMillisecond);
BENCHMARK(AddAndRemove)->Arg(20000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace pangaea
