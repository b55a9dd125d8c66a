#include "common/map/map_edit.h"

#include <optional>
#include <string>
#include <utility>

#include "common/map/atlas_editor.h"
#include "common/map/map_bytes.h"

namespace pangaea {
namespace {

// First byte of what EncodeEdits gives.
constexpr std::uint8_t kBatchFormat = 1;
constexpr std::size_t kMinEditBytes = 3;  // tag, version and the shortest body

void EncodeOne(const MapEdit& edit, MapWriter& writer) {
  std::visit(
      [&](const auto& kind) {
        writer.bytes().Word(kind.kTag);
        writer.bytes().Word(kind.kVersion);
        Encode(kind, writer);
      },
      edit);
}

// Reads the body if the tag is that of `Kind`; false if it is another's.
template <typename Kind>
bool DecodeAs(std::uint8_t tag, std::uint8_t version, MapReader& reader, Result<MapEdit>& result) {
  if (tag != Kind::kTag) return false;
  if (version == 0 || version > Kind::kVersion) {
    result =
        Fail(ErrorCode::kUnsupported, "version " + std::to_string(version) + " of edit " + std::string(Kind::kName));
    return true;
  }
  Kind edit;
  Decode(reader, version, edit);
  if (reader.bytes().ok()) {
    result = MapEdit(std::move(edit));
  } else {
    result = Fail(ErrorCode::kCorrupt, "malformed edit " + std::string(Kind::kName));
  }
  return true;
}

// The table of all kinds is the variant itself.
template <typename... Kinds>
void DecodeAny(std::type_identity<std::variant<Kinds...>>, std::uint8_t tag, std::uint8_t version, MapReader& reader,
               Result<MapEdit>& result) {
  (DecodeAs<Kinds>(tag, version, reader, result) || ...);
}

Result<MapEdit> DecodeOne(MapReader& reader) {
  const auto tag = reader.bytes().Word<std::uint8_t>();
  const auto version = reader.bytes().Word<std::uint8_t>();
  if (!reader.bytes().ok()) return Fail(ErrorCode::kCorrupt, "an edit is truncated");
  Result<MapEdit> result = Fail(ErrorCode::kUnsupported, "unknown kind of edit: " + std::to_string(tag));
  DecodeAny(std::type_identity<MapEdit>(), tag, version, reader, result);
  return result;
}

}  // namespace

Status Validate(const MapEdit& edit, const Atlas& atlas) {
  return std::visit([&](const auto& kind) { return Validate(kind, atlas); }, edit);
}

Status Apply(const MapEdit& edit, Atlas& atlas) {
  if (auto status = Validate(edit, atlas); !status) return status;
  AtlasEditor editor(atlas);
  std::visit([&](const auto& kind) { ApplyValid(kind, editor); }, edit);
  editor.SetVersion(atlas.version() + 1);
  return {};
}

void Encode(const MapEdit& edit, ByteWriter& writer) {
  MapWriter map_writer(writer);
  EncodeOne(edit, map_writer);
}

Result<MapEdit> Decode(ByteReader& reader) {
  MapReader map_reader(reader);
  return DecodeOne(map_reader);
}

std::vector<std::byte> EncodeEdits(std::span<const MapEdit> edits) {
  ByteWriter bytes;
  MapWriter writer(bytes);
  bytes.Word(kBatchFormat);
  bytes.Varint(edits.size());
  for (const MapEdit& edit : edits) EncodeOne(edit, writer);
  return bytes.Take();
}

Result<std::vector<MapEdit>> DecodeEdits(std::span<const std::byte> bytes) {
  ByteReader byte_reader(bytes);
  MapReader reader(byte_reader);
  const auto format = byte_reader.Word<std::uint8_t>();
  if (byte_reader.ok() && format != kBatchFormat) {
    return Fail(ErrorCode::kUnsupported, "unknown format of edits: " + std::to_string(format));
  }
  std::vector<MapEdit> edits;
  const std::size_t count = byte_reader.Count(kMinEditBytes);
  for (std::size_t i = 0; i < count; ++i) {
    auto edit = DecodeOne(reader);
    if (!edit) return tl::make_unexpected(std::move(edit.error()));
    edits.push_back(std::move(*edit));
  }
  if (byte_reader.ok() && byte_reader.remaining() == 0) return edits;
  return Fail(ErrorCode::kCorrupt, "edits are truncated or followed by something else");
}

std::string_view KindName(const MapEdit& edit) {
  return std::visit([](const auto& kind) { return std::string_view(kind.kName); }, edit);
}

bool TouchesOnly(const MapEdit& edit, SessionId session) {
  return std::visit([&](const auto& kind) { return TouchesOnly(kind, session); }, edit);
}

}  // namespace pangaea
