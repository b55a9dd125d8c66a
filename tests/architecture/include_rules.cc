#include "tests/architecture/include_rules.h"

#include <array>
#include <fstream>
#include <map>
#include <regex>
#include <set>

namespace pangaea {
namespace {

using Allowed = std::map<std::string, std::set<std::string>>;

// Folder → folders it may include, besides itself. The table of docs/architecture.md.
const Allowed& AllowedIncludes() {
  static const std::set<std::string> kMiddle = {"common/base", "common/geometry"};
  static const std::set<std::string> kUpper = {"common/base", "common/geometry", "common/map", "common/features",
                                               "common/sensor"};
  static const std::set<std::string> kLink = {
      "common/base",  "common/geometry",   "common/map",     "common/features",   "common/sensor",
      "common/place", "common/estimation", "common/mapping", "common/simulation", "common/evaluation"};
  static const Allowed kAllowed = [] {
    Allowed allowed;
    allowed["common/base"] = {};
    allowed["common/geometry"] = {"common/base"};
    for (const char* folder : {"common/map", "common/features", "common/sensor"}) allowed[folder] = kMiddle;
    for (const char* folder : {"common/place", "common/estimation", "common/simulation", "common/evaluation"}) {
      allowed[folder] = kUpper;
    }
    allowed["common/mapping"] = kUpper;
    allowed["common/mapping"].insert("common/estimation");
    allowed["common/wire"] = kLink;
    allowed["common/dds"] = kLink;
    allowed["common/dds"].insert("common/wire");
    allowed["common/lcm"] = allowed["common/dds"];
    std::set<std::string> program = kLink;
    program.insert({"common/wire", "common/dds", "common/lcm"});
    allowed["agent"] = program;
    allowed["server"] = program;
    allowed["cli"] = program;
    allowed["cli"].insert("server");  // its storage alone, see below
    return allowed;
  }();
  return kAllowed;
}

// Folders of core code: functions on values, without a thread, lock, clock, socket or file.
constexpr std::array kCore = {
    "common/geometry",          "common/features", "common/map",          "common/place", "common/estimation",
    "common/mapping",           "agent/tracking",  "agent/mapping",       "agent/uplink", "server/ingest",
    "server/place_recognition", "server/fusion",   "server/optimization", "server/atlas", "server/downlink",
    "agent/absorption",         "server/map_comparison"};

// Generated and library types of a transport, by the folder their headers come from → who may see them.
const Allowed& AllowedTypes() {
  static const Allowed kTypes = {
      {"idl", {"common/wire", "common/dds"}},
      {"dds", {"common/wire", "common/dds"}},
      {"lcm", {"common/lcm"}},
      {"pangaea_lcm", {"common/lcm"}},
  };
  return kTypes;
}

constexpr std::array kForbiddenInCore = {"thread",
                                         "mutex",
                                         "shared_mutex",
                                         "condition_variable",
                                         "future",
                                         "fstream",
                                         "filesystem",
                                         "sys/socket.h",
                                         "common/base/mutex.h",
                                         "common/base/bounded_queue.h",
                                         "common/base/published.h"};

std::string FolderOf(const std::string& path) {
  const auto first = path.find('/');
  if (path.rfind("common/", 0) != 0) return path.substr(0, first);
  return path.substr(0, path.find('/', first + 1));
}

bool IsBelow(const std::string& path, const std::string& folder) { return path.rfind(folder + "/", 0) == 0; }

bool IsOurs(const std::string& path) { return AllowedIncludes().contains(FolderOf(path)) || IsBelow(path, "tests"); }

void CheckCore(const Include& include, std::vector<std::string>& forbidden) {
  for (const char* folder : kCore) {
    if (!IsBelow(include.from, folder)) continue;
    for (const char* header : kForbiddenInCore) {
      if (include.to == header) {
        forbidden.push_back(include.from + ":" + std::to_string(include.line) + ": core code includes " + header);
      }
    }
  }
}

void CheckDirection(const Include& include, std::vector<std::string>& forbidden) {
  if (IsBelow(include.from, "tests") || !IsOurs(include.to)) return;
  const std::string from = FolderOf(include.from);
  const std::string to = FolderOf(include.to);
  const bool cli_beyond_storage = from == "cli" && to == "server" && !IsBelow(include.to, "server/storage");
  if (from == to || (AllowedIncludes().at(from).contains(to) && !cli_beyond_storage)) return;
  forbidden.push_back(include.from + ":" + std::to_string(include.line) + ": " + from + " may not include " +
                      include.to);
}

void CheckTypes(const Include& include, std::vector<std::string>& forbidden) {
  if (IsBelow(include.from, "tests")) return;
  const auto types = AllowedTypes().find(include.to.substr(0, include.to.find('/')));
  if (types == AllowedTypes().end() || types->second.contains(FolderOf(include.from))) return;
  forbidden.push_back(include.from + ":" + std::to_string(include.line) + ": " + FolderOf(include.from) +
                      " may not see the types of " + include.to);
}

}  // namespace

std::vector<Include> ReadIncludes(const std::filesystem::path& root) {
  static const std::regex kPattern(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"])");
  std::vector<Include> includes;
  for (const char* top : {"common", "agent", "server", "cli", "tests"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root / top)) {
      const std::string extension = entry.path().extension().string();
      if (extension != ".h" && extension != ".cc") continue;
      std::ifstream file(entry.path());
      std::string line;
      for (int number = 1; std::getline(file, line); ++number) {
        std::smatch match;
        if (!std::regex_search(line, match, kPattern)) continue;
        includes.push_back({std::filesystem::relative(entry.path(), root).generic_string(), match[1], number});
      }
    }
  }
  return includes;
}

std::vector<std::string> ForbiddenIncludes(const std::vector<Include>& includes) {
  std::vector<std::string> forbidden;
  for (const Include& include : includes) {
    CheckCore(include, forbidden);
    CheckDirection(include, forbidden);
    CheckTypes(include, forbidden);
  }
  return forbidden;
}

}  // namespace pangaea
