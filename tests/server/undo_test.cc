#include "server/storage/undo.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "common/map/consistency.h"
#include "common/map/digest.h"
#include "server/storage/recovery.h"
#include "server/storage/snapshot_store.h"
#include "tests/map/small_world.h"
#include "tests/server/flight.h"
#include "tests/server/temporary_store.h"

namespace pangaea {
namespace {

const Similarity3d kAnnaFromBert =
    Similarity3d::FromNormalized(1.0, Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY())), {1, 2, 3})
        .value();

// Two flights in a store, and what the server makes of them.
class MergedStore {
 public:
  MergedStore() : store_(Store::Open(place_.path(), "hall", {}).value()) {}

  void Fly(Flight& flight, int envelopes) {
    for (int i = 0; i < envelopes; ++i) Send(flight.Next());
  }
  void Send(const Envelope& envelope) {
    Play(envelope.edits);
    ASSERT_TRUE(store_.Append({{{++position_, envelope}}, {}, {}, {}}));
  }
  // Returns the cause.
  std::string Edit(const std::string& kind, const std::vector<MapEdit>& edits) {
    const std::string cause = kind + " " + std::to_string(position_ + 1);
    Edit({position_ + 1, cause, EncodeEdits(edits)});
    return cause;
  }
  void Edit(const ServerEdits& edits) {
    Play(edits.edits);
    position_ = edits.position;
    ASSERT_TRUE(store_.Append({{}, {edits}, {}, {}}));
  }
  void Snapshot() { ASSERT_TRUE(SnapshotStore::Open(place_.path(), 0)->Write(atlas_, position_, 1, {})); }
  void Keep() { ASSERT_TRUE(SnapshotStore::Open(place_.path(), 0)->Keep(atlas_, position_, 1, {})); }
  std::string Merge() { return Edit("merge", {MergeMaps{M(1), M(1, kBert), kAnnaFromBert, K(1, kBert), K(1)}}); }

  Result<UndoReport> Undo(const std::string& cause) { return UndoCause(store_, cause, 1); }
  RecoveredAtlas Recover() {
    auto recovered = RecoverAtlas(store_);
    EXPECT_TRUE(recovered) << recovered.error().message;
    if (!recovered) return {};
    EXPECT_TRUE(CheckConsistency(recovered->atlas).empty());
    return std::move(*recovered);
  }
  const Atlas& atlas() const { return atlas_; }
  Store& store() { return store_; }

  Flight anna{kAnna};
  Flight bert{kBert, {.keypoints = 41}};

 private:
  void Play(const std::vector<std::byte>& edits) {
    const auto decoded = DecodeEdits(edits);
    ASSERT_TRUE(decoded);
    for (const MapEdit& edit : *decoded) {
      const Status applied = Apply(edit, atlas_);
      ASSERT_TRUE(applied) << applied.error().message;
    }
  }

  TemporaryStore place_;
  Store store_;
  Atlas atlas_;
  std::uint64_t position_ = 0;
};

TEST(Undo, AMergeTakenBackGivesTheAtlasAsWithoutIt) {
  MergedStore merged;
  merged.Fly(merged.anna, 5);
  merged.Fly(merged.bert, 5);
  const std::string cause = merged.Merge();
  merged.Fly(merged.anna, 3);
  merged.Fly(merged.bert, 3);
  EXPECT_EQ(cause, "merge 11");
  ASSERT_EQ(merged.Recover().atlas.Maps().size(), 1u);
  const auto undone = merged.Undo(cause);
  ASSERT_TRUE(undone) << undone.error().message;
  EXPECT_EQ(undone->misfits, 0u);
  EXPECT_TRUE(undone->also.empty());
  const RecoveredAtlas recovered = merged.Recover();
  EXPECT_EQ(recovered.atlas.Maps(), (std::vector<MapId>{M(1), M(1, kBert)}));
  EXPECT_EQ(Digest(recovered.atlas, M(1)), Digest(merged.anna.atlas(), M(1)));
  EXPECT_EQ(Digest(recovered.atlas, M(1, kBert)), Digest(merged.bert.atlas(), M(1, kBert)));
  EXPECT_TRUE(recovered.atlas.merged_maps().empty()) << "forwarding included";
}

