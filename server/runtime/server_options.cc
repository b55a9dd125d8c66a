#include "server/runtime/server_options.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "common/base/config.h"

namespace pangaea {
namespace {

constexpr std::uint64_t kMebibyte = 1U << 20;
constexpr std::array<std::string_view, 6> kLogLevels{"trace", "debug", "info", "warn", "error", "off"};

Status AtLeastOne(std::uint64_t value, const char* name) {
  if (value >= 1) return {};
  return Fail(ErrorCode::kInvalidArgument, std::string(name) + " is 0; at least 1 is needed");
}

// Sizes stand in the file in MiB.
void ReadMebibytes(ConfigReader& reader, const char* key, std::uint64_t* bytes, std::uint64_t smallest) {
  std::uint64_t mebibytes = *bytes / kMebibyte;
  constexpr std::uint64_t kLargest = 1U << 30;
  reader.Read(key, &mebibytes, Range{smallest, kLargest});
  *bytes = mebibytes * kMebibyte;
}

void ReadMilliseconds(ConfigReader& reader, const char* key, std::chrono::milliseconds* duration) {
  auto count = duration->count();
  reader.Read(key, &count, Range{10, 60'000});
  *duration = std::chrono::milliseconds(count);
}

void ReadService(ConfigReader& reader, ServiceOptions& options) {
  reader.Read("ingest.queue_capacity", &options.queue_capacity, Range{1, 100'000});
  reader.Read("ingest.round_envelopes", &options.round_envelopes, Range{1, 10'000});
  std::uint64_t round_bytes = options.round_bytes;
  ReadMebibytes(reader, "ingest.round_mib", &round_bytes, 1);
  options.round_bytes = round_bytes;
  reader.Read("ingest.max_sessions", &options.ingest.max_sessions, Range{1, 10'000'000});
  ReadMebibytes(reader, "store.max_mib", &options.store.max_bytes, 0);
  reader.Read("snapshot.every_envelopes", &options.snapshot_envelopes, Range{1, 1'000'000'000});
  ReadMebibytes(reader, "snapshot.every_mib", &options.snapshot_bytes, 1);
  reader.Read("snapshot.kept", &options.retention.snapshots, Range{0, 1000});
  ReadMebibytes(reader, "snapshot.kept_mib", &options.retention.journal_bytes, 0);
}

}  // namespace

Status ServiceOptions::Check() const {
  if (auto status = AtLeastOne(queue_capacity, "queue_capacity"); !status) return status;
  if (auto status = AtLeastOne(round_envelopes, "round_envelopes"); !status) return status;
  if (auto status = AtLeastOne(round_bytes, "round_bytes"); !status) return status;
  if (auto status = AtLeastOne(snapshot_envelopes, "snapshot_envelopes"); !status) return status;
  if (auto status = AtLeastOne(snapshot_bytes, "snapshot_bytes"); !status) return status;
  if (auto status = ingest.Check(); !status) return status;
  return store.Check();
}

Status StatusOptions::Check() const {
  if (shortest_interval.count() > 0 && shortest_interval <= longest_interval) return {};
  return Fail(ErrorCode::kInvalidArgument,
              "the status's shortest interval must be above 0 and not above the longest interval");
}

Status ServerOptions::Check() const {
  if (auto checked = CheckSiteName(site); !checked) return checked;
  if (store.empty()) return Fail(ErrorCode::kInvalidArgument, "the store has no file name");
  if (std::ranges::find(kLogLevels, log_level) == kLogLevels.end()) {
    return Fail(ErrorCode::kInvalidArgument,
                "log level '" + log_level + "' is none of trace, debug, info, warn, error, off");
  }
  if (auto checked = domain.Check(); !checked) return checked;
  if (auto checked = service.Check(); !checked) return checked;
  if (auto checked = work.Check(); !checked) return checked;
  if (auto checked = guests.Check(); !checked) return checked;
  return status.Check();
}

Status LoadServerOptions(const std::filesystem::path& file, ServerOptions& options) {
  auto reader = ConfigReader::Open(file);
  if (!reader) return tl::make_unexpected(reader.error());
  reader->Read("site", &options.site);
  std::string store = options.store.string();
  reader->Read("store.path", &store);
  options.store = store;
  reader->Read("log_level", &options.log_level);
  reader->Read("dds.domain", &options.domain.id, Range{0, 230});
  reader->Read("dds.configuration", &options.domain.configuration);
  ReadService(*reader, options.service);
  ReadWork(*reader, options.work);
  reader->Read("downlink.guests", &options.guests.wanted, Range{0, 1000});
  reader->Read("downlink.new_guests", &options.guests.new_at_once, Range{1, 100});
  reader->Read("downlink.found_guests", &options.guests.found_at_once, Range{1, 100});
  ReadMilliseconds(*reader, "status.longest_interval_ms", &options.status.longest_interval);
  ReadMilliseconds(*reader, "status.shortest_interval_ms", &options.status.shortest_interval);
  return reader->Finish();
}

}  // namespace pangaea
