#pragma once

#include "common/map/atlas.h"
#include "common/wire/envelope.h"

namespace pangaea {

// What the server truly has of this session: the envelopes it acknowledged and did not reject, in order, by its own
// rule: an envelope counts whole or not at all.
class ConfirmedAtlas {
 public:
  // False where it does not fit: then the server cannot have taken it either, and nothing is changed. Keyframes that
  // `mirror` has too share their payload with it.
  bool Take(const Envelope& envelope, const Atlas& mirror);
  // The server has exactly this.
  void Set(const Atlas& atlas) { atlas_ = atlas; }

  const Atlas& atlas() const { return atlas_; }

 private:
  Atlas atlas_;
};

}  // namespace pangaea
