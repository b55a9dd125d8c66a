#include "cli/atlas_scene.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "cli/side_by_side.h"

namespace pangaea {
namespace {

// A trajectory is not drawn across a longer gap between two of its frames.
constexpr std::int64_t kLongestGap_ns = 1'500'000'000;

// What shares one frame, by the frame: the world common to recordings (0), a recording's own world, or a map's own.
using FrameKey = std::pair<int, std::size_t>;
FrameKey KeyOfTruth(std::span<const Truth> truths, std::size_t index) {
  return truths[index].shares_world ? FrameKey{0, 0} : FrameKey{1, index};
}
FrameKey KeyOfMap(std::size_t index) { return {2, index}; }

void AppendPieces(const std::vector<StampedPose>& poses, const Similarity3d& scene_from_map, PlotTrajectory& drawn) {
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (i == 0 || poses[i].stamp_ns - poses[i - 1].stamp_ns > kLongestGap_ns) drawn.pieces.emplace_back();
    drawn.pieces.back().push_back(scene_from_map * poses[i].world_from_body.translation());
  }
}

void SetTruth(const std::vector<StampedPose>& poses, PlotTrajectory& drawn) {
  drawn.truth.clear();
  for (const StampedPose& pose : poses) drawn.truth.push_back(pose.world_from_body.translation());
}

// Of two sets of poses together.
void AddError(const ErrorStatistics& error, ErrorStatistics& sum) {
  if (error.count == 0) return;
  const auto squares = [](const ErrorStatistics& e) { return static_cast<double>(e.count) * e.rms * e.rms; };
  const double total = squares(error) + squares(sum);
  sum.count += error.count;
  sum.rms = std::sqrt(total / static_cast<double>(sum.count));
}

// Cameras look ahead more than up or down: the mean of their upward directions.
Eigen::Vector3d UpOfCameras(const Atlas& atlas, MapId map) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  atlas.ForEachKeyframe([&](const Keyframe& keyframe) {
    if (keyframe.map == map) sum += keyframe.camera_from_map.rotation().conjugate() * Eigen::Vector3d(0.0, -1.0, 0.0);
  });
  return sum.norm() > 0.0 ? Eigen::Vector3d(sum.normalized()) : Eigen::Vector3d::UnitZ();
}

// The error of the part as it is drawn: under the alignment of its whole map.
const ErrorStatistics& DrawnError(const EvaluationReport& report, std::size_t row) {
  const SessionError& alone = report.alone[row].error.sessions.front();
  if (!report.joint || alone.error.count == 0) return alone.error;
  // The joint evaluation has the rows with an error alone, in the same order.
  const auto before = std::count_if(report.alone.begin(), report.alone.begin() + static_cast<std::ptrdiff_t>(row),
                                    [](const auto& other) { return other.error.error.count > 0; });
  return report.joint->sessions[static_cast<std::size_t>(before)].error;
}

// The sessions of one group, a session's parts together.
class Group {
 public:
  PlotTrajectory& Of(SessionId session, const std::string& name) {
    const auto [place, is_new] = places_.emplace(session, scene.trajectories.size());
    if (is_new) {
      scene.trajectories.emplace_back();
      scene.trajectories.back().name = name;
      errors_.emplace_back();
    }
    return scene.trajectories[place->second];
  }
  void AddErrorOf(SessionId session, const ErrorStatistics& error) {
    const std::size_t place = places_.at(session);
    AddError(error, errors_[place]);
    if (errors_[place].count > 0) scene.trajectories[place].rms_error = errors_[place].rms;
  }

  PlotScene scene;

 private:
  std::map<SessionId, std::size_t> places_;
  std::vector<ErrorStatistics> errors_;
};

void DrawKeyframes(const StoredAtlas& stored, const SessionPart& part, const Similarity3d& scene_from_map,
                   PlotTrajectory& drawn) {
  const auto record = std::ranges::find(stored.recovered.sessions, part.session,
                                        [](const SessionRecord& r) { return r.announcement.session; });
  const Eigen::Vector3d body_in_camera = record->announcement.body_from_camera.Inverse().translation();
  stored.atlas().ForEachKeyframe(part.session, [&](const Keyframe& keyframe) {
    if (keyframe.map != part.map) return;
    drawn.keyframes.push_back(scene_from_map * (keyframe.camera_from_map.Inverse() * body_in_camera));
  });
  drawn.keyframe_count = drawn.keyframes.size();
}

