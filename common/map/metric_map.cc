#include "common/map/metric_map.h"

namespace pangaea {

bool IsMetric(const Atlas& atlas, MapId map) {
  const MapInfo* info = atlas.FindMap(map);
  return info != nullptr && atlas.FindKeyframe(info->root)->data->camera.is_stereo();
}

}  // namespace pangaea
