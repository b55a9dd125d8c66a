#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <utility>
#include <vector>

#include "common/map/digest.h"
#include "server/ingest/ingest_round.h"
#include "tests/server/flight.h"

namespace pangaea {

inline constexpr Sender kAgent{1, 100};

// The ingest with a store that always takes everything.
class Ingest {
 public:
  IngestOutcome Take(const std::vector<Envelope>& envelopes, Sender sender = kAgent) {
    IngestRound round(state_, {}, 1234);
    for (const Envelope& envelope : envelopes) round.Take(EnvelopeArrived{envelope, sender});
    return Adopt(std::move(round));
  }
  IngestOutcome Announce(const SessionAnnouncement& announcement, Sender sender = kAgent) {
    IngestRound round(state_, {}, 1234);
    round.Take(SessionAnnounced{announcement, sender});
    return Adopt(std::move(round));
  }
  IngestOutcome Lose(std::uint64_t writer) {
    IngestRound round(state_, {}, 1234);
    round.Take(WriterLost{writer});
    return Adopt(std::move(round));
  }
  IngestOutcome Propose(EditsProposed proposal) {
    IngestRound round(state_, {}, 1234);
    round.Take(std::move(proposal));
    return Adopt(std::move(round));
  }
  // Expects that the next envelope of the flight, with `edits` or spoiled, is rejected whole, and that the flight goes
  // on after it.
  void ExpectRejected(Flight& flight, const Envelope& envelope, RejectionReason reason) {
    const std::uint64_t digest = Digest(state_.atlas);
    const std::uint64_t version = state_.atlas.version();
    const IngestOutcome outcome = Take({envelope});
    EXPECT_EQ(Digest(state_.atlas), digest);
    EXPECT_EQ(state_.atlas.version(), version);
    EXPECT_TRUE(outcome.batch.entries.empty());
    ASSERT_EQ(outcome.batch.rejections.size(), 1u);
    EXPECT_EQ(outcome.batch.rejections[0].session, envelope.session);
    ASSERT_EQ(outcome.acks.size(), 1u);
    EXPECT_EQ(outcome.acks[0].up_to, envelope.sequence);
    ASSERT_EQ(outcome.acks[0].rejections.size(), 1u);
    EXPECT_EQ(outcome.acks[0].rejections[0].sequence, envelope.sequence);
    EXPECT_EQ(outcome.acks[0].rejections[0].reason, reason) << outcome.acks[0].rejections[0].text;
    EXPECT_FALSE(outcome.acks[0].rejections[0].text.empty());
    ASSERT_EQ(outcome.events.size(), 1u);
    EXPECT_EQ(outcome.events[0].kind, AtlasEventKind::kRejected);
    EXPECT_EQ(Take({flight.Next()}).batch.entries.size(), 1u);
    EXPECT_EQ(Digest(state_.atlas), Digest(flight.atlas()));
  }

  const IngestState& state() const { return state_; }

 private:
  IngestOutcome Adopt(IngestRound round) {
    IngestOutcome outcome = std::move(round).Finish();
    state_ = outcome.state;
    return outcome;
  }

  IngestState state_;
};

}  // namespace pangaea
