#include "cli/vocabulary.h"

#include <unistd.h>

#include <algorithm>
#include <iomanip>
#include <iostream>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/training_images.h"
#include "common/base/text.h"
#include "common/place/dbow2_import.h"
#include "common/place/vocabulary_codec.h"
#include "common/place/vocabulary_training.h"

namespace pangaea {
namespace {

struct TrainArguments {
  std::vector<std::string> images;
  std::string out;
  int features = 1000;
  VocabularyTrainingOptions options;
};

struct ImportArguments {
  std::string dbow2;
  std::string out;
};

// On a terminal one line that counts; a log gets a line per task.
void ShowProgress(const char* task, std::size_t done, std::size_t total) {
  const bool terminal = isatty(STDERR_FILENO) != 0;
  if (!terminal && done != total) return;
  std::cerr << (terminal ? "\r" : "") << task << " " << done << " of " << total << (done == total ? "\n" : "")
            << std::flush;
}

Status WriteVocabulary(const std::string& path, const VocabularyTree& tree) {
  const std::vector<std::byte> bytes = EncodeVocabulary(tree.layout());
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (Status written = WriteTextFile(path, text); !written) return written;
  std::cout << path << ": " << tree.words() << " words, " << bytes.size() << " bytes\n";
  return {};
}

Status Train(const TrainArguments& arguments) {
  if (Status checked = arguments.options.Check(); !checked) return checked;
  std::vector<std::filesystem::path> paths;
  for (const std::string& source : arguments.images) {
    const auto images = ListImages(source);
    if (!images) return tl::make_unexpected(images.error());
    std::cout << source << ": " << images->size() << " images\n";
    paths.insert(paths.end(), images->begin(), images->end());
  }
  const auto descriptors =
      DescribeImages(paths, arguments.features, [](auto done, auto total) { ShowProgress("described", done, total); });
  if (!descriptors) return tl::make_unexpected(descriptors.error());
  const auto tree = TrainVocabulary(*descriptors, arguments.options,
                                    [](auto done, auto total) { ShowProgress("clustered", done, total); });
  if (!tree) return tl::make_unexpected(tree.error());
  return WriteVocabulary(arguments.out, *tree);
}

Status Describe(const std::string& path) {
  const auto bytes = ReadTextFile(path);
  if (!bytes) return tl::make_unexpected(bytes.error());
  const auto tree = DecodeVocabulary(std::as_bytes(std::span(*bytes)));
  if (!tree) return Fail(tree.error().code, path + ": " + tree.error().message);
  const auto& weights = tree->layout().word_weights;
  const auto silent = std::ranges::count(weights, 0);
  const auto [least, most] = std::ranges::minmax(weights);
  const auto in_units = [&](std::uint16_t weight) { return static_cast<float>(weight) * tree->layout().weight_unit; };
  std::cout << "words        " << tree->words() << "\nnodes        " << tree->nodes() << "\nbranching    "
            << tree->branching() << "\ndepth        " << tree->depth() << "\nweights      " << in_units(least) << " to "
            << in_units(most) << " (" << silent << " words of weight 0)\nbytes        " << bytes->size()
            << "\nfingerprint  " << std::hex << std::setfill('0') << std::setw(16) << tree->fingerprint() << std::dec
            << "\n";
  return {};
}

Status Import(const ImportArguments& arguments) {
  const auto text = ReadTextFile(arguments.dbow2);
  if (!text) return tl::make_unexpected(text.error());
  const auto tree = ImportDbow2(*text);
  if (!tree) return Fail(tree.error().code, arguments.dbow2 + ": " + tree.error().message);
  return WriteVocabulary(arguments.out, *tree);
}

CommandBody DeclareTrain(CLI::App& app) {
  auto arguments = std::make_shared<TrainArguments>();
  app.add_option("--images", arguments->images,
                 "Folders searched for PNG and JPEG images, also below; FOLDER:10 takes every tenth image")
      ->required();
  app.add_option("--out", arguments->out, "File for the vocabulary")->required();
  app.add_option("--branching", arguments->options.branching, "Children of each node")->capture_default_str();
  app.add_option("--depth", arguments->options.depth, "Levels; words are at most branching ^ depth")
      ->capture_default_str();
  app.add_option("--min-split", arguments->options.min_split, "Descriptors that a node must have to be split")
      ->capture_default_str();
  app.add_option("--seed", arguments->options.seed, "The same images and seed give the same file")
      ->capture_default_str();
  app.add_option("--features", arguments->features, "Keypoints per image")->capture_default_str();
  return [arguments] { return Train(*arguments); };
}

CommandBody DeclareInfo(CLI::App& app) {
  auto path = std::make_shared<std::string>();
  app.add_option("file", *path, "A vocabulary")->required();
  return [path] { return Describe(*path); };
}

CommandBody DeclareImport(CLI::App& app) {
  auto arguments = std::make_shared<ImportArguments>();
  app.add_option("--dbow2", arguments->dbow2, "A vocabulary of 256-bit descriptors in DBoW2's text form")->required();
  app.add_option("--out", arguments->out, "File for the vocabulary")->required();
  return [arguments] { return Import(*arguments); };
}

CommandBody Declare(CLI::App& app) {
  app.require_subcommand(1);
  std::vector<std::pair<CLI::App*, CommandBody>> bodies;
  const auto add = [&](const char* name, const char* summary, CommandBody (*declare)(CLI::App&)) {
    CLI::App* subcommand = app.add_subcommand(name, summary);
    bodies.emplace_back(subcommand, declare(*subcommand));
  };
  add("train", "Train a vocabulary from images", DeclareTrain);
  add("info", "Describe a vocabulary file", DeclareInfo);
  add("import", "Convert a vocabulary of DBoW2", DeclareImport);
  return [bodies] {
    return std::ranges::find_if(bodies, [](const auto& body) { return body.first->parsed(); })->second();
  };
}

}  // namespace

Command VocabularyCommand() { return {"vocabulary", "Train, describe or import a vocabulary of places", Declare}; }

}  // namespace pangaea
