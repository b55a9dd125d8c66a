#include "common/features/patch_pyramid.h"

#include <opencv2/imgproc.hpp>

#include "common/base/check.h"

namespace pangaea {

void BuildImagePyramid(const cv::Mat& image, int levels, ImagePyramid& pyramid) {
  PANGAEA_CHECK(image.type() == CV_8UC1 && !image.empty());
  PANGAEA_CHECK(levels >= 1 && levels <= kMaxPyramidLevels);
  pyramid.levels.resize(static_cast<std::size_t>(levels));
  pyramid.levels[0] = image;
  for (std::size_t l = 1; l < pyramid.levels.size(); ++l) cv::pyrDown(pyramid.levels[l - 1], pyramid.levels[l]);
}

ImagePyramid CopyPyramid(const ImagePyramid& pyramid) {
  ImagePyramid copy;
  copy.levels.push_back(pyramid.levels.front());
  for (std::size_t level = 1; level < pyramid.levels.size(); ++level) {
    copy.levels.push_back(pyramid.levels[level].clone());
  }
  return copy;
}

}  // namespace pangaea
