#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "common/base/result.h"

namespace pangaea {

// Where LCM messages come from or go to: a network, or a log file as lcm-logger writes it.
struct LcmUrl {
  std::string network;  // for liblcm; empty for a log
  std::optional<std::filesystem::path> log;

  // "udpm://239.255.76.67:7667?ttl=0" or "file://FOLDER/NAME". A receive buffer of 4 MB is asked for unless the text
  // says otherwise: the default one loses images.
  static Result<LcmUrl> Parse(const std::string& text);
};

}  // namespace pangaea
