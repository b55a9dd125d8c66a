// Compares every map of a recorded store with every other, each as a whole:
//   map_comparison_replay atlas.db
// Prints one line a pair. Not a test: shows on what figures CompareMaps decides.
#include <chrono>
#include <cstdio>
#include <string>

#include "server/map_comparison/map_comparison.h"
#include "server/storage/recovery.h"
#include "server/storage/store.h"

namespace pangaea {
namespace {

std::string NameOf(const RecoveredAtlas& recovered, MapId map) {
  std::string names;
  for (const SessionRecord& session : recovered.sessions) {
    bool lives_there = false;
    recovered.atlas.ForEachKeyframe(session.announcement.session, [&](const Keyframe& keyframe) {
      lives_there = lives_there || keyframe.map == map;
    });
    if (lives_there) names += (names.empty() ? "" : "+") + session.announcement.name;
  }
  return names;
}

int Run(const char* path) {
  auto store = Store::OpenReadOnly(path);
  if (!store) return std::fprintf(stderr, "%s\n", store.error().message.c_str()), 1;
  const auto recovered = RecoverAtlas(*store);
  if (!recovered) return std::fprintf(stderr, "%s\n", recovered.error().message.c_str()), 1;
  const std::vector<MapId> maps = recovered->atlas.Maps();
  for (std::size_t i = 0; i < maps.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      const auto start = std::chrono::steady_clock::now();
      const MapComparison comparison = CompareMaps(recovered->atlas, maps[i], maps[k], {});
      const std::chrono::duration<double, std::milli> taken = std::chrono::steady_clock::now() - start;
      std::printf("%-24s %-24s %6.1f ms  %s\n", NameOf(*recovered, maps[i]).c_str(),
                  NameOf(*recovered, maps[k]).c_str(), taken.count(), Describe(comparison).c_str());
    }
  }
  return 0;
}

}  // namespace
}  // namespace pangaea

int main(int argc, char** argv) {
  if (argc == 2) return pangaea::Run(argv[1]);
  std::fprintf(stderr, "usage: map_comparison_replay atlas.db\n");
  return 2;
}