TEST(Undo, TheMapsTakenApartAreRemembered) {
  MergedStore merged;
  merged.Fly(merged.anna, 2);
  merged.Fly(merged.bert, 2);
  ASSERT_TRUE(merged.Undo(merged.Merge()));
  const auto separations = merged.Recover().separations;
  ASSERT_EQ(separations.size(), 1u);
  EXPECT_EQ(separations[0], std::pair(M(1), M(1, kBert)));
}

TEST(Undo, ReachesBackFromASnapshotThatWasKept) {
  MergedStore merged;
  merged.Fly(merged.anna, 5);
  merged.Fly(merged.bert, 5);
  merged.Keep();
  const std::string cause = merged.Merge();
  merged.Fly(merged.anna, 3);
  merged.Snapshot();
  merged.Fly(merged.anna, 1);
  const auto undone = merged.Undo(cause);
  ASSERT_TRUE(undone) << undone.error().message;
  EXPECT_EQ(Digest(merged.Recover().atlas, M(1)), Digest(merged.anna.atlas(), M(1)));
}

TEST(Undo, WithoutASnapshotFromBeforeItThereIsNothingToUndo) {
  MergedStore merged;
  merged.Fly(merged.anna, 5);
  merged.Fly(merged.bert, 5);
  const std::string cause = merged.Merge();
  merged.Fly(merged.anna, 40);
  merged.Edit("loop", {AddLoopEdge{K(5), K(1), {}}});
  merged.Keep();
  merged.Fly(merged.anna, 1);
  merged.Snapshot();
  const auto undone = merged.Undo(cause);
  ASSERT_FALSE(undone);
  EXPECT_EQ(undone.error().code, ErrorCode::kNotFound) << "it is not even in the journal any more";
  EXPECT_EQ(Fingerprint(merged.Recover().atlas), Fingerprint(merged.atlas()));
}

// Poses that were optimised on the merged map, a second merge that used it, and an optimisation elsewhere.
TEST(Undo, WhatTheServerBuiltOnItLaterIsTakenBackWithItAndTheRestStays) {
  constexpr SessionId kCarl = 0xc, kDora = 0xd;
  Flight carl(kCarl), dora(kDora);
  MergedStore merged;
  merged.Fly(merged.anna, 3);
  merged.Fly(merged.bert, 3);
  merged.Fly(carl, 3);
  merged.Fly(dora, 3);
  const std::string cause = merged.Merge();
  const MoveKeyframes elsewhere{{{K(2, kDora), MakePose(0.1, 0.1, 0, 0)}}};
  merged.Edit("optimization", {elsewhere});
  const std::string built = merged.Edit("optimization", {MoveKeyframes{{{K(2, kBert), MakePose(0.2, 1, 0, 0)}}}});
  const std::string second = merged.Edit("merge", {MergeMaps{M(1), M(1, kCarl), {}, K(1, kCarl), K(1, kBert)}});
  const auto undone = merged.Undo(cause);
  ASSERT_TRUE(undone) << undone.error().message;
  EXPECT_EQ(undone->also, (std::vector<std::string>{second, built}));
  EXPECT_EQ(undone->separations.size(), 1u) << "the second merge may be found again";
  const RecoveredAtlas recovered = merged.Recover();
  EXPECT_EQ(recovered.atlas.Maps().size(), 4u);
  EXPECT_EQ(Digest(recovered.atlas, M(1, kBert)), Digest(merged.bert.atlas(), M(1, kBert)));
  EXPECT_EQ(Digest(recovered.atlas, M(1, kCarl)), Digest(carl.atlas(), M(1, kCarl)));
  EXPECT_EQ(Digest(recovered.atlas, M(1, kDora)), Digest(merged.atlas(), M(1, kDora)));
}

