#include "cli/work_times.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

namespace pangaea {
namespace {

// One after the other, as a keyframe goes through them; kinds of later builds follow.
constexpr const char* kOrder[] = {"recognition", "comparison", "seam", "merge", "loop", "pose_graph", "global_bundle"};

struct Durations {
  std::vector<double> wall_ms;  // ascending, like the rest
  std::vector<double> cpu_ms;
};

std::size_t Rank(const std::string& kind) {
  return static_cast<std::size_t>(std::ranges::find(kOrder, kind) - std::begin(kOrder));
}

std::vector<std::pair<std::string, Durations>> ByKind(std::span<const WorkTime> times) {
  std::map<std::pair<std::size_t, std::string>, Durations> kinds;
  for (const WorkTime& time : times) {
    Durations& durations = kinds[{Rank(time.kind), time.kind}];
    durations.wall_ms.push_back(time.wall_ms);
    durations.cpu_ms.push_back(time.cpu_ms);
  }
  std::vector<std::pair<std::string, Durations>> result;
  for (auto& [key, durations] : kinds) {
    std::ranges::sort(durations.wall_ms);
    std::ranges::sort(durations.cpu_ms);
    result.emplace_back(key.second, std::move(durations));
  }
  return result;
}

// The smallest value that is not exceeded by this part of them.
double Quantile(const std::vector<double>& ascending, double part) {
  const double rank = std::ceil(part * static_cast<double>(ascending.size()));
  return ascending[static_cast<std::size_t>(std::max(rank, 1.0)) - 1];
}

constexpr double kMedian = 0.5;
constexpr double kHigh = 0.95;

}  // namespace

std::string FormatWorkTimes(std::span<const WorkTime> times) {
  if (times.empty()) return "";
  char line[160];
  std::snprintf(line, sizeof(line), "%-14s%8s%16s%10s%16s%10s\n", "server's work", "count", "wall ms median", "p95",
                "CPU ms median", "p95");
  std::string text = line;
  for (const auto& [kind, durations] : ByKind(times)) {
    std::snprintf(line, sizeof(line), "%-14s%8zu%16.1f%10.1f%16.1f%10.1f\n", kind.c_str(), durations.wall_ms.size(),
                  Quantile(durations.wall_ms, kMedian), Quantile(durations.wall_ms, kHigh),
                  Quantile(durations.cpu_ms, kMedian), Quantile(durations.cpu_ms, kHigh));
    text += line;
  }
  return text;
}

nlohmann::json WorkTimesJson(std::span<const WorkTime> times) {
  nlohmann::json json = nlohmann::json::object();
  for (const auto& [kind, durations] : ByKind(times)) {
    json[kind] = {{"count", durations.wall_ms.size()},
                  {"wall_median_ms", Quantile(durations.wall_ms, kMedian)},
                  {"wall_p95_ms", Quantile(durations.wall_ms, kHigh)},
                  {"cpu_median_ms", Quantile(durations.cpu_ms, kMedian)},
                  {"cpu_p95_ms", Quantile(durations.cpu_ms, kHigh)}};
  }
  return json;
}

}  // namespace pangaea
