#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "agent/absorption/absorption.h"
#include "common/map/map_edit.h"

namespace pangaea {

// An absorption in the making: the atlas as it will be, and the edits that lead there.
class AbsorptionDraft {
 public:
  AbsorptionDraft(const Atlas& atlas, const AbsorptionInput& input) : input_(input), before_(atlas), atlas_(atlas) {}

  const Atlas& before() const { return before_; }  // the absorption
  const Atlas& atlas() const { return atlas_; }
  const AbsorptionInput& input() const { return input_; }
  // What the server had been told when it cut the pieces. Of pieces that are complete: all there is.
  const Atlas& told() const { return input_.complete ? before_ : input_.base; }
  bool IsOwn(KeyframeId id) const { return id.session == input_.session; }

  // False, and left out, where the edit does not fit.
  bool Emit(MapEdit edit);
  Absorption Take() && { return {std::move(edits_), std::move(atlas_)}; }

 private:
  const AbsorptionInput& input_;
  const Atlas before_;
  Atlas atlas_;
  std::vector<MapEdit> edits_;
};

// The steps, in their order. `host` is the agent's map that the piece is about; none where the session has no part in
// it yet.
MapId JoinMaps(const MapPiece& piece, AbsorptionDraft& draft);
void MoveToServersFrame(const MapPiece& piece, MapId host, AbsorptionDraft& draft);
void InsertKeyframes(const MapPiece& piece, MapId host, AbsorptionDraft& draft);
void AbsorbLandmarks(const MapPiece& piece, AbsorptionDraft& draft);
void RemoveCulled(const MapPiece& piece, AbsorptionDraft& draft);

// The entry of a piece for an id; nullptr where it is not listed.
const PieceKeyframe* FindIn(const MapPiece& piece, KeyframeId id);
const PieceLandmark* FindIn(const MapPiece& piece, LandmarkId id);
const GoneKeyframe* FindGone(const MapPiece& piece, KeyframeId id);

}  // namespace pangaea
