#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/base/result.h"

namespace pangaea {

// One session's way through the map.
struct PlotTrajectory {
  std::string name;
  // Positions, metres, in the frame common to the scene; each piece is drawn as one line (a lost camera ends one).
  std::vector<std::vector<Eigen::Vector3d>> pieces;
  std::vector<Eigen::Vector3d> keyframes;     // drawn as small marks; may be empty
  std::vector<Eigen::Vector3d> truth;         // drawn thin and dashed below; may be empty
  std::optional<double> rms_error;            // metres, for the legend
  std::optional<std::size_t> keyframe_count;  // for the legend
};

// What a picture of an atlas shows. All points in one frame, metres.
struct PlotScene {
  std::string title;
  std::string subtitle;
  std::vector<PlotTrajectory> trajectories;
  std::vector<Eigen::Vector3d> landmarks;
  // Upwards, where it is known; else the direction in which the trajectories vary least.
  std::optional<Eigen::Vector3d> up;
  // What lies to the right in the picture; unset: the longest extent of the trajectories.
  std::optional<Eigen::Vector3d> right;
};

struct PlotOptions {
  int width = 1600;   // pixels
  int height = 1000;  // pixels
  // More landmarks than this are thinned evenly, so that the file stays small.
  std::size_t max_landmarks = 40000;
};

// The scene from above as an SVG document. A pure function: equal scenes give equal bytes.
std::string DrawSvg(const PlotScene& scene, const PlotOptions& options = {});
Status WriteSvg(const std::filesystem::path& path, const PlotScene& scene, const PlotOptions& options = {});

}  // namespace pangaea
