#include "cli/single_runs.h"

#include <cmath>
#include <utility>

namespace pangaea {
namespace {

// Of a session that made several maps, the later ones are called "name, map 2".
std::string SessionName(const std::string& part) { return part.substr(0, part.find(", map ")); }

// The maps of one session together.
struct Sum {
  SingleRun run;
  double squares = 0.0;
  std::size_t poses = 0;
};

Result<std::map<std::string, Sum>> SumSessions(const StoredAtlas& stored, const AbsoluteErrorOptions& options) {
  const auto evaluations = EvaluateMaps(stored, options);
  if (!evaluations) return tl::make_unexpected(evaluations.error());
  std::map<std::string, Sum> sums;
  for (const MapEvaluation& evaluation : *evaluations) {
    for (const EvaluationReport::Row& row : evaluation.report.alone) {
      const SessionError& session = row.error.sessions.front();
      Sum& sum = sums[SessionName(session.name)];
      sum.run.keyframes += row.counts.keyframes.value_or(0);
      sum.run.landmarks += row.counts.landmarks.value_or(0);
      sum.squares += static_cast<double>(session.error.count) * session.error.rms * session.error.rms;
      sum.poses += session.error.count;
    }
  }
  return sums;
}

}  // namespace

Result<std::map<std::string, SingleRun>> ReadSingleRuns(const std::vector<std::string>& stores,
                                                        std::span<const Truth> truths,
                                                        const AbsoluteErrorOptions& options) {
  std::map<std::string, SingleRun> runs;
  for (const std::string& store : stores) {
    auto stored = ReadStoredAtlas(store);
    if (!stored) return tl::make_unexpected(stored.error());
    if (auto status = AttachTruths(truths, *stored); !status) return tl::make_unexpected(status.error());
    auto sums = SumSessions(*stored, options);
    if (!sums) return tl::make_unexpected(sums.error());
    for (auto& [name, sum] : *sums) {
      if (sum.poses > 0) sum.run.rms = std::sqrt(sum.squares / static_cast<double>(sum.poses));
      if (runs.emplace(name, sum.run).second) continue;
      return Fail(ErrorCode::kInvalidArgument, store + ": session '" + name + "' is in an earlier --single, too");
    }
  }
  return runs;
}

void CompareWithSingleRuns(const std::map<std::string, SingleRun>& runs, std::vector<MapEvaluation>& evaluations) {
  for (MapEvaluation& evaluation : evaluations) {
    for (EvaluationReport::Row& row : evaluation.report.alone) {
      const auto found = runs.find(row.error.sessions.front().name);
      if (found != runs.end()) row.single = found->second;
    }
  }
}

}  // namespace pangaea
