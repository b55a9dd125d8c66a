#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/map/copy_on_write.h"

namespace pangaea {

// Slots addressed by the counter of an id, in chunks that copies of the table share until one of them writes. A write
// after a copy costs one directory, one page and one chunk, whatever the number of slots.
template <typename Slot, std::size_t kChunkSlots, std::size_t kPageChunks>
class IdTable {
 public:
  // nullptr where nothing was ever written nearby; else a slot, perhaps a default one.
  const Slot* Find(std::uint32_t counter) const {
    const Directory* directory = directory_.get();
    if (directory == nullptr || counter / kPageSlots >= directory->size()) return nullptr;
    const Page* page = (*directory)[counter / kPageSlots].get();
    if (page == nullptr) return nullptr;
    const Chunk* chunk = (*page)[counter / kChunkSlots % kPageChunks].get();
    return chunk == nullptr ? nullptr : &(*chunk)[counter % kChunkSlots];
  }

  // The directory grows with the counter: callers bound it (limits.h).
  Slot& Write(std::uint32_t counter, const WriteMark& mark) {
    Directory& directory = directory_.Write(mark);
    if (counter / kPageSlots >= directory.size()) directory.resize(counter / kPageSlots + 1);
    Page& page = directory[counter / kPageSlots].Write(mark);
    return page[counter / kChunkSlots % kPageChunks].Write(mark)[counter % kChunkSlots];
  }

  // visit(counter, slot), ascending, default slots included.
  template <typename Visit>
  void ForEach(Visit&& visit) const {
    const Directory* directory = directory_.get();
    for (std::size_t p = 0; directory != nullptr && p < directory->size(); ++p) {
      const Page* page = (*directory)[p].get();
      for (std::size_t c = 0; page != nullptr && c < kPageChunks; ++c) {
        const Chunk* chunk = (*page)[c].get();
        for (std::size_t s = 0; chunk != nullptr && s < kChunkSlots; ++s) {
          visit(static_cast<std::uint32_t>(p * kPageSlots + c * kChunkSlots + s), (*chunk)[s]);
        }
      }
    }
  }

 private:
  static constexpr std::size_t kPageSlots = kPageChunks * kChunkSlots;
  using Chunk = std::array<Slot, kChunkSlots>;
  using Page = std::array<CopyOnWrite<Chunk>, kPageChunks>;
  using Directory = std::vector<CopyOnWrite<Page>>;

  CopyOnWrite<Directory> directory_;
};

}  // namespace pangaea
