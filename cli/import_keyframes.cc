#include "cli/import_keyframes.h"

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <set>
#include <string>

#include "cli/posed_recording.h"
#include "common/base/version.h"
#include "common/wire/envelope.h"
#include "common/wire/session_id.h"
#include "server/storage/session_import.h"

namespace pangaea {
namespace {

// Landmarks of a keyframe that another one sees as well, on average. Under poses that do not fit the images some twenty
// match by chance.
constexpr std::size_t kMinShared = 50;

struct ImportArguments {
  PosedRecordingOptions recording;
  std::string sensor = "auto";
  std::string store;
  std::string site;
  std::string name;
};

std::int64_t Now() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

// The one the store is of; the default for a new store.
Result<std::string> SiteOf(const ImportArguments& arguments) {
  if (!arguments.site.empty()) return arguments.site;
  std::error_code error;
  if (!std::filesystem::exists(arguments.store, error)) return "default";
  const auto store = Store::OpenReadOnly(arguments.store);
  if (!store) return tl::make_unexpected(store.error());
  return store->site();
}

SessionAnnouncement Announce(const PosedRecording& recording, const std::string& name, const std::string& site) {
  SessionAnnouncement session;
  session.session = RandomSessionId();
  session.name = name.empty() ? recording.name : name;
  session.site = site;
  session.sensor_kind = recording.sensor;
  session.ideal_camera = recording.camera;
  session.body_from_camera = recording.body_from_camera;
  session.software_version = kVersion;
  session.wire_version = kWireVersion;
  session.epoch_ns = Now();
  session.closed = true;
  return session;
}

struct Size {
  std::size_t keyframes = 0;
  std::size_t landmarks = 0;
  std::size_t shared = 0;               // landmarks that several keyframes see
  std::size_t shared_observations = 0;  // of those
};

Size SizeOf(const PosedMap& map) {
  Size size;
  std::set<LandmarkId> shared;
  for (const MapEdit& edit : map.edits) {
    size.keyframes += std::holds_alternative<AddKeyframe>(edit) ? 1 : 0;
    size.landmarks += std::holds_alternative<AddLandmark>(edit) ? 1 : 0;
    if (const auto* more = std::get_if<AddObservation>(&edit)) {
      shared.insert(more->landmark);
      ++size.shared_observations;
    }
  }
  size.shared = shared.size();
  size.shared_observations += shared.size();
  return size;
}

void Report(const SessionAnnouncement& session, const PosedMap& map, const Size& size) {
  char error[32];
  std::snprintf(error, sizeof(error), "%.2f", map.median_error);
  std::cout << "session " << ToString(session.session) << " (" << session.name << "): " << size.keyframes
            << " keyframes, " << size.landmarks << " landmarks, " << size.shared
            << " of them seen by several; median reprojection error " << error << " sigma\n";
}

Status Import(ImportArguments arguments) {
  if (arguments.sensor == "stereo") arguments.recording.sensor = SensorKind::kStereo;
  if (arguments.sensor == "mono") arguments.recording.sensor = SensorKind::kMonocular;
  const auto site = SiteOf(arguments);
  if (!site) return tl::make_unexpected(site.error());
  // Before the work: a server may have it.
  auto store = Store::Open(arguments.store, *site, {});
  if (!store) return tl::make_unexpected(store.error());
  const auto recording = ReadPosedRecording(arguments.recording);
  if (!recording) return tl::make_unexpected(recording.error());
  for (const std::string& warning : recording->warnings) {
    std::cerr << "pangaea import-keyframes: note: " << warning << "\n";
  }
  const SessionAnnouncement session = Announce(*recording, arguments.name, *site);
  const PosedMap map = BuildPosedMap(session.session, recording->keyframes, {});
  const Size size = SizeOf(map);
  if (size.shared_observations < kMinShared * size.keyframes) {
    return Fail(ErrorCode::kRefused, arguments.recording.dataset.string() + ": a keyframe shares " +
                                         std::to_string(size.shared_observations / size.keyframes) +
                                         " landmarks with others, a map needs " + std::to_string(kMinShared) +
                                         ": are poses, calibration and images of one recording?");
  }
  if (auto status = ImportSession(*store, session, map.edits, Now()); !status) return status;
  Report(session, map, size);
  return {};
}

CommandBody Declare(CLI::App& app) {
  auto arguments = std::make_shared<ImportArguments>();
  app.add_option("dataset", arguments->recording.dataset, "Folder of a recording (EuRoC, TUM-VI, KITTI, TUM RGB-D)")
      ->required();
  app.add_option("--store", arguments->store,
                 "File that holds the atlas; made where there is none, no server may have it open")
      ->required();
  app.add_option("--poses", arguments->recording.poses,
                 "TUM file of the body's poses (default: the recording's ground truth)");
  app.add_option("--interval", arguments->recording.interval_s,
                 "Least time between two keyframes, seconds; 0 takes every frame")
      ->capture_default_str();
  app.add_option("--sensor", arguments->sensor, "stereo, mono, or auto: stereo where there are two cameras")
      ->check(CLI::IsMember({"auto", "stereo", "mono"}))
      ->capture_default_str();
  app.add_option("--name", arguments->name, "Name of the session for people (default: the recording's)");
  app.add_option("--site", arguments->site, "Site of the store (default: the store's own, or \"default\")");
  app.footer(
      "The keyframes stay where the poses say; landmarks are triangulated between them. The map is a session like an\n"
      "agent's: a server that is started on the store recognises its places and merges it.\n"
      "  pangaea import-keyframes V1_01_easy --interval 1 --store atlas.db");
  return [arguments] { return Import(*arguments); };
}

}  // namespace

Command ImportKeyframesCommand() {
  return {"import-keyframes", "Make a map of recorded frames whose poses are known, as a session of a store", Declare};
}

}  // namespace pangaea
