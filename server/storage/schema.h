#pragma once

#include <string>

#include "server/storage/database.h"

namespace pangaea {

// Version of the tables. A build reads its own version only; an older store is upgraded here once there is one.
inline constexpr int kStoreSchema = 1;

// Makes the tables in an empty file and writes down whose atlas it holds.
Status CreateSchema(Database& database, const std::string& site);

// Refuses files that are not a store (kCorrupt), and stores of another schema (kUnsupported).
Status CheckSchema(Database& database);

// The site whose atlas the store holds.
Result<std::string> StoredSite(Database& database);

// True for a file without any table.
Result<bool> IsEmpty(Database& database);

}  // namespace pangaea
