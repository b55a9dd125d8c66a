#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "common/geometry/rigid3.h"
#include "common/simulation/ray_table.h"
#include "common/simulation/scene.h"

namespace pangaea {

// Draws a scene as one camera sees it: per pixel the nearest surface along the pixel's own ray, its texture filtered
// over the pixel's footprint, and eight rays where a pixel shows more than one surface. Keeps scratch memory from
// picture to picture: one renderer per thread.
class Renderer {
 public:
  explicit Renderer(std::shared_ptr<const RayTable> rays);
  ~Renderer();
  Renderer(Renderer&&) noexcept;

  // Grey values 0 to 255 as 32-bit floats, no noise. Black where no surface is hit.
  void Render(const std::vector<Surface>& surfaces, const Rigid3d& camera_from_world, cv::Mat& image);

 private:
  class Picture;
  std::unique_ptr<Picture> picture_;
};

}  // namespace pangaea
