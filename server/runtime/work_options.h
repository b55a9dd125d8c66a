#pragma once

#include <filesystem>

#include "common/base/config.h"
#include "common/base/result.h"
#include "server/atlas/comparison_agenda.h"
#include "server/atlas/lookup_agenda.h"
#include "server/atlas/map_economy.h"
#include "server/atlas/map_optimization.h"
#include "server/atlas/optimization_agenda.h"
#include "server/atlas/welding_agenda.h"
#include "server/fusion/fusion_options.h"
#include "server/fusion/redundancy.h"
#include "server/map_comparison/map_comparison_options.h"
#include "server/optimization/pose_graph.h"
#include "server/place_recognition/frame_lookup.h"
#include "server/place_recognition/place_recognition_options.h"

namespace pangaea {

// What the server does with maps by itself.
struct WorkOptions {
  // Without it maps stay as their agents made them.
  bool enabled = true;
  std::filesystem::path vocabulary;  // empty: the shipped one, which is built in
  LookupOptions lookup{};
  PlaceRecognitionOptions place{};
  FrameLookupOptions frames{};
  bool compare_maps = true;  // as wholes, those that no keyframe joins
  MapComparisonOptions comparison{};
  ComparisonAgendaOptions comparisons{};
  WeldingAgendaOptions agenda{};
  FusionOptions fusion{};
  PoseGraphOptions pose_graph{};
  OptimizationAgendaOptions optimization{};
  MapOptimizationOptions map{};
  EconomyOptions economy{};
  RedundancyOptions redundancy{};
  InUseOptions in_use{};
  // Keyframes and landmarks may take so many bytes of memory; beyond, what is redundant is culled. 0: nothing is.
  std::size_t max_bytes = 0;

  Status Check() const;
};

// Reads the keys recognition.*, fusion.*, optimization.*, economy.* and redundancy.*.
void ReadWork(ConfigReader& reader, WorkOptions& options);

}  // namespace pangaea