void DrawMap(const StoredAtlas& stored, const MapEvaluation& evaluation, Group& group) {
  const Similarity3d scene_from_map = evaluation.truth_from_map.value_or(Similarity3d());
  std::size_t row = 0;
  for (const SessionPart& part : stored.parts) {
    if (part.map != evaluation.map) continue;
    PlotTrajectory& drawn = group.Of(part.session, part.trajectory.name);
    AppendPieces(part.trajectory.estimate, scene_from_map, drawn);
    DrawKeyframes(stored, part, scene_from_map, drawn);
    if (evaluation.truth_from_map) SetTruth(part.trajectory.truth, drawn);
    group.AddErrorOf(part.session, DrawnError(evaluation.report, row++));
  }
  stored.atlas().ForEachLandmark([&](const Landmark& landmark) {
    if (stored.atlas().MapOf(landmark) == evaluation.map) {
      group.scene.landmarks.push_back(scene_from_map * landmark.point_in_map);
    }
  });
}

std::string Plural(std::size_t count, const std::string& word) {
  return std::to_string(count) + " " + word + (count == 1 ? "" : "s");
}

constexpr const char* kDot = "  \xC2\xB7  ";

PlotScene Join(std::map<FrameKey, Group> groups, const std::string& title, std::string subtitle) {
  std::vector<PlotScene> scenes;
  for (auto& [key, group] : groups) scenes.push_back(std::move(group.scene));
  if (scenes.size() > 1) subtitle += std::string(kDot) + "side by side: they share no frame";
  PlotScene scene = PlaceSideBySide(std::move(scenes));
  scene.title = title;
  scene.subtitle = subtitle;
  // By name, so that colours do not depend on who joined first.
  std::ranges::stable_sort(scene.trajectories, {}, &PlotTrajectory::name);
  return scene;
}

}  // namespace

PlotScene SceneOf(const StoredAtlas& stored, std::span<const MapEvaluation> evaluations,
                  std::span<const Truth> truths) {
  std::map<FrameKey, Group> groups;
  for (std::size_t i = 0; i < evaluations.size(); ++i) {
    const MapEvaluation& evaluation = evaluations[i];
    const auto known = std::ranges::find_if(stored.parts, [&](const SessionPart& part) {
      return part.map == evaluation.map && part.truth && !truths[*part.truth].poses.empty();
    });
    const bool is_aligned = evaluation.truth_from_map.has_value() && known != stored.parts.end();
    Group& group = groups[is_aligned ? KeyOfTruth(truths, *known->truth) : KeyOfMap(i)];
    group.scene.up = is_aligned ? truths[*known->truth].up : UpOfCameras(stored.atlas(), evaluation.map);
    DrawMap(stored, evaluation, group);
  }
  const std::string subtitle =
      Plural(stored.recovered.sessions.size(), "session") + " in " + Plural(stored.maps.size(), "map") + kDot +
      Plural(stored.atlas().keyframe_count(), "keyframe") + kDot + Plural(stored.atlas().landmark_count(), "landmark");
  return Join(std::move(groups), "Atlas of site " + stored.site, subtitle);
}

PlotScene SceneOf(std::span<const EvaluatedTrajectory> trajectories, std::span<const Truth> truths,
                  const EvaluationReport& report) {
  std::map<FrameKey, Group> groups;
  for (std::size_t i = 0; i < trajectories.size(); ++i) {
    Group& group = groups[KeyOfTruth(truths, i)];
    group.scene.up = truths[i].up;
    PlotTrajectory& drawn = group.Of(i, trajectories[i].name);
    AppendPieces(trajectories[i].estimate, report.alone[i].error.truth_from_estimate, drawn);
    SetTruth(trajectories[i].truth, drawn);
    group.AddErrorOf(i, report.alone[i].error.error);
  }
  return Join(std::move(groups), trajectories.size() == 1 ? "Trajectory" : "Trajectories",
              Plural(trajectories.size(), "session") + ", each aligned with the truth");
}

}  // namespace pangaea
