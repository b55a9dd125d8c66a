#include "agent/runtime/agent_options.h"

#include <cmath>
#include <sstream>

#include "common/base/config.h"
#include "common/lcm/url.h"

namespace pangaea {

namespace {

// Before the run and not after it.
Status CheckFolderOf(const char* option, const std::filesystem::path& file) {
  std::error_code ignored;
  if (!file.has_parent_path() || std::filesystem::is_directory(file.parent_path(), ignored)) return {};
  return Fail(ErrorCode::kInvalidArgument,
              std::string(option) + " is " + file.string() + "; there is no folder " + file.parent_path().string());
}

void ReadTracking(ConfigReader& reader, TrackingOptions& tracking) {
  reader.Read("tracking.min_inliers", &tracking.min_inliers, Range{6, 1000});
  reader.Read("tracking.min_agreement", &tracking.min_agreement, Range{0.0, 1.0});
  reader.Read("tracking.min_recovery_inliers", &tracking.min_recovery_inliers, Range{6, 1000});
  reader.Read("tracking.min_start_points", &tracking.min_start_points, Range{20, 5000});
  reader.Read("tracking.frames_for_hint", &tracking.frames_for_hint, Range{0, 100000});
  reader.Read("tracking.frames_until_new_map", &tracking.frames_until_new_map, Range{1, 100000});
  reader.Read("tracking.max_position_sigma_m", &tracking.observability.max_sigma_m, Range{0.0001, 1000.0});
  reader.Read("tracking.max_position_sigma_of_depth", &tracking.observability.max_sigma_of_depth, Range{0.0001, 1.0});
  reader.Read("tracking.max_templates", &tracking.max_templates, Range{1000, 1000000});
  reader.Read("tracking.max_landmarks", &tracking.search.max_landmarks, Range{20, 5000});
  reader.Read("tracking.patch_sigma", &tracking.search.patch_sigma, Range{0.05, 10.0});
  reader.Read("tracking.local_keyframes", &tracking.local_map.max_keyframes, Range{1, 1000});
}

void ReadKeyframes(ConfigReader& reader, KeyframeDecisionOptions& keyframes) {
  reader.Read("keyframes.min_coverage_ratio", &keyframes.min_coverage_ratio, Range{0.1, 1.0});
  reader.Read("keyframes.min_inlier_ratio", &keyframes.min_inlier_ratio, Range{0.1, 1.0});
  reader.Read("keyframes.max_relative_distance", &keyframes.max_relative_distance, Range{0.01, 10.0});
  reader.Read("keyframes.max_turn", &keyframes.max_turn, Range{1.0, 180.0});
  reader.Read("keyframes.min_gap", &keyframes.min_gap, Range{1, 1000});
}

void ReadMonocular(ConfigReader& reader, TrackingOptions& tracking) {
  MonocularStartOptions& start = tracking.monocular_start;
  reader.Read("monocular.min_parallax", &start.two_view.min_parallax, Range{0.1, 20.0});
  reader.Read("monocular.min_points", &start.two_view.min_points, Range{20, 5000});
  reader.Read("monocular.confirmations", &start.confirmations, Range{1, 100});
  reader.Read("monocular.features", &tracking.monocular_features, Range{100, 10000});
  KeyframeDecisionOptions& keyframes = tracking.monocular_keyframes;
  reader.Read("monocular.min_coverage_ratio", &keyframes.min_coverage_ratio, Range{0.1, 1.0});
  reader.Read("monocular.min_inlier_ratio", &keyframes.min_inlier_ratio, Range{0.1, 1.0});
  reader.Read("monocular.max_relative_distance", &keyframes.max_relative_distance, Range{0.01, 10.0});
}

void ReadFeatures(ConfigReader& reader, OrbOptions& orb) {
  reader.Read("features.count", &orb.features, Range{100, 10000});
  reader.Read("features.high_threshold", &orb.high_threshold, Range{1, 255});
  reader.Read("features.low_threshold", &orb.low_threshold, Range{1, 255});
}

void ReadMapping(ConfigReader& reader, LocalMappingOptions& mapping) {
  reader.Read("mapping.window_keyframes", &mapping.bundle_adjustment.window_keyframes, Range{2, 60});
  reader.Read("mapping.fixed_keyframes", &mapping.bundle_adjustment.fixed_keyframes, Range{1, 500});
  reader.Read("mapping.iterations", &mapping.bundle_adjustment.iterations, Range{1, 100});
  reader.Read("mapping.max_strain", &mapping.wide_adjustment.max_strain, Range{0.0, 1.0});
  reader.Read("mapping.wide_keyframes", &mapping.wide_adjustment.bundle_adjustment.window_keyframes, Range{60, 5000});
  reader.Read("mapping.min_vergence_shift", &mapping.vergence.min_shift, Range{0.0, 100.0});
  reader.Read("mapping.pixel_sigma", &mapping.noise.pixel_sigma, Range{0.05, 10.0});
  reader.Read("mapping.max_depth_baselines", &mapping.noise.max_depth_baselines, Range{1.0, 10000.0});
  reader.Read("mapping.search_radius", &mapping.search.radius, Range{0.5, 100.0});
  reader.Read("mapping.redundant_ratio", &mapping.keyframe_culling.redundant_ratio, Range{0.1, 1.0});
}

// In seconds, as every patience of the file.
void ReadPatience(ConfigReader& reader, const char* key, std::chrono::milliseconds& patience) {
  double seconds = std::chrono::duration<double>(patience).count();
  reader.Read(key, &seconds, Range{0.0, 86400.0});
  patience = std::chrono::milliseconds(std::llround(1000.0 * seconds));
}

void ReadUplink(ConfigReader& reader, AgentOptions& options) {
  reader.Read("uplink.queue_batches", &options.uplink.queue_batches, Range{1, 10000});
  reader.Read("uplink.min_observations", &options.uplink.edits.planner.min_observations, Range{1, 1000});
  reader.Read("uplink.envelope_bytes", &options.uplink.edits.envelope_bytes, Range{1000, 1000000});
  ReadPatience(reader, "uplink.patience_s", options.flush_patience);
  ReadPatience(reader, "corrections.patience_s", options.correction_patience);
  reader.Read("corrections.deterministic_frames", &options.frames_between_corrections, Range{1, 1000000});
}

void ReadMemory(ConfigReader& reader, KeptKeyframesOptions& memory) {
  reader.Read("memory.max_keyframes", &memory.most, Range{0, 1000000});
  reader.Read("memory.kept_keyframes", &memory.left, Range{5, 1000000});
  memory = KeptKeyframesOptions::Of(memory.most, memory.left);
}

void ReadLcm(ConfigReader& reader, LcmChannels& lcm) {
  reader.Read("lcm.images", &lcm.images);
  reader.Read("lcm.right_images", &lcm.right_images);
  reader.Read("lcm.calibration", &lcm.calibration);
  reader.Read("lcm.pose", &lcm.pose);
  reader.Read("lcm.tracking_state", &lcm.tracking_state);
  reader.Read("lcm.statistics", &lcm.statistics);
}

}  // namespace

Status AgentOptions::CheckInput() const {
  const int inputs = int{!dataset.empty()} + int{!video.empty()} + int{!lcm_input.empty()};
  if (inputs != 1) {
    return Fail(ErrorCode::kInvalidArgument,
                std::to_string(inputs) + " inputs are given; allowed: exactly one of --dataset, --video, --lcm");
  }
  if (!video.empty() && calibration.empty()) {
    return Fail(ErrorCode::kInvalidArgument, "--video needs --calibration: a YAML file that describes the camera");
  }
  for (const std::string* url : {&lcm_input, &lcm_output}) {
    if (url->empty()) continue;
    if (auto parsed = LcmUrl::Parse(*url); !parsed) return tl::make_unexpected(parsed.error());
  }
  return {};
}

Status AgentOptions::Check() const {
  if (!(rate.speed == 0.0 || (rate.speed >= 0.01 && rate.speed <= 100.0))) {
    std::ostringstream message;
    message << "--rate is " << rate.speed << "; allowed: realtime, max, or a factor of 0.01 to 100";
    return Fail(ErrorCode::kInvalidArgument, message.str());
  }
  if (auto status = CheckSiteName(site); !status) return status;
  if (auto status = domain.Check(); !status) return status;
  if (auto status = CheckFolderOf("--trajectory", trajectory); !status) return status;
  if (auto status = CheckFolderOf("--live-trajectory", live_trajectory); !status) return status;
  if (auto status = CheckFolderOf("--report", report); !status) return status;
  if (auto status = tracking.Check(); !status) return status;
  if (auto status = mapping.Check(); !status) return status;
  if (auto status = lcm.Check(); !status) return status;
  return uplink.Check();
}

Status ReadAgentConfig(const std::filesystem::path& path, AgentOptions& options) {
  auto reader = ConfigReader::Open(path);
  if (!reader) return tl::make_unexpected(reader.error());
  ReadTracking(*reader, options.tracking);
  ReadKeyframes(*reader, options.tracking.keyframes);
  ReadMonocular(*reader, options.tracking);
  ReadFeatures(*reader, options.tracking.orb);
  ReadMapping(*reader, options.mapping);
  ReadUplink(*reader, options);
  ReadMemory(*reader, options.uplink.memory);
  ReadLcm(*reader, options.lcm);
  if (auto status = reader->Finish(); !status) return status;
  return options.Check();
}

}  // namespace pangaea
