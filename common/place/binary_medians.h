#pragma once

#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include "common/base/descriptor.h"

namespace pangaea {

struct BinaryMediansOptions {
  int clusters = 10;        // wanted; fewer where there are fewer different descriptors
  int max_iterations = 11;  // of assignment and new centres; most clusterings stand still earlier
};

// Centres of clusters and, for each descriptor, the cluster it belongs to: the nearest, of equals the first. No cluster
// is empty.
struct BinaryClusters {
  std::vector<Descriptor> centres;
  std::vector<std::uint32_t> assignment;
};

// k-medians in Hamming space: the centre of a cluster has the bits that most of its descriptors have (the majority
// minimises the sum of Hamming distances; Grana et al. 2013 and Galvez-Lopez and Tardos 2012), from centres drawn as by
// k-means++ (Arthur and Vassilvitskii 2007; for bits, the squared Euclidean distance is the Hamming distance).
BinaryClusters ClusterDescriptors(std::span<const Descriptor> descriptors, const BinaryMediansOptions& options,
                                  std::mt19937_64& random);

}  // namespace pangaea
