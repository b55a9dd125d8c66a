#include "server/atlas/welding_agenda.h"

#include <algorithm>

namespace pangaea {
namespace {

std::uint32_t SharedLandmarks(const Keyframe& a, KeyframeId b) {
  const auto found = std::ranges::lower_bound(a.covisible, b, {}, &Covisibility::keyframe);
  return found != a.covisible.end() && found->keyframe == b ? found->weight : 0;
}

}  // namespace

Status WeldingAgendaOptions::Check() const {
  if (capacity >= 1) return {};
  return Fail(ErrorCode::kInvalidArgument, "capacity is 0; at least 1 is needed");
}

void WeldingAgenda::Add(PlaceMatch match) {
  matches_.push_back(std::move(match));
  if (matches_.size() <= options_.capacity) return;
  // What is a loop can change until its turn comes; two ends of one session are one for sure.
  const auto loop = std::ranges::find_if(
      matches_, [](const PlaceMatch& waiting) { return waiting.query.session == waiting.candidate.session; });
  matches_.erase(loop == matches_.end() ? matches_.begin() : loop);
  ++dropped_;
}

std::optional<PlaceMatch> WeldingAgenda::Next(const Atlas& atlas, const std::function<bool(MapId)>& waits) {
  dropped_ += std::erase_if(matches_, [&](const auto& match) { return SenseOf(match, atlas) == Sense::kNone; });
  const auto is_merge = [&](const PlaceMatch& match) { return SenseOf(match, atlas) == Sense::kMerge; };
  const auto may_go = [&](const PlaceMatch& match) {
    return !waits(atlas.FindKeyframe(atlas.Resolve(match.query))->map);
  };
  auto next = std::ranges::find_if(matches_, is_merge);
  if (next == matches_.end()) next = std::ranges::find_if(matches_, may_go);
  if (next == matches_.end()) return std::nullopt;
  PlaceMatch match = std::move(*next);
  matches_.erase(next);
  return match;
}

WeldingAgenda::Sense WeldingAgenda::SenseOf(const PlaceMatch& match, const Atlas& atlas) const {
  const Keyframe* query = atlas.FindKeyframe(atlas.Resolve(match.query));
  const Keyframe* candidate = atlas.FindKeyframe(atlas.Resolve(match.candidate));
  if (query == nullptr || candidate == nullptr || query->id == candidate->id) return Sense::kNone;
  if (query->map != candidate->map) {
    return AreSeparated(query->map, candidate->map, atlas) ? Sense::kNone : Sense::kMerge;
  }
  return SharedLandmarks(*query, candidate->id) >= options_.joined_landmarks ? Sense::kNone : Sense::kLoop;
}

bool WeldingAgenda::AreSeparated(MapId a, MapId b, const Atlas& atlas) const {
  return std::ranges::any_of(separations_, [&](const auto& separation) {
    const MapId first = atlas.Resolve(separation.first);
    const MapId second = atlas.Resolve(separation.second);
    return (first == a && second == b) || (first == b && second == a);
  });
}

}  // namespace pangaea
