#include "server/runtime/status_json.h"

#include <nlohmann/json.hpp>
#include <set>

#include "common/base/process_memory.h"
#include "common/map/digest.h"
#include "common/wire/envelope.h"
#include "server/storage/schema.h"

#ifndef PANGAEA_VERSION
#error "the build defines PANGAEA_VERSION"
#endif

namespace pangaea {
namespace {

using nlohmann::json;
using SessionsOfMaps = std::map<MapId, std::set<SessionId>>;

SessionsOfMaps FindSessionsOfMaps(const Atlas& atlas) {
  SessionsOfMaps sessions;
  atlas.ForEachKeyframe([&sessions](const Keyframe& keyframe) { sessions[keyframe.map].insert(keyframe.id.session); });
  return sessions;
}

json MapJson(const IngestState& state, const MapInfo& map, const std::set<SessionId>& sessions, DigestCache& digests) {
  json entry{{"id", ToString(map.id)},
             {"keyframes", map.keyframes},
             {"landmarks", map.landmarks},
             {"closed", map.closed},
             {"sessions", json::array()}};
  bool alive = false;
  std::uint64_t progress = state.correction;
  for (const SessionId id : sessions) {
    entry["sessions"].push_back(ToString(id));
    const auto session = state.sessions.find(id);
    if (session == state.sessions.end()) continue;
    alive = alive || session->second.alive();
    progress += session->second.record().acknowledged;
  }
  if (!alive) entry["digest"] = ToString(digests.OfMap(state.atlas, map.id, progress));
  return entry;
}

json MapsJson(const IngestState& state, DigestCache& digests) {
  const SessionsOfMaps sessions = FindSessionsOfMaps(state.atlas);
  json maps = json::array();
  for (const MapId id : state.atlas.Maps()) {
    const auto of_map = sessions.find(id);
    maps.push_back(MapJson(state, *state.atlas.FindMap(id),
                           of_map == sessions.end() ? std::set<SessionId>() : of_map->second, digests));
  }
  return maps;
}

json SessionJson(const IngestState& state, SessionId id, const IngestSession& session, DigestCache& digests) {
  const SessionRecord& record = session.record();
  json entry{{"id", ToString(id)},
             {"name", record.announcement.name},
             {"alive", session.alive()},
             {"closed", record.announcement.closed},
             {"keyframes", state.atlas.keyframe_count(id)},
             {"landmarks", state.atlas.landmark_count(id)},
             {"acknowledged", record.acknowledged},
             {"rejected", record.rejected},
             {"duplicates", session.duplicates()},
             {"gaps", session.gaps()},
             {"foreign", session.foreign()},
             {"joined_unix_ns", record.joined_unix_ns},
             {"software", record.announcement.software_version}};
  if (!session.alive()) {
    entry["digest"] = ToString(digests.OfSession(state.atlas, id, state.correction + record.acknowledged));
  }
  return entry;
}

json SessionsJson(const IngestState& state, DigestCache& digests) {
  json sessions = json::array();
  for (const auto& [id, session] : state.sessions) sessions.push_back(SessionJson(state, id, session, digests));
  return sessions;
}

json StoreJson(const ServiceState& state, const ServerFacts& facts) {
  return {{"path", facts.store_path},
          {"bytes", state.store.bytes},
          {"journaled_envelopes", state.store.journaled_envelopes},
          {"writable", state.store_error.empty()},
          {"error", state.store_error},
          {"snapshot",
           {{"position", facts.snapshot.position},
            {"written", facts.snapshot.written},
            {"seconds", facts.snapshot.seconds},
            {"error", facts.snapshot.error}}}};
}

json TimingJson(const LatencyWindow& window) {
  constexpr double kMedian = 0.5;
  constexpr double kHigh = 0.95;
  return {{"count", window.count()}, {"median_ms", window.Quantile(kMedian)}, {"p95_ms", window.Quantile(kHigh)}};
}

json WeldsJson(const std::deque<WeldReport>& welds) {
  json entries = json::array();
  for (const WeldReport& weld : welds) {
    json entry{{"kind", weld.merge ? "merge" : "loop"},
               {"sessions", json::array()},
               {"evidence", weld.text},
               {"ms", weld.milliseconds},
               {"unix_ns", weld.unix_ns}};
    if (!weld.cause.empty()) entry["cause"] = weld.cause;
    for (const SessionId id : weld.sessions) entry["sessions"].push_back(ToString(id));
    entries.push_back(std::move(entry));
  }
  return entries;
}

// What the server does with maps by itself, beside what the rest of the status says.
void AddWork(const ServerFacts::Work& work, const IngestState& state, json& status) {
  const WorkReport& report = work.report;
  status["under_way"] = report.IsUnderWay(state.atlas.version(), state.living());
  status["welds"] = {{"merges", report.merges},
                     {"loops", report.loops},
                     {"refused", report.refused},
                     {"last", WeldsJson(report.welds)},
                     {"last_refused", WeldsJson(report.refusals)}};
  status["relocalization"] = {{"found", report.relocalized}, {"not_found", report.not_relocalized}};
  status["optimization"] = {
      {"running", report.optimizing.has_value()},
      {"cancelled", report.cancelled_optimizations},
      {"culled", report.culled},
      {"economy",
       {{"fused", report.fused}, {"landmarks", report.culled_landmarks}, {"keyframes", report.culled_keyframes}}}};
  if (report.optimizing) status["optimization"]["map"] = ToString(*report.optimizing);
  status["queues"]["recognition"] = {{"size", report.lookups_waiting}};
  status["queues"]["welding"] = {{"size", report.matches_waiting}};
  status["queues"]["optimization"] = {{"size", report.optimizations_waiting}};
  status["timings"]["recognition"] = TimingJson(report.recognition_ms);
  status["timings"]["relocalization"] = TimingJson(report.relocalization_ms);
  status["timings"]["merge"] = TimingJson(report.merge_ms);
  status["timings"]["loop"] = TimingJson(report.loop_ms);
  status["timings"]["pose_graph"] = TimingJson(report.pose_graph_ms);
  status["timings"]["global_bundle"] = TimingJson(report.global_ms);
  status["versions"]["vocabulary"] = ToString(work.vocabulary);
}

}  // namespace

std::uint64_t DigestCache::OfSession(const Atlas& atlas, SessionId session, std::uint64_t progress) {
  const auto [entry, fresh] = sessions_.try_emplace(session);
  if (fresh || entry->second.first != progress) entry->second = {progress, DigestOfSession(atlas, session)};
  return entry->second.second;
}

std::uint64_t DigestCache::OfMap(const Atlas& atlas, MapId map, std::uint64_t progress) {
  const auto [entry, fresh] = maps_.try_emplace(map);
  if (fresh || entry->second.first != progress) entry->second = {progress, Digest(atlas, map)};
  return entry->second.second;
}

std::string StatusJson(const ServiceState& state, const ServerFacts& facts, DigestCache& digests) {
  json status{{"site", facts.site},
              {"incarnation", facts.incarnation},
              {"uptime_s", facts.uptime_seconds},
              {"maps", MapsJson(state.ingest, digests)},
              {"sessions", SessionsJson(state.ingest, digests)},
              {"keyframes", state.ingest.atlas.keyframe_count()},
              {"landmarks", state.ingest.atlas.landmark_count()},
              {"store", StoreJson(state, facts)},
              {"queues", {{"ingest", {{"size", facts.queued}, {"capacity", facts.queue_capacity}}}}},
              {"timings", {{"acknowledge", TimingJson(state.acknowledge_ms)}, {"commit", TimingJson(state.commit_ms)}}},
              {"correction", state.ingest.correction},
              {"refused_messages", state.ingest.refused},
              {"memory_mib", ResidentMib()},
              {"versions", {{"server", PANGAEA_VERSION}, {"wire", kWireVersion}, {"store_schema", kStoreSchema}}}};
  if (facts.work) AddWork(*facts.work, state.ingest, status);
  // Names come from the network: whatever is not UTF-8 is replaced, never thrown about.
  return status.dump(-1, ' ', false, json::error_handler_t::replace);
}

}  // namespace pangaea
