#include "common/base/text.h"

#include <charconv>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>

namespace pangaea {
namespace {

constexpr int kSecondDecimals = 9;
constexpr std::uint64_t kSecond = 1'000'000'000;
constexpr std::string_view kBlanks = " \t\r\n\v\f";

std::string_view Trim(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

template <typename T>
std::optional<T> ParseWhole(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

bool AllDigits(std::string_view text) { return text.find_first_not_of("0123456789") == std::string_view::npos; }

}  // namespace

Result<std::string> ReadTextFile(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    return Fail(ErrorCode::kNotFound, path.string() + ": there is no such file");
  }
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  if (std::filesystem::file_size(path, error) > 0) text << file.rdbuf();
  if (!file || !text) return Fail(ErrorCode::kUnavailable, path.string() + ": the file cannot be read");
  return std::move(text).str();
}

Status WriteTextFile(const std::filesystem::path& path, std::string_view text) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(text.data(), static_cast<std::streamsize>(text.size()));
  file.close();
  if (!file) return Fail(ErrorCode::kUnavailable, path.string() + ": the file cannot be written");
  return {};
}

void ForEachLine(std::string_view text, const std::function<void(int, std::string_view)>& use) {
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = text.find('\n');
    use(number, Trim(text.substr(0, end)));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
}

std::vector<std::string_view> SplitFields(std::string_view line, char separator) {
  std::vector<std::string_view> fields;
  const std::string_view separators = separator == ' ' ? kBlanks : std::string_view(&separator, 1);
  while (true) {
    const std::size_t end = line.find_first_of(separators);
    const std::string_view field = Trim(line.substr(0, end));
    if (separator != ' ' || !field.empty()) fields.push_back(field);
    if (end == std::string_view::npos) return fields;
    line.remove_prefix(end + 1);
  }
}

std::optional<double> ParseNumber(std::string_view text) {
  const auto value = ParseWhole<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<std::int64_t> ParseInteger(std::string_view text) { return ParseWhole<std::int64_t>(text); }

std::optional<std::int64_t> ParseSeconds(std::string_view text) {
  const bool negative = text.starts_with('-');
  if (negative) text.remove_prefix(1);
  int exponent = 0;
  if (const std::size_t e = text.find_first_of("eE"); e != std::string_view::npos) {
    const auto parsed = ParseWhole<int>(text.substr(e + 1));
    if (!parsed || std::abs(*parsed) > 100) return std::nullopt;
    exponent = *parsed;
    text = text.substr(0, e);
  }
  const std::size_t point = text.find('.');
  const std::string_view decimals = point == std::string_view::npos ? "" : text.substr(point + 1);
  std::string digits = std::string(text.substr(0, point)) + std::string(decimals);
  if (digits.empty() || !AllDigits(digits)) return std::nullopt;
  // The number is `digits` with so many digits before its decimal point, then moved by nine to count nanoseconds.
  const int whole = static_cast<int>(digits.size() - decimals.size()) + exponent + kSecondDecimals;
  if (whole <= 0) return 0;
  digits.resize(static_cast<std::size_t>(whole), '0');
  const auto value = ParseWhole<std::int64_t>(digits);
  if (!value) return std::nullopt;
  return negative ? -*value : *value;
}

std::string FormatSeconds(std::int64_t nanoseconds) {
  // The magnitude as unsigned: the smallest integer has no positive counterpart.
  const bool negative = nanoseconds < 0;
  const auto bits = static_cast<std::uint64_t>(nanoseconds);
  const std::uint64_t magnitude = negative ? 0 - bits : bits;
  char text[32];
  std::snprintf(text, sizeof(text), "%s%" PRIu64 ".%09" PRIu64, negative ? "-" : "", magnitude / kSecond,
                magnitude % kSecond);
  return text;
}

}  // namespace pangaea
