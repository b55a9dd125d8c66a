#include "agent/runtime/agent_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <vector>

#include "common/base/version.h"
#include "common/evaluation/trajectory_file.h"
#include "common/map/digest.h"
#include "common/map/forgetting.h"
#include "common/map/keyframe_vergence.h"
#include "common/map/trajectory.h"

namespace pangaea {
namespace {

using MapTrajectory = std::vector<StampedPose>;

// The body's way through each map, the longest first.
std::vector<MapTrajectory> MapTrajectories(const AgentRun& run) {
  const Rigid3d camera_from_body = run.body_from_camera.Inverse();
  std::map<MapId, MapTrajectory> by_map;
  for (const TrajectoryPose& pose : SessionTrajectory(*run.atlas, run.session)) {
    by_map[pose.map].push_back({pose.stamp_ns, pose.map_from_camera * camera_from_body});
  }
  std::vector<MapTrajectory> trajectories;
  for (auto& [map, trajectory] : by_map) trajectories.push_back(std::move(trajectory));
  std::stable_sort(trajectories.begin(), trajectories.end(),
                   [](const MapTrajectory& a, const MapTrajectory& b) { return a.size() > b.size(); });
  return trajectories;
}

std::filesystem::path Numbered(const std::filesystem::path& path, std::size_t number) {
  if (number == 1) return path;
  std::filesystem::path numbered = path;
  numbered.replace_extension(fmt::format(".{}{}", number, path.extension().string()));
  return numbered;
}

Status WriteReport(const std::filesystem::path& path, const AgentRun& run) {
  std::ofstream file(path);
  file << ReportOf(run).dump(2) << '\n';
  file.close();
  if (file) return {};
  return Fail(ErrorCode::kUnavailable, path.string() + ": cannot be written");
}

// Of the session's keyframes whose features only the server has.
std::vector<std::uint32_t> ForgottenCounters(const AgentRun& run) {
  std::vector<std::uint32_t> counters;
  run.atlas->ForEachKeyframe(run.session, [&](const Keyframe& keyframe) {
    if (IsForgotten(keyframe)) counters.push_back(keyframe.id.counter);
  });
  return counters;
}

}  // namespace

nlohmann::json ReportOf(const AgentRun& run) {
  nlohmann::json stages = nlohmann::json::object();
  for (const auto& [name, statistics] : run.stages) {
    stages[name] = {{"count", statistics.count},
                    {"median_ms", statistics.median_ms},
                    {"mean_ms", statistics.mean_ms},
                    {"p95_ms", statistics.p95_ms}};
  }
  nlohmann::json memory = nlohmann::json::array();
  for (const MemorySample& sample : run.flight.memory) memory.push_back({sample.seconds, sample.resident_mib});
  return {
      {"version", kVersion},
      {"session", ToString(run.session)},
      {"name", run.name},
      {"frames", run.source.frames},
      {"tracked", run.flight.tracked},
      {"lost", run.flight.lost},
      {"dropped", run.source.dropped},
      {"skipped", run.source.skipped},
      {"missing", run.source.missing},
      {"maps", run.atlas->Maps().size()},
      {"keyframes", run.atlas->keyframe_count()},
      {"landmarks", run.atlas->landmark_count()},
      {"vergence_deg", VergenceOf(*run.atlas, run.session) * 180.0 / std::numbers::pi},
      {"cpu_seconds", run.cpu_seconds},
      {"wall_seconds", run.wall_seconds},
      {"peak_rss_mib", run.peak_rss_mib},
      {"memory_mib", memory},
      {"forgotten", ForgottenCounters(run)},
      {"times_forgotten", run.uplink.forgotten},
      {"bytes_sent", run.uplink.bytes_sent},
      {"envelopes_sent", run.uplink.envelopes_sent},
      {"resends", run.uplink.resends},
      {"rejections", run.uplink.rejections},
      {"repairs", run.uplink.repairs},
      {"corrections", run.uplink.corrections},
      {"complete_corrections", run.uplink.complete_corrections},
      {"agreed", run.uplink.agreed},
      {"bytes_received", run.uplink.bytes_received},
      {"guest_keyframes", run.atlas->keyframe_count() - run.atlas->keyframe_count(run.session)},
      {"own_landmarks", run.atlas->landmark_count(run.session)},
      {"acknowledged", run.acknowledged},
      {"unconfirmed", run.unconfirmed ? run.unconfirmed->message : ""},
      {"digest", fmt::format("{:016x}", DigestOfSession(*run.atlas, run.session))},
      {"stages", stages},
  };
}

std::string SummaryOf(const AgentRun& run) {
  std::string text = fmt::format("{}: {} of {} frames tracked in {} map{}, {} dropped, {} skipped\n", run.name,
                                 run.flight.tracked, run.source.frames, run.atlas->Maps().size(),
                                 run.atlas->Maps().size() == 1 ? "" : "s", run.source.dropped, run.source.skipped);
  text +=
      fmt::format("  {} keyframes, {} landmarks; {:.1f} s wall, {:.1f} s CPU, {:.0f} MiB; {:.1f} MB sent{}{}\n",
                  run.atlas->keyframe_count(), run.atlas->landmark_count(), run.wall_seconds, run.cpu_seconds,
                  run.peak_rss_mib, 1e-6 * static_cast<double>(run.uplink.bytes_sent),
                  run.acknowledged ? ", all acknowledged" : "", run.uplink.agreed ? ", the same at the server" : "");
  if (run.unconfirmed) text += fmt::format("  NOT CONFIRMED by the server: {}\n", run.unconfirmed->message);
  text += fmt::format("  {:<28}{:>8}{:>10}{:>10}{:>10}\n", "stage", "count", "median ms", "mean ms", "p95 ms");
  for (const auto& [name, statistics] : run.stages) {
    text += fmt::format("  {:<28}{:>8}{:>10.2f}{:>10.2f}{:>10.2f}\n", name, statistics.count, statistics.median_ms,
                        statistics.mean_ms, statistics.p95_ms);
  }
  return text;
}

Status WriteOutputs(const AgentOptions& options, const AgentRun& run) {
  if (!options.trajectory.empty()) {
    std::size_t number = 1;
    for (const MapTrajectory& trajectory : MapTrajectories(run)) {
      if (auto status = WriteTrajectory(Numbered(options.trajectory, number++), trajectory); !status) return status;
    }
  }
  if (!options.live_trajectory.empty()) {
    if (auto status = WriteTrajectory(options.live_trajectory, run.flight.live_trajectory); !status) return status;
  }
  if (!options.report.empty()) return WriteReport(options.report, run);
  return {};
}

}  // namespace pangaea
