#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/base/result.h"

namespace pangaea {

// Both ends belong to it.
template <typename T>
struct Range {
  T min;
  T max;
};
template <typename T>
Range(T, T) -> Range<T>;

// The one reader of YAML files. A caller describes each key it knows, with its place and allowed range; Finish() says
// everything that is wrong, each with file, line, key and what is allowed:
//
//   auto reader = ConfigReader::Open(path);
//   if (!reader) return tl::make_unexpected(reader.error());
//   reader->Read("tracking.max_landmarks", &options.tracking.max_landmarks, Range{1, 5000});
//   return reader->Finish();
//
// A dot in a key leads into a nested mapping. Values that are wrong leave the option as it was. Never throws.
class ConfigReader {
 public:
  static Result<ConfigReader> Open(const std::filesystem::path& path);
  // From text; `name` stands for the file in messages.
  static Result<ConfigReader> Parse(const std::string& text, const std::string& name);
  ConfigReader(ConfigReader&&) noexcept;
  ConfigReader& operator=(ConfigReader&&) noexcept;
  ~ConfigReader();

  // A key that may be missing: the value then keeps its default.
  template <typename T, typename R>
  requires(std::is_arithmetic_v<T> && !std::same_as<T, bool>) void Read(std::string_view key, T* value,
                                                                        Range<R> range) {
    ReadArithmetic(key, value, range, Presence::kOptional);
  }
  void Read(std::string_view key, bool* value);
  void Read(std::string_view key, std::string* value) { ReadText(key, value, Presence::kOptional); }
  // One of the named choices; `value` gets its position.
  void ReadChoice(std::string_view key, std::size_t* value, std::initializer_list<std::string_view> choices);

  // A key that must be there.
  template <typename T, typename R>
  requires(std::is_arithmetic_v<T> && !std::same_as<T, bool>) void Require(std::string_view key, T* value,
                                                                           Range<R> range) {
    ReadArithmetic(key, value, range, Presence::kRequired);
  }
  void Require(std::string_view key, std::string* value) { ReadText(key, value, Presence::kRequired); }
  // A list of as many numbers as one of `counts` says, each in the range. A matrix may be written as a list of rows.
  void RequireList(std::string_view key, std::vector<double>* values, std::initializer_list<std::size_t> counts,
                   Range<double> range);

  // Adds an error of the caller's own check, for example of several numbers together.
  void Refuse(std::string_view key, const std::string& why, const std::string& allowed);

  bool Has(std::string_view key) const;
  // "file:line: key" for messages of checks that concern several keys.
  std::string PlaceOf(std::string_view key) const;

  // All errors so far, and keys of the file that nothing asked for (with the nearest known key).
  Status Finish() const;
  // The same for files of others, in which further keys are fine.
  Status FinishIgnoringUnknown() const;

 private:
  enum class Presence { kOptional, kRequired };
  struct Document;

  explicit ConfigReader(std::unique_ptr<Document> document);

  template <typename T, typename R>
  void ReadArithmetic(std::string_view key, T* value, Range<R> range, Presence presence) {
    if constexpr (std::integral<T>) {
      std::int64_t number = 0;
      if (ReadInteger(key, &number, ClampToType<T>(range), presence)) *value = static_cast<T>(number);
    } else {
      double number = 0.0;
      const Range<double> wide{static_cast<double>(range.min), static_cast<double>(range.max)};
      if (ReadNumber(key, &number, wide, presence)) *value = static_cast<T>(number);
    }
  }
  template <typename T, typename R>
  static Range<std::int64_t> ClampToType(Range<R> range) {
    using Limits = std::numeric_limits<T>;
    constexpr std::int64_t kLowest = std::is_unsigned_v<T> ? 0 : static_cast<std::int64_t>(Limits::min());
    constexpr std::int64_t kHighest = std::cmp_less(std::numeric_limits<std::int64_t>::max(), Limits::max())
                                          ? std::numeric_limits<std::int64_t>::max()
                                          : static_cast<std::int64_t>(Limits::max());
    const auto clamp = [](std::int64_t x) { return x < kLowest ? kLowest : x > kHighest ? kHighest : x; };
    return {clamp(static_cast<std::int64_t>(range.min)), clamp(static_cast<std::int64_t>(range.max))};
  }
  void ReadText(std::string_view key, std::string* value, Presence presence);
  bool ReadInteger(std::string_view key, std::int64_t* value, Range<std::int64_t> range, Presence presence);
  bool ReadNumber(std::string_view key, double* value, Range<double> range, Presence presence);

  std::unique_ptr<Document> document_;
};

}  // namespace pangaea
