#include "server/runtime/work_options.h"

#include <string>

namespace pangaea {

Status WorkOptions::Check() const {
  if (auto status = lookup.Check(); !status) return status;
  if (auto status = place.Check(); !status) return status;
  if (auto status = frames.Check(); !status) return status;
  if (auto status = comparison.Check(); !status) return status;
  if (auto status = comparisons.Check(); !status) return status;
  if (auto status = agenda.Check(); !status) return status;
  if (auto status = fusion.Check(); !status) return status;
  if (auto status = pose_graph.Check(); !status) return status;
  if (auto status = optimization.Check(); !status) return status;
  if (auto status = map.Check(); !status) return status;
  if (auto status = economy.Check(); !status) return status;
  if (auto status = in_use.Check(); !status) return status;
  return redundancy.Check();
}

void ReadWork(ConfigReader& reader, WorkOptions& options) {
  reader.Read("recognition.enabled", &options.enabled);
  std::string vocabulary = options.vocabulary.string();
  reader.Read("recognition.vocabulary", &vocabulary);
  options.vocabulary = vocabulary;
  reader.Read("recognition.recent", &options.lookup.recent, Range{1, 1000});
  reader.Read("recognition.places", &options.place.candidates.places, Range{1, 100});
  reader.Read("recognition.min_inliers", &options.place.geometry.min_inliers, Range{10, 1000});
  reader.Read("recognition.agreeing_keyframes", &options.place.agreement.keyframes, Range{1, 10});
  reader.Read("recognition.compare_maps", &options.compare_maps);
  reader.Read("recognition.min_common_surface", &options.comparison.min_surface_share, Range{0.1, 1.0});
  reader.Read("relocalization.candidates", &options.frames.query.candidates, Range{1, 100});
  reader.Read("relocalization.min_inliers", &options.frames.min_inliers, Range{6, 1000});
  reader.Read("fusion.queue_matches", &options.agenda.capacity, Range{1, 10'000});
  reader.Read("fusion.window_keyframes", &options.fusion.window.keyframes, Range{2, 200});
  reader.Read("fusion.min_common_landmarks", &options.fusion.judgement.min_common_landmarks, Range{10, 1000});
  reader.Read("fusion.max_cost_growth", &options.fusion.judgement.max_cost_growth, Range{1.0, 100.0});
  reader.Read("optimization.growth", &options.optimization.growth, Range{0.01, 10.0});
  reader.Read("optimization.max_seconds", &options.map.bundle.max_seconds, Range{0.0, 86'400.0});
  reader.Read("optimization.threads", &options.map.bundle.threads, Range{1, 256});
  reader.Read("economy.enabled", &options.economy.enabled);
  reader.Read("economy.max_descriptor_bits", &options.economy.fusion.search.max_distance, Range{0, 256});
  reader.Read("economy.landmarks_per_keyframe", &options.economy.thinning.kept, Range{20, 100'000});
  reader.Read("economy.max_observers", &options.economy.thinning.max_observers, Range{0, 1000});
  reader.Read("economy.newest_in_use", &options.in_use.newest, Range{1, 100'000});
  reader.Read("economy.around_newest", &options.in_use.around, Range{0, 100'000});
  std::size_t mebibytes = options.max_bytes >> 20U;
  reader.Read("redundancy.max_mib", &mebibytes, Range{0, 1 << 30});
  options.max_bytes = mebibytes << 20U;
  reader.Read("redundancy.share", &options.redundancy.redundant_share, Range{0.1, 1.0});
  reader.Read("redundancy.other_observers", &options.redundancy.other_observers, Range{1, 100});
  reader.Read("optimization.patience", &options.optimization.patience, Range{1, 100});
}

}  // namespace pangaea
