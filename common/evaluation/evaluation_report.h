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

// One evaluation as a person reads it: every session under its own alignment, then all under one.
struct EvaluationReport {
  struct Row {
    AbsoluteError error;  // of one session
    MapCounts counts;
  };
  std::vector<Row> alone;
  std::optional<AbsoluteError> joint;  // absent for a single session, or where they share no map
  MapCounts total;
  bool with_scale = false;
};

// A table of plain text, one session a line, ATE after the report's kind of alignment. A session whose error has no
// poses was not compared with any truth: only what is known of it is shown.
std::string FormatTable(const EvaluationReport& report);
nlohmann::json ToJson(const EvaluationReport& report);

}  // namespace pangaea
