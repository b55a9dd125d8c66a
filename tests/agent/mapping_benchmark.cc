#include <benchmark/benchmark.h>

#include <chrono>
#include <map>
#include <string>

#include "agent/mapping/local_mapper.h"
#include "tests/agent/mapping_synthetic_world.h"

namespace pangaea {
namespace {

// Adds up the time of each stage.
class TimingRecorder final : public StageRecorder {
 public:
  void Begin(std::string_view name) override { starts_[std::string(name)] = Clock::now(); }
  void End(std::string_view name) override {
    const std::chrono::duration<double, std::milli> duration = Clock::now() - starts_[std::string(name)];
    totals_[std::string(name)] += duration.count();
  }
  const std::map<std::string, double>& milliseconds() const { return totals_; }

 private:
  using Clock = std::chrono::steady_clock;
  std::map<std::string, Clock::time_point> starts_;
  std::map<std::string, double> totals_;
};

// One keyframe of some thousand keypoints in a map of `keyframes` keyframes, on the second lap of a circle.
void InsertKeyframe(benchmark::State& state) {
  const int keyframes = static_cast<int>(state.range(0));
  testing::SyntheticWorldOptions world_options;
  world_options.points = 14000;
  world_options.tracked = 0.4;
  testing::SyntheticWorld world(world_options);
  LocalMapper mapper(1, {});
  NoStageRecorder silent;
  int k = 0;
  for (; k < keyframes; ++k) mapper.Insert(world.NextKeyframe(testing::CirclePose(k, 60), mapper.atlas()), silent);
  TimingRecorder recorder;
  std::size_t keypoints = 0;
  std::size_t tracked = 0;
  for (auto _ : state) {
    state.PauseTiming();
    const KeyframeCandidate candidate = world.NextKeyframe(testing::CirclePose(k++, 60), mapper.atlas());
    keypoints += candidate.landmarks.size();
    for (const LandmarkId id : candidate.landmarks) tracked += id.valid() ? 1 : 0;
    state.ResumeTiming();
    mapper.Insert(candidate, recorder);
  }
  const auto iterations = static_cast<double>(state.iterations());
  for (const auto& [name, milliseconds] : recorder.milliseconds()) state.counters[name] = milliseconds / iterations;
  state.counters["keypoints"] = static_cast<double>(keypoints) / iterations;
  state.counters["tracked"] = static_cast<double>(tracked) / iterations;
  state.counters["landmarks"] = static_cast<double>(mapper.atlas().landmark_count());
  state.counters["map_keyframes"] = static_cast<double>(mapper.atlas().keyframe_count());
}
BENCHMARK(InsertKeyframe)->Arg(20)->Arg(90)->Unit(benchmark::kMillisecond)->Iterations(20);

}  // namespace
}  // namespace pangaea
