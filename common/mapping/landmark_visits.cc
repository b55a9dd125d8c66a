#include "common/mapping/landmark_visits.h"

#include <algorithm>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "common/base/check.h"
#include "common/base/range_check.h"

namespace pangaea {
namespace {

// Of one session: the indices of observations of one landmark.
struct Visit {
  std::size_t begin = 0;
  std::size_t end = 0;
  int point = 0;
};

// Splits one landmark after the other.
class VisitSplitter {
 public:
  VisitSplitter(const WindowBundle& bundle, const VisitOptions& options) : bundle_(bundle), options_(options) {
    split_.problem.cameras = bundle.problem.cameras;
    split_.problem.poses = bundle.problem.poses;
    split_.problem.points = bundle.problem.points;
    split_.problem.observations.reserve(bundle.problem.observations.size());
    split_.observations.resize(bundle.problem.observations.size());
    split_.longest_visit.resize(bundle.landmarks.size(), -1);
    for (const BundlePose& pose : bundle.problem.poses)
      centers_.push_back(pose.camera_from_map.Inverse().translation());
  }

  VisitBundle Split() && {
    const auto& observations = bundle_.problem.observations;
    for (std::size_t begin = 0; begin < observations.size();) {
      std::size_t end = begin;
      while (end < observations.size() && observations[end].point == observations[begin].point) ++end;
      SplitLandmark(begin, end);
      begin = end;
    }
    return std::move(split_);
  }

 private:
  const BundleObservation& At(std::size_t observation) const { return bundle_.problem.observations[observation]; }
  const BundlePoint& PointOf(std::size_t observation) const {
    return bundle_.problem.points[static_cast<std::size_t>(At(observation).point)];
  }
  KeyframeId Observer(std::size_t observation) const {
    return bundle_.keyframes[static_cast<std::size_t>(At(observation).pose)];
  }

  void SplitLandmark(std::size_t begin, std::size_t end) {
    std::vector<Visit> visits = FindVisits(begin, end);
    for (std::size_t v = 0; v < visits.size(); ++v) {
      if (v > 0) visits[v].point = AnotherPoint(begin);
      for (std::size_t i = visits[v].begin; i < visits[v].end; ++i) {
        split_.observations[i] = split_.problem.observations.size();
        Observe(i, visits[v].point, 1.0);
      }
    }
    if (visits.size() == 1) return;
    const auto length = [](const Visit& visit) { return visit.end - visit.begin; };
    split_.longest_visit[static_cast<std::size_t>(At(begin).point)] = std::ranges::max(visits, {}, length).point;
    TieTogether(visits);
  }

  // One where the landmark is fixed.
  std::vector<Visit> FindVisits(std::size_t begin, std::size_t end) const {
    std::vector<Visit> visits = {{begin, begin + 1, At(begin).point}};
    for (std::size_t i = begin + 1; i < end; ++i) {
      if (PointOf(begin).fixed || GoesOn(Observer(i - 1), Observer(i))) {
        ++visits.back().end;
      } else {
        visits.push_back({i, i + 1, At(begin).point});
      }
    }
    return visits;
  }

  // Observers ascend.
  bool GoesOn(KeyframeId before, KeyframeId after) const {
    return after.session == before.session && after.counter - before.counter < options_.gap;
  }

  // A free one, in the same place.
  int AnotherPoint(std::size_t observation) {
    split_.problem.points.push_back({PointOf(observation).point_in_map});
    return static_cast<int>(split_.problem.points.size()) - 1;
  }

  void Observe(std::size_t observation, int point, double sigma_ratio) {
    BundleObservation seen = At(observation);
    seen.point = point;
    seen.inverse_sigma /= sigma_ratio;
    split_.problem.observations.push_back(seen);
  }

  void Tie(std::size_t observation, int point) { Observe(observation, point, options_.sigma_ratio); }

  void TieTogether(std::span<const Visit> visits) {
    const std::vector<Eigen::Vector3d> rays = RaysTo(visits.front().begin, visits.back().end);
    for (std::size_t v = 1; v < visits.size(); ++v) {
      const auto tie = NearestViews(visits[v], visits.first(v), rays);
      if (!tie) continue;  // numbers out of all bounds
      Tie(tie->here, tie->other_point);
      Tie(tie->there, visits[v].point);
    }
  }

