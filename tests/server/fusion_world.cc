#include "tests/server/fusion_world.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

namespace pangaea::testing {

Similarity3d RandomFrame(std::uint64_t seed, double scale) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Vector6d twist;
  for (double& value : twist) value = uniform(random);
  const Rigid3d rigid = Rigid3d::Exp(twist);
  return Similarity3d(scale, rigid.rotation(), 3.0 * rigid.translation());
}

SurveyedWorld TwoMaps(std::uint64_t seed, const SurveyOptions& newer, const SurveyOptions& older) {
  SurveyedWorld world(seed);
  SurveyOptions first = older;
  first.map_from_world = RandomFrame(seed, older.map_from_world.scale());
  world.Fly(kOlder, CirclePoses(0, 11, 40), first);
  SurveyOptions second = newer;
  second.stamp_ns += 1'000'000'000'000;
  second.map_from_world = RandomFrame(seed + 100, newer.map_from_world.scale());
  world.Fly(kNewer, CirclePoses(6, 17, 40), second);
  return world;
}

PlaceMatch MiddleMatch(const SurveyedWorld& world) {
  return world.TrueMatch(world.KeyframesOf(kNewer)[2], world.KeyframesOf(kOlder)[8]);
}

WeldedFlights::WeldedFlights(std::uint64_t seed, const std::vector<Rigid3d>& way, std::size_t at,
                             const FusionOptions& options)
    : world(seed) {
  world.Fly(kOlder, way, {});
  SurveyOptions second;
  second.stamp_ns = 1'000'000'000'000;
  second.map_from_world = RandomFrame(seed);
  world.Fly(kNewer, way, second);
  const PlaceMatch match = world.TrueMatch(world.KeyframesOf(kNewer)[at], world.KeyframesOf(kOlder)[at]);
  const WeldingOutcome plan = PlanWelding(world.atlas, match, options, {});
  EXPECT_TRUE(plan.has_value());
  merged = world.atlas;
  if (plan) Carry(*plan, merged);
}

std::vector<KeyframeId> AllKeyframes(const SurveyedWorld& world) {
  std::vector<KeyframeId> all = world.KeyframesOf(kOlder);
  const std::vector<KeyframeId>& newer = world.KeyframesOf(kNewer);
  all.insert(all.end(), newer.begin(), newer.end());
  return all;
}

void Carry(const WeldingPlan& plan, Atlas& atlas) {
  ApplyTolerantly(plan.edits, atlas);
  for (const MapEdit& edit : Rebase(plan.correction, atlas)) {
    const Status status = Apply(edit, atlas);
    EXPECT_TRUE(status.has_value()) << KindName(edit) << ": " << (status ? "" : status.error().message);
  }
}

double WorstError(const SurveyedWorld& world, const Atlas& atlas, const std::vector<KeyframeId>& keyframes,
                  double scale) {
  const KeyframeId first = keyframes.front();
  const Rigid3d map_from_first = atlas.FindKeyframe(first)->camera_from_map.Inverse();
  double worst = 0.0;
  for (const KeyframeId id : keyframes) {
    const Rigid3d first_from_camera = world.TrueCameraFromWorld(first) * world.TrueCameraFromWorld(id).Inverse();
    const Eigen::Vector3d truth = map_from_first * (scale * first_from_camera.translation());
    worst = std::max(worst, (atlas.FindKeyframe(id)->camera_from_map.Inverse().translation() - truth).norm());
  }
  return worst;
}

std::size_t CountDuplicates(const SurveyedWorld& world, const Atlas& atlas) {
  std::map<int, int> landmarks;
  atlas.ForEachLandmark([&](const Landmark& landmark) { ++landmarks[world.CornerOf(landmark.observations.front())]; });
  std::size_t duplicates = 0;
  for (const auto& [corner, count] : landmarks) duplicates += count > 1 ? 1 : 0;
  return duplicates;
}

std::size_t CountMixed(const SurveyedWorld& world, const Atlas& atlas) {
  std::size_t mixed = 0;
  atlas.ForEachLandmark([&](const Landmark& landmark) {
    const int corner = world.CornerOf(landmark.observations.front());
    const bool pure = std::all_of(landmark.observations.begin(), landmark.observations.end(),
                                  [&](const Observation& o) { return world.CornerOf(o) == corner; });
    mixed += pure ? 0 : 1;
  });
  return mixed;
}

}  // namespace pangaea::testing
