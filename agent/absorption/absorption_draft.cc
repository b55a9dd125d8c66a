#include "agent/absorption/absorption_draft.h"

#include <algorithm>

namespace pangaea {
namespace {

template <typename Entry, typename Id>
const Entry* FindEntry(const std::vector<Entry>& entries, Id id) {
  const auto found = std::lower_bound(entries.begin(), entries.end(), id,
                                      [](const Entry& entry, Id other) { return entry.id < other; });
  return found == entries.end() || found->id != id ? nullptr : &*found;
}

}  // namespace

bool AbsorptionDraft::Emit(MapEdit edit) {
  if (!Apply(edit, atlas_)) return false;
  edits_.push_back(std::move(edit));
  return true;
}

const PieceKeyframe* FindIn(const MapPiece& piece, KeyframeId id) { return FindEntry(piece.keyframes, id); }
const GoneKeyframe* FindGone(const MapPiece& piece, KeyframeId id) { return FindEntry(piece.culled, id); }
const PieceLandmark* FindIn(const MapPiece& piece, LandmarkId id) { return FindEntry(piece.landmarks, id); }

}  // namespace pangaea
