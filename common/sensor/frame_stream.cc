#include "common/sensor/frame_stream.h"

#include <utility>

#include "common/sensor/image.h"

namespace pangaea {
namespace {

class DatasetStream final : public FrameStream {
 public:
  DatasetStream(std::vector<DatasetFrame> frames, ImageSize size) : frames_(std::move(frames)), size_(size) {}

  std::optional<Result<StreamFrame>> Next(const std::stop_token& stop) override {
    if (next_ == frames_.size() || stop.stop_requested()) return std::nullopt;
    const DatasetFrame& frame = frames_[next_++];
    return StreamFrame{frame.stamp_ns, LoaderOf(frame.left), LoaderOf(frame.right)};
  }
  bool is_live() const override { return false; }
  std::optional<std::size_t> frame_count() const override { return frames_.size(); }

 private:
  ImageLoader LoaderOf(const std::string& path) const {
    if (path.empty()) return {};
    return [path, size = size_] { return ReadGrayImage(path, size); };
  }

  std::vector<DatasetFrame> frames_;
  ImageSize size_;
  std::size_t next_ = 0;
};

}  // namespace

CameraInput InputFrom(Dataset dataset) {
  const ImageSize size{dataset.rig.left.width, dataset.rig.left.height};
  CameraInput input;
  input.name = std::move(dataset.name);
  input.kind = dataset.layout + " layout";
  input.rig = std::move(dataset.rig);
  input.warnings = std::move(dataset.warnings);
  input.frames = std::make_unique<DatasetStream>(std::move(dataset.frames), size);
  return input;
}

}  // namespace pangaea
