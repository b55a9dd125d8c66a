#pragma once

#include <cstdint>
#include <string>

namespace pangaea {

// The state of a site's atlas as the server last published it.
struct AtlasStatus {
  std::string site;
  std::uint64_t server_incarnation = 0;
  std::int64_t stamp_ns = 0;  // system clock of the server
  std::string json;           // the whole status; its fields are in docs/wire.md
  bool operator==(const AtlasStatus&) const = default;
};

}  // namespace pangaea
