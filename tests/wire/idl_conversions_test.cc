#include "common/wire/idl_conversions.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

namespace pangaea {
namespace {

SessionAnnouncement SomeSession() {
  SessionAnnouncement session;
  session.session = 0x1234567890abcdefULL;
  session.name = "a1";
  session.site = "hall";
  session.sensor_kind = SensorKind::kMonocular;
  session.ideal_camera = {752, 480, 458.0, 457.5, 367.2, 248.4, 0.11};
  session.body_from_camera = Rigid3d(Eigen::Quaterniond(0.5, -0.5, 0.5, 0.5), Eigen::Vector3d(-0.02, -0.06, 0.01));
  session.software_version = "0.1.0";
  session.wire_version = kWireVersion;
  session.epoch_ns = 1403636579763555584;
  session.closed = true;
  return session;
}

TEST(IdlConversions, ASessionComesBackAsItWas) {
  const SessionAnnouncement sent = SomeSession();
  const auto received = FromIdl(BorrowAsIdl(sent));
  ASSERT_TRUE(received);
  EXPECT_EQ(received->session, sent.session);
  EXPECT_EQ(received->name, sent.name);
  EXPECT_EQ(received->site, sent.site);
  EXPECT_EQ(received->sensor_kind, sent.sensor_kind);
  EXPECT_EQ(received->ideal_camera, sent.ideal_camera);
  EXPECT_EQ(received->body_from_camera.rotation().coeffs(), sent.body_from_camera.rotation().coeffs());
  EXPECT_EQ(received->body_from_camera.translation(), sent.body_from_camera.translation());
  EXPECT_EQ(received->software_version, sent.software_version);
  EXPECT_EQ(received->wire_version, sent.wire_version);
  EXPECT_EQ(received->epoch_ns, sent.epoch_ns);
  EXPECT_TRUE(received->closed);
}

TEST(IdlConversions, EnvelopesAndAcksAndStatusAndEventsComeBackAsTheyWere) {
  const Envelope envelope = MakeEnvelope(5, 6, 7, {});
  EXPECT_EQ(FromIdl(BorrowAsIdl(envelope)).value(), envelope);
  const EditAck ack{5, 6, 77, {{6, RejectionReason::kUnknownReference, "landmark 3 is unknown"}}, 12, true, 3};
  std::vector<pangaea_wire_Rejection> rejections;
  EXPECT_EQ(FromIdl(BorrowAsIdl(ack, rejections)).value(), ack);
  const AtlasStatus status{"hall", 8, 9, R"({"maps":[]})"};
  EXPECT_EQ(FromIdl(BorrowAsIdl(status)).value(), status);
  const AtlasEvent event{"hall", AtlasEventKind::kRejected, "wire version 9", 4, 10};
  EXPECT_EQ(FromIdl(BorrowAsIdl(event)).value(), event);
  const UndoRequest request{99, "merge 17"};
  EXPECT_EQ(FromIdl(BorrowAsIdl(request)).value(), request);
  const UndoAnswer answer{99, true, "merge 17 is undone"};
  EXPECT_EQ(FromIdl(BorrowAsIdl(answer)).value(), answer);
}

TEST(IdlConversions, CorrectionsAndInterestsAndRelocalizationsComeBackAsTheyWere) {
  const CorrectionPart part{5, 77, 6, 7, 1, 3, 99, std::vector<std::byte>(2, std::byte{7}), true};
  EXPECT_EQ(FromIdl(BorrowAsIdl(part)).value(), part);
  const MapInterest interest{5, 6, {5, 1}, {5, 30}, {{4, 1}, {4, 2}}, {{5, 7}, {5, 8}, {5, 9}}, {{5, 2}}, {3, 4, 88}};
  std::vector<pangaea_wire_ItemId> guests;
  EXPECT_EQ(FromIdl(BorrowAsIdl(interest, guests)).value(), interest);
  auto frame = std::make_shared<KeyframeData>();
  frame->stamp_ns = 12;
  frame->camera = SomeSession().ideal_camera;
  for (int i = 0; i < 2; ++i) {
    frame->features.keypoints.emplace_back();
    frame->features.descriptors.emplace_back();
  }
  std::vector<std::byte> octets;
  const auto request = FromIdl(BorrowAsIdl(RelocalizationRequest{5, 6, frame}, octets));
  ASSERT_TRUE(request);
  EXPECT_EQ(request->request, 6U);
  EXPECT_EQ(request->frame->stamp_ns, 12);
  EXPECT_EQ(request->frame->features.keypoints.size(), 2U);
  const RelocalizationAnswer answer{5, 6, true, {4, 1}, {4, 9}, Rigid3d({1, 0, 0, 0}, {1, 2, 3}), 8};
  const auto received = FromIdl(BorrowAsIdl(answer));
  ASSERT_TRUE(received);
  EXPECT_TRUE(received->found);
  EXPECT_EQ(received->reference, answer.reference);
  EXPECT_EQ(received->camera_from_reference.translation(), answer.camera_from_reference.translation());
  EXPECT_EQ(received->inliers, 8U);
}

TEST(IdlConversions, ImpossibleCorrectionsAndRequestsAreRefused) {
  CorrectionPart part{5, 77, 6, 7, 3, 3, 99, {}};
  EXPECT_FALSE(FromIdl(BorrowAsIdl(part)));  // of three parts the fourth
  part = {5, 77, 6, 7, 0, 1, 99, std::vector<std::byte>(kMaxCorrectionPartBytes + 1)};
  EXPECT_FALSE(FromIdl(BorrowAsIdl(part)));
  std::vector<pangaea_wire_ItemId> guests;
  EXPECT_FALSE(FromIdl(BorrowAsIdl(MapInterest{5, 6, {5, 1}, {5, 30}, {{4, 0}}}, guests)));
  EXPECT_FALSE(FromIdl(BorrowAsIdl(MapInterest{5, 6, {5, 1}, {5, 30}, {}, {{5, 0}}}, guests)));
  EXPECT_FALSE(FromIdl(BorrowAsIdl(MapInterest{5, 6, {5, 1}, {5, 30}, {}, {}, {{0, 3}}}, guests)));
  std::vector<std::byte> octets;
  EXPECT_FALSE(FromIdl(BorrowAsIdl(RelocalizationRequest{5, 6, nullptr}, octets)));
  RelocalizationAnswer answer{5, 6, true, {4, 1}, {}, Rigid3d(), 8};
  EXPECT_FALSE(FromIdl(BorrowAsIdl(answer)));
  answer.found = false;
  EXPECT_TRUE(FromIdl(BorrowAsIdl(answer)));
}

TEST(IdlConversions, AnAgentStateKeepsItsSimilarity) {
  AgentState state;
  state.session = 3;
  state.tracking = AgentTracking::kLost;
  state.map_from_odom = Similarity3d(2.5, Eigen::Quaterniond(0.8, 0.0, 0.6, 0.0), Eigen::Vector3d(1, 2, 3));
  state.frames = 100;
  const auto received = FromIdl(BorrowAsIdl(state));
  ASSERT_TRUE(received);
  EXPECT_EQ(received->tracking, AgentTracking::kLost);
  EXPECT_DOUBLE_EQ(received->map_from_odom.scale(), 2.5);
  EXPECT_EQ(received->map_from_odom.translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(received->frames, 100U);
}

TEST(IdlConversions, ASessionWithANaNPoseOrAnEmptyCameraIsRefused) {
  const SessionAnnouncement session = SomeSession();
  auto sample = BorrowAsIdl(session);
  sample.body_from_camera.translation[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(FromIdl(sample));
  sample = BorrowAsIdl(session);
  std::memset(sample.body_from_camera.rotation, 0, sizeof(sample.body_from_camera.rotation));
  EXPECT_FALSE(FromIdl(sample));
  sample = BorrowAsIdl(session);
  sample.ideal_camera.width = -5;
  EXPECT_FALSE(FromIdl(sample));
  sample = BorrowAsIdl(session);
  sample.ideal_camera.focal_x = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(FromIdl(sample));
  sample = BorrowAsIdl(session);
  sample.session = 0;
  EXPECT_FALSE(FromIdl(sample));
}

TEST(IdlConversions, NullTextsOfAnOlderPeerReadAsEmpty) {
  auto sample = BorrowAsIdl(SomeSession());
  sample.name = nullptr;
  sample.site = nullptr;
  sample.software_version = nullptr;
  const auto session = FromIdl(sample);
  ASSERT_TRUE(session);
  EXPECT_EQ(session->name, "");
}

TEST(IdlConversions, TooLongATextAndTooManyRejectionsAreRefused) {
  const AtlasEvent event{"hall", AtlasEventKind::kMerge, std::string(kMaxWireText + 1, 'x'), 0, 0};
  EXPECT_FALSE(FromIdl(BorrowAsIdl(event)));
  EditAck ack{1, 1, 1, {}};
  ack.rejections.resize(kMaxRejections + 1);
  std::vector<pangaea_wire_Rejection> rejections;
  EXPECT_FALSE(FromIdl(BorrowAsIdl(ack, rejections)));
}

TEST(IdlConversions, AKindFromANewerPeerArrivesAsItIs) {
  const AtlasEvent event{"hall", static_cast<AtlasEventKind>(999), "", 0, 0};
  EXPECT_EQ(FromIdl(BorrowAsIdl(event)).value(), event);
}

}  // namespace
}  // namespace pangaea
