#include "common/wire/idl_conversions.h"

#include <cmath>
#include <cstring>
#include <string>
#include <string_view>

#include "common/map/limits.h"

namespace pangaea {
namespace {

// The C binding has no const: what is borrowed is only ever read.
char* Borrow(const std::string& text) { return const_cast<char*>(text.c_str()); }

Result<std::string> ReadText(const char* text, const char* what, std::size_t limit = kMaxWireText) {
  const std::string_view view = text == nullptr ? std::string_view() : std::string_view(text);
  if (view.size() > limit) {
    return Fail(ErrorCode::kInvalidArgument, std::string(what) + " is longer than " + std::to_string(limit));
  }
  return std::string(view);
}

Result<IdealCamera> ReadCamera(const pangaea_wire_Camera& sample) {
  const IdealCamera camera{sample.width,    sample.height,   sample.focal_x, sample.focal_y,
                           sample.center_x, sample.center_y, sample.baseline};
  const auto is_side = [](int side) { return side > 0 && side <= kMaxImageSide; };
  const auto is_length = [](double value) { return std::isfinite(value) && value > 0.0 && value < kMaxLength; };
  const bool sound = is_side(camera.width) && is_side(camera.height) && is_length(camera.focal_x) &&
                     is_length(camera.focal_y) && std::isfinite(camera.center_x) && std::isfinite(camera.center_y) &&
                     (camera.baseline == 0.0 || is_length(camera.baseline));
  if (!sound) return Fail(ErrorCode::kInvalidArgument, "the ideal camera is none");
  return camera;
}

}  // namespace

pangaea_wire_RigidPose ToIdl(const Rigid3d& pose) {
  pangaea_wire_RigidPose sample;
  for (int i = 0; i < 4; ++i) sample.rotation[i] = pose.rotation().coeffs()[i];
  for (int i = 0; i < 3; ++i) sample.translation[i] = pose.translation()[i];
  return sample;
}

Result<Rigid3d> ReadPose(const pangaea_wire_RigidPose& sample, const char* what) {
  constexpr double kNormTolerance = 1e-3;  // what single precision leaves, and more
  const Eigen::Map<const Eigen::Vector4d> rotation(sample.rotation);
  const Eigen::Map<const Eigen::Vector3d> translation(sample.translation);
  const bool sound = rotation.allFinite() && std::abs(rotation.norm() - 1.0) < kNormTolerance &&
                     translation.allFinite() && translation.cwiseAbs().maxCoeff() < kMaxCoordinate;
  if (!sound) return Fail(ErrorCode::kInvalidArgument, std::string(what) + " is no rigid motion");
  return Rigid3d(Eigen::Quaterniond(Eigen::Vector4d(rotation)), translation);
}

pangaea_wire_SessionInfo BorrowAsIdl(const SessionAnnouncement& value) {
  const IdealCamera& camera = value.ideal_camera;
  pangaea_wire_SessionInfo sample{};
  sample.session = value.session;
  sample.name = Borrow(value.name);
  sample.site = Borrow(value.site);
  sample.sensor_kind = static_cast<std::uint32_t>(value.sensor_kind);
  sample.ideal_camera = {camera.width,    camera.height,   camera.focal_x, camera.focal_y,
                         camera.center_x, camera.center_y, camera.baseline};
  sample.body_from_camera = ToIdl(value.body_from_camera);
  sample.software_version = Borrow(value.software_version);
  sample.wire_version = value.wire_version;
  sample.epoch_ns = value.epoch_ns;
  sample.closed = value.closed;
  return sample;
}

Result<SessionAnnouncement> FromIdl(const pangaea_wire_SessionInfo& sample) {
  if (sample.session == 0) return Fail(ErrorCode::kInvalidArgument, "a session with the id 0");
  auto name = ReadText(sample.name, "the session's name");
  if (!name) return tl::make_unexpected(name.error());
  auto site = ReadText(sample.site, "the session's site");
  if (!site) return tl::make_unexpected(site.error());
  auto version = ReadText(sample.software_version, "the software version");
  if (!version) return tl::make_unexpected(version.error());
  const auto camera = ReadCamera(sample.ideal_camera);
  if (!camera) return tl::make_unexpected(camera.error());
  const auto body_from_camera = ReadPose(sample.body_from_camera, "body_from_camera");
  if (!body_from_camera) return tl::make_unexpected(body_from_camera.error());
  return SessionAnnouncement{.session = sample.session,
                             .name = std::move(*name),
                             .site = std::move(*site),
                             .sensor_kind = static_cast<SensorKind>(sample.sensor_kind),
                             .ideal_camera = *camera,
                             .body_from_camera = *body_from_camera,
                             .software_version = std::move(*version),
                             .wire_version = sample.wire_version,
                             .epoch_ns = sample.epoch_ns,
                             .closed = sample.closed};
}

pangaea_wire_MapEdits BorrowAsIdl(const Envelope& value) {
  pangaea_wire_MapEdits sample{};
  sample.session = value.session;
  sample.sequence_number = value.sequence;
  sample.base_correction_version = value.base_correction_version;
  sample.wire_version = value.wire_version;
  sample.checksum = value.checksum;
  const auto size = static_cast<std::uint32_t>(value.edits.size());
  auto* octets = const_cast<std::uint8_t*>(reinterpret_cast<const std::uint8_t*>(value.edits.data()));
  sample.edits = {._maximum = size, ._length = size, ._buffer = octets, ._release = false};
  return sample;
}

Result<Envelope> FromIdl(const pangaea_wire_MapEdits& sample) {
  Envelope envelope;
  envelope.session = sample.session;
  envelope.sequence = sample.sequence_number;
  envelope.base_correction_version = sample.base_correction_version;
  envelope.wire_version = sample.wire_version;
  envelope.checksum = sample.checksum;
  const auto* octets = reinterpret_cast<const std::byte*>(sample.edits._buffer);
  if (octets != nullptr) envelope.edits.assign(octets, octets + sample.edits._length);
  return envelope;
}

pangaea_wire_EditAck BorrowAsIdl(const EditAck& value, std::vector<pangaea_wire_Rejection>& rejections) {
  rejections.clear();
  for (const Rejection& rejection : value.rejections) {
    rejections.push_back({rejection.sequence, static_cast<std::uint32_t>(rejection.reason), Borrow(rejection.text)});
  }
  const auto size = static_cast<std::uint32_t>(rejections.size());
  pangaea_wire_EditAck sample{};
  sample.session = value.session;
  sample.up_to = value.up_to;
  sample.server_incarnation = value.server_incarnation;
  sample.rejections = {._maximum = size, ._length = size, ._buffer = rejections.data(), ._release = false};
  sample.correction_version = value.correction_version;
  sample.agreed_claim = value.agreed_claim;
  sample.working = value.working;
  return sample;
}

Result<EditAck> FromIdl(const pangaea_wire_EditAck& sample) {
  if (sample.rejections._length > kMaxRejections) {
    return Fail(ErrorCode::kInvalidArgument, "an ack with more than " + std::to_string(kMaxRejections) + " rejections");
  }
  EditAck ack{sample.session, sample.up_to,       sample.server_incarnation, {}, sample.correction_version,
              sample.working, sample.agreed_claim};
  for (std::uint32_t i = 0; i < sample.rejections._length; ++i) {
    const pangaea_wire_Rejection& rejection = sample.rejections._buffer[i];
    auto text = ReadText(rejection.text, "a rejection's text");
    if (!text) return tl::make_unexpected(text.error());
    ack.rejections.push_back(
        {rejection.sequence_number, static_cast<RejectionReason>(rejection.reason), std::move(*text)});
  }
  return ack;
}

pangaea_wire_AgentState BorrowAsIdl(const AgentState& value) {
  const Similarity3d& map_from_odom = value.map_from_odom;
  pangaea_wire_AgentState sample{};
  sample.session = value.session;
  sample.stamp_ns = value.stamp_ns;
  sample.tracking = static_cast<std::uint32_t>(value.tracking);
  sample.discontinuity = value.discontinuity;
  sample.map_counter = value.map_counter;
  sample.odom_from_body = ToIdl(value.odom_from_body);
  sample.map_from_odom = ToIdl(Rigid3d(map_from_odom.rotation(), map_from_odom.translation()));
  sample.map_from_odom_scale = map_from_odom.scale();
  sample.frames = value.frames;
  sample.tracked = value.tracked;
  sample.dropped = value.dropped;
  sample.keyframes = value.keyframes;
  sample.landmarks = value.landmarks;
  sample.tracking_ms = value.tracking_ms;
  sample.memory_mib = value.memory_mib;
  sample.bytes_sent = value.bytes_sent;
  sample.retained_edits = value.retained_edits;
  return sample;
}

Result<AgentState> FromIdl(const pangaea_wire_AgentState& sample) {
  const auto odom_from_body = ReadPose(sample.odom_from_body, "odom_from_body");
  if (!odom_from_body) return tl::make_unexpected(odom_from_body.error());
  const auto motion = ReadPose(sample.map_from_odom, "map_from_odom");
  if (!motion) return tl::make_unexpected(motion.error());
  const double scale = sample.map_from_odom_scale;
  if (!(scale > 1.0 / kMaxScale && scale < kMaxScale)) {
    return Fail(ErrorCode::kInvalidArgument, "the scale of map_from_odom is out of range");
  }
  return AgentState{.session = sample.session,
                    .stamp_ns = sample.stamp_ns,
                    .tracking = static_cast<AgentTracking>(sample.tracking),
                    .discontinuity = sample.discontinuity,
                    .map_counter = sample.map_counter,
                    .odom_from_body = *odom_from_body,
                    .map_from_odom = Similarity3d(scale, motion->rotation(), motion->translation()),
                    .frames = sample.frames,
                    .tracked = sample.tracked,
                    .dropped = sample.dropped,
                    .keyframes = sample.keyframes,
                    .landmarks = sample.landmarks,
                    .tracking_ms = sample.tracking_ms,
                    .memory_mib = sample.memory_mib,
                    .bytes_sent = sample.bytes_sent,
                    .retained_edits = sample.retained_edits};
}

pangaea_wire_AtlasStatus BorrowAsIdl(const AtlasStatus& value) {
  pangaea_wire_AtlasStatus sample{};
  sample.site = Borrow(value.site);
  sample.server_incarnation = value.server_incarnation;
  sample.stamp_ns = value.stamp_ns;
  sample.json = Borrow(value.json);
  return sample;
}

Result<AtlasStatus> FromIdl(const pangaea_wire_AtlasStatus& sample) {
  auto site = ReadText(sample.site, "the status' site");
  if (!site) return tl::make_unexpected(site.error());
  auto json = ReadText(sample.json, "the status", kMaxStatusBytes);
  if (!json) return tl::make_unexpected(json.error());
  return AtlasStatus{std::move(*site), sample.server_incarnation, sample.stamp_ns, std::move(*json)};
}

pangaea_wire_AtlasEvent BorrowAsIdl(const AtlasEvent& value) {
  pangaea_wire_AtlasEvent sample{};
  sample.site = Borrow(value.site);
  sample.kind = static_cast<std::uint32_t>(value.kind);
  sample.text = Borrow(value.text);
  sample.session = value.session;
  sample.stamp_ns = value.stamp_ns;
  return sample;
}

Result<AtlasEvent> FromIdl(const pangaea_wire_AtlasEvent& sample) {
  auto site = ReadText(sample.site, "the event's site");
  if (!site) return tl::make_unexpected(site.error());
  auto text = ReadText(sample.text, "the event's text");
  if (!text) return tl::make_unexpected(text.error());
  return AtlasEvent{std::move(*site), static_cast<AtlasEventKind>(sample.kind), std::move(*text), sample.session,
                    sample.stamp_ns};
}

pangaea_wire_UndoRequest BorrowAsIdl(const UndoRequest& value) { return {value.request, Borrow(value.cause)}; }

Result<UndoRequest> FromIdl(const pangaea_wire_UndoRequest& sample) {
  auto cause = ReadText(sample.cause, "the cause to undo");
  if (!cause) return tl::make_unexpected(cause.error());
  return UndoRequest{sample.request, std::move(*cause)};
}

pangaea_wire_UndoAnswer BorrowAsIdl(const UndoAnswer& value) { return {value.request, value.done, Borrow(value.text)}; }

Result<UndoAnswer> FromIdl(const pangaea_wire_UndoAnswer& sample) {
  auto text = ReadText(sample.text, "the answer");
  if (!text) return tl::make_unexpected(text.error());
  return UndoAnswer{sample.request, sample.done, std::move(*text)};
}

}  // namespace pangaea
