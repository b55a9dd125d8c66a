#include "server/downlink/session_downlink.h"

#include <algorithm>
#include <set>
#include <utility>

#include "server/downlink/piece_changes.h"

namespace pangaea {

void SessionDownlink::Take(const MapInterest& interest) {
  interest_ = interest;
  if (!sent_ || interest.applied_version < sent_->version) return;
  confirmed_ = std::exchange(sent_, std::nullopt);
}

std::optional<AgentCorrection> SessionDownlink::Next(const SessionView& view) {
  if (!interest_ || sent_ || view.position <= sent_version_) return std::nullopt;
  const std::vector<KeyframeId> new_guests = NewGuests(view.atlas);
  if (new_guests.empty() && !IsConcerned(view)) return std::nullopt;
  AgentCorrection correction;
  correction.session = session_;
  correction.version = view.position;
  correction.acknowledged = view.acknowledged;
  for (const MapId map : ConcernedMaps(view.atlas)) {
    MapPiece piece = PieceOf(map, view, new_guests);
    if (!piece.empty()) correction.pieces.push_back(std::move(piece));
  }
  sent_ = Told{view.atlas, view.position, view.correction};
  sent_version_ = view.position;
  return correction;
}

// Whether the server changed anything of the session since it was last told.
bool SessionDownlink::IsConcerned(const SessionView& view) const {
  const std::uint64_t known = confirmed_ ? confirmed_->correction : interest_->applied_version;
  if (view.correction <= known) return false;
  bool corrected = false;
  view.atlas.ForEachKeyframe(session_,
                             [&](const Keyframe& keyframe) { corrected = corrected || keyframe.corrected_at > 0; });
  return corrected || !interest_->guests.empty();
}

std::vector<MapId> SessionDownlink::ConcernedMaps(const Atlas& atlas) const {
  std::set<MapId> maps;
  atlas.ForEachKeyframe(session_, [&](const Keyframe& keyframe) { maps.insert(keyframe.map); });
  for (const KeyframeId id : interest_->guests) {
    if (const Keyframe* guest = atlas.FindKeyframe(id)) maps.insert(guest->map);
  }
  if (const Keyframe* near = atlas.FindKeyframe(atlas.Resolve(interest_->reference))) maps.insert(near->map);
  return {maps.begin(), maps.end()};
}

std::vector<KeyframeId> SessionDownlink::NewGuests(const Atlas& atlas) const {
  std::vector<KeyframeId> guests = ChooseGuests(atlas, interest_->reference, session_, options_);
  std::erase_if(guests, [this](KeyframeId id) { return std::ranges::binary_search(interest_->guests, id); });
  if (guests.size() > options_.new_at_once) guests.resize(options_.new_at_once);
  return guests;
}

// All keyframes of the session in the map, what it holds of others, and what is new to it. A keyframe without its
// features is 60 bytes: which of them the agent knows in which state is not worth finding out.
MapPiece SessionDownlink::PieceOf(MapId map, const SessionView& view, const std::vector<KeyframeId>& new_guests) const {
  const Atlas& atlas = view.atlas;
  const KnownState known = confirmed_ ? KnownState{&confirmed_->atlas, confirmed_->version}
                                      : KnownState{nullptr, interest_->applied_version};
  PieceSelection selection;
  selection.map = map;
  const auto is_here = [&](KeyframeId id) {
    const Keyframe* keyframe = atlas.FindKeyframe(id);
    return keyframe != nullptr && keyframe->map == map;
  };
  atlas.ForEachKeyframe(session_, [&](const Keyframe& keyframe) {
    if (keyframe.map == map) selection.keyframes.push_back(keyframe.id);
  });
  std::ranges::copy_if(interest_->guests, std::back_inserter(selection.keyframes), is_here);
  selection.held.insert(selection.keyframes.begin(), selection.keyframes.end());
  std::ranges::copy_if(new_guests, std::back_inserter(selection.keyframes), is_here);
  selection.landmarks = ChangedLandmarks(atlas, known, selection.keyframes, {new_guests.begin(), new_guests.end()});
  selection.former_landmarks = FormerLandmarks(atlas, known, session_);
  selection.culled = GoneKeyframes(atlas, known, session_, interest_->guests);
  return CutPiece(atlas, selection);
}

}  // namespace pangaea
