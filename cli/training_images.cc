#include "cli/training_images.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <system_error>
#include <utility>

#include "common/base/text.h"
#include "common/features/orb_extractor.h"
#include "common/sensor/image.h"

namespace pangaea {
namespace {

namespace fs = std::filesystem;

struct ImageSource {
  fs::path folder;
  std::size_t step = 1;
};

// A colon may belong to the folder's name: only what stands behind the last one and is a number is a step.
Result<ImageSource> ParseSource(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  const auto step = colon == std::string::npos ? std::nullopt : ParseInteger(text.substr(colon + 1));
  if (!step) return ImageSource{text, 1};
  if (*step < 1) return Fail(ErrorCode::kInvalidArgument, "--images " + text + ": the step must be at least 1");
  return ImageSource{text.substr(0, colon), static_cast<std::size_t>(*step)};
}

bool IsImage(const fs::path& path) {
  std::string extension = path.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".png" || extension == ".jpg" || extension == ".jpeg" || extension == ".pgm";
}

}  // namespace

Result<std::vector<fs::path>> ListImages(const std::string& source) {
  const auto parsed = ParseSource(source);
  if (!parsed) return tl::make_unexpected(parsed.error());
  std::map<fs::path, std::vector<fs::path>> by_folder;
  std::error_code error;
  for (auto entry = fs::recursive_directory_iterator(parsed->folder, error);
       !error && entry != fs::recursive_directory_iterator(); entry.increment(error)) {
    if (IsImage(entry->path())) by_folder[entry->path().parent_path()].push_back(entry->path());
  }
  if (error) return Fail(ErrorCode::kNotFound, parsed->folder.string() + ": " + error.message());
  std::vector<fs::path> images;
  for (auto& [folder, files] : by_folder) {
    std::ranges::sort(files);
    for (std::size_t i = 0; i < files.size(); i += parsed->step) images.push_back(files[i]);
  }
  if (images.empty()) return Fail(ErrorCode::kNotFound, parsed->folder.string() + ": holds no PNG, JPEG or PGM image");
  return images;
}

Result<std::vector<std::vector<Descriptor>>> DescribeImages(
    const std::vector<fs::path>& images, int features, const std::function<void(std::size_t, std::size_t)>& report) {
  const OrbOptions options{.features = features};
  if (Status checked = options.Check(); !checked) return tl::make_unexpected(checked.error());
  OrbExtractor extractor(options);
  std::vector<std::vector<Descriptor>> described;
  for (const fs::path& path : images) {
    const auto size = ReadImageSize(path);
    if (!size) return tl::make_unexpected(size.error());
    const auto image = ReadGrayImage(path, *size);
    if (!image) return tl::make_unexpected(image.error());
    described.push_back(extractor.Extract(*image).descriptors);
    report(described.size(), images.size());
  }
  return described;
}

}  // namespace pangaea