  // In which direction each of the observations sees their landmark, in the map.
  std::vector<Eigen::Vector3d> RaysTo(std::size_t begin, std::size_t end) const {
    std::vector<Eigen::Vector3d> rays;
    for (std::size_t i = begin; i < end; ++i) {
      rays.push_back((PointOf(i).point_in_map - centers_[static_cast<std::size_t>(At(i).pose)]).normalized());
    }
    return rays;
  }

  // The two observations that see the landmark from most nearly the same direction.
  struct Nearest {
    std::size_t here = 0;   // of the visit
    std::size_t there = 0;  // of one of the earlier ones …
    int other_point = 0;    // … whose point this is
  };
  static std::optional<Nearest> NearestViews(const Visit& visit, std::span<const Visit> earlier,
                                             std::span<const Eigen::Vector3d> rays) {
    const std::size_t begin = earlier.front().begin;
    std::optional<Nearest> nearest;
    double greatest_cosine = -2.0;
    for (const Visit& other : earlier) {
      for (std::size_t i = visit.begin; i < visit.end; ++i) {
        for (std::size_t j = other.begin; j < other.end; ++j) {
          const double cosine = rays[i - begin].dot(rays[j - begin]);
          if (!(cosine > greatest_cosine)) continue;
          greatest_cosine = cosine;
          nearest = Nearest{i, j, other.point};
        }
      }
    }
    return nearest;
  }

  const WindowBundle& bundle_;
  const VisitOptions& options_;
  std::vector<Eigen::Vector3d> centers_;  // of the cameras, in the map
  VisitBundle split_;
};

// The landmarks of several visits and all that was seen of them, with the poses held where they came to lie.
struct Placing {
  BundleProblem problem;
  std::vector<std::size_t> observations;  // which of the bundle's
};

Placing PlacingOf(const WindowBundle& bundle, const VisitBundle& split, const BundleResult& moved) {
  Placing placing;
  placing.problem = {bundle.problem.cameras, bundle.problem.poses, bundle.problem.points, {}};
  StartFrom(moved, placing.problem);
  for (BundlePose& pose : placing.problem.poses) pose.fixed = true;
  // From the visit that knows most of the depth: another one may be a single view.
  for (std::size_t i = 0; i < placing.problem.points.size(); ++i) {
    if (split.longest_visit[i] < 0) continue;
    const Eigen::Vector3d& point = moved.points[static_cast<std::size_t>(split.longest_visit[i])];
    if (IsWithinBounds(point)) placing.problem.points[i].point_in_map = point;
  }
  for (std::size_t i = 0; i < bundle.problem.observations.size(); ++i) {
    const BundleObservation& observation = bundle.problem.observations[i];
    if (split.longest_visit[static_cast<std::size_t>(observation.point)] < 0) continue;
    placing.problem.observations.push_back(observation);
    placing.observations.push_back(i);
  }
  return placing;
}

}  // namespace

Status VisitOptions::Check() const {
  RangeCheck check("landmark visits");
  check.In("gap", gap, 1, 1000000).In("sigma_ratio", sigma_ratio, 1, 1000);
  return check.status();
}

VisitBundle SplitByVisits(const WindowBundle& bundle, const VisitOptions& options) {
  PANGAEA_CHECK(options.Check().has_value());
  return VisitSplitter(bundle, options).Split();
}

Result<BundleResult> SolveByVisits(const WindowBundle& bundle, const VisitOptions& options,
                                   const BundleOptions& solver) {
  const VisitBundle split = SplitByVisits(bundle, options);
  auto result = SolveBundle(split.problem, solver);
  if (!result) return result;
  const Placing placing = PlacingOf(bundle, split, *result);
  result->points.resize(bundle.landmarks.size());
  std::vector<std::uint8_t> outliers;
  for (const std::size_t observation : split.observations) outliers.push_back(result->outliers[observation]);
  result->outliers = std::move(outliers);
  if (placing.observations.empty()) return result;

  BundleOptions held = solver;
  held.solver = BundleSolver::kLocal;  // no pose is free: there is nothing to factor
  held.out_of_time = {};
  held.stop = {};
  auto placed = SolveBundle(placing.problem, held);
  if (!placed) return placed;
  for (std::size_t i = 0; i < bundle.landmarks.size(); ++i) {
    if (split.longest_visit[i] >= 0) result->points[i] = placed->points[i];
  }
  for (std::size_t i = 0; i < placing.observations.size(); ++i) {
    result->outliers[placing.observations[i]] = placed->outliers[i];
  }
  return result;
}

}  // namespace pangaea
