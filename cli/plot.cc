#include "cli/plot.h"

#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "cli/atlas_scene.h"
#include "cli/evaluation.h"

namespace pangaea {
namespace {

struct PlotArguments {
  std::vector<std::string> trajectories;
  std::vector<std::string> truths;
  std::string store;
  std::string out;
  std::string title;
  AbsoluteErrorOptions error;
  PlotOptions picture;
};

Result<PlotScene> SceneOfFiles(const PlotArguments& arguments, const std::vector<Truth>& truths) {
  const auto trajectories = ReadTrajectories(arguments.trajectories, truths, false);
  if (!trajectories) return tl::make_unexpected(trajectories.error());
  const auto report = EvaluateTrajectories(*trajectories, false, arguments.error);
  if (!report) return tl::make_unexpected(report.error());
  return SceneOf(*trajectories, truths, *report);
}

Result<PlotScene> SceneOfStore(const PlotArguments& arguments, const std::vector<Truth>& truths) {
  auto stored = ReadStoredAtlas(arguments.store);
  if (!stored) return tl::make_unexpected(stored.error());
  if (stored->parts.empty()) return Fail(ErrorCode::kNotFound, arguments.store + ": the atlas is empty");
  if (!truths.empty()) {
    if (auto status = AttachTruths(truths, *stored); !status) return tl::make_unexpected(status.error());
    for (const std::string& remark : stored->remarks) std::cerr << "pangaea plot: note: " << remark << "\n";
  }
  const auto evaluations = EvaluateMaps(*stored, arguments.error);
  if (!evaluations) return tl::make_unexpected(evaluations.error());
  return SceneOf(*stored, *evaluations, truths);
}

Status Run(const PlotArguments& arguments) {
  if (arguments.store.empty() == arguments.trajectories.empty()) {
    return Fail(ErrorCode::kInvalidArgument, "give either --store or --trajectory");
  }
  const auto truths = ReadTruths(arguments.truths);
  if (!truths) return tl::make_unexpected(truths.error());
  auto scene = arguments.store.empty() ? SceneOfFiles(arguments, *truths) : SceneOfStore(arguments, *truths);
  if (!scene) return tl::make_unexpected(scene.error());
  if (!arguments.title.empty()) scene->title = arguments.title;
  if (auto status = WriteSvg(arguments.out, *scene, arguments.picture); !status) return status;
  std::cout << arguments.out << "\n";
  return {};
}

CommandBody Declare(CLI::App& app) {
  auto arguments = std::make_shared<PlotArguments>();
  app.add_option("--store", arguments->store, "File that holds an atlas: trajectories, keyframes and landmarks");
  app.add_option("--trajectory", arguments->trajectories,
                 "TUM file of body poses; repeatable, with one --truth each, in the same order");
  app.add_option("--truth", arguments->truths, std::string(kTruthHelp) + "; a store can do without");
  app.add_option("--out", arguments->out, "The picture (SVG; every web browser shows it)")->required();
  app.add_option("--title", arguments->title, "Its headline");
  app.add_option("--width", arguments->picture.width, "Pixels")->check(CLI::Range(640, 10000))->capture_default_str();
  app.add_option("--height", arguments->picture.height, "Pixels")->check(CLI::Range(400, 10000))->capture_default_str();
  app.add_flag("--scale", arguments->error.with_scale, "Align with scale (Sim(3)), for monocular maps");
  app.footer(
      "With truth, everything is drawn in its frame; maps without a common frame stand side by side.\n"
      "  pangaea plot --store atlas.db --truth V1_01_easy --truth V1_02_medium --out atlas.svg");
  return [arguments] { return Run(*arguments); };
}

}  // namespace

Command PlotCommand() { return {"plot", "Draw an atlas or trajectories from above (SVG)", Declare}; }

}  // namespace pangaea
