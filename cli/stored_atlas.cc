#include "cli/stored_atlas.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "common/map/trajectory.h"
#include "server/storage/store.h"

namespace pangaea {
namespace {

// Poses of a session that a truth has to cover to be taken for its own without being named so.
constexpr std::size_t kMinCommonPoses = 3;

std::string NameOf(const SessionRecord& record) {
  const SessionAnnouncement& announcement = record.announcement;
  return announcement.name.empty() ? ToString(announcement.session) : announcement.name;
}

std::vector<MapId> LargestFirst(const Atlas& atlas) {
  std::vector<MapId> maps = atlas.Maps();
  std::ranges::stable_sort(maps, std::ranges::greater(), [&](MapId id) { return atlas.FindMap(id)->keyframes; });
  return maps;
}

MapCounts CountOf(const Atlas& atlas, SessionId session, MapId map) {
  MapCounts counts{.maps = {}, .keyframes = 0, .landmarks = 0};
  atlas.ForEachKeyframe(session, [&](const Keyframe& keyframe) {
    if (keyframe.map == map) ++*counts.keyframes;
  });
  atlas.ForEachLandmark(session, [&](const Landmark& landmark) {
    if (atlas.MapOf(landmark) == map) ++*counts.landmarks;
  });
  return counts;
}

SessionPart PartOf(const Atlas& atlas, const SessionRecord& record, MapId map) {
  SessionPart part{.session = record.announcement.session, .map = map, .truth = {}, .trajectory = {}, .counts = {}};
  part.counts = CountOf(atlas, part.session, map);
  const Rigid3d camera_from_body = record.announcement.body_from_camera.Inverse();
  for (const TrajectoryPose& pose : SessionTrajectory(atlas, part.session, map)) {
    part.trajectory.estimate.push_back({pose.stamp_ns, pose.map_from_camera * camera_from_body});
  }
  return part;
}

bool HasTruthAt(const Truth& truth, std::int64_t stamp_ns) {
  return InterpolatePose(truth.poses, stamp_ns, AbsoluteErrorOptions{}).has_value();
}

std::size_t CommonPoses(const StoredAtlas& stored, SessionId session, const Truth& truth) {
  std::size_t common = 0;
  for (const SessionPart& part : stored.parts) {
    if (part.session != session) continue;
    common += static_cast<std::size_t>(std::ranges::count_if(
        part.trajectory.estimate, [&](const StampedPose& pose) { return HasTruthAt(truth, pose.stamp_ns); }));
  }
  return common;
}

// One that was killed before anything of it came has none.
bool HasPoses(const StoredAtlas& stored, SessionId session) {
  return std::ranges::any_of(stored.parts, [session](const SessionPart& part) { return part.session == session; });
}

Result<std::optional<std::size_t>> FindTruth(const StoredAtlas& stored, const SessionRecord& record,
                                             std::span<const Truth> truths) {
  const SessionId session = record.announcement.session;
  std::vector<std::size_t> fitting;
  for (std::size_t i = 0; i < truths.size(); ++i) {
    const std::size_t common = CommonPoses(stored, session, truths[i]);
    if (truths[i].name == NameOf(record)) {
      if (common > 0 || truths[i].poses.empty() || !HasPoses(stored, session)) return i;
      return Fail(ErrorCode::kInvalidArgument, "session '" + NameOf(record) +
                                                   "': at none of its times is there truth in " + truths[i].source +
                                                   "; is it another recording of that name?");
    }
    if (common >= kMinCommonPoses) fitting.push_back(i);
  }
  if (fitting.empty()) return std::nullopt;
  if (fitting.size() == 1) return fitting.front();
  return Fail(ErrorCode::kInvalidArgument,
              "session '" + NameOf(record) + "': " + truths[fitting[0]].source + " and " + truths[fitting[1]].source +
                  " both fit its times; say which with --truth " + NameOf(record) + "=DATASET");
}

void Attach(const Truth& truth, std::size_t index, SessionId session, StoredAtlas& stored) {
  for (SessionPart& part : stored.parts) {
    if (part.session != session) continue;
    part.truth = index;
    part.trajectory.truth = truth.poses;
    part.trajectory.dataset_frames = truth.frames;
  }
}

}  // namespace

Result<StoredAtlas> ReadStoredAtlas(const std::filesystem::path& path) {
  auto store = Store::OpenReadOnly(path);
  if (!store) return tl::make_unexpected(store.error());
  auto recovered = RecoverAtlas(*store);
  if (!recovered) return tl::make_unexpected(recovered.error());
  auto times = store->WorkTimes();
  if (!times) return tl::make_unexpected(times.error());
  StoredAtlas stored;
  stored.site = store->site();
  stored.recovered = std::move(*recovered);
  stored.work_times = std::move(*times);
  stored.maps = LargestFirst(stored.atlas());
  std::map<SessionId, int> parts;
  for (const MapId map : stored.maps) {
    for (const SessionRecord& record : stored.recovered.sessions) {
      SessionPart part = PartOf(stored.atlas(), record, map);
      if (part.trajectory.estimate.empty()) continue;
      const int number = ++parts[part.session];
      part.trajectory.name = NameOf(record) + (number == 1 ? "" : ", map " + std::to_string(number));
      stored.parts.push_back(std::move(part));
    }
  }
  return stored;
}

Status AttachTruths(std::span<const Truth> truths, StoredAtlas& stored) {
  std::set<std::size_t> used;
  for (const SessionRecord& record : stored.recovered.sessions) {
    const auto found = FindTruth(stored, record, truths);
    if (!found) return tl::make_unexpected(found.error());
    if (!*found) {
      stored.remarks.push_back("session '" + NameOf(record) + "': none of the truths given is its own");
      continue;
    }
    if (!HasPoses(stored, record.announcement.session)) {
      stored.remarks.push_back("session '" + NameOf(record) + "': nothing of it is in the store");
    }
    const Truth& truth = truths[**found];
    Attach(truth, **found, record.announcement.session, stored);
    if (truth.poses.empty() && used.insert(**found).second) {
      stored.remarks.push_back(truth.source + ": has no ground truth, so no error is known");
    }
    used.insert(**found);
  }
  for (std::size_t i = 0; i < truths.size(); ++i) {
    if (!used.contains(i)) stored.remarks.push_back(truths[i].source + ": belongs to no session of the store");
  }
  return {};
}

void EvaluateCameras(StoredAtlas& stored) {
  for (const SessionRecord& record : stored.recovered.sessions) {
    for (SessionPart& part : stored.parts) {
      if (part.session == record.announcement.session) {
        part.trajectory.body_from_evaluated = record.announcement.body_from_camera;
      }
    }
  }
}

}  // namespace pangaea
