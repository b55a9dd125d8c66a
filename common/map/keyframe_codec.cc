#include "common/map/keyframe_codec.h"

#include <cmath>
#include <limits>
#include <utility>

#include "common/map/map_bytes.h"

namespace pangaea {
namespace {

constexpr std::uint8_t kFormat = 1;
constexpr std::uint8_t kFormatWithVergence = 2;  // the same, and the vergence after the stamp
constexpr std::uint8_t kFormatWithArrival = 3;   // the same, and the arrival after the vergence
// Of a keypoint's first byte: the octave, and whether a column in the right image follows.
constexpr std::uint8_t kOctaveMask = 0x7f;
constexpr std::uint8_t kHasRight = 0x80;

// Columns and rows are counts of kPixelQuantum; 16 bits hold those of images up to this size.
constexpr int kMaxNarrowSide = 2047;
bool IsNarrow(const IdealCamera& camera) { return camera.width <= kMaxNarrowSide && camera.height <= kMaxNarrowSide; }

template <typename Count>
Count ToCount(float pixel) {
  const float count = std::nearbyint(pixel / kPixelQuantum);
  const bool fits = count >= 0.0F && count < static_cast<float>(std::numeric_limits<Count>::max());
  return fits ? static_cast<Count>(count) : std::numeric_limits<Count>::max();  // unfit: outside of any image
}

template <typename Count>
void WriteKeypoints(const std::vector<Keypoint>& keypoints, ByteWriter& writer) {
  for (const Keypoint& keypoint : keypoints) {
    const std::uint8_t flags = keypoint.has_depth() ? kHasRight : 0;
    writer.Word(static_cast<std::uint8_t>((keypoint.octave & kOctaveMask) | flags));
    writer.Word(keypoint.angle);
    writer.Word(ToCount<Count>(keypoint.u));
    writer.Word(ToCount<Count>(keypoint.v));
    if (keypoint.has_depth()) writer.Word(ToCount<Count>(keypoint.u_right));
  }
}

template <typename Count>
void ReadKeypoints(std::vector<Keypoint>& keypoints, ByteReader& reader) {
  const auto read_pixel = [&] { return static_cast<float>(reader.Word<Count>()) * kPixelQuantum; };
  for (Keypoint& keypoint : keypoints) {
    const auto flags = reader.Word<std::uint8_t>();
    keypoint.octave = flags & kOctaveMask;
    keypoint.angle = reader.Word<std::uint8_t>();
    keypoint.u = read_pixel();
    keypoint.v = read_pixel();
    if ((flags & kHasRight) != 0) keypoint.u_right = read_pixel();
  }
}

void WriteCamera(const IdealCamera& camera, ByteWriter& writer) {
  writer.SignedVarint(camera.width);
  writer.SignedVarint(camera.height);
  for (const double value : {camera.focal_x, camera.focal_y, camera.center_x, camera.center_y, camera.baseline}) {
    writer.Word(value);
  }
}

int ReadSide(ByteReader& reader) {
  const std::int64_t side = reader.SignedVarint();
  const bool fits = side >= 0 && side <= std::numeric_limits<int>::max();
  if (!fits) reader.Invalidate();
  return fits ? static_cast<int>(side) : 0;
}

IdealCamera ReadCamera(ByteReader& reader) {
  IdealCamera camera;
  camera.width = ReadSide(reader);
  camera.height = ReadSide(reader);
  for (double* value : {&camera.focal_x, &camera.focal_y, &camera.center_x, &camera.center_y, &camera.baseline}) {
    *value = reader.Word<double>();
  }
  return camera;
}

void WriteArrival(const TrackedArrival& arrival, ByteWriter& bytes) {
  MapWriter writer(bytes);
  writer.WriteId(arrival.reference);
  writer.WriteRigid(arrival.camera_from_reference);
  bytes.Word(arrival.reference_scale);
  bytes.SignedVarint(arrival.since_ns);
}

TrackedArrival ReadArrival(ByteReader& bytes) {
  MapReader reader(bytes);
  TrackedArrival arrival;
  arrival.reference = reader.ReadId<KeyframeTag>();
  arrival.camera_from_reference = reader.ReadRigid();
  arrival.reference_scale = bytes.Word<double>();
  arrival.since_ns = bytes.SignedVarint();
  return arrival;
}

std::uint8_t FormatOf(const KeyframeData& data) {
  if (data.arrival.reference.valid()) return kFormatWithArrival;
  return data.vergence != 0.0 ? kFormatWithVergence : kFormat;
}

}  // namespace

void EncodeKeyframeData(const KeyframeData& data, ByteWriter& writer) {
  const Features& features = data.features;
  const std::uint8_t format = FormatOf(data);
  writer.Word(format);
  writer.SignedVarint(data.stamp_ns);
  if (format >= kFormatWithVergence) writer.Word(data.vergence);
  if (format >= kFormatWithArrival) WriteArrival(data.arrival, writer);
  WriteCamera(data.camera, writer);
  writer.Varint(features.keypoints.size());
  if (IsNarrow(data.camera)) {
    WriteKeypoints<std::uint16_t>(features.keypoints, writer);
  } else {
    WriteKeypoints<std::uint32_t>(features.keypoints, writer);
  }
  // Always one per keypoint, so that the bytes can be read back whatever was given.
  for (std::size_t i = 0; i < features.keypoints.size(); ++i) {
    const Descriptor descriptor = i < features.descriptors.size() ? features.descriptors[i] : Descriptor{};
    writer.Bytes(std::as_bytes(std::span(descriptor.words)));
  }
}

Result<std::shared_ptr<const KeyframeData>> DecodeKeyframeData(ByteReader& reader) {
  const auto format = reader.Word<std::uint8_t>();
  if (reader.ok() && (format < kFormat || format > kFormatWithArrival)) {
    reader.Invalidate();
    return Fail(ErrorCode::kUnsupported, "unknown format of keyframe data: " + std::to_string(format));
  }
  auto data = std::make_shared<KeyframeData>();
  data->stamp_ns = reader.SignedVarint();
  if (format >= kFormatWithVergence) data->vergence = reader.Word<double>();
  if (format >= kFormatWithArrival) data->arrival = ReadArrival(reader);
  data->camera = ReadCamera(reader);
  const bool narrow = IsNarrow(data->camera);
  const std::size_t count = reader.Count((narrow ? 6 : 10) + sizeof(Descriptor));
  data->features.keypoints.resize(count);
  data->features.descriptors.resize(count);
  if (narrow) {
    ReadKeypoints<std::uint16_t>(data->features.keypoints, reader);
  } else {
    ReadKeypoints<std::uint32_t>(data->features.keypoints, reader);
  }
  for (Descriptor& descriptor : data->features.descriptors) {
    for (std::uint64_t& word : descriptor.words) word = reader.Word<std::uint64_t>();
  }
  if (!reader.ok()) return Fail(ErrorCode::kCorrupt, "keyframe data are truncated or malformed");
  return std::shared_ptr<const KeyframeData>(std::move(data));
}

}  // namespace pangaea
