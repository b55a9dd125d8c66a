#include "cli/digest.h"

#include <cstdint>
#include <fstream>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/map/digest.h"
#include "server/storage/recovery.h"
#include "server/storage/store.h"

namespace pangaea {
namespace {

using nlohmann::json;

struct DigestOptions {
  std::string store;
  std::string report;
  bool json = false;
};

// What an agent had forgotten when it ended: of that its report's digest says no more than where it is.
struct AgentsForgotten {
  std::string session;
  std::vector<std::uint32_t> counters;
};

Result<AgentsForgotten> ReadForgotten(const std::string& report) {
  std::ifstream file(report);
  const json parsed = json::parse(file, nullptr, false);
  const auto wrong = Fail(ErrorCode::kInvalidArgument, "--report " + report + ": expected the report of an agent");
  if (!parsed.is_object() || !parsed.contains("session") || !parsed.contains("forgotten")) return wrong;
  try {
    return AgentsForgotten{parsed.at("session").get<std::string>(),
                           parsed.at("forgotten").get<std::vector<std::uint32_t>>()};
  } catch (const json::exception&) {  // of other types
    return wrong;
  }
}

json DigestJson(const RecoveredAtlas& recovered, const std::string& site, const AgentsForgotten& forgotten) {
  const Atlas& atlas = recovered.atlas;
  json maps = json::array();
  for (const MapId id : atlas.Maps()) {
    const MapInfo& map = *atlas.FindMap(id);
    maps.push_back({{"id", ToString(id)},
                    {"keyframes", map.keyframes},
                    {"landmarks", map.landmarks},
                    {"digest", ToString(Digest(atlas, id))}});
  }
  json sessions = json::array();
  for (const SessionRecord& record : recovered.sessions) {
    const SessionId id = record.announcement.session;
    std::set<KeyframeId> left_out;
    if (ToString(id) == forgotten.session) {
      for (const std::uint32_t counter : forgotten.counters) left_out.insert({id, counter});
    }
    sessions.push_back({{"id", ToString(id)},
                        {"name", record.announcement.name},
                        {"keyframes", atlas.keyframe_count(id)},
                        {"landmarks", atlas.landmark_count(id)},
                        {"acknowledged", record.acknowledged},
                        {"rejected", record.rejected},
                        {"digest", ToString(DigestOfSession(atlas, id, left_out))}});
  }
  return {{"site", site}, {"digest", ToString(Digest(atlas))}, {"maps", maps}, {"sessions", sessions}};
}

void PrintLines(const json& digests) {
  const auto print = [](const std::string& kind, const json& entry) {
    std::cout << entry.at("digest").get<std::string>() << "  " << kind << " " << entry.at("id").get<std::string>()
              << "  " << entry.at("keyframes") << " keyframes, " << entry.at("landmarks") << " landmarks\n";
  };
  std::cout << digests.at("digest").get<std::string>() << "  atlas of site " << digests.at("site").get<std::string>()
            << "\n";
  for (const json& map : digests.at("maps")) print("map", map);
  for (const json& session : digests.at("sessions")) print("session", session);
}

Status Run(const DigestOptions& options) {
  auto store = Store::OpenReadOnly(options.store);
  if (!store) return tl::make_unexpected(store.error());
  const auto recovered = RecoverAtlas(*store);
  if (!recovered) return tl::make_unexpected(recovered.error());
  AgentsForgotten forgotten;
  if (!options.report.empty()) {
    auto read = ReadForgotten(options.report);
    if (!read) return tl::make_unexpected(read.error());
    forgotten = std::move(*read);
  }
  const json digests = DigestJson(*recovered, store->site(), forgotten);
  if (options.json) {
    std::cout << digests.dump(-1, ' ', false, json::error_handler_t::replace) << "\n";
  } else {
    PrintLines(digests);
  }
  return {};
}

CommandBody Declare(CLI::App& app) {
  auto options = std::make_shared<DigestOptions>();
  app.add_option("--store", options->store, "File that holds the atlas")->required();
  app.add_option("--report", options->report, "Report of an agent: of its session, what it had not forgotten");
  app.add_flag("--json", options->json, "One line of JSON instead of text");
  return [options] { return Run(*options); };
}

}  // namespace

Command DigestCommand() { return {"digest", "Print the digests of the maps and sessions in a store", Declare}; }

}  // namespace pangaea
