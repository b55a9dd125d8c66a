#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "common/base/result.h"
#include "common/place/vocabulary_tree.h"

namespace pangaea {

struct VocabularyTrainingOptions {
  int branching = 10;
  // Branching 10 and depth 5 give up to 100,000 words in 3.8 MB.
  int depth = 5;
  // Descriptors a node must have to be split: splitting fewer learns the images by heart.
  int min_split = 2;
  std::uint64_t seed = 1;  // the same images and seed give the same vocabulary

  Status Check() const;
};

// Trains a vocabulary: clusters all descriptors into `branching` groups, each of these again, and so on down to the
// depth (Nister and Stewenius 2006, section 3.1, with k-medians for bits); a word's weight is ln(images / images that
// show it). `images` are the descriptors of each image. kInvalidArgument without at least two different descriptors.
// `report(done, total)` is called now and then with descriptors that have reached their word.
Result<VocabularyTree> TrainVocabulary(std::span<const std::vector<Descriptor>> images,
                                       const VocabularyTrainingOptions& options,
                                       const std::function<void(std::size_t, std::size_t)>& report = {});

}  // namespace pangaea
