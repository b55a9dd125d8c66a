#include "common/simulation/hall.h"

#include <atomic>
#include <functional>
#include <thread>
#include <vector>

#include "common/simulation/floor_plan.h"
#include "common/simulation/lighting.h"
#include "common/simulation/random.h"

namespace pangaea {
namespace {

constexpr double kLightSpacing = 0.25;  // metres between samples of the light
// Parts of the seed.
constexpr std::uint64_t kFurniture = 1;
constexpr std::uint64_t kPictures = 2;
constexpr std::uint64_t kOccluders = 3;
LightGrid Glow() { return {2, 2, {1.0F, 1.0F, 1.0F, 1.0F}}; }

std::uint64_t PictureSeed(const HallOptions& options, const PlannedSurface& surface, std::size_t index) {
  const std::uint64_t pictures = MixSeed(options.seed, kPictures);
  return MixSeed(pictures, options.repetitive ? static_cast<std::uint64_t>(surface.material) : 1000 + index);
}

Surface Paint(const PlannedSurface& planned, std::uint64_t seed, const LightGrid& light, double coarseness) {
  Surface surface = planned.surface;
  surface.texture = PaintMaterial(planned.material, seed, surface.along.norm(), surface.across.norm(),
                                  coarseness * planned.texel, light);
  return surface;
}

void ForEachIndex(std::size_t count, int jobs, const std::function<void(std::size_t)>& work) {
  std::atomic<std::size_t> next = 0;
  const auto loop = [&] {
    for (std::size_t i = next++; i < count; i = next++) work(i);
  };
  std::vector<std::jthread> threads;
  for (int i = 1; i < jobs; ++i) threads.emplace_back(loop);
  loop();
}

Occluder MakeOccluder(std::uint64_t seed) {
  Random random(seed);
  Occluder occluder;
  for (const PlannedSurface& planned : PlanOccluder(random.Next()).surfaces) {
    occluder.surfaces.push_back(Paint(planned, random.Next(), Glow(), 1.0));
  }
  occluder.phase = random.Unit();
  occluder.radius_x = random.Uniform(4.5, 8.0);
  occluder.radius_y = random.Uniform(2.8, 5.4);
  const double period = random.Uniform(25.0, 40.0);
  occluder.period = random.Chance(0.5) ? period : -period;
  return occluder;
}

}  // namespace

Scene BuildHall(const HallOptions& options) {
  FloorPlan plan = PlanHall(MixSeed(options.seed, kFurniture));
  const Lighting lighting(plan.scene, plan.lamps);
  Scene scene = std::move(plan.scene);
  scene.surfaces.resize(plan.surfaces.size());
  ForEachIndex(plan.surfaces.size(), options.jobs, [&](std::size_t i) {
    const PlannedSurface& planned = plan.surfaces[i];
    const LightGrid light =
        planned.glowing ? Glow() : lighting.Light(planned.surface, kLightSpacing * options.coarseness);
    scene.surfaces[i] = Paint(planned, PictureSeed(options, planned, i), light, options.coarseness);
  });
  for (int i = 0; i < options.occluders; ++i) {
    scene.occluders.push_back(MakeOccluder(MixSeed(MixSeed(options.seed, kOccluders), static_cast<std::uint64_t>(i))));
  }
  return scene;
}

}  // namespace pangaea
