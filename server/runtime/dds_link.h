#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <vector>

#include "common/base/result.h"
#include "common/dds/participant.h"
#include "common/dds/reader.h"
#include "common/dds/waiter.h"
#include "common/dds/writer.h"
#include "server/atlas/relocalization_agenda.h"
#include "server/ingest/ingest_round.h"
#include "server/runtime/server_options.h"

namespace pangaea {

// Which participant each living writer belongs to. Used on the link's thread alone.
class SenderBook {
 public:
  Sender Find(const ReaderBase& reader, PublicationHandle publication);
  // Forgets the writers that `reader` does not match any more, and returns them.
  std::vector<PublicationHandle> TakeLost(const ReaderBase& reader);

 private:
  std::map<std::int32_t, std::map<PublicationHandle, std::uint64_t>> participants_;  // by reader
};

// The server's end of the DDS topics of one site. One thread takes what comes and hands it on.
class DdsLink {
 public:
  // Where goes what comes. Called on the link's thread; may wait.
  struct Sinks {
    std::function<void(IngestInput)> ingest;
    std::function<void(MapInterest)> interest;
    std::function<void(PlaceQuestion)> question;
    std::function<void(const Error&)> refused_question;  // none of ours; ever more seldom in a flood
    std::function<void(UndoRequest)> undo;
  };
  static Result<std::unique_ptr<DdsLink>> Open(const DomainOptions& domain, const std::string& site, Sinks sinks);

  void Start() { waiter_->Start(); }
  // No input reaches the sink any more; writing goes on.
  void Stop() { waiter_->Stop(); }

  // Any thread. What cannot be written is logged: acks are repeated when an agent asks, status and events come again.
  void Acknowledge(const EditAck& ack);
  void Report(const AtlasEvent& event);
  void Publish(const AtlasStatus& status);
  void Send(const CorrectionPart& part);
  void Answer(const RelocalizationAnswer& answer);
  void Answer(const UndoAnswer& answer);

 private:
  struct Topics {
    Reader<SessionAnnouncement> sessions;
    Reader<Envelope> edits;
    Reader<MapInterest> interests;
    Reader<RelocalizationRequest> requests;
    Writer<EditAck> acks;
    Writer<CorrectionPart> corrections;
    Writer<RelocalizationAnswer> answers;
    Writer<AtlasEvent> events;
    Writer<AtlasStatus> status;
    Reader<UndoRequest> undos;
    Writer<UndoAnswer> undo_answers;
  };
  static Result<Topics> OpenTopics(const Participant& participant);
  DdsLink(Domain domain, Participant participant, Topics topics, Sinks sinks);
  Status Connect();
  void SubmitLost(const ReaderBase& reader);

  // In the order of their dependence: destroyed from the last to the first.
  Domain domain_;
  Participant participant_;
  Topics topics_;
  Sinks sinks_;
  SenderBook senders_;
  std::uint64_t refused_questions_ = 0;
  std::unique_ptr<Waiter> waiter_;
};

}  // namespace pangaea
