#include "common/sensor/image_decoder.h"

#include "common/base/module.h"

namespace pangaea {

Result<const ImageDecoder*> OpenImageDecoder(const std::string& needed_by) {
  static const Result<const ImageDecoder*> kDecoder = OpenModule<ImageDecoder>(ModuleFolder());
  if (kDecoder) return kDecoder;
  return Fail(kDecoder.error().code, needed_by + " needs a module: " + kDecoder.error().message);
}

}  // namespace pangaea
