#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"

namespace pangaea {

Result<std::string> ReadTextFile(const std::filesystem::path& path);
// Replaces the file as a whole. The folder must exist.
Status WriteTextFile(const std::filesystem::path& path, std::string_view text);

// Calls `use` with each line's number (from 1) and text without its ending (\n or \r\n) and outer blanks. The last line
// may lack an ending.
void ForEachLine(std::string_view text, const std::function<void(int, std::string_view)>& use);

// The fields between separators, without outer blanks. With a blank as separator, runs of blanks separate once.
std::vector<std::string_view> SplitFields(std::string_view line, char separator);

// The whole text as a finite number, independent of the locale.
std::optional<double> ParseNumber(std::string_view text);
std::optional<std::int64_t> ParseInteger(std::string_view text);

// Decimal seconds ("1403715273.262142976", "1.5e-1") as nanoseconds, exactly: never through a double, which has too
// few digits. Digits beyond the ninth decimal are cut off.
std::optional<std::int64_t> ParseSeconds(std::string_view text);
// The same with 9 decimals.
std::string FormatSeconds(std::int64_t nanoseconds);

}  // namespace pangaea
