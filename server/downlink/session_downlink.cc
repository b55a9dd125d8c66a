#include "server/downlink/session_downlink.h"

#include <algorithm>
#include <set>
#include <utility>

#include "common/map/digest.h"
#include "common/map/forgetting.h"

namespace pangaea {

namespace {

// A version is the position of the journal and a count of the corrections that were cut there: an agent may be told of
// guests while nothing is journaled.
constexpr std::uint64_t kMostAtOnePosition = 1024;
std::uint64_t PositionOf(std::uint64_t version) { return version / kMostAtOnePosition; }

// So many answers to wrong claims in a row tell what changed; further ones tell everything.
constexpr int kMostPartialAnswers = 3;

}  // namespace

void SessionDownlink::Take(const MapInterest& interest) {
  const bool moved = interest_ && interest_->reference != interest.reference;
  interest_ = interest;
  given_.insert(interest.guests.begin(), interest.guests.end());
  if (sent_ && interest.applied_version >= sent_->version) Confirm();
  if (!moved) return;
  not_wanted_.clear();
  if (place_told_) place_ = {};
}

void SessionDownlink::Confirm() {
  confirmed_ = std::exchange(sent_, std::nullopt);
  place_told_ = place_told_ || confirmed_->place == place_;
  for (const KeyframeId id : confirmed_->new_guests) {
    if (!Holds(id)) not_wanted_.insert(id);
  }
}

void SessionDownlink::Show(KeyframeId place) {
  place_ = place;
  place_told_ = false;
  not_wanted_.clear();
}

// Nothing where there are too many at one position.
std::optional<std::uint64_t> SessionDownlink::NextVersion(std::uint64_t position) const {
  // After a restart of the server the agent may have applied what is not remembered here.
  const std::uint64_t newest = std::max(sent_version_, interest_->applied_version);
  const std::uint64_t version = std::max(position * kMostAtOnePosition, newest + 1);
  return PositionOf(version) == position ? std::optional(version) : std::nullopt;
}

std::optional<AgentCorrection> SessionDownlink::Next(const SessionView& view) {
  if (!interest_ || sent_) return std::nullopt;
  const auto version = NextVersion(view.position);
  if (!version) return std::nullopt;
  const std::vector<KeyframeId> new_guests = NewGuests(view.atlas);
  place_told_ = place_told_ || new_guests.empty();  // it holds what is there
  AgentCorrection correction;
  int answers = 0;
  if (new_guests.empty() && !IsConcerned(view)) {
    if (!IsClaimDue(view)) return std::nullopt;
    if (IsClaimTrue(view.atlas)) agreed_claim_ = interest_->claim.number;
    if (agreed_claim_ == interest_->claim.number) return std::nullopt;
    // Other agents go on changing what both see: some answers may come too late for that alone.
    const int before = confirmed_ ? confirmed_->answers : 0;
    answers = before + 1;
    correction.complete = before >= kMostPartialAnswers || (before > 0 && confirmed_->position == view.position);
  }
  correction.session = session_;
  correction.version = *version;
  correction.acknowledged = view.acknowledged;
  for (const MapId map : ConcernedMaps(view.atlas)) {
    MapPiece piece = PieceOf(map, view.atlas, new_guests, correction.pieces.empty(), correction.complete);
    if (!piece.empty()) correction.pieces.push_back(std::move(piece));
  }
  sent_ = Told{view.atlas, *version, view.position, view.correction, new_guests, place_, answers};
  sent_version_ = *version;
  return correction;
}

// Whether the server changed anything of the session since it was last told.
bool SessionDownlink::IsConcerned(const SessionView& view) const {
  const std::uint64_t known = confirmed_ ? confirmed_->correction : PositionOf(interest_->applied_version);
  if (view.correction <= known) return false;
  bool corrected = false;
  view.atlas.ForEachKeyframe(session_,
                             [&](const Keyframe& keyframe) { corrected = corrected || keyframe.corrected_at > 0; });
  return corrected || !interest_->guests.empty();
}

bool SessionDownlink::IsClaimDue(const SessionView& view) const {
  return interest_->claim.number > agreed_claim_ && interest_->claim.sequence == view.acknowledged;
}

bool SessionDownlink::IsClaimTrue(const Atlas& atlas) const {
  std::set<KeyframeId> forgotten;
  atlas.ForEachKeyframe(session_, [&](const Keyframe& keyframe) {
    if (!Holds(keyframe.id)) forgotten.insert(keyframe.id);
  });
  return DigestOfSession(atlas, session_, forgotten) == interest_->claim.digest;
}

std::vector<MapId> SessionDownlink::ConcernedMaps(const Atlas& atlas) const {
  std::set<MapId> maps;
  atlas.ForEachKeyframe(session_, [&](const Keyframe& keyframe) { maps.insert(keyframe.map); });
  for (const auto* ids : {&interest_->guests, &interest_->wanted}) {
    for (const KeyframeId id : *ids) {
      if (const Keyframe* guest = atlas.FindKeyframe(id)) maps.insert(guest->map);
    }
  }
  if (const Keyframe* near = atlas.FindKeyframe(atlas.Resolve(interest_->reference))) maps.insert(near->map);
  if (const Keyframe* place = atlas.FindKeyframe(atlas.Resolve(place_))) maps.insert(place->map);
  return {maps.begin(), maps.end()};
}

bool SessionDownlink::Holds(KeyframeId id) const {
  if (id.session != session_) return std::ranges::binary_search(interest_->guests, id);
  const std::vector<KeyframeId>& held = interest_->held;
  return held.empty() || id > held.back() || std::ranges::binary_search(held, id);
}

// What the agent asks back, then what is around its camera.
std::vector<KeyframeId> SessionDownlink::NewGuests(const Atlas& atlas) const {
  const bool is_found = place_.valid();
  std::vector<KeyframeId> guests = interest_->wanted;
  // Where a lost camera was found it needs what it has forgotten, too. Else it asks back what it was given once.
  const SessionId others = is_found ? SessionId{0} : session_;
  for (const KeyframeId id : ChooseGuests(atlas, is_found ? place_ : interest_->reference, others, options_)) {
    const bool known = !is_found && given_.contains(id);
    if (!known && std::ranges::find(guests, id) == guests.end()) guests.push_back(id);
  }
  std::erase_if(guests, [&](KeyframeId id) {
    const Keyframe* keyframe = atlas.FindKeyframe(id);
    return Holds(id) || not_wanted_.contains(id) || keyframe == nullptr || IsForgotten(*keyframe);
  });
  // What it wants back it will look at before long.
  const bool urgent = is_found || !interest_->wanted.empty();
  guests.resize(std::min(guests.size(), urgent ? options_.found_at_once : options_.new_at_once));
  return guests;
}

bool SessionDownlink::HasPartIn(const Atlas& atlas, MapId map) const {
  bool found = false;
  atlas.ForEachKeyframe(session_, [&](const Keyframe& keyframe) { found = found || keyframe.map == map; });
  return found;
}

// Whether an undo took the guest's map apart from the session's since it was last told.
bool SessionDownlink::WasSeparated(const Atlas& atlas, KeyframeId guest) const {
  const Keyframe* before = confirmed_ ? confirmed_->atlas.FindKeyframe(guest) : nullptr;
  const Keyframe* now = atlas.FindKeyframe(guest);
  return before != nullptr && now != nullptr && HasPartIn(confirmed_->atlas, before->map) &&
         !HasPartIn(atlas, now->map);
}

KnownState SessionDownlink::Known(bool complete) const {
  if (complete) return {nullptr, 0};
  if (confirmed_) return {&confirmed_->atlas, confirmed_->position};
  return {nullptr, PositionOf(interest_->applied_version)};
}

// All keyframes of the session in the map, what it holds of others, and what is new to it. A keyframe without its
// features is 60 bytes: which of them the agent knows in which state is not worth finding out. Of what it has forgotten
// it needs to know no more than where it is.
MapPiece SessionDownlink::PieceOf(MapId map, const Atlas& atlas, const std::vector<KeyframeId>& new_guests,
                                  bool is_first, bool complete) const {
  const KnownState known = Known(complete);
  PieceSelection selection;
  selection.map = map;
  const auto is_here = [&](KeyframeId id) {
    const Keyframe* keyframe = atlas.FindKeyframe(id);
    return keyframe != nullptr && keyframe->map == map && !WasSeparated(atlas, id);
  };
  atlas.ForEachKeyframe(session_, [&](const Keyframe& keyframe) {
    if (keyframe.map == map) selection.keyframes.push_back(keyframe.id);
  });
  std::ranges::copy_if(interest_->guests, std::back_inserter(selection.keyframes), is_here);
  selection.held.insert(selection.keyframes.begin(), selection.keyframes.end());
  std::ranges::copy_if(new_guests, std::back_inserter(selection.keyframes), is_here);
  const std::set<KeyframeId> fresh(new_guests.begin(), new_guests.end());
  for (const KeyframeId id : fresh) selection.held.erase(id);
  std::vector<KeyframeId> seen_from = selection.keyframes;
  std::erase_if(seen_from, [&](KeyframeId id) { return !fresh.contains(id) && !Holds(id); });
  const std::set<KeyframeId> all_of = complete ? std::set(seen_from.begin(), seen_from.end()) : fresh;
  selection.landmarks = ChangedLandmarks(atlas, known, seen_from, all_of);
  selection.former_landmarks = FormerLandmarks(atlas, known, session_);
  // What is gone without a trace is of no map: one piece tells it.
  if (!is_first) std::erase_if(selection.former_landmarks, [&](LandmarkId id) { return !atlas.Resolve(id).valid(); });
  std::ranges::copy_if(selection.landmarks, std::back_inserter(selection.released_landmarks),
                       [&](LandmarkId id) { return atlas.MapOf(*atlas.FindLandmark(id)) != map; });
  selection.culled = GoneKeyframes(atlas, known, session_, interest_->guests);
  if (HasPartIn(atlas, map)) {
    std::ranges::copy_if(interest_->guests, std::back_inserter(selection.released),
                         [&](KeyframeId id) { return WasSeparated(atlas, id); });
  }
  return CutPiece(atlas, selection);
}

}  // namespace pangaea
