#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "agent/tracking/template_store.h"
#include "common/features/patch_pyramid.h"
#include "common/map/atlas.h"
#include "common/map/edits/reference_scale.h"

namespace pangaea {

// The newest keyframes of a session: those on their way into the map, and those whose images are still of use. A value
// without a thread.
class RecentKeyframes {
 public:
  // Of all that wait no more than `most` are kept: each holds an image.
  explicit RecentKeyframes(std::size_t most) : most_(most) {}

  // `image` is copied. `reference` is none for the first one of a map; `scale` is the reference's.
  void Add(KeyframeId id, const ImagePyramid& image, KeyframeId reference, const Rigid3d& camera_from_reference,
           ReferenceScale scale);
  void Clear() { keyframes_.clear(); }

  // Whether the newest one is not in the map yet.
  bool IsOneUnderWay(const Atlas& atlas) const;
  // The newest one as it lives in the map, where it was tracked against `reference`; none where it was not, or is under
  // way.
  KeyframeId NewestTrackedAgainst(KeyframeId reference, const Atlas& atlas) const;
  // camera_from_map of those that are not in the map yet, as far as it is known.
  std::vector<Rigid3d> PosesUnderWay(const Atlas& atlas) const;
  // Cuts templates of what is in the map by now; see HarvestTemplates.
  void Harvest(const Atlas& atlas, double new_view_angle, TemplateStore& templates) const;

  // The newest one of `session` that belongs into `map`, in it by now or not.
  struct Place {
    KeyframeId id;
    Rigid3d camera_from_map;
    std::optional<ReferenceScale> scale;  // none: it is on its way
  };
  std::optional<Place> NewestIn(MapId map, SessionId session, const Atlas& atlas) const;

 private:
  struct Recent {
    KeyframeId id;
    ImagePyramid image;
    KeyframeId reference;
    Rigid3d camera_from_reference;
    ReferenceScale scale;
  };
  static std::optional<Rigid3d> PoseUnderWay(const Recent& recent, const Atlas& atlas);

  std::size_t most_;
  std::deque<Recent> keyframes_;  // the newest last
};

}  // namespace pangaea
