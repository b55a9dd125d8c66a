#pragma once

#include <cstdint>
#include <span>

#include "common/estimation/similarity_refinement.h"

namespace pangaea {

// The normal equations of a similarity, for the perturbation of similarity_refinement.h: cost is the sum of the kernel
// of the squared errors, gradient and information are half its first and second derivative.
struct SimilarityNormalEquations {
  Matrix7d information = Matrix7d::Zero();
  Vector7d gradient = Vector7d::Zero();
  double cost = 0.0;
};

// Sums the pairs whose flag in `active` is not 0. Huber's kernel bends at these squared errors (in sigmas); infinity is
// no kernel.
SimilarityNormalEquations AccumulateSimilarity(std::span<const SightingPair> pairs,
                                               std::span<const std::uint8_t> active,
                                               const Similarity3d& target_from_source, double monocular_bend,
                                               double stereo_bend);

}  // namespace pangaea
