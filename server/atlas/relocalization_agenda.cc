#include "server/atlas/relocalization_agenda.h"

#include <utility>

namespace pangaea {

bool RelocalizationAgenda::Put(PlaceQuestion question) {
  const SessionId session = question.request.session;
  const auto waiting = waiting_.find(session);
  if (waiting == waiting_.end() && waiting_.size() >= kMostSessions) return false;
  if (waiting != waiting_.end() && waiting->second.request.request > question.request.request) return true;
  waiting_.insert_or_assign(session, std::move(question));
  return true;
}

std::optional<PlaceQuestion> RelocalizationAgenda::Next() {
  if (waiting_.empty()) return std::nullopt;
  auto next = waiting_.upper_bound(served_);
  if (next == waiting_.end()) next = waiting_.begin();
  served_ = next->first;
  PlaceQuestion question = std::move(next->second);
  waiting_.erase(next);
  return question;
}

Status CheckQuestion(const IngestState& state, const PlaceQuestion& question) {
  const auto session = state.sessions.find(question.request.session);
  if (session == state.sessions.end() || !session->second.alive()) {
    return Fail(ErrorCode::kNotFound, "no such agent is here");
  }
  if (!session->second.IsOwnedBy(question.sender)) {
    return Fail(ErrorCode::kRefused, "asked by one that does not own it");
  }
  if (question.request.frame == nullptr) return Fail(ErrorCode::kInvalidArgument, "there is no frame");
  const SessionAnnouncement& announced = session->second.record().announcement;
  if (question.request.frame->camera.is_stereo() == announced.ideal_camera.is_stereo()) return {};
  return Fail(ErrorCode::kInvalidArgument, "the frame is of another kind of camera than the session's");
}

}  // namespace pangaea
