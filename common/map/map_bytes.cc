#include "common/map/map_bytes.h"

#include <algorithm>
#include <limits>

namespace pangaea {
namespace {

void WriteQuaternion(ByteWriter& bytes, const Eigen::Quaterniond& rotation) {
  for (const double value : {rotation.w(), rotation.x(), rotation.y(), rotation.z()}) bytes.Word(value);
}

Eigen::Quaterniond ReadQuaternion(ByteReader& bytes) {
  const auto w = bytes.Word<double>();
  const auto x = bytes.Word<double>();
  const auto y = bytes.Word<double>();
  const auto z = bytes.Word<double>();
  return Eigen::Quaterniond(w, x, y, z);
}

}  // namespace

// 0 is the id "none", 1 to n are the sessions met so far, n + 1 announces another.
void MapWriter::WriteSession(SessionId session, bool valid) {
  if (session == 0 && !valid) {
    bytes_.Varint(0);
    return;
  }
  const auto found = std::find(sessions_.begin(), sessions_.end(), session);
  bytes_.Varint(static_cast<std::uint64_t>(found - sessions_.begin()) + 1);
  if (found != sessions_.end()) return;
  bytes_.Word(session);
  sessions_.push_back(session);
}

bool MapReader::ReadSession(SessionId& session) {
  const std::uint64_t index = bytes_.Varint();
  if (index == 0) return false;
  if (index <= sessions_.size()) {
    session = sessions_[index - 1];
    return true;
  }
  if (index != sessions_.size() + 1) bytes_.Invalidate();
  session = bytes_.Word<SessionId>();
  if (bytes_.ok()) sessions_.push_back(session);
  return bytes_.ok();
}

std::uint32_t MapReader::ReadCounter() {
  const std::uint64_t value = bytes_.Varint();
  if (value > std::numeric_limits<std::uint32_t>::max()) bytes_.Invalidate();
  return bytes_.ok() ? static_cast<std::uint32_t>(value) : 0;
}

void MapWriter::WritePoint(const Eigen::Vector3d& point) {
  for (const double value : {point.x(), point.y(), point.z()}) bytes_.Word(value);
}

Eigen::Vector3d MapReader::ReadPoint() {
  const auto x = bytes_.Word<double>();
  const auto y = bytes_.Word<double>();
  const auto z = bytes_.Word<double>();
  return {x, y, z};
}

void MapWriter::WriteRigid(const Rigid3d& rigid) {
  WriteQuaternion(bytes_, rigid.rotation());
  WritePoint(rigid.translation());
}

Rigid3d MapReader::ReadRigid() {
  const Eigen::Quaterniond rotation = ReadQuaternion(bytes_);
  const Eigen::Vector3d translation = ReadPoint();
  const auto rigid = Rigid3d::FromNormalized(rotation, translation);
  if (!rigid) bytes_.Invalidate();
  return rigid.value_or(Rigid3d());
}

void MapWriter::WriteSimilarity(const Similarity3d& similarity) {
  bytes_.Word(similarity.scale());
  WriteQuaternion(bytes_, similarity.rotation());
  WritePoint(similarity.translation());
}

Similarity3d MapReader::ReadSimilarity() {
  const auto scale = bytes_.Word<double>();
  const Eigen::Quaterniond rotation = ReadQuaternion(bytes_);
  const Eigen::Vector3d translation = ReadPoint();
  const auto similarity = Similarity3d::FromNormalized(scale, rotation, translation);
  if (!similarity) bytes_.Invalidate();
  return similarity.value_or(Similarity3d());
}

}  // namespace pangaea
