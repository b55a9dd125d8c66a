#include "cli/export.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <system_error>
#include <utility>

#include "cli/stored_atlas.h"
#include "common/evaluation/trajectory_file.h"

namespace pangaea {
namespace {

namespace fs = std::filesystem;

struct ExportOptions {
  std::string format = "tum";
  std::string store;
  fs::path out;
  std::string session;  // name or id; empty: all
  bool of_camera = false;
};

// One way to write an atlas. A new format is a new line in kFormats.
struct Format {
  const char* name;
  Status (*write)(const StoredAtlas& stored, const ExportOptions& options);
};

// Names come from agents: only what is harmless in a file's name remains of them.
std::string FileStem(const std::string& session_name) {
  std::string stem = session_name;
  for (char& c : stem) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '-' && c != '_' && c != '.') c = '_';
  }
  if (stem.empty() || stem.front() == '.') stem.insert(stem.begin(), '_');
  return stem;
}

// "V1_01" and, of two sessions of one name, "V1_01-9f3a...".
std::map<SessionId, std::string> FileStems(const StoredAtlas& stored) {
  std::map<std::string, int> uses;
  std::map<SessionId, std::string> stems;
  for (const SessionRecord& record : stored.recovered.sessions) ++uses[FileStem(record.announcement.name)];
  for (const SessionRecord& record : stored.recovered.sessions) {
    const SessionId id = record.announcement.session;
    const std::string stem = FileStem(record.announcement.name);
    stems[id] = uses[stem] == 1 ? stem : stem + "-" + ToString(id);
  }
  return stems;
}

Result<std::set<SessionId>> ChosenSessions(const StoredAtlas& stored, const std::string& wanted) {
  std::set<SessionId> chosen;
  std::string known;
  for (const SessionRecord& record : stored.recovered.sessions) {
    const SessionAnnouncement& session = record.announcement;
    if (wanted.empty() || session.name == wanted || ToString(session.session) == wanted) chosen.insert(session.session);
    known += (known.empty() ? "" : ", ") + session.name;
  }
  if (!chosen.empty()) return chosen;
  if (wanted.empty()) return Fail(ErrorCode::kNotFound, "the atlas is empty");
  return Fail(ErrorCode::kInvalidArgument, "--session " + wanted + ": no such session; there are: " + known);
}

// OUT.tum for the largest map, then OUT.2.tum and so on: as an agent names them.
fs::path Numbered(const fs::path& path, int number) {
  if (number == 1) return path;
  fs::path numbered = path;
  return numbered.replace_extension("." + std::to_string(number) + path.extension().string());
}

Status CreateFolder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (!error) return {};
  return Fail(ErrorCode::kUnavailable, folder.string() + ": cannot be created: " + error.message());
}

Status WriteTum(const StoredAtlas& stored, const ExportOptions& options) {
  const auto chosen = ChosenSessions(stored, options.session);
  if (!chosen) return tl::make_unexpected(chosen.error());
  const bool is_file = options.out.extension() == ".tum";
  if (is_file && chosen->size() > 1) {
    return Fail(ErrorCode::kInvalidArgument, "--out " + options.out.string() + " is one file, but there are " +
                                                 std::to_string(chosen->size()) +
                                                 " sessions; choose one with --session, or give a folder");
  }
  if (!is_file) {
    if (auto status = CreateFolder(options.out); !status) return status;
  }
  const auto stems = FileStems(stored);
  std::map<SessionId, int> files;
  for (const SessionPart& part : stored.parts) {
    if (!chosen->contains(part.session)) continue;
    std::vector<StampedPose> poses = part.trajectory.estimate;
    for (StampedPose& pose : poses) pose.world_from_body = pose.world_from_body * part.trajectory.body_from_evaluated;
    const fs::path path = is_file ? options.out : options.out / (stems.at(part.session) + ".tum");
    const fs::path numbered = Numbered(path, ++files[part.session]);
    if (auto status = WriteTrajectory(numbered, poses); !status) return status;
    std::cout << numbered.string() << ": " << poses.size() << " poses\n";
  }
  if (files.empty()) return Fail(ErrorCode::kNotFound, "the store holds no frame of it yet");
  return {};
}

constexpr std::array kFormats = {Format{"tum", &WriteTum}};

Status Run(const ExportOptions& options) {
  auto stored = ReadStoredAtlas(options.store);
  if (!stored) return tl::make_unexpected(stored.error());
  if (options.of_camera) EvaluateCameras(*stored);
  const auto format = std::ranges::find(kFormats, options.format, &Format::name);
  return format->write(*stored, options);
}

CommandBody Declare(CLI::App& app) {
  auto options = std::make_shared<ExportOptions>();
  std::set<std::string> formats;
  for (const Format& format : kFormats) formats.insert(format.name);
  app.add_option("--format", options->format, "tum: body poses, \"seconds tx ty tz qx qy qz qw\"")
      ->check(CLI::IsMember(formats))
      ->capture_default_str();
  app.add_option("--store", options->store, "File that holds the atlas")->required();
  app.add_option("--out", options->out, "Folder for one file per session and map, or FILE.tum for one session")
      ->required();
  app.add_option("--session", options->session, "Name or id of the only session to write");
  app.add_flag("--camera", options->of_camera, "Poses of the ideal left camera instead of the body");
  return [options] { return Run(*options); };
}

}  // namespace

Command ExportCommand() { return {"export", "Write the trajectories of a store as files", Declare}; }

}  // namespace pangaea
