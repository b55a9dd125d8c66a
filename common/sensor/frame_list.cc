#include "common/sensor/frame_list.h"

#include <algorithm>
#include <cstdlib>

namespace pangaea {
namespace {

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

// Positions of a longest strictly increasing subsequence, by patience sorting: O(n log n).
std::vector<std::size_t> LongestIncreasing(const std::vector<std::int64_t>& stamps) {
  std::vector<std::size_t> tails;  // tails[k]: where the best subsequence of k + 1 items ends
  std::vector<std::size_t> before(stamps.size(), kNone);
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    const auto place = std::ranges::lower_bound(tails, stamps[i], {}, [&](std::size_t tail) { return stamps[tail]; });
    if (place != tails.begin()) before[i] = *(place - 1);
    if (place == tails.end()) {
      tails.push_back(i);
    } else {
      *place = i;
    }
  }
  std::vector<std::size_t> kept;
  for (std::size_t i = tails.empty() ? kNone : tails.back(); i != kNone; i = before[i]) kept.push_back(i);
  std::ranges::reverse(kept);
  return kept;
}

template <typename T>
std::vector<T> Keep(std::vector<T> items, const std::string& where, std::vector<std::string>& warnings) {
  std::vector<std::int64_t> stamps;
  for (const T& item : items) stamps.push_back(item.stamp_ns);
  const std::vector<std::size_t> kept = LongestIncreasing(stamps);
  if (kept.size() == items.size()) return items;
  warnings.push_back(where + ": " + std::to_string(items.size() - kept.size()) + " of " + std::to_string(items.size()) +
                     " rows are out of order by time and were skipped");
  std::vector<T> ascending;
  for (const std::size_t i : kept) ascending.push_back(std::move(items[i]));
  return ascending;
}

}  // namespace

std::vector<StampedFile> KeepAscending(std::vector<StampedFile> items, const std::string& where,
                                       std::vector<std::string>& warnings) {
  return Keep(std::move(items), where, warnings);
}

std::vector<StampedPose> KeepAscending(std::vector<StampedPose> items, const std::string& where,
                                       std::vector<std::string>& warnings) {
  return Keep(std::move(items), where, warnings);
}

std::vector<DatasetFrame> PairByStamp(const std::vector<StampedFile>& left, const std::vector<StampedFile>& right,
                                      std::int64_t tolerance_ns, std::vector<std::string>& warnings) {
  std::vector<DatasetFrame> frames;
  auto candidate = right.begin();
  for (const StampedFile& image : left) {
    const auto distance = [&](const StampedFile& other) { return std::abs(other.stamp_ns - image.stamp_ns); };
    while (candidate != right.end() && candidate->stamp_ns < image.stamp_ns - tolerance_ns) ++candidate;
    if (candidate == right.end()) break;
    while (candidate + 1 != right.end() && distance(candidate[1]) < distance(*candidate)) ++candidate;
    if (distance(*candidate) > tolerance_ns) continue;
    frames.push_back({image.stamp_ns, image.path, candidate->path});
    if (++candidate == right.end()) break;
  }
  const std::size_t alone = left.size() + right.size() - 2 * frames.size();
  if (alone > 0) {
    warnings.push_back(std::to_string(alone) +
                       " images have no partner of the same time in the other camera and were " + "skipped (" +
                       std::to_string(left.size()) + " left, " + std::to_string(right.size()) + " right, " +
                       std::to_string(frames.size()) + " pairs)");
  }
  return frames;
}

}  // namespace pangaea
