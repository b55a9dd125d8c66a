#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/evaluation/absolute_error.h"

namespace pangaea {

// Sizes of what a session or an atlas built; absent where unknown.
struct MapCounts {
  std::optional<std::size_t> maps;
  std::optional<std::size_t> keyframes;
  std::optional<std::size_t> landmarks;
};

// What the session comes to when it runs alone: its own map, not what became of it among others.
struct SingleRun {
  std::size_t keyframes = 0;
  std::size_t landmarks = 0;
  std::optional<double> rms;  // of the absolute error, metres; each map of it under its own alignment
};

// One evaluation as a person reads it: every session under its own alignment, then all under one.
struct EvaluationReport {
  struct Row {
    AbsoluteError error;  // of one session
    MapCounts counts;
    std::optional<SingleRun> single = {};
  };
  std::vector<Row> alone;
  std::optional<AbsoluteError> joint;  // absent for a single session, or where they share no map
  MapCounts total;
  bool with_scale = false;
};

// Sizes of the single runs together, nothing where one of them is not known.
std::optional<SingleRun> SumOfSingleRuns(const EvaluationReport& report);

// A table of plain text, one session a line, ATE after the report's kind of alignment: of the session by itself and,
// in the column `joint m`, under the one alignment of all. A session whose error has no poses was not compared with any
// truth: only what is known of it is shown.
std::string FormatTable(const EvaluationReport& report);
nlohmann::json ToJson(const EvaluationReport& report);

}  // namespace pangaea
