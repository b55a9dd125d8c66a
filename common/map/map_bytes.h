#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/base/bytes.h"
#include "common/geometry/rigid3.h"
#include "common/geometry/similarity3.h"
#include "common/map/ids.h"

namespace pangaea {

// Writes the map's types. Ids are short: their session stands in the bytes once, where it first occurs, and is a small
// number from then on. Motions keep every bit.
class MapWriter {
 public:
  explicit MapWriter(ByteWriter& bytes) : bytes_(bytes) {}

  ByteWriter& bytes() { return bytes_; }
  template <typename Tag>
  void WriteId(const Id<Tag>& id) {
    WriteSession(id.session, id.valid());
    if (id.session != 0 || id.valid()) bytes_.Varint(id.counter);
  }
  void WritePoint(const Eigen::Vector3d& point);
  void WriteRigid(const Rigid3d& rigid);
  void WriteSimilarity(const Similarity3d& similarity);

 private:
  void WriteSession(SessionId session, bool valid);

  ByteWriter& bytes_;
  std::vector<SessionId> sessions_;
};

// Reads what a MapWriter wrote, from bytes that may be anything: bytes().ok() is false where they were not.
class MapReader {
 public:
  explicit MapReader(ByteReader& bytes) : bytes_(bytes) {}

  ByteReader& bytes() { return bytes_; }
  template <typename Tag>
  Id<Tag> ReadId() {
    SessionId session = 0;
    if (!ReadSession(session)) return {};
    return {session, ReadCounter()};
  }
  Eigen::Vector3d ReadPoint();
  Rigid3d ReadRigid();
  Similarity3d ReadSimilarity();
  // A varint that fits 32 bits.
  std::uint32_t ReadCounter();

 private:
  // False for the id "none", which has no counter.
  bool ReadSession(SessionId& session);

  ByteReader& bytes_;
  std::vector<SessionId> sessions_;
};

}  // namespace pangaea
