#include "common/sensor/video_capture.h"

#include "common/base/module.h"

namespace pangaea {

Result<const VideoCaptures*> OpenVideoCaptures() {
  static const Result<const VideoCaptures*> kCaptures = OpenModule<VideoCaptures>(ModuleFolder());
  if (kCaptures) return kCaptures;
  return Fail(kCaptures.error().code, "a video or camera needs a module: " + kCaptures.error().message);
}

}  // namespace pangaea
