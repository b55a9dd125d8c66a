// Makes a large store of a small one, to measure on: every session so many times, each time under new ids:
//   store_copies IN.db COPIES OUT.db
// The copies of a keyframe are disturbed as if another flight had taken it: keypoints move by some tenths of a pixel,
// bits of descriptors flip. The maps of the copies are maps of their own, as no server has looked at them. Only of
// stores whose server made no edits.
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "common/map/limits.h"
#include "common/map/map_edit.h"
#include "common/wire/envelope.h"
#include "server/storage/store.h"

namespace pangaea {
namespace {

constexpr int kFlippedBits = 12;      // of 256 in each descriptor
constexpr double kPixelSigma = 0.15;  // in each coordinate
constexpr std::int64_t kLater = 3'600'000'000'000;

SessionId CopyOf(SessionId session, std::uint64_t copy) { return session ^ (copy * 0x9e3779b97f4a7c15ULL); }

// The encoding writes a session as its word once, then by its number.
std::vector<MapEdit> Renamed(const std::vector<MapEdit>& edits, const std::vector<SessionId>& sessions,
                             std::uint64_t copy) {
  std::vector<std::byte> bytes = EncodeEdits(edits);
  for (const SessionId session : sessions) {
    const SessionId renamed = CopyOf(session, copy);
    for (std::size_t i = 0; i + sizeof(session) <= bytes.size(); ++i) {
      if (std::memcmp(&bytes[i], &session, sizeof(session)) == 0) std::memcpy(&bytes[i], &renamed, sizeof(renamed));
    }
  }
  return DecodeEdits(bytes).value();
}

class Disturbance {
 public:
  explicit Disturbance(std::uint64_t seed) : random_(seed) {}

  KeyframeData Of(const KeyframeData& original, std::uint64_t copy) {
    KeyframeData data = original;
    data.stamp_ns += static_cast<std::int64_t>(copy) * kLater;
    for (Keypoint& keypoint : data.features.keypoints) {
      const float u = Moved(keypoint.u, data.camera.width);
      const float right = keypoint.u_right + (u - keypoint.u);
      if (keypoint.u_right >= 0.0F && (right < 0.0F || right >= static_cast<float>(data.camera.width))) continue;
      if (keypoint.u_right >= 0.0F) keypoint.u_right = right;
      keypoint.u = u;
      keypoint.v = Moved(keypoint.v, data.camera.height);
    }
    for (Descriptor& descriptor : data.features.descriptors) {
      for (int bit = 0; bit < kFlippedBits; ++bit) {
        const std::uint64_t flipped = random_() % 256;
        descriptor.words[flipped / 64] ^= std::uint64_t{1} << (flipped % 64);
      }
    }
    return data;
  }

 private:
  float Moved(float value, int limit) {
    const auto quanta = static_cast<float>(std::lround(kPixelSigma * noise_(random_) / kPixelQuantum));
    const float moved = value + quanta * kPixelQuantum;
    return moved >= 0.0F && moved < static_cast<float>(limit) ? moved : value;
  }

  std::mt19937_64 random_;
  std::normal_distribution<double> noise_{0.0, 1.0};
};

Status Copy(Store& from, std::uint64_t copies, Store& to) {
  auto sessions = from.Sessions();
  if (!sessions) return tl::make_unexpected(sessions.error());
  std::vector<SessionId> ids;
  for (const SessionRecord& record : *sessions) ids.push_back(record.announcement.session);
  std::uint64_t position = 0;
  for (std::uint64_t copy = 0; copy < copies; ++copy) {
    Disturbance disturbance(copy);
    JournalBatch batch;
    const auto take = [&](const JournalEntry& entry) -> Status {
      if (entry.envelope.session == 0) return Fail(ErrorCode::kUnsupported, "the store has edits of its server");
      auto edits = DecodeEdits(entry.envelope.edits);
      if (!edits) return tl::make_unexpected(edits.error());
      if (copy > 0) *edits = Renamed(*edits, ids, copy);
      for (MapEdit& edit : *edits) {
        auto* keyframe = std::get_if<AddKeyframe>(&edit);
        if (copy > 0 && keyframe != nullptr) {
          keyframe->data = std::make_shared<KeyframeData>(disturbance.Of(*keyframe->data, copy));
        }
      }
      batch.entries.push_back(
          {++position, MakeEnvelope(CopyOf(entry.envelope.session, copy), entry.envelope.sequence, 0, *edits)});
      return {};
    };
    if (auto status = from.ForEachEditsAfter(0, take); !status) return status;
    for (SessionRecord record : *sessions) {
      record.announcement.session = CopyOf(record.announcement.session, copy);
      record.announcement.closed = true;
      batch.sessions.push_back(std::move(record));
    }
    if (auto status = to.Append(batch); !status) return status;
  }
  return {};
}

Status Run(const std::string& in, std::uint64_t copies, const std::string& out) {
  auto from = Store::OpenReadOnly(in);
  if (!from) return tl::make_unexpected(from.error());
  auto to = Store::Open(out, from->site(), {});
  if (!to) return tl::make_unexpected(to.error());
  return Copy(*from, copies, *to);
}

}  // namespace
}  // namespace pangaea

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "store_copies IN.db COPIES OUT.db\n");
    return 2;
  }
  const auto status = pangaea::Run(argv[1], std::stoul(argv[2]), argv[3]);
  if (status) return 0;
  std::fprintf(stderr, "%s\n", status.error().message.c_str());
  return 1;
}
