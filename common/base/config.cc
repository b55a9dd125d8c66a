#include "common/base/config.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <optional>

#include "common/base/text.h"

namespace pangaea {
namespace {

constexpr int kMaxDepth = 32;  // of nested mappings; also ends a document that contains itself

// One key of the document, with the keys above it: "tracking.max_landmarks".
struct Entry {
  std::string path;
  YAML::Node value;
  int line = 0;  // from 1
};

std::string Text(double number) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.10g", number);
  return text;
}

template <typename T>
std::string Text(Range<T> range) {
  const bool open_above = range.max == std::numeric_limits<T>::max() || std::isinf(static_cast<double>(range.max));
  const bool smallest = std::is_floating_point_v<T> && static_cast<double>(range.min) > 0.0 &&
                        static_cast<double>(range.min) <= std::numeric_limits<double>::min();
  if (smallest && open_above) return "greater than 0";
  if (range.min == std::numeric_limits<T>::lowest() && open_above) return "any finite number";
  const std::string from = std::is_integral_v<T> ? std::to_string(range.min) : Text(static_cast<double>(range.min));
  if (open_above) return "from " + from;
  return from + " to " + (std::is_integral_v<T> ? std::to_string(range.max) : Text(static_cast<double>(range.max)));
}

bool Within(double value, Range<double> range) { return value >= range.min && value <= range.max; }

std::size_t EditDistance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0U);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row[b.size()];
}

// The items of a list, or those of its rows where all of it are lists.
std::vector<YAML::Node> ItemsOf(const YAML::Node& list) {
  const bool has_rows = std::all_of(list.begin(), list.end(), [](const auto& row) { return row.IsSequence(); });
  std::vector<YAML::Node> items;
  for (const auto& row : list) {
    if (has_rows) {
      for (const auto& item : row) items.push_back(item);
    } else {
      items.push_back(row);
    }
  }
  return items;
}

bool IsBelow(std::string_view path, std::string_view section) {
  return path.size() > section.size() && path.starts_with(section) && path[section.size()] == '.';
}

}  // namespace

struct ConfigReader::Document {
  std::string name;
  std::vector<Entry> entries;  // in the order of the file, sections before what is in them
  std::vector<std::string> known;
  std::vector<std::string> errors;

  void Flatten(const YAML::Node& mapping, const std::string& prefix, int depth) {
    for (const auto& item : mapping) {
      const std::string path = prefix + (item.first.IsScalar() ? item.first.Scalar() : "?");
      const int line = item.first.Mark().line + 1;
      if (const Entry* first = Find(path)) {
        AddError(line, path + " is set a second time; the first is in line " + std::to_string(first->line));
        continue;
      }
      entries.push_back({path, item.second, line});
      if (item.second.IsMap() && depth < kMaxDepth) Flatten(item.second, path + ".", depth + 1);
    }
  }

  const Entry* Find(std::string_view path) const {
    const auto found = std::ranges::find(entries, path, &Entry::path);
    return found == entries.end() ? nullptr : &*found;
  }

  // Remembers the key as a known one, and misses it where it must be there.
  const Entry* Look(std::string_view key, Presence presence, const std::string& allowed) {
    known.emplace_back(key);
    const Entry* entry = Find(key);
    if (entry == nullptr && presence == Presence::kRequired) {
      errors.push_back(name + ": the key " + std::string(key) + " is missing; allowed: " + allowed);
    }
    return entry;
  }

  void AddError(int line, const std::string& what) {
    errors.push_back(name + ":" + std::to_string(line) + ": " + what);
  }

  void Refuse(const Entry& entry, const std::string& why, const std::string& allowed) {
    const std::string value = entry.value.IsScalar() ? "'" + entry.value.Scalar() + "'" : "not a single value";
    AddError(entry.line, entry.path + " is " + value + why + "; allowed: " + allowed);
  }

  std::string UnknownKey(const Entry& entry) const {
    std::string message = name + ":" + std::to_string(entry.line) + ": unknown key " + entry.path;
    const auto nearest =
        std::ranges::min_element(known, {}, [&](const std::string& key) { return EditDistance(key, entry.path); });
    if (nearest != known.end()) message += "; the nearest known key is " + *nearest;
    return message;
  }

  std::vector<std::string> UnknownKeys() const {
    std::vector<std::string> messages;
    std::vector<std::string_view> settled;  // known keys and reported sections: what is in them is no further matter
    for (const Entry& entry : entries) {
      if (std::ranges::any_of(settled, [&](std::string_view path) { return IsBelow(entry.path, path); })) continue;
      const bool asked = std::ranges::find(known, entry.path) != known.end();
      const bool leads_to_known =
          entry.value.IsMap() && std::ranges::any_of(known, [&](const auto& key) { return IsBelow(key, entry.path); });
      if (asked || !leads_to_known) settled.push_back(entry.path);
      if (!asked && !leads_to_known) messages.push_back(UnknownKey(entry));
    }
    return messages;
  }

  Status Report(const std::vector<std::string>& unknown) const {
    std::string message;
    for (const auto* list : {&errors, &unknown}) {
      for (const std::string& line : *list) message += (message.empty() ? "" : "\n") + line;
    }
    if (message.empty()) return {};
    return Fail(ErrorCode::kInvalidArgument, message);
  }
};

ConfigReader::ConfigReader(std::unique_ptr<Document> document) : document_(std::move(document)) {}
ConfigReader::ConfigReader(ConfigReader&&) noexcept = default;
ConfigReader& ConfigReader::operator=(ConfigReader&&) noexcept = default;
ConfigReader::~ConfigReader() = default;

