#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/map/ids.h"

namespace pangaea {

// Ids of one kind, each once, as bits by session and counter: entering one and listing all in order costs a fraction of
// sorting them. The directory of a session grows with the counter: callers bound it (limits.h).
template <typename Tag>
class IdSet {
 public:
  // False where it was there already.
  bool Insert(Id<Tag> id) {
    Words& words = PageOf(id);
    std::uint64_t& word = words[id.counter % kPageIds / 64];
    const std::uint64_t bit = std::uint64_t{1} << (id.counter % 64);
    if ((word & bit) != 0) return false;
    word |= bit;
    ++size_;
    return true;
  }

  bool Contains(Id<Tag> id) const {
    const auto part = std::ranges::lower_bound(parts_, id.session, {}, &Part::session);
    if (part == parts_.end() || part->session != id.session) return false;
    const std::size_t page = id.counter / kPageIds;
    if (page >= part->pages.size() || part->pages[page] < 0) return false;
    const Words& words = pages_[static_cast<std::size_t>(part->pages[page])];
    return (words[id.counter % kPageIds / 64] >> (id.counter % 64) & 1) != 0;
  }

  std::vector<Id<Tag>> Ascending() const {
    std::vector<Id<Tag>> ids;
    ids.reserve(size_);
    for (const Part& part : parts_) {
      for (std::size_t page = 0; page < part.pages.size(); ++page) {
        if (part.pages[page] < 0) continue;
        const Words& words = pages_[static_cast<std::size_t>(part.pages[page])];
        for (std::size_t w = 0; w < words.size(); ++w) {
          for (std::uint64_t rest = words[w]; rest != 0; rest &= rest - 1) {
            const std::size_t counter = page * kPageIds + 64 * w + static_cast<std::size_t>(std::countr_zero(rest));
            ids.push_back({part.session, static_cast<std::uint32_t>(counter)});
          }
        }
      }
    }
    return ids;
  }

  std::size_t size() const { return size_; }

 private:
  static constexpr std::size_t kPageIds = 4096;
  using Words = std::array<std::uint64_t, kPageIds / 64>;
  struct Part {
    SessionId session = 0;
    std::vector<std::int32_t> pages;  // index into pages_, -1: nothing there
  };

  Words& PageOf(Id<Tag> id) {
    // What comes in a row is mostly of one session.
    if (last_ >= parts_.size() || parts_[last_].session != id.session) last_ = IndexOf(id.session);
    std::vector<std::int32_t>& pages = parts_[last_].pages;
    const std::size_t page = id.counter / kPageIds;
    if (page >= pages.size()) pages.resize(page + 1, -1);
    if (pages[page] < 0) {
      pages[page] = static_cast<std::int32_t>(pages_.size());
      pages_.emplace_back();
    }
    return pages_[static_cast<std::size_t>(pages[page])];
  }

  std::size_t IndexOf(SessionId session) {
    auto part = std::ranges::lower_bound(parts_, session, {}, &Part::session);
    if (part == parts_.end() || part->session != session) part = parts_.insert(part, {session, {}});
    return static_cast<std::size_t>(part - parts_.begin());
  }

  std::vector<Part> parts_;   // ascending by session
  std::vector<Words> pages_;  // in the order in which they were needed
  std::size_t last_ = 0;      // part of the latest id
  std::size_t size_ = 0;
};

using KeyframeIdSet = IdSet<KeyframeTag>;
using LandmarkIdSet = IdSet<LandmarkTag>;

}  // namespace pangaea
