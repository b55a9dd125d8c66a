#include <benchmark/benchmark.h>

#include "common/base/check.h"
#include "server/fusion/map_fusion.h"
#include "server/fusion/redundancy.h"
#include "tests/server/fusion_world.h"

namespace pangaea::testing {
namespace {

constexpr int kLap = 125;

// Two maps of so many keyframes each, of some 900 keypoints and 400 landmarks, that show the same room.
SurveyedWorld TwoLargeMaps(int keyframes) {
  SurveyedWorld world(1, 14000);
  SurveyOptions first;
  first.mapped = 0.45;
  world.Fly(kOlder, CirclePoses(0, keyframes - 1, kLap), first);
  SurveyOptions second = first;
  second.stamp_ns = 1'000'000'000'000'000;
  second.map_from_world = RandomFrame(7);
  world.Fly(kNewer, CirclePoses(0, keyframes - 1, kLap), second);
  return world;
}

PlaceMatch MatchInTheMiddle(const SurveyedWorld& world) {
  const std::size_t middle = world.KeyframesOf(kOlder).size() / 2;
  return world.TrueMatch(world.KeyframesOf(kNewer)[middle], world.KeyframesOf(kOlder)[middle]);
}

// From the verified match to edits and correction.
void PlanMerge(benchmark::State& state) {
  const SurveyedWorld world = TwoLargeMaps(static_cast<int>(state.range(0)));
  const PlaceMatch match = MatchInTheMiddle(world);
  for (auto _ : state) {
    const WeldingOutcome plan = PlanWelding(world.atlas, match, {}, {});
    PANGAEA_CHECK(plan.has_value());
    state.counters["window"] = static_cast<double>(plan->evidence.window_keyframes);
    state.counters["observations"] = static_cast<double>(plan->evidence.after.observations);
    state.counters["fused"] = static_cast<double>(plan->evidence.fused);
  }
}
BENCHMARK(PlanMerge)->Arg(25)->Arg(250)->Unit(benchmark::kMillisecond);

// What the owner of the atlas does with it.
void CarryMerge(benchmark::State& state) {
  const SurveyedWorld world = TwoLargeMaps(static_cast<int>(state.range(0)));
  const WeldingOutcome plan = PlanWelding(world.atlas, MatchInTheMiddle(world), {}, {});
  PANGAEA_CHECK(plan.has_value());
  for (auto _ : state) {
    Atlas atlas = world.atlas;
    ApplyTolerantly(plan->edits, atlas);
    for (const MapEdit& edit : Rebase(plan->correction, atlas)) PANGAEA_CHECK(Apply(edit, atlas).has_value());
  }
}
BENCHMARK(CarryMerge)->Arg(250)->Unit(benchmark::kMillisecond);

// For each keyframe of the merged map.
void FuseAllOfTheMap(benchmark::State& state) {
  const SurveyedWorld world = TwoLargeMaps(static_cast<int>(state.range(0)));
  Atlas atlas = world.atlas;
  const WeldingOutcome plan = PlanWelding(atlas, MatchInTheMiddle(world), {}, {});
  PANGAEA_CHECK(plan.has_value());
  Carry(*plan, atlas);
  for (auto _ : state) {
    const MapFusion fusion = FuseDuplicates(atlas, plan->map, {}, LookedAtMap(), {});
    state.counters["fused"] = static_cast<double>(fusion.fused);
  }
}
BENCHMARK(FuseAllOfTheMap)->Arg(250)->Unit(benchmark::kMillisecond);

// A merged map, and what the looks saw that rid it of duplicates.
struct SettledMap {
  explicit SettledMap(int keyframes) : world(TwoLargeMaps(keyframes)) {
    Weld(MatchInTheMiddle(world));
    for (int i = 0; i < 4; ++i) {
      const MapFusion fusion = FuseDuplicates(world.atlas, map, {}, seen, {});
      ApplyTolerantly(fusion.edits, world.atlas);
      for (const MapEdit& edit : Rebase(fusion.correction, world.atlas)) {
        PANGAEA_CHECK(Apply(edit, world.atlas).has_value());
      }
      seen = *fusion.looked_at;
    }
  }

  // A session that flew a tenth of the way again.
  void Grow(int keyframes) {
    SurveyOptions third;
    third.stamp_ns = 2'000'000'000'000'000;
    third.mapped = 0.45;
    third.map_from_world = RandomFrame(8);
    const int middle = keyframes / 2;
    world.Fly(kThird, CirclePoses(middle, middle + keyframes / 10, kLap), third);
    const auto meeting = static_cast<std::size_t>(middle + 5);
    Weld(world.TrueMatch(world.KeyframesOf(kThird)[5], world.KeyframesOf(kOlder)[meeting]));
  }

  void Weld(const PlaceMatch& match) {
    const WeldingOutcome plan = PlanWelding(world.atlas, match, {}, {});
    PANGAEA_CHECK(plan.has_value());
    Carry(*plan, world.atlas);
    map = plan->map;
  }

  static constexpr SessionId kThird = 0x33;
  SurveyedWorld world;
  MapId map;
  LookedAtMap seen;
};

enum class Since { kNever, kLastLook };

void Look(benchmark::State& state, bool grown, Since since) {
  SettledMap settled(static_cast<int>(state.range(0)));
  if (grown) settled.Grow(static_cast<int>(state.range(0)));
  const LookedAtMap before = since == Since::kLastLook ? settled.seen : LookedAtMap();
  for (auto _ : state) {
    const MapFusion fusion = FuseDuplicates(settled.world.atlas, settled.map, {}, before, {});
    state.counters["fused"] = static_cast<double>(fusion.fused);
    state.counters["looks"] = static_cast<double>(fusion.looks);
  }
}
BENCHMARK_CAPTURE(Look, grown_at_everything, true, Since::kNever)->Arg(125)->Arg(250)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Look, grown_at_what_changed, true, Since::kLastLook)
    ->Arg(125)
    ->Arg(250)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Look, same_at_everything, false, Since::kNever)->Arg(125)->Arg(250)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Look, same_at_what_changed, false, Since::kLastLook)
    ->Arg(125)
    ->Arg(250)
    ->Unit(benchmark::kMillisecond);

void CullRedundant(benchmark::State& state) {
  const SurveyedWorld world = TwoLargeMaps(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    state.counters["edits"] = static_cast<double>(PlanCulling(world.atlas, {}, {}, {}).size());
  }
}
BENCHMARK(CullRedundant)->Arg(250)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace pangaea::testing