Result<ConfigReader> ConfigReader::Open(const std::filesystem::path& path) {
  const auto text = ReadTextFile(path);
  if (!text) return tl::make_unexpected(text.error());
  return Parse(*text, path.string());
}

Result<ConfigReader> ConfigReader::Parse(const std::string& text, const std::string& name) {
  auto document = std::make_unique<Document>();
  document->name = name;
  try {
    const YAML::Node root = YAML::Load(text);
    if (root.IsMap()) {
      document->Flatten(root, "", 0);
    } else if (!root.IsNull()) {
      return Fail(ErrorCode::kCorrupt, name + ": the file is not a list of 'key: value' lines");
    }
  } catch (const YAML::Exception& exception) {
    return Fail(ErrorCode::kCorrupt,
                name + ":" + std::to_string(exception.mark.line + 1) + ": not valid YAML: " + exception.msg);
  }
  return ConfigReader(std::move(document));
}

void ConfigReader::Read(std::string_view key, bool* value) {
  const std::string allowed = "true or false";
  const Entry* entry = document_->Look(key, Presence::kOptional, allowed);
  if (entry == nullptr) return;
  const std::string text = entry->value.IsScalar() ? entry->value.Scalar() : "";
  if (text != "true" && text != "false") return document_->Refuse(*entry, "", allowed);
  *value = text == "true";
}

void ConfigReader::ReadText(std::string_view key, std::string* value, Presence presence) {
  const std::string allowed = "a text";
  const Entry* entry = document_->Look(key, presence, allowed);
  if (entry == nullptr) return;
  if (!entry->value.IsScalar()) return document_->Refuse(*entry, "", allowed);
  *value = entry->value.Scalar();
}

void ConfigReader::ReadChoice(std::string_view key, std::size_t* value,
                              std::initializer_list<std::string_view> choices) {
  std::string allowed;
  for (const std::string_view choice : choices) allowed += (allowed.empty() ? "" : ", ") + std::string(choice);
  const Entry* entry = document_->Look(key, Presence::kOptional, allowed);
  if (entry == nullptr) return;
  const auto* found =
      std::ranges::find(choices, entry->value.IsScalar() ? std::string_view(entry->value.Scalar()) : "");
  if (found == choices.end()) return document_->Refuse(*entry, "", allowed);
  *value = static_cast<std::size_t>(found - choices.begin());
}

void ConfigReader::RequireList(std::string_view key, std::vector<double>* values,
                               std::initializer_list<std::size_t> counts, Range<double> range) {
  std::string allowed;
  for (const std::size_t count : counts) allowed += (allowed.empty() ? "" : " or ") + std::to_string(count);
  allowed += " numbers, each " + Text(range);
  const Entry* entry = document_->Look(key, Presence::kRequired, allowed);
  if (entry == nullptr) return;
  if (!entry->value.IsSequence()) return document_->Refuse(*entry, "", allowed);
  const std::vector<YAML::Node> items = ItemsOf(entry->value);
  if (std::ranges::find(counts, items.size()) == counts.end()) {
    return document_->AddError(entry->line,
                               entry->path + " has " + std::to_string(items.size()) + " numbers; allowed: " + allowed);
  }
  std::vector<double> numbers;
  for (const YAML::Node& item : items) {
    const std::string text = item.IsScalar() ? item.Scalar() : "?";
    const auto number = ParseNumber(text);
    if (!number || !Within(*number, range)) {
      return document_->AddError(item.Mark().line + 1, entry->path + ": number " + std::to_string(numbers.size() + 1) +
                                                           " is '" + text + "'; allowed: " + allowed);
    }
    numbers.push_back(*number);
  }
  *values = std::move(numbers);
}

bool ConfigReader::ReadInteger(std::string_view key, std::int64_t* value, Range<std::int64_t> range,
                               Presence presence) {
  const Entry* entry = document_->Look(key, presence, Text(range));
  if (entry == nullptr) return false;
  const auto number = ParseInteger(entry->value.IsScalar() ? entry->value.Scalar() : "");
  if (!number) return document_->Refuse(*entry, ", which is not a whole number", Text(range)), false;
  if (*number < range.min || *number > range.max) return document_->Refuse(*entry, "", Text(range)), false;
  *value = *number;
  return true;
}

bool ConfigReader::ReadNumber(std::string_view key, double* value, Range<double> range, Presence presence) {
  const Entry* entry = document_->Look(key, presence, Text(range));
  if (entry == nullptr) return false;
  const auto number = ParseNumber(entry->value.IsScalar() ? entry->value.Scalar() : "");
  if (!number) return document_->Refuse(*entry, ", which is not a number", Text(range)), false;
  if (!Within(*number, range)) return document_->Refuse(*entry, "", Text(range)), false;
  *value = *number;
  return true;
}

void ConfigReader::Refuse(std::string_view key, const std::string& why, const std::string& allowed) {
  document_->errors.push_back(PlaceOf(key) + " " + why + "; allowed: " + allowed);
}

bool ConfigReader::Has(std::string_view key) const { return document_->Find(key) != nullptr; }

std::string ConfigReader::PlaceOf(std::string_view key) const {
  const Entry* entry = document_->Find(key);
  return document_->name + ":" + (entry == nullptr ? "" : std::to_string(entry->line) + ":") + " " + std::string(key);
}

Status ConfigReader::Finish() const { return document_->Report(document_->UnknownKeys()); }

Status ConfigReader::FinishIgnoringUnknown() const { return document_->Report({}); }

}  // namespace pangaea
