#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

namespace pangaea {

// One run of an agent; random, so that ids never clash across machines or restarts. 0 is no session.
using SessionId = std::uint64_t;

// An id is unique for ever: the session that made it, and that session's counter of such things. Counters start at 1;
// {0, 0} is "none".
template <typename Tag>
struct Id {
  SessionId session = 0;
  std::uint32_t counter = 0;

  constexpr bool valid() const { return counter != 0; }
  constexpr auto operator<=>(const Id&) const = default;
};

using MapId = Id<struct MapTag>;
using KeyframeId = Id<struct KeyframeTag>;
using LandmarkId = Id<struct LandmarkTag>;

// For people: the session in hexadecimal, a slash, the counter.
std::string ToString(SessionId session);
template <typename Tag>
std::string ToString(const Id<Tag>& id) {
  return ToString(id.session) + "/" + std::to_string(id.counter);
}

}  // namespace pangaea

template <typename Tag>
struct std::hash<pangaea::Id<Tag>> {
  std::size_t operator()(const pangaea::Id<Tag>& id) const noexcept {
    // Sessions are random already; the odd constant spreads consecutive counters over the table.
    return static_cast<std::size_t>(id.session ^ (static_cast<std::uint64_t>(id.counter) * 0x9e3779b97f4a7c15ULL));
  }
};
