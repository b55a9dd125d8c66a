#include "common/lcm/url.h"

#include <string_view>

namespace pangaea {
namespace {

constexpr std::string_view kFile = "file://";
constexpr std::string_view kMulticast = "udpm://";
constexpr std::string_view kReceiveBuffer = "recv_buf_size=";

}  // namespace

Result<LcmUrl> LcmUrl::Parse(const std::string& text) {
  if (text.starts_with(kFile)) {
    std::string path = text.substr(kFile.size());
    path.resize(std::min(path.size(), path.find('?')));
    if (!path.empty()) return LcmUrl{.network = {}, .log = path};
  } else if (text.starts_with(kMulticast)) {
    if (text.find(kReceiveBuffer) != std::string::npos) return LcmUrl{.network = text, .log = {}};
    const char joint = text.find('?') == std::string::npos ? '?' : '&';
    return LcmUrl{.network = text + joint + std::string(kReceiveBuffer) + "4000000", .log = {}};
  }
  return Fail(ErrorCode::kInvalidArgument,
              "LCM address '" + text + "'; allowed: udpm://GROUP:PORT?ttl=N for a network, file://PATH for a log");
}

}  // namespace pangaea
