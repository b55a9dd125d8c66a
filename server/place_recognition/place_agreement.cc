#include "server/place_recognition/place_agreement.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include "common/map/covisibility.h"
#include "server/place_recognition/guided_matching.h"
#include "server/place_recognition/place_view.h"

namespace pangaea {
namespace {

// A camera at an assumed pose in the candidate's map.
struct AssumedPose {
  Similarity3d map_from_camera;
  Eigen::Vector3d axis_in_map;
};

// The keyframes that look most nearly the same way from most nearly the same position, best first.
std::vector<KeyframeId> Lookalikes(const Atlas& atlas, std::span<const KeyframeId> window, const AssumedPose& pose,
                                   const PlaceAgreementOptions& options) {
  const double min_cosine = std::cos(options.max_axis_angle * std::numbers::pi / 180.0);
  std::vector<std::pair<double, KeyframeId>> ranked;
  for (const KeyframeId id : window) {
    const Rigid3d map_from_camera = atlas.FindKeyframe(id)->camera_from_map.Inverse();
    const double cosine = pose.axis_in_map.dot(map_from_camera.rotation() * Eigen::Vector3d::UnitZ());
    if (cosine < min_cosine) continue;
    const double distance = (map_from_camera.translation() - pose.map_from_camera.translation()).norm();
    ranked.emplace_back(distance * (2.0 - cosine), id);
  }
  const std::size_t count = std::min(options.lookalikes, ranked.size());
  std::ranges::partial_sort(ranked, ranked.begin() + static_cast<std::ptrdiff_t>(count));
  std::vector<KeyframeId> best;
  for (std::size_t i = 0; i < count; ++i) best.push_back(ranked[i].second);
  return best;
}

PlaceVote VoteOf(const PlaceWitness& witness, const PlaceAgreementOptions& options) {
  const double expected = static_cast<double>(witness.expected_cells);
  const double confirmed = static_cast<double>(witness.confirmed_cells);
  if (witness.found >= options.min_matches && confirmed >= options.min_cell_share * expected) return PlaceVote::kYes;
  const bool enough = witness.expected_cells >= options.min_cells;
  return enough && confirmed < options.contradicting_cell_share * expected ? PlaceVote::kNo : PlaceVote::kNothing;
}

PlaceWitness Ask(const Atlas& atlas, const KeyframeData& asked, std::span<const KeyframeId> window,
                 const Similarity3d& map_from_asked, const PlaceRecognitionOptions& options) {
  PlaceWitness witness;
  const AssumedPose pose{map_from_asked, map_from_asked.rotation() * Eigen::Vector3d::UnitZ()};
  const std::vector<KeyframeId> lookalikes = Lookalikes(atlas, window, pose, options.agreement);
  if (lookalikes.empty()) return witness;
  const PlaceView place = MakePlaceView(atlas, lookalikes);
  const Similarity3d map_from_center(atlas.FindKeyframe(lookalikes.front())->camera_from_map.Inverse());
  const FeatureGrid grid(asked.features.keypoints);
  const GuidedSearch search = SearchInImage(place, asked, grid, pose.map_from_camera.Inverse() * map_from_center,
                                            options.agreement.radius, options.geometry);
  witness.visible = search.visible;
  witness.found = search.matches.size();
  witness.expected_cells = search.expected_cells;
  witness.confirmed_cells = search.confirmed_cells;
  witness.vote = VoteOf(witness, options.agreement);
  return witness;
}

}  // namespace

std::vector<PlaceWitness> AskSurroundings(const Atlas& atlas, const Keyframe& query, const Keyframe& candidate,
                                          const Similarity3d& candidate_from_query,
                                          const PlaceRecognitionOptions& options) {
  const std::vector<KeyframeId> window = GrowWindow(atlas, candidate.id, options.agreement.window);
  const Similarity3d map_from_query = Similarity3d(candidate.camera_from_map.Inverse()) * candidate_from_query;
  std::vector<KeyframeId> around = {query.id};
  for (const Covisibility& edge : CovisibleKeyframes(atlas, query.id)) {
    if (around.size() > options.agreement.covisible) break;
    around.push_back(edge.keyframe);
  }
  std::vector<PlaceWitness> witnesses;
  for (const KeyframeId id : around) {
    const Keyframe& asked = *atlas.FindKeyframe(id);
    const Rigid3d query_from_asked = query.camera_from_map * asked.camera_from_map.Inverse();
    const Similarity3d map_from_asked = map_from_query * Similarity3d(query_from_asked);
    witnesses.push_back(Ask(atlas, *asked.data, window, map_from_asked, options));
    witnesses.back().keyframe = id;
  }
  return witnesses;
}

PlaceWitness AskFrame(const Atlas& atlas, const KeyframeData& frame, const Keyframe& candidate,
                      const Rigid3d& camera_from_map, const PlaceRecognitionOptions& options) {
  const std::vector<KeyframeId> window = GrowWindow(atlas, candidate.id, options.agreement.window);
  return Ask(atlas, frame, window, Similarity3d(camera_from_map.Inverse()), options);
}

}  // namespace pangaea
