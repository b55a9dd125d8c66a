#include "cli/status_table.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <vector>

namespace pangaea {
namespace {

using nlohmann::json;
using Row = std::vector<std::string>;

// Columns as wide as their widest cell; the first `left` columns are text, the others numbers, flush right.
std::string Table(const std::vector<Row>& rows, std::size_t left) {
  std::vector<std::size_t> widths(rows.front().size(), 0);
  for (const Row& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  std::string text;
  for (const Row& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::string padding(widths[i] - row[i].size(), ' ');
      text += (i < left ? row[i] + padding : padding + row[i]) + "  ";
    }
    text.erase(text.find_last_not_of(' ') + 1);
    text += "\n";
  }
  return text;
}

std::string Fixed(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.1f", value);
  return text;
}

std::string Count(const json& entry, const char* key) { return std::to_string(entry.value(key, std::uint64_t{0})); }

std::string Header(const json& status) {
  const json versions = status.value("versions", json::object());
  return "site " + status.value("site", std::string("?")) + ": " + Count(status, "keyframes") + " keyframes, " +
         Count(status, "landmarks") + " landmarks; server " + versions.value("server", std::string("?")) + ", wire " +
         Count(versions, "wire") + ", start " + Count(status, "incarnation") + ", up " +
         Fixed(status.value("uptime_s", 0.0)) + " s, " + Fixed(status.value("memory_mib", 0.0)) + " MiB\n";
}

std::string StoreLine(const json& status) {
  constexpr double kMebibyte = 1024.0 * 1024.0;
  const json store = status.value("store", json::object());
  const std::string error = store.value("error", std::string());
  return "store " + store.value("path", std::string("?")) + ": " + Fixed(store.value("bytes", 0.0) / kMebibyte) +
         " MiB, " + Count(store, "journaled_envelopes") + " envelopes in the journal" +
         (error.empty() ? "" : "; TAKES NOTHING: " + error) + "\n";
}

std::string Timing(const json& timings, const char* key) {
  const json timing = timings.value(key, json::object());
  return std::string(key) + " " + Fixed(timing.value("median_ms", 0.0)) +
         " ms (95 %: " + Fixed(timing.value("p95_ms", 0.0)) + ")";
}

std::string QueueLine(const json& status) {
  const json queue = status.value("queues", json::object()).value("ingest", json::object());
  const json timings = status.value("timings", json::object());
  return "queue " + Count(queue, "size") + " of " + Count(queue, "capacity") + ", " + Timing(timings, "acknowledge") +
         ", " + Timing(timings, "commit") + "\n";
}

std::string Maps(const json& status) {
  std::vector<Row> rows{{"map", "state", "keyframes", "landmarks", "sessions"}};
  for (const json& map : status.value("maps", json::array())) {
    rows.push_back({map.value("id", std::string("?")), map.value("closed", false) ? "closed" : "open",
                    Count(map, "keyframes"), Count(map, "landmarks"),
                    std::to_string(map.value("sessions", json::array()).size())});
  }
  return Table(rows, 2);
}

std::string StateOf(const json& session) {
  if (session.value("alive", false)) return "alive";
  return session.value("closed", false) ? "ended" : "gone";
}

std::string Sessions(const json& status) {
  std::vector<Row> rows{{"session", "name", "state", "keyframes", "landmarks", "acknowledged", "rejected"}};
  for (const json& session : status.value("sessions", json::array())) {
    rows.push_back({session.value("id", std::string("?")), session.value("name", std::string("?")), StateOf(session),
                    Count(session, "keyframes"), Count(session, "landmarks"), Count(session, "acknowledged"),
                    Count(session, "rejected")});
  }
  return Table(rows, 3);
}

bool IsUnderWayIn(const json& status) { return status.value("under_way", false); }

// What recognition, welding and optimisation did; nothing where the server has none of it.
std::string WorkLines(const json& status) {
  if (!status.contains("welds")) return {};
  const json& welds = status["welds"];
  std::string text = Count(welds, "merges") + " merges, " + Count(welds, "loops") + " loops, " +
                     Count(welds, "refused") + " refused; " + (IsUnderWayIn(status) ? "at work" : "idle") + "\n";
  const json& last = welds.value("last", json::array());
  if (!last.empty()) text += "last: " + last.back().value("evidence", std::string()) + "\n";
  return text;
}

// What `read` makes of the status's JSON; kCorrupt where it is not what this program reads.
template <typename ReadJson>
auto Read(const AtlasStatus& status, ReadJson&& read) -> Result<decltype(read(json()))> {
  try {
    return read(json::parse(status.json));
  } catch (const json::exception& error) {
    return Fail(ErrorCode::kCorrupt,
                std::string("the server's status is not what this program reads: ") + error.what());
  }
}

}  // namespace

Result<bool> IsUnderWay(const AtlasStatus& status) { return Read(status, IsUnderWayIn); }

Result<std::string> StatusTable(const AtlasStatus& status) {
  return Read(status, [](const json& parsed) {
    return Header(parsed) + StoreLine(parsed) + QueueLine(parsed) + WorkLines(parsed) + "\n" + Maps(parsed) + "\n" +
           Sessions(parsed);
  });
}

}  // namespace pangaea
