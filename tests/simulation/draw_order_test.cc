#include <gtest/gtest.h>

#include <array>
#include <utility>

#include "common/simulation/floor_plan.h"
#include "common/simulation/hall.h"
#include "common/simulation/material.h"

// One seed gives one hall, whatever the compiler: what is drawn for a seed is compared with figures that gcc and clang
// both gave. Draws that share an expression come in another order from another compiler. Sums and means are compared,
// because the last bits of numbers may differ. A change of the hall that is meant brings new figures, from both.
namespace pangaea {
namespace {

double MeanGrey(const Texture& texture) {
  double sum = 0.0;
  for (int y = 0; y < texture.height(); ++y) {
    for (int x = 0; x < texture.width(); ++x) sum += texture.Texel(x, y);
  }
  return sum / (texture.width() * texture.height());
}

TEST(DrawOrder, TheFurnitureStandsWhereEveryCompilerPutsIt) {
  const FloorPlan plan = PlanHall(1);
  EXPECT_EQ(plan.scene.solids.size(), 805U);
  EXPECT_EQ(plan.surfaces.size(), 4286U);
  Eigen::Vector3d centers = Eigen::Vector3d::Zero();
  Eigen::Vector3d half_sizes = Eigen::Vector3d::Zero();
  for (const Solid& solid : plan.scene.solids) {
    centers += solid.center;
    half_sizes += solid.half_size;
  }
  EXPECT_LT((centers - Eigen::Vector3d(-408.308433, -271.368421, 1105.124027)).norm(), 1e-5);
  EXPECT_LT((half_sizes - Eigen::Vector3d(175.177348, 131.852954, 201.866638)).norm(), 1e-5);
}

TEST(DrawOrder, OccludersGoRoundTheSameWay) {
  HallOptions options;
  options.coarseness = 20.0;  // sooner ready; changes no draw of an occluder
  options.occluders = 4;
  const std::array<double, 4> periods = {32.640529, -36.089178, -29.326189, 28.348246};
  const Scene hall = BuildHall(options);
  ASSERT_EQ(hall.occluders.size(), periods.size());
  for (std::size_t i = 0; i < periods.size(); ++i) EXPECT_NEAR(hall.occluders[i].period, periods[i], 1e-5);
}

TEST(DrawOrder, EveryMaterialIsPaintedAlike) {
  // Grey levels.
  constexpr std::array<std::pair<Material, double>, 13> kMeans = {{{Material::kPlaster, 146.63},
                                                                   {Material::kFloor, 110.12},
                                                                   {Material::kCeiling, 175.33},
                                                                   {Material::kConcrete, 130.75},
                                                                   {Material::kWood, 133.95},
                                                                   {Material::kCarton, 159.58},
                                                                   {Material::kMetal, 142.11},
                                                                   {Material::kFabric, 110.30},
                                                                   {Material::kBook, 128.50},
                                                                   {Material::kPoster, 138.04},
                                                                   {Material::kWindow, 198.04},
                                                                   {Material::kDoor, 112.75},
                                                                   {Material::kLamp, 233.75}}};
  const LightGrid evenly{2, 2, {1.0F, 1.0F, 1.0F, 1.0F}};
  for (const auto& [material, mean] : kMeans) {
    EXPECT_NEAR(MeanGrey(*PaintMaterial(material, 5, 1.2, 0.8, 0.01, evenly)), mean, 0.05)
        << "material " << static_cast<int>(material);
  }
}

}  // namespace
}  // namespace pangaea
