#include "common/mapping/landmark_visits.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "common/base/check.h"

namespace pangaea {
namespace {

// Per pose a number that counts the keyframes of its session; between sessions it jumps by more than `gap`.
std::vector<int> CountKeyframes(const std::vector<KeyframeId>& keyframes, int gap) {
  std::vector<std::size_t> ascending(keyframes.size());
  std::iota(ascending.begin(), ascending.end(), std::size_t{0});
  std::ranges::sort(ascending, {}, [&](std::size_t pose) { return keyframes[pose]; });
  std::vector<int> counts(keyframes.size());
  int count = 0;
  for (std::size_t i = 0; i < ascending.size(); ++i) {
    const bool same = i > 0 && keyframes[ascending[i]].session == keyframes[ascending[i - 1]].session;
    count += same ? 1 : gap + 1;
    counts[ascending[i]] = count;
  }
  return counts;
}

// Indices of a landmark's observations.
struct Visit {
  std::size_t begin = 0;
  std::size_t end = 0;
  int point = 0;
};

// Splits one landmark after the other.
class VisitSplitter {
 public:
  VisitSplitter(const WindowBundle& bundle, const VisitOptions& options)
      : bundle_(bundle), options_(options), counts_(CountKeyframes(bundle.keyframes, options.gap)) {
    problem_.cameras = bundle.problem.cameras;
    problem_.poses = bundle.problem.poses;
    problem_.points = bundle.problem.points;
    problem_.observations.reserve(bundle.problem.observations.size());
    for (const BundlePose& pose : problem_.poses) centers_.push_back(pose.camera_from_map.Inverse().translation());
  }

  BundleProblem Split() && {
    const auto& observations = bundle_.problem.observations;
    for (std::size_t begin = 0; begin < observations.size();) {
      std::size_t end = begin;
      while (end < observations.size() && observations[end].point == observations[begin].point) ++end;
      SplitLandmark(begin, end);
      begin = end;
    }
    return std::move(problem_);
  }

 private:
  const BundleObservation& At(std::size_t observation) const { return bundle_.problem.observations[observation]; }

  void SplitLandmark(std::size_t begin, std::size_t end) {
    const std::vector<Visit> visits = FindVisits(begin, end);
    for (std::size_t v = 0; v < visits.size(); ++v) {
      for (std::size_t i = visits[v].begin; i < visits[v].end; ++i) Observe(i, visits[v].point, 1.0);
    }
    if (visits.size() > 1) TieTogether(visits);
  }

  std::vector<Visit> FindVisits(std::size_t begin, std::size_t end) {
    std::vector<Visit> visits;
    for (std::size_t i = begin; i < end; ++i) {
      const auto count = [this](std::size_t at) { return counts_[static_cast<std::size_t>(At(at).pose)]; };
      if (i > begin && count(i) - count(i - 1) <= options_.gap) {
        ++visits.back().end;
        continue;
      }
      visits.push_back({i, i + 1, visits.empty() ? At(begin).point : AnotherPoint(At(begin).point)});
    }
    return visits;
  }

  int AnotherPoint(int like) {
    problem_.points.push_back(problem_.points[static_cast<std::size_t>(like)]);
    return static_cast<int>(problem_.points.size()) - 1;
  }

  void Observe(std::size_t observation, int point, double sigma_ratio) {
    BundleObservation seen = At(observation);
    seen.point = point;
    seen.inverse_sigma /= sigma_ratio;
    problem_.observations.push_back(seen);
  }

  void TieTogether(std::span<const Visit> visits) {
    const std::size_t begin = visits.front().begin;
    const Eigen::Vector3d& point = bundle_.problem.points[static_cast<std::size_t>(At(begin).point)].point_in_map;
    std::vector<Eigen::Vector3d> rays;
    for (std::size_t i = begin; i < visits.back().end; ++i) {
      rays.push_back((point - centers_[static_cast<std::size_t>(At(i).pose)]).normalized());
    }
    for (std::size_t v = 1; v < visits.size(); ++v) {
      double nearest = -std::numeric_limits<double>::infinity();
      std::size_t here = 0;
      std::size_t there = 0;
      const Visit* other = nullptr;
      for (const Visit& earlier : visits.first(v)) {
        for (std::size_t i = visits[v].begin; i < visits[v].end; ++i) {
          for (std::size_t j = earlier.begin; j < earlier.end; ++j) {
            const double cosine = rays[i - begin].dot(rays[j - begin]);
            if (cosine <= nearest) continue;
            nearest = cosine;
            here = i;
            there = j;
            other = &earlier;
          }
        }
      }
      if (other == nullptr) continue;  // numbers out of all bounds
      Observe(here, other->point, options_.sigma_ratio);
      Observe(there, visits[v].point, options_.sigma_ratio);
    }
  }

  const WindowBundle& bundle_;
  const VisitOptions& options_;
  const std::vector<int> counts_;
  std::vector<Eigen::Vector3d> centers_;  // of the cameras, in the map
  BundleProblem problem_;
};

}  // namespace

Status VisitOptions::Check() const {
  if (gap < 0 || gap > 1000000) return Fail(ErrorCode::kInvalidArgument, "visits.gap must be 0 to 1000000");
  if (sigma_ratio >= 1.0 && sigma_ratio <= 1000.0) return {};
  return Fail(ErrorCode::kInvalidArgument, "visits.sigma_ratio must be 1 to 1000");
}

BundleProblem SplitByVisits(const WindowBundle& bundle, const VisitOptions& options) {
  PANGAEA_CHECK(options.Check().has_value());
  return VisitSplitter(bundle, options).Split();
}

}  // namespace pangaea
