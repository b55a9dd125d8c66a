// What recognition costs: of a keyframe whose place is known (one verification from the bag of words to the vote), and
// of one whose place is not. For the index at the scale of an atlas see bench_place; for both on recorded flights see
// place_replay --copies.
#include <benchmark/benchmark.h>

#include "common/place/vocabulary_file.h"
#include "server/place_recognition/place_recognizer.h"
#include "tests/server/surveyed_world.h"

namespace pangaea {
namespace {

using testing::CirclePoses;
using testing::SurveyedWorld;

constexpr SessionId kMapped = 1;
constexpr SessionId kAsking = 2;
constexpr int kCircle = 36;

// The asking session flies where the other was, or on the other side of the room.
struct Scene {
  explicit Scene(int first_pose) : recognizer(OpenVocabulary().value(), {}) {
    world.Fly(kMapped, CirclePoses(0, 12, kCircle), {});
    world.Fly(kAsking, CirclePoses(first_pose, first_pose + 6, kCircle), {});
    recognizer.Synchronize(world.atlas);
  }
  SurveyedWorld world{1};
  PlaceRecognizer recognizer;
};

void Recognize(benchmark::State& state, int first_pose, std::size_t expected_matches) {
  Scene scene(first_pose);
  NoStageRecorder stages;
  const KeyframeId query = scene.world.KeyframesOf(kAsking)[3];
  for (auto _ : state) {
    const PlaceRecognition recognition = scene.recognizer.Recognize(scene.world.atlas, query, stages);
    if (recognition.matches.size() != expected_matches) state.SkipWithError("another number of matches");
    benchmark::DoNotOptimize(recognition);
  }
}

void RecognizeAKnownPlace(benchmark::State& state) { Recognize(state, 3, 1); }
void RecognizeNothing(benchmark::State& state) { Recognize(state, 20, 0); }
BENCHMARK(RecognizeAKnownPlace)->Unit(benchmark::kMillisecond);
BENCHMARK(RecognizeNothing)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace pangaea
