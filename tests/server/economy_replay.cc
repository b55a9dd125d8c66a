// What the server's economy makes of a recorded store, step by step, with sizes, errors and CPU time after each:
//   economy_replay atlas.db STEP... -- NAME=DATASET...
// Steps: weld[:SEARCHED:KEYFRAMES] (look up every keyframe, weld what is recognised, with such windows), optimize
// (duplicates along the map, global bundle adjustment), economize (what a map needs no longer), grow (all of that for
// one session after the other), forget (the next looks are at everything), seen:STORE (they are at what has changed
// since that store), fuse:RADIUS:DISTANCE:RATIO (duplicates alone), thin:KEPT:KEPT_IN_CELL:MAX_OBSERVERS (weak
// landmarks), cull (redundant keyframes), count (by how many keyframes landmarks are seen).
#include <cstdio>
#include <ctime>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "cli/evaluation.h"
#include "cli/stored_atlas.h"
#include "common/base/blas_threads.h"
#include "common/map/covisibility.h"
#include "common/map/map_edit.h"
#include "common/map/trajectory.h"
#include "common/place/vocabulary_file.h"
#include "server/atlas/map_economy.h"
#include "server/atlas/map_optimization.h"
#include "server/atlas/optimization_agenda.h"
#include "server/atlas/welding_agenda.h"
#include "server/fusion/landmark_thinning.h"
#include "server/fusion/redundancy.h"
#include "server/ingest/ingest_round.h"
#include "server/optimization/pose_graph.h"
#include "server/place_recognition/place_recognizer.h"

namespace pangaea {
namespace {

double CpuSeconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

class Replay {
 public:
  explicit Replay(StoredAtlas stored) : stored_(std::move(stored)) {}

  void Report(const std::string& step, double seconds) {
    for (SessionPart& part : stored_.parts) {
      part.trajectory.estimate.clear();
      const Rigid3d camera_from_body = BodyFromCamera(part.session).Inverse();
      for (const TrajectoryPose& pose : SessionTrajectory(stored_.atlas(), part.session, part.map)) {
        part.trajectory.estimate.push_back({pose.stamp_ns, pose.map_from_camera * camera_from_body});
      }
    }
    std::printf("%-24s %5.2f s CPU, %4zu keyframes, %5zu landmarks", step.c_str(), seconds,
                stored_.atlas().keyframe_count(), stored_.atlas().landmark_count());
    const auto maps = EvaluateMaps(stored_, {});
    if (!maps) {
      std::printf(" %s\n", maps.error().message.c_str());
      return;
    }
    for (const MapEvaluation& map : *maps) {
      std::printf("; ATE");
      for (const auto& row : map.report.alone) {
        std::printf(" %.4f", row.error.error.rms);
      }
      if (map.report.joint) std::printf(" joint %.4f", map.report.joint->error.rms);
    }
    std::printf("\n");
  }

  void Do(const std::string& step) {
    const double begin = CpuSeconds();
    if (step == "count") Count();
    if (step == "optimize") Optimize();
    if (step == "grow") Grow();
    if (step.starts_with("seen:")) TakeAsSeen(step.substr(5));
    if (step == "forget") looked_at_ = economized_ = {};
    if (step == "cull") Cull();
    if (step == "economize") Economize();
    if (step.starts_with("weld")) Weld(step);
    if (step.starts_with("thin:")) Thin(step);
    if (step.starts_with("fuse:")) FuseAll(step);
    Report(step, CpuSeconds() - begin);
  }

 private:
  Rigid3d BodyFromCamera(SessionId session) const {
    for (const SessionRecord& record : stored_.recovered.sessions) {
      if (record.announcement.session == session) return record.announcement.body_from_camera;
    }
    return {};
  }

  Atlas& atlas() { return stored_.recovered.atlas; }

  void Take(const std::vector<MapEdit>& edits) {
    for (const MapEdit& edit : edits) {
      if (!Apply(edit, atlas())) std::printf("an edit does not fit\n");
    }
  }

  // As the atlas thread does, but for the commit.
  void Carry(std::function<Status(ServerDraft&)> make) {
    IngestState before;
    before.atlas = std::move(atlas());
    before.position = position_;
    IngestRound round(before, {}, 0);
    round.Take(EditsProposed{{"replay"}, std::move(make)});
    before = {};
    IngestOutcome outcome = std::move(round).Finish({});
    if (!outcome.answers.front()) std::printf("  %s\n", outcome.answers.front().error().message.c_str());
    position_ = outcome.state.position;
    atlas() = std::move(outcome.state.atlas);
  }

