#include "agent/runtime/stage_clock.h"

#include <algorithm>
#include <numeric>

#include "common/base/check.h"

namespace pangaea {
namespace {

double Quantile(const std::vector<float>& ascending, double share) {
  const auto index = static_cast<std::size_t>(share * static_cast<double>(ascending.size() - 1) + 0.5);
  return ascending[index];
}

StageStatistics Summarise(std::vector<float> milliseconds) {
  std::sort(milliseconds.begin(), milliseconds.end());
  StageStatistics statistics;
  statistics.count = milliseconds.size();
  statistics.median_ms = Quantile(milliseconds, 0.5);
  statistics.p95_ms = Quantile(milliseconds, 0.95);
  statistics.mean_ms = std::accumulate(milliseconds.begin(), milliseconds.end(), 0.0) / double(milliseconds.size());
  return statistics;
}

}  // namespace

void StageClock::Begin(std::string_view name) { open_.push_back({name, Clock::now(), {}}); }

void StageClock::End(std::string_view name) {
  PANGAEA_CHECK(!open_.empty() && open_.back().name == name);
  const Open stage = open_.back();
  open_.pop_back();
  const Clock::duration elapsed = Clock::now() - stage.begin;
  const Clock::duration decoding = name == kDecode ? elapsed : stage.decoding;
  if (!open_.empty()) open_.back().decoding += decoding;
  const Clock::duration charged = name == kDecode ? elapsed : elapsed - stage.decoding;
  auto entry = milliseconds_.find(name);
  if (entry == milliseconds_.end()) entry = milliseconds_.emplace(name, std::vector<float>{}).first;
  entry->second.push_back(std::chrono::duration<float, std::milli>(charged).count());
}

void StageClock::Add(const StageClock& other) {
  for (const auto& [name, durations] : other.milliseconds_) {
    std::vector<float>& mine = milliseconds_[name];
    mine.insert(mine.end(), durations.begin(), durations.end());
  }
}

std::map<std::string, StageStatistics> StageClock::Statistics() const {
  std::map<std::string, StageStatistics> statistics;
  for (const auto& [name, durations] : milliseconds_) statistics.emplace(name, Summarise(durations));
  return statistics;
}

}  // namespace pangaea
