#include "common/wire/edit_packing.h"

#include "common/map/map_edit.h"

namespace pangaea {

std::vector<std::span<const MapEdit>> PackEdits(std::span<const MapEdit> edits, std::size_t max_bytes) {
  std::vector<std::span<const MapEdit>> runs;
  std::size_t begin = 0;
  std::size_t bytes = 0;
  for (std::size_t i = 0; i < edits.size(); ++i) {
    ByteWriter writer;
    Encode(edits[i], writer);
    if (i > begin && bytes + writer.size() > max_bytes) {
      runs.push_back(edits.subspan(begin, i - begin));
      begin = i;
      bytes = 0;
    }
    bytes += writer.size();
  }
  if (begin < edits.size()) runs.push_back(edits.subspan(begin));
  return runs;
}

}  // namespace pangaea
