// The conversions of what flows back to agents, and of what they ask for.
#include <algorithm>
#include <string>
#include <utility>

#include "common/map/keyframe_codec.h"
#include "common/map/validation.h"
#include "common/wire/idl_conversions.h"

namespace pangaea {
namespace {

template <typename Sequence>
void BorrowOctets(const std::vector<std::byte>& octets, Sequence& sequence) {
  const auto size = static_cast<std::uint32_t>(octets.size());
  sequence._maximum = size;
  sequence._length = size;
  sequence._buffer = const_cast<std::uint8_t*>(reinterpret_cast<const std::uint8_t*>(octets.data()));
  sequence._release = false;
}

template <typename Sequence>
std::span<const std::byte> OctetsOf(const Sequence& sequence) {
  if (sequence._buffer == nullptr) return {};
  return {reinterpret_cast<const std::byte*>(sequence._buffer), sequence._length};
}

template <typename Tag>
pangaea_wire_ItemId ToIdl(const Id<Tag>& id) {
  return {id.session, id.counter};
}

template <typename Id>
Id IdOf(const pangaea_wire_ItemId& sample) {
  return {sample.session, sample.counter};
}

// None, or one that can be.
template <typename Id>
bool IsIdOrNone(const Id& id) {
  return id == Id{} || CheckNewId(id).has_value();
}

}  // namespace

pangaea_wire_CorrectionPart BorrowAsIdl(const CorrectionPart& value) {
  pangaea_wire_CorrectionPart sample{};
  sample.session = value.session;
  sample.server_incarnation = value.server_incarnation;
  sample.version = value.version;
  sample.acknowledged = value.acknowledged;
  sample.part = value.part;
  sample.parts = value.parts;
  sample.checksum = value.checksum;
  BorrowOctets(value.octets, sample.octets);
  sample.complete = value.complete;
  return sample;
}

Result<CorrectionPart> FromIdl(const pangaea_wire_CorrectionPart& sample) {
  const auto octets = OctetsOf(sample.octets);
  if (sample.session == 0 || sample.version == 0 || sample.part >= sample.parts) {
    return Fail(ErrorCode::kInvalidArgument, "a correction without session or version, or a part beyond its parts");
  }
  if (octets.size() > kMaxCorrectionPartBytes) {
    return Fail(ErrorCode::kInvalidArgument, "a part of a correction with " + std::to_string(octets.size()) +
                                                 " octets; the limit is " + std::to_string(kMaxCorrectionPartBytes));
  }
  return CorrectionPart{
      sample.session,  sample.server_incarnation,      sample.version, sample.acknowledged, sample.part, sample.parts,
      sample.checksum, {octets.begin(), octets.end()}, sample.complete};
}

pangaea_wire_MapInterest BorrowAsIdl(const MapInterest& value, std::vector<pangaea_wire_ItemId>& ids) {
  ids.clear();
  ids.reserve(value.guests.size() + value.held.size() + value.wanted.size());
  const auto borrow = [&ids](const std::vector<KeyframeId>& list, auto& sequence) {
    const auto size = static_cast<std::uint32_t>(list.size());
    sequence = {._maximum = size, ._length = size, ._buffer = ids.data() + ids.size(), ._release = false};
    for (const KeyframeId id : list) ids.push_back(ToIdl(id));
  };
  pangaea_wire_MapInterest sample{};
  sample.session = value.session;
  sample.applied_version = value.applied_version;
  sample.map_id = ToIdl(value.map);
  sample.reference = ToIdl(value.reference);
  borrow(value.guests, sample.guests);
  borrow(value.held, sample.held);
  borrow(value.wanted, sample.wanted);
  sample.claim = value.claim.number;
  sample.claim_sequence = value.claim.sequence;
  sample.claim_digest = value.claim.digest;
  return sample;
}

Result<MapInterest> FromIdl(const pangaea_wire_MapInterest& sample) {
  MapInterest interest{
      sample.session, sample.applied_version, IdOf<MapId>(sample.map_id), IdOf<KeyframeId>(sample.reference), {}};
  for (const auto& [from, to] : {std::pair(&sample.guests, &interest.guests), std::pair(&sample.held, &interest.held),
                                 std::pair(&sample.wanted, &interest.wanted)}) {
    const std::uint32_t count = from->_buffer == nullptr ? 0 : from->_length;
    if (count > kMaxInterestIds) {
      return Fail(ErrorCode::kInvalidArgument,
                  "an interest with more than " + std::to_string(kMaxInterestIds) + " keyframes of a kind");
    }
    for (std::uint32_t i = 0; i < count; ++i) to->push_back(IdOf<KeyframeId>(from->_buffer[i]));
  }
  interest.claim = {sample.claim, sample.claim_sequence, sample.claim_digest};
  const auto can_be = [](const std::vector<KeyframeId>& ids) {
    return std::all_of(ids.begin(), ids.end(), [](KeyframeId id) { return CheckNewId(id).has_value(); });
  };
  const bool sound = interest.session != 0 && IsIdOrNone(interest.map) && IsIdOrNone(interest.reference) &&
                     can_be(interest.guests) && can_be(interest.held) && can_be(interest.wanted);
  if (!sound) return Fail(ErrorCode::kInvalidArgument, "an interest of session 0, or with impossible ids");
  return interest;
}

pangaea_wire_RelocalizationRequest BorrowAsIdl(const RelocalizationRequest& value, std::vector<std::byte>& octets) {
  ByteWriter bytes;
  if (value.frame) EncodeKeyframeData(*value.frame, bytes);
  octets = bytes.Take();
  pangaea_wire_RelocalizationRequest sample{};
  sample.session = value.session;
  sample.request = value.request;
  BorrowOctets(octets, sample.frame);
  return sample;
}

Result<RelocalizationRequest> FromIdl(const pangaea_wire_RelocalizationRequest& sample) {
  const auto octets = OctetsOf(sample.frame);
  if (sample.session == 0 || octets.size() > kMaxFrameBytes) {
    return Fail(ErrorCode::kInvalidArgument, "a request of session 0, or with a frame that is too large");
  }
  ByteReader reader(octets);
  auto frame = DecodeKeyframeData(reader);
  if (!frame) return tl::make_unexpected(frame.error());
  if (reader.remaining() != 0) return Fail(ErrorCode::kCorrupt, "a frame is followed by something else");
  if (const Status status = CheckKeyframeData(**frame); !status) return tl::make_unexpected(status.error());
  return RelocalizationRequest{sample.session, sample.request, std::move(*frame)};
}

pangaea_wire_RelocalizationAnswer BorrowAsIdl(const RelocalizationAnswer& value) {
  pangaea_wire_RelocalizationAnswer sample{};
  sample.session = value.session;
  sample.request = value.request;
  sample.found = value.found;
  sample.map_id = ToIdl(value.map);
  sample.reference = ToIdl(value.reference);
  sample.camera_from_reference = ToIdl(value.camera_from_reference);
  sample.inliers = value.inliers;
  return sample;
}

Result<RelocalizationAnswer> FromIdl(const pangaea_wire_RelocalizationAnswer& sample) {
  RelocalizationAnswer answer;
  answer.session = sample.session;
  answer.request = sample.request;
  answer.found = sample.found;
  if (sample.session == 0) return Fail(ErrorCode::kInvalidArgument, "an answer to session 0");
  if (!answer.found) return answer;
  answer.map = IdOf<MapId>(sample.map_id);
  answer.reference = IdOf<KeyframeId>(sample.reference);
  answer.inliers = sample.inliers;
  if (!CheckNewId(answer.map) || !CheckNewId(answer.reference)) {
    return Fail(ErrorCode::kInvalidArgument, "an answer with impossible ids");
  }
  const auto pose = ReadPose(sample.camera_from_reference, "camera_from_reference");
  if (!pose) return tl::make_unexpected(pose.error());
  answer.camera_from_reference = *pose;
  return answer;
}

}  // namespace pangaea
