#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "common/simulation/floor_plan.h"

namespace pangaea {
namespace {

using Eigen::Vector3d;

const Vector3d kUp = Vector3d::UnitZ();
const Vector3d kHallHalfSize(10.0, 7.0, 3.0);
// Texels, metres: fine where cameras come near.
constexpr double kWallTexel = 0.005;
constexpr double kFloorTexel = 0.006;
constexpr double kCeilingTexel = 0.010;
constexpr double kDoorTexel = 0.005;
constexpr double kPosterTexel = 0.0035;

// A wall seen from inside: points on it by (to the right, upwards, off the wall).
struct Wall {
  Vector3d left_foot;
  Vector3d right;
  Vector3d normal;
  double length;

  Vector3d At(double along, double height, double off) const {
    return left_foot + along * right + height * kUp + off * normal;
  }
  double yaw() const { return std::atan2(right.y(), right.x()); }
};

std::vector<Wall> WallsOf(const Vector3d& half) {
  const Vector3d x = Vector3d::UnitX();
  const Vector3d y = Vector3d::UnitY();
  return {{{-half.x(), half.y(), 0.0}, x, -y, 2.0 * half.x()},
          {{half.x(), half.y(), 0.0}, -y, -x, 2.0 * half.y()},
          {{half.x(), -half.y(), 0.0}, -x, y, 2.0 * half.x()},
          {{-half.x(), -half.y(), 0.0}, y, x, 2.0 * half.y()}};
}

void AddShell(FloorPlan& plan, const std::vector<Wall>& walls) {
  const Vector3d& half = plan.scene.half_size;
  const Vector3d y = Vector3d::UnitY();
  plan.AddRectangle(Vector3d::Zero(), kUp, y, 2.0 * half.x(), 2.0 * half.y(), Material::kFloor, kFloorTexel);
  plan.AddRectangle(2.0 * half.z() * kUp, -kUp, y, 2.0 * half.x(), 2.0 * half.y(), Material::kCeiling, kCeilingTexel);
  for (const Wall& wall : walls) {
    plan.AddRectangle(wall.At(0.5 * wall.length, half.z(), 0.0), wall.normal, kUp, wall.length, 2.0 * half.z(),
                      Material::kPlaster, kWallTexel);
  }
}

void AddCeilingWork(FloorPlan& plan) {
  const Vector3d& half = plan.scene.half_size;
  const double top = 2.0 * half.z();
  for (const double x : {-7.5, -2.5, 2.5, 7.5}) {
    plan.AddBox({x, 0.0, top - 0.2}, {0.15, half.y(), 0.2}, 0.0, Material::kConcrete, true);
  }
  for (const double y : {-5.6, 5.4}) plan.AddBox({0.0, y, 5.15}, {9.6, 0.22, 0.22}, 0.0, Material::kMetal, true);
  for (const double x : {-6.0, 0.0, 6.0}) {
    for (const double y : {-3.3, 3.3}) {
      plan.lamps.push_back({x, y, 4.75});
      const std::size_t first = plan.surfaces.size();
      plan.AddBox({x, y, 4.9}, {0.7, 0.14, 0.07}, 0.0, Material::kLamp, true);
      for (std::size_t i = first; i < plan.surfaces.size(); ++i) plan.surfaces[i].glowing = true;
    }
  }
  for (const double x : {-3.9, 3.9}) {
    for (const double y : {-1.9, 1.9}) {
      plan.AddBox({x, y, half.z()}, {0.26, 0.26, half.z()}, 0.0, Material::kConcrete);
      plan.AddBox({x, y, 0.15}, {0.36, 0.36, 0.15}, 0.0, Material::kMetal);
    }
  }
}

void AddCrates(FloorPlan& plan, Random& random, const Vector3d& foot, double size, int count) {
  double height = 0.0;
  for (int i = 0; i < count; ++i) {
    const double half_x = size * random.Uniform(0.38, 0.5);
    const double half_y = size * random.Uniform(0.38, 0.5);
    const Vector3d half(half_x, half_y, size * random.Uniform(0.3, 0.5));
    const Material material = random.Chance(0.5) ? Material::kWood : Material::kCarton;
    const double shift_x = random.Uniform(-0.06, 0.06);
    const Vector3d shift(shift_x, random.Uniform(-0.06, 0.06), height + half.z());
    plan.AddBox(foot + shift, half, random.Uniform(0.0, std::numbers::pi), material);
    height += 2.0 * half.z();
    size *= random.Uniform(0.75, 0.95);
  }
}

// Cartons, books and tins beside each other along a board. `left` is the board's end at its middle depth.
void AddGoods(FloorPlan& plan, Random& random, const Vector3d& left, const Vector3d& right, double length, double depth,
              double room_above) {
  const double yaw = std::atan2(right.y(), right.x());
  for (double along = random.Uniform(0.02, 0.15); along < length - 0.1;) {
    const bool book = random.Chance(0.45);
    const double width = std::min(book ? random.Uniform(0.05, 0.12) : random.Uniform(0.15, 0.38), length - along);
    const double height = room_above * random.Uniform(0.45, 0.9);
    const Vector3d half(0.5 * width, 0.5 * depth * random.Uniform(0.55, 0.9), 0.5 * height);
    constexpr std::array<Material, 3> kGoods = {Material::kCarton, Material::kMetal, Material::kFabric};
    const Material material = book ? Material::kBook : kGoods[static_cast<std::size_t>(random.Index(3))];
    plan.AddBox(left + (along + half.x()) * right + half.z() * kUp, half,
                yaw + (book ? 0.0 : random.Uniform(-0.12, 0.12)), material);
    along += width + (random.Chance(0.2) ? random.Uniform(0.1, 0.3) : 0.012);
  }
}

void AddShelf(FloorPlan& plan, Random& random, const Wall& wall, double along, double length) {
  constexpr double kDepth = 0.42;
  constexpr double kBoard = 0.02;  // half a board's thickness
  const double height = random.Uniform(1.7, 2.3);
  const int boards = 3 + random.Index(2);
  const double yaw = wall.yaw();
  for (const double side : {0.0, length}) {
    plan.AddBox(wall.At(along + side, 0.5 * height, 0.5 * kDepth), {kBoard, 0.5 * kDepth, 0.5 * height}, yaw,
                Material::kWood);
  }
  const double spacing = (height - 0.1) / boards;
  for (int i = 0; i <= boards; ++i) {
    const double z = 0.1 + i * spacing;
    plan.AddBox(wall.At(along + 0.5 * length, z, 0.5 * kDepth), {0.5 * length, 0.5 * kDepth, kBoard}, yaw,
                Material::kWood, true);
    AddGoods(plan, random, wall.At(along + 0.04, z + kBoard, 0.5 * kDepth), wall.right, length - 0.08, kDepth,
             spacing - 2.0 * kBoard);
  }
}

void AddDoor(FloorPlan& plan, const Wall& wall, double along, double width) {
  plan.AddRectangle(wall.At(along + 0.5 * width, 1.05, 0.02), wall.normal, kUp, width, 2.1, Material::kDoor,
                    kDoorTexel);
  for (const double side : {0.0, width}) {
    plan.AddBox(wall.At(along + side, 1.08, 0.04), {0.06, 0.04, 1.08}, wall.yaw(), Material::kWood);
  }
  plan.AddBox(wall.At(along + 0.5 * width, 2.2, 0.04), {0.5 * width + 0.06, 0.04, 0.06}, wall.yaw(), Material::kWood,
              true);
}

void AddPosters(FloorPlan& plan, Random& random, const Wall& wall, double low, double high, double spacing) {
  int layer = 0;
  for (double along = random.Uniform(0.3, 0.8); along < wall.length - 1.2;
       along += spacing * random.Uniform(0.7, 1.3)) {
    const double width = random.Uniform(0.45, 1.3);
    const double height = random.Uniform(0.5, std::min(1.4, high - low));
    const double turn = random.Uniform(-0.06, 0.06);
    const Vector3d up = std::cos(turn) * kUp + std::sin(turn) * wall.right;
    const double z = random.Uniform(low + 0.5 * height, high - 0.5 * height);
    // Each a little farther off the wall than the last, so that overlapping ones have an order.
    const double off = 0.010 + 0.002 * (layer++ % 5);
    const Material material = random.Chance(0.75) ? Material::kPoster : Material::kFabric;
    plan.AddRectangle(wall.At(std::min(along + 0.5 * width, wall.length - 0.7), z, off), wall.normal, up, width, height,
                      material, kPosterTexel);
  }
}

void AddWindows(FloorPlan& plan, Random& random, const Wall& wall) {
  constexpr double kWidth = 1.5;
  constexpr double kHeight = 1.7;
  for (double along = 1.2; along + kWidth < wall.length - 1.0; along += kWidth + random.Uniform(0.7, 1.5)) {
    const Vector3d center = wall.At(along + 0.5 * kWidth, 3.7, 0.0);
    const std::size_t first = plan.surfaces.size();
    plan.AddRectangle(center + 0.014 * wall.normal, wall.normal, kUp, kWidth, kHeight, Material::kWindow, kWallTexel);
    plan.surfaces[first].glowing = true;
    for (const double side : {-0.5, 0.0, 0.5}) {
      plan.AddBox(center + side * kWidth * wall.right + 0.03 * wall.normal, {0.04, 0.03, 0.5 * kHeight}, wall.yaw(),
                  Material::kWood);
    }
    for (const double side : {-0.5, 0.1, 0.5}) {
      plan.AddBox(center + side * kHeight * kUp + 0.03 * wall.normal, {0.5 * kWidth + 0.04, 0.03, 0.04}, wall.yaw(),
                  Material::kWood, true);
    }
  }
}

// Furniture along a wall from one end to the other.
void FurnishWall(FloorPlan& plan, Random& random, const Wall& wall) {
  for (double along = random.Uniform(0.9, 1.4); along < wall.length - 1.6;) {
    const double room = wall.length - 0.9 - along;
    const int choice = random.Index(10);
    double width = random.Uniform(1.2, 2.2);
    if (choice < 4) {
      width = std::min(width, room);
      AddShelf(plan, random, wall, along, width);
    } else if (choice < 6) {
      width = std::min(random.Uniform(0.8, 1.3), room);
      const Vector3d half(0.5 * width, 0.25, random.Uniform(0.4, 0.95));
      plan.AddBox(wall.At(along + 0.5 * width, half.z(), 0.25), half, wall.yaw(), Material::kMetal);
      AddGoods(plan, random, wall.At(along, 2.0 * half.z(), 0.25), wall.right, width, 0.4, 0.4);
    } else if (choice < 8) {
      width = 0.9;
      const double size = random.Uniform(0.6, 0.9);
      AddCrates(plan, random, wall.At(along + 0.45, 0.0, 0.55), size, 1 + random.Index(3));
    } else {
      width = std::min(random.Uniform(0.9, 1.3), room);
      AddDoor(plan, wall, along, width);
    }
    along += width + random.Uniform(0.15, 0.9);
  }
}

bool IsFree(const FloorPlan& plan, const Vector3d& center, double radius) {
  return std::all_of(plan.scene.solids.begin(), plan.scene.solids.end(),
                     [&](const Solid& solid) { return solid.Distance(center) > radius; });
}

void AddTable(FloorPlan& plan, Random& random, const Vector3d& foot, double yaw) {
  const double half_length = random.Uniform(0.6, 0.85);
  const Vector3d half(half_length, random.Uniform(0.32, 0.42), 0.02);
  const double height = random.Uniform(0.7, 0.8);
  const Vector3d right(std::cos(yaw), std::sin(yaw), 0.0);
  const Vector3d back(-right.y(), right.x(), 0.0);
  plan.AddBox(foot + height * kUp, half, yaw, Material::kWood, true);
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      const Vector3d at = foot + x * (half.x() - 0.06) * right + y * (half.y() - 0.06) * back;
      plan.AddBox(at + 0.5 * height * kUp, {0.035, 0.035, 0.5 * height - 0.02}, yaw, Material::kWood);
    }
  }
  const Vector3d top = foot + (height + 0.02) * kUp;
  AddGoods(plan, random, top - half.x() * right + 0.18 * back, right, 2.0 * half.x(), 0.25, 0.45);
  AddGoods(plan, random, top - half.x() * right - 0.18 * back, right, 1.2 * half.x(), 0.2, 0.2);
}

