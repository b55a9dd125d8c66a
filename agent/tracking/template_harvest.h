#pragma once

#include "agent/tracking/template_store.h"
#include "common/features/patch_pyramid.h"
#include "common/map/atlas.h"

namespace pangaea {

// Cuts templates out of a keyframe's image for the landmarks it observes: for those without any, and for those whose
// templates all show them from more than `new_view_angle` degrees away. Nothing happens when the keyframe is not in the
// atlas.
void HarvestTemplates(const Atlas& atlas, KeyframeId id, const ImagePyramid& image, double new_view_angle,
                      TemplateStore& templates);

}  // namespace pangaea