TEST(Undo, WhatAgentsDidOnTheMergedMapIsKeptAsFarAsItMakesSense) {
  MergedStore merged;
  merged.Fly(merged.anna, 3);
  merged.Fly(merged.bert, 3);
  const std::string cause = merged.Merge();
  // Bert sees one of Anna's landmarks, and goes on below one of her keyframes.
  const auto observation = std::vector<MapEdit>{AddObservation{L(1), K(3, kBert), 40}};
  const auto guest =
      std::vector<MapEdit>{AddKeyframe{K(100, kBert), M(1, kBert), K(3), MakePose(0.1, 0.1, 0, 0), MakeData(40, 1)}};
  merged.Send(merged.bert.NextWith(observation));
  merged.Send(merged.bert.NextWith(guest));
  const auto undone = merged.Undo(cause);
  ASSERT_TRUE(undone) << undone.error().message;
  EXPECT_EQ(undone->misfits, 0u);
  EXPECT_FALSE(merged.Recover().atlas.FindKeyframe(K(3, kBert))->landmarks[40].valid())
      << "the observation across what are two maps now";
  EXPECT_EQ(merged.Recover().atlas.FindKeyframe(K(100, kBert))->map, M(1)) << "with its parent";
}

TEST(Undo, TheServerGoesOnFromThereAndTheUndoingIsACorrection) {
  MergedStore merged;
  merged.Fly(merged.anna, 3);
  merged.Fly(merged.bert, 3);
  const auto undone = merged.Undo(merged.Merge());
  ASSERT_TRUE(undone);
  EXPECT_EQ(undone->position, 8u);
  RecoveredAtlas recovered = merged.Recover();
  EXPECT_EQ(recovered.position, 8u);
  ASSERT_TRUE(merged.store().Append({{{9, merged.anna.Next()}}, {}, {}, {}}));
  recovered = merged.Recover();
  EXPECT_EQ(recovered.replayed, 1u);
  EXPECT_EQ(Digest(recovered.atlas, M(1)), Digest(merged.anna.atlas(), M(1)));
}

TEST(Undo, OneAfterTheOtherAlsoTheEarlierAfterTheLater) {
  constexpr SessionId kCarl = 0xc;
  Flight carl(kCarl);
  MergedStore merged;
  merged.Fly(merged.anna, 3);
  merged.Fly(merged.bert, 3);
  merged.Fly(carl, 3);
  const std::string first = merged.Merge();
  const std::string second = merged.Edit("merge", {MergeMaps{M(1), M(1, kCarl), {}, K(1, kCarl), K(1)}});
  ASSERT_TRUE(merged.Undo(second));
  EXPECT_EQ(merged.Recover().atlas.Maps().size(), 2u);
  ASSERT_TRUE(merged.Undo(first));
  EXPECT_EQ(merged.Recover().atlas.Maps().size(), 3u);
  EXPECT_FALSE(merged.Undo(first)) << "it was undone";
  EXPECT_FALSE(merged.Undo("merge 4711"));
}

TEST(Undo, TheListTellsWhatCanBeUndone) {
  MergedStore merged;
  merged.Fly(merged.anna, 3);
  merged.Fly(merged.bert, 3);
  const std::string cause = merged.Merge();
  merged.Edit({merged.Recover().position + 1, cause, EncodeEdits(std::vector<MapEdit>{RemoveLandmark{L(1)}})});
  auto causes = ListCauses(merged.store());
  ASSERT_TRUE(causes);
  ASSERT_EQ(causes->size(), 1u);
  EXPECT_EQ(causes->at(0).cause, cause);
  EXPECT_EQ(causes->at(0).entries, 2u);
  EXPECT_TRUE(causes->at(0).reachable);
  EXPECT_FALSE(causes->at(0).undone);
  ASSERT_TRUE(merged.Undo(cause));
  causes = ListCauses(merged.store());
  ASSERT_TRUE(causes);
  EXPECT_TRUE(causes->at(0).undone);
}

}  // namespace
}  // namespace pangaea