void AddChair(FloorPlan& plan, const Vector3d& foot, double yaw) {
  const Vector3d right(std::cos(yaw), std::sin(yaw), 0.0);
  const Vector3d back(-right.y(), right.x(), 0.0);
  plan.AddBox(foot + 0.44 * kUp, {0.21, 0.21, 0.025}, yaw, Material::kFabric, true);
  plan.AddBox(foot + 0.19 * back + 0.72 * kUp, {0.21, 0.02, 0.25}, yaw, Material::kWood, true);
  for (const double x : {-0.17, 0.17}) {
    for (const double y : {-0.17, 0.17}) {
      plan.AddBox(foot + x * right + y * back + 0.21 * kUp, {0.025, 0.025, 0.21}, yaw, Material::kMetal);
    }
  }
}

// Boards with posters, tables, chairs and crates between the pillars.
void FurnishMiddle(FloorPlan& plan, Random& random) {
  for (const double x : {-2.2, 0.3, 2.6}) {
    const double yaw = random.Uniform(0.0, std::numbers::pi);
    const double shift_x = random.Uniform(-0.4, 0.4);
    const Vector3d foot(x + shift_x, random.Uniform(-0.9, 0.9), 0.0);
    plan.AddBox(foot + 1.05 * kUp, {0.8, 0.05, 1.05}, yaw, Material::kPoster);
  }
  constexpr int kTries = 90;
  int tables = 0;
  for (int i = 0; i < kTries; ++i) {
    const double x = random.Uniform(-4.0, 4.0);
    const Vector3d foot(x, random.Uniform(-1.9, 1.9), 0.0);
    const double yaw = random.Uniform(0.0, std::numbers::pi);
    if (tables < 5 && IsFree(plan, foot + 0.5 * kUp, 0.95)) {
      AddTable(plan, random, foot, yaw);
      ++tables;
    } else if (IsFree(plan, foot + 0.4 * kUp, 0.6) && random.Chance(0.5)) {
      const double size = random.Uniform(0.5, 0.8);
      AddCrates(plan, random, foot, size, 1 + random.Index(3));
    } else if (IsFree(plan, foot + 0.4 * kUp, 0.32)) {
      AddChair(plan, foot, yaw);
    }
  }
}

}  // namespace

FloorPlan PlanHall(std::uint64_t seed) {
  FloorPlan plan;
  plan.scene.half_size = kHallHalfSize;
  Random random(seed);
  const std::vector<Wall> walls = WallsOf(kHallHalfSize);
  AddShell(plan, walls);
  AddCeilingWork(plan);
  for (const Wall& wall : walls) {
    FurnishWall(plan, random, wall);
    AddPosters(plan, random, wall, 1.2, 2.7, 1.3);
  }
  AddWindows(plan, random, walls[0]);
  AddWindows(plan, random, walls[2]);
  AddPosters(plan, random, walls[1], 2.9, 4.9, 1.4);
  AddPosters(plan, random, walls[3], 2.9, 4.9, 1.4);
  FurnishMiddle(plan, random);
  return plan;
}

}  // namespace pangaea