  // What an earlier look saw is left out; what leaving out nothing would have cost is measured beside it.
  MapFusion LookIn(MapId map, const MapFusionOptions& options, LookedAtMap& before) {
    const double begin = CpuSeconds();
    const MapFusion whole = FuseDuplicates(atlas(), map, options, LookedAtMap(), {});
    const double looked = CpuSeconds();
    MapFusion fusion = FuseDuplicates(atlas(), map, options, before, {});
    std::printf(
        "  look at everything: %zu fused, %zu added, %zu looks, %.2f s; at what changed: %zu, %zu, %zu, %.2f s\n",
        whole.fused, whole.added, whole.looks, looked - begin, fusion.fused, fusion.added, fusion.looks,
        CpuSeconds() - looked);
    before = *fusion.looked_at;
    return fusion;
  }

  void TakeAsSeen(const std::string& store) {
    const auto earlier = ReadStoredAtlas(store);
    if (!earlier) return (void)std::printf("%s\n", earlier.error().message.c_str());
    for (const MapId map : earlier->atlas().Maps()) {
      looked_at_[map] = economized_[map] = LookedAtMap::Of(earlier->atlas(), map);
    }
  }

  void Optimize() {
    for (const MapId map : atlas().Maps()) {
      if (growing_ && !IsWelded(atlas(), map)) continue;
      // As OptimizeMap, with a clock.
      const MapOptimizationOptions options;
      const double begin = CpuSeconds();
      const MapFusion fusion = LookIn(map, options.fusion, looked_at_[map]);
      const double fused = CpuSeconds();
      const auto bundle = AdjustMap(fusion.after, map, options.bundle, {});
      const double adjusted = CpuSeconds();
      if (!bundle) continue;
      Carry([&](ServerDraft& draft) {
        return OptimizationEdits({fusion.edits, {fusion.correction, bundle->correction}, bundle->removals}, draft);
      });
      std::printf(
          "  %zu duplicates in %.2f s, bundle adjustment of %zu observations (%zu outliers) in %.2f s, edits in %.2f "
          "s\n",
          fusion.fused, fused - begin, bundle->observations, bundle->outliers, adjusted - fused,
          CpuSeconds() - adjusted);
    }
  }

  void FuseAll(const std::string& step) {
    MapFusionOptions options;
    double radius = 4;
    std::sscanf(step.c_str(), "fuse:%lf:%d:%lf", &radius, &options.search.max_distance, &options.search.max_ratio);
    options.search.radius = options.search.old_radius = options.search.fusion_gate = radius;
    for (const MapId map : atlas().Maps()) {
      const MapFusion fusion = FuseDuplicates(atlas(), map, options, LookedAtMap(), {});
      std::printf("  fused %zu, observations added %zu\n", fusion.fused, fusion.added);
      OptimizedMap optimized;
      optimized.joins = fusion.edits;
      optimized.corrections.push_back(fusion.correction);
      Carry([&](ServerDraft& draft) { return OptimizationEdits(optimized, draft); });
    }
  }

  // As the server would: each keyframe is looked up, what is found is welded at once.
  void Weld(const std::string& step) {
    FusionOptions fusion;
    std::sscanf(step.c_str(), "weld:%zu:%zu", &fusion.window.searched, &fusion.window.keyframes);
    PlaceRecognizer recognizer(vocabulary_, {});
    std::vector<KeyframeId> ids;
    atlas().ForEachKeyframe([&](const Keyframe& keyframe) { ids.push_back(keyframe.id); });
    WeldAll(ids, recognizer, fusion);
  }

  // One session after the other, each looked up, welded, and its map adjusted and made smaller.
  void Grow() {
    growing_ = true;
    PlaceRecognizer recognizer(vocabulary_, {});
    for (const SessionId session : atlas().Sessions()) {
      std::vector<KeyframeId> ids;
      atlas().ForEachKeyframe(session, [&](const Keyframe& keyframe) { ids.push_back(keyframe.id); });
      WeldAll(ids, recognizer, {});
      for (const char* step : {"optimize", "economize", "optimize"}) Do(step);
    }
    growing_ = false;
  }

