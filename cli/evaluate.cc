#include "cli/evaluate.h"

#include <algorithm>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/evaluation.h"
#include "cli/single_runs.h"
#include "cli/work_times.h"

namespace pangaea {
namespace {

using nlohmann::json;

struct EvaluateOptions {
  std::vector<std::string> trajectories;
  std::vector<std::string> truths;
  std::string store;
  std::vector<std::string> singles;
  bool jointly = false;
  bool of_camera = false;
  bool as_json = false;
  AbsoluteErrorOptions error;
};

void PrintJson(const json& value) { std::cout << value.dump(-1, ' ', false, json::error_handler_t::replace) << "\n"; }

const char* AlignmentName(const EvaluateOptions& options) { return options.error.with_scale ? "Sim(3)" : "SE(3)"; }

// Where the body is, seen from the camera, is known in metres: in a map of free scale the camera's way alone is exact.
bool ComparesCameras(const EvaluateOptions& options, const std::vector<Truth>& truths) {
  if (options.of_camera || !options.error.with_scale) return options.of_camera;
  return std::ranges::all_of(truths, [](const Truth& truth) { return truth.body_from_camera.has_value(); });
}

Status RunOnFiles(const EvaluateOptions& options, const std::vector<Truth>& truths) {
  const auto trajectories = ReadTrajectories(options.trajectories, truths, ComparesCameras(options, truths));
  if (!trajectories) return tl::make_unexpected(trajectories.error());
  const auto report = EvaluateTrajectories(*trajectories, options.jointly, options.error);
  if (!report) return tl::make_unexpected(report.error());
  if (options.as_json) {
    PrintJson(ToJson(*report));
  } else {
    std::cout << FormatTable(*report) << "ATE after " << AlignmentName(options) << " alignment\n";
  }
  return {};
}

// How large the shared map is beside those of its sessions alone; empty where these are not known.
std::string AgainstSingleMaps(const EvaluationReport& report) {
  const auto single = SumOfSingleRuns(report);
  if (!single || single->keyframes == 0 || single->landmarks == 0) return "";
  const auto percent = [](std::size_t part, std::size_t whole) {
    return std::to_string((200 * part + whole) / (2 * whole)) + " % of the ";
  };
  return "against the single maps: " + percent(report.total.keyframes.value_or(0), single->keyframes) + "keyframes, " +
         percent(report.total.landmarks.value_or(0), single->landmarks) + "landmarks\n";
}

// Sessions that are alone in their map share one table; a map of several has its own, with the joint error.
void PrintTables(const StoredAtlas& stored, const std::vector<MapEvaluation>& evaluations,
                 const EvaluateOptions& options) {
  EvaluationReport alone{.alone = {}, .joint = {}, .total = {}, .with_scale = options.error.with_scale};
  for (const MapEvaluation& evaluation : evaluations) {
    const EvaluationReport& report = evaluation.report;
    if (report.alone.size() == 1) {
      alone.alone.push_back(report.alone.front());
    } else {
      std::cout << "map " << ToString(evaluation.map) << ", shared by " << report.alone.size() << " sessions:\n"
                << FormatTable(report) << AgainstSingleMaps(report) << "\n";
    }
  }
  if (!alone.alone.empty()) {
    std::ranges::stable_sort(alone.alone, {}, [](const auto& row) { return row.error.sessions.front().name; });
    if (alone.alone.size() < evaluations.size()) std::cout << "each in a map of its own:\n";
    std::cout << FormatTable(alone) << "\n";
  }
  const std::size_t maps = stored.maps.size();
  std::cout << "atlas of site " << stored.site << ": " << maps << (maps == 1 ? " map, " : " maps, ")
            << stored.atlas().keyframe_count() << " keyframes, " << stored.atlas().landmark_count()
            << " landmarks; ATE after " << AlignmentName(options) << " alignment\n";
  if (!stored.work_times.empty()) std::cout << "\n" << FormatWorkTimes(stored.work_times);
}

// As for files, a list of all sessions, each with its map; and the maps, with the joint error where several share one.
json StoreJson(const StoredAtlas& stored, const std::vector<MapEvaluation>& evaluations,
               const EvaluateOptions& options) {
  json sessions = json::array();
  json maps = json::array();
  for (const MapEvaluation& evaluation : evaluations) {
    json report = ToJson(evaluation.report);
    json map = {{"id", ToString(evaluation.map)},
                {"keyframes", report["keyframes"]},
                {"landmarks", report["landmarks"]},
                {"sessions", json::array()}};
    for (json& session : report["sessions"]) {
      map["sessions"].push_back(session["name"]);
      session["map"] = ToString(evaluation.map);
      sessions.push_back(std::move(session));
    }
    if (report.contains("joint")) map["joint"] = std::move(report["joint"]);
    if (report.contains("single")) map["single"] = std::move(report["single"]);
    maps.push_back(std::move(map));
  }
  return {{"site", stored.site},
          {"alignment", options.error.with_scale ? "sim3" : "se3"},
          {"sessions", std::move(sessions)},
          {"maps", std::move(maps)},
          {"keyframes", stored.atlas().keyframe_count()},
          {"landmarks", stored.atlas().landmark_count()},
          {"work_times", WorkTimesJson(stored.work_times)}};
}

Status RunOnStore(const EvaluateOptions& options, const std::vector<Truth>& truths) {
  auto stored = ReadStoredAtlas(options.store);
  if (!stored) return tl::make_unexpected(stored.error());
  if (auto status = AttachTruths(truths, *stored); !status) return status;
  if (options.of_camera || options.error.with_scale) EvaluateCameras(*stored);
  for (const std::string& remark : stored->remarks) std::cerr << "pangaea evaluate: note: " << remark << "\n";
  if (stored->parts.empty()) return Fail(ErrorCode::kNotFound, options.store + ": the atlas is empty");
  if (std::ranges::none_of(stored->parts, [](const SessionPart& part) { return part.truth.has_value(); })) {
    return Fail(ErrorCode::kInvalidArgument, options.store + ": none of the truths given belongs to a session of it");
  }
  auto evaluations = EvaluateMaps(*stored, options.error);
  if (!evaluations) return tl::make_unexpected(evaluations.error());
  const auto singles = ReadSingleRuns(options.singles, truths, options.error);
  if (!singles) return tl::make_unexpected(singles.error());
  CompareWithSingleRuns(*singles, *evaluations);
  if (options.as_json) {
    PrintJson(StoreJson(*stored, *evaluations, options));
  } else {
    PrintTables(*stored, *evaluations, options);
  }
  return {};
}

Status Run(const EvaluateOptions& options) {
  if (options.store.empty() == options.trajectories.empty()) {
    return Fail(ErrorCode::kInvalidArgument, "give either --store or --trajectory");
  }
  if (options.store.empty() && !options.singles.empty()) {
    return Fail(ErrorCode::kInvalidArgument, "--single compares with a --store");
  }
  const auto truths = ReadTruths(options.truths);
  if (!truths) return tl::make_unexpected(truths.error());
  return options.store.empty() ? RunOnFiles(options, *truths) : RunOnStore(options, *truths);
}

CommandBody Declare(CLI::App& app) {
  auto options = std::make_shared<EvaluateOptions>();
  app.add_option("--trajectory", options->trajectories,
                 "TUM file of body poses, as an agent writes it; repeatable, with one --truth each, in the same order");
  app.add_option("--store", options->store, "File that holds an atlas: all its sessions, each frame as known by now");
  app.add_option(
      "--single", options->singles,
      "Store of sessions that ran alone, to compare the sizes and errors of their single maps with; repeatable");
  app.add_option("--truth", options->truths, kTruthHelp)->required();
  app.add_flag("--joint", options->jointly,
               "Files: also under one alignment for all, for trajectories of one map (a store knows by itself)");
  app.add_flag("--scale", options->error.with_scale,
               "Align with scale (Sim(3)), for monocular maps; the left camera's positions are compared");
  app.add_flag("--camera", options->of_camera, "Compare the left camera's positions instead of the body's");
  app.add_flag("--json", options->as_json, "One line of JSON instead of a table");
  app.footer(
      "A store's sessions are matched to the truths by name, else by time; NAME=DATASET names a session.\n"
      "  pangaea evaluate --trajectory out.tum --truth V1_01_easy\n"
      "  pangaea evaluate --store atlas.db --truth V1_01_easy --truth V1_02_medium");
  return [options] { return Run(*options); };
}

}  // namespace

Command EvaluateCommand() {
  return {"evaluate", "Compare trajectories with ground truth: RMS ATE alone and jointly, coverage", Declare};
}

}  // namespace pangaea
