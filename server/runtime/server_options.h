#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include "common/base/result.h"
#include "common/dds/participant.h"
#include "server/downlink/guest_choice.h"
#include "server/ingest/ingest_round.h"
#include "server/runtime/work_options.h"
#include "server/storage/snapshot_store.h"
#include "server/storage/store.h"

namespace pangaea {

struct ServiceOptions {
  // Messages waiting for the atlas thread. When it is full, the thread that takes them from the network waits: what an
  // agent has in flight is bounded by the agent (4 MB), so nothing is dropped here.
  std::size_t queue_capacity = 256;
  // A round is committed together: larger rounds cost fewer disk flushes, smaller ones acknowledge earlier. It never
  // waits to be full.
  std::size_t round_envelopes = 64;
  std::size_t round_bytes = 16U << 20;
  // A snapshot is written when the journal has grown by either, so that recovery stays within 5 s.
  std::uint64_t snapshot_envelopes = 1000;
  std::uint64_t snapshot_bytes = 128U << 20;
  SnapshotRetention retention{};
  IngestOptions ingest{};
  StoreOptions store{};

  Status Check() const;
};

struct StatusOptions {
  // Published at least this often, so that readers see that the server lives, and upon change at most this often.
  std::chrono::milliseconds longest_interval{1000};
  std::chrono::milliseconds shortest_interval{500};

  Status Check() const;
};

struct ServerOptions {
  std::string site = "default";
  std::filesystem::path store = "atlas.db";
  std::string log_level = "info";
  DomainOptions domain;
  ServiceOptions service;
  StatusOptions status;
  WorkOptions work;
  GuestOptions guests;

  Status Check() const;
};

// Reads what the file sets into `options`. Errors name file, line, key and what is allowed.
Status LoadServerOptions(const std::filesystem::path& file, ServerOptions& options);

}  // namespace pangaea
