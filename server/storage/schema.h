#pragma once

#include <string>

#include "server/storage/database.h"

namespace pangaea {

// Version of the tables. Older stores are read, and upgraded when a server opens them: 2 added what undo needs, 3 the
// times of the server's work.
inline constexpr int kStoreSchema = 3;
inline constexpr int kOldestStoreSchema = 1;

// Makes the tables in an empty file and writes down whose atlas it holds.
Status CreateSchema(Database& database, const std::string& site);

// Refuses files that are not a store (kCorrupt), and stores of another schema (kUnsupported).
Status CheckSchema(Database& database);

// Makes the tables of a checked store those of this build. All or nothing.
Status UpgradeSchema(Database& database);

// The site whose atlas the store holds.
Result<std::string> StoredSite(Database& database);

// True for a file without any table.
Result<bool> IsEmpty(Database& database);

}  // namespace pangaea