  void WeldAll(const std::vector<KeyframeId>& ids, PlaceRecognizer& recognizer, const FusionOptions& fusion) {
    WeldingAgenda agenda({}, {});
    NoStageRecorder stages;
    for (const KeyframeId id : ids) {
      for (PlaceMatch& match : recognizer.Recognize(atlas(), id, stages).matches) agenda.Add(std::move(match));
      while (auto match = agenda.Next(atlas(), [](MapId) { return false; })) {
        const double begin = CpuSeconds();
        const auto plan = PlanWelding(atlas(), *match, fusion, {});
        const double planned = CpuSeconds();
        if (!plan) {
          std::printf("  %5.0f ms %s\n", 1e3 * (planned - begin), Describe(plan.error()).c_str());
          continue;
        }
        if (plan->is_merge()) Carry([&](ServerDraft& draft) { return WeldingEdits(*plan, std::nullopt, draft); });
        const double carried = CpuSeconds();
        auto spread =
            OptimizePoseGraph(plan->correction.base, plan->after_seam, plan->map, plan->held, PoseGraphOptions(), {});
        const double spread_out = CpuSeconds();
        Carry([&](ServerDraft& draft) {
          return plan->is_merge() ? OptimizationEdits({{}, {spread->correction}, {}}, draft)
                                  : WeldingEdits(*plan, spread->correction, draft);
        });
        std::printf(
            "  plan %3.0f ms, edits of a merge %3.0f ms, pose graph %3.0f ms (%.2g to %.2g), edits %3.0f ms: %s\n",
            1e3 * (planned - begin), 1e3 * (carried - planned), 1e3 * (spread_out - carried), spread->initial_cost,
            spread->final_cost, 1e3 * (CpuSeconds() - spread_out), Describe(*plan).c_str());
      }
    }
    for (SessionPart& part : stored_.parts) part.map = atlas().Resolve(part.map);
    stored_.maps = atlas().Maps();
  }

  void Economize() {
    for (const MapId map : atlas().Maps()) {
      if (growing_ && !IsWelded(atlas(), map)) continue;
      LookedAtMap before = economized_[map];
      (void)LookIn(map, EconomyOptions().fusion, before);
      const double begin = CpuSeconds();
      const auto economy = EconomizeMap(atlas(), map, {}, {}, {}, economized_[map], {});
      economized_[map] = std::move(before);
      const double planned = CpuSeconds();
      Carry([&](ServerDraft& draft) { return OptimizationEdits(economy->changes, draft); });
      std::printf("  %s; in %.2f s, edits in %.2f s\n", Describe(*economy).c_str(), planned - begin,
                  CpuSeconds() - planned);
    }
  }

  void Thin(const std::string& step) {
    ThinningOptions options;
    std::sscanf(step.c_str(), "thin:%zu:%zu:%zu", &options.kept, &options.kept_in_cell, &options.max_observers);
    for (const MapId map : atlas().Maps()) Take(PlanThinning(atlas(), map, {}, options, {}));
  }

  void Cull() { Take(PlanCulling(atlas(), {}, {}, {})); }

  void Count() {
    std::map<std::size_t, std::size_t> of_observers;
    std::size_t of_many_sessions = 0;
    std::size_t observations = 0;
    atlas().ForEachLandmark([&](const Landmark& landmark) {
      ++of_observers[std::min<std::size_t>(landmark.observations.size(), 12)];
      observations += landmark.observations.size();
      std::set<SessionId> sessions;
      for (const Observation& observation : landmark.observations) sessions.insert(observation.keyframe.session);
      of_many_sessions += sessions.size() > 1 ? 1 : 0;
    });
    std::printf("  observers:");
    for (const auto& [count, landmarks] : of_observers) std::printf(" %zu:%zu", count, landmarks);
    std::printf("; %zu observations, %zu landmarks of several sessions\n", observations, of_many_sessions);
  }

  StoredAtlas stored_;
  std::uint64_t position_ = 1;
  std::shared_ptr<const VocabularyTree> vocabulary_ = OpenVocabulary().value();
  LookMemory looked_at_;
  LookMemory economized_;
  bool growing_ = false;
};

}  // namespace
}  // namespace pangaea

int main(int argc, char** argv) {
  pangaea::UseOneBlasThread();
  std::vector<std::string> steps;
  std::vector<std::string> datasets;
  bool after = false;
  for (int i = 2; i < argc; ++i) {
    if (std::string(argv[i]) == "--") {
      after = true;
    } else {
      (after ? datasets : steps).emplace_back(argv[i]);
    }
  }
  if (argc < 2) {
    std::fprintf(stderr, "economy_replay STORE STEP... -- NAME=DATASET...\n");
    return 2;
  }
  auto stored = pangaea::ReadStoredAtlas(argv[1]);
  if (!stored) {
    std::fprintf(stderr, "%s\n", stored.error().message.c_str());
    return 1;
  }
  const auto truths = pangaea::ReadTruths(datasets);
  if (!truths) {
    std::fprintf(stderr, "%s\n", truths.error().message.c_str());
    return 1;
  }
  if (auto status = pangaea::AttachTruths(*truths, *stored); !status) {
    std::fprintf(stderr, "%s\n", status.error().message.c_str());
    return 1;
  }
  pangaea::Replay replay(std::move(*stored));
  replay.Report("stored", 0);
  for (const auto& step : steps) replay.Do(step);
  return 0;
}
