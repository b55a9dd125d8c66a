// Recognises the places of a recorded store and compares what was recognised with ground truth:
//   place_replay [--copies N] atlas.db DATASET...
// Edits are applied in the order in which the server took them, and each keyframe is looked up as soon as it is there.
// With --copies the index also holds N disturbed copies of the store's keyframes, as ballast: what does a query cost
// then? Recordings whose names begin alike up to the last '_' share one world; others have nothing in common.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <map>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "cli/truth.h"
#include "common/evaluation/absolute_error.h"
#include "common/map/map_edit.h"
#include "common/place/vocabulary_file.h"
#include "server/ingest/agent_edit.h"
#include "server/place_recognition/place_recognizer.h"
#include "server/storage/recovery.h"

namespace pangaea {
namespace {

// A keyframe of a revisit: at most this far from an earlier one of another map, looking nearly the same way.
constexpr double kNear = 1.0;           // metres
constexpr double kNearAngle = 25.0;     // degrees
constexpr double kFalseDistance = 0.3;  // metres beyond which a match is false
constexpr double kFalseAngle = 5.0;     // degrees

// What the thread has worked, however busy the machine is.
struct ThreadClock {
  using duration = std::chrono::nanoseconds;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<ThreadClock>;
  static constexpr bool is_steady = true;
  static time_point now() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return time_point(std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec));
  }
};

class Durations final : public StageRecorder {
 public:
  void Begin(std::string_view name) override { open_.emplace_back(name, ThreadClock::now()); }
  void End(std::string_view name) override {
    Add(std::string(name), ThreadClock::now() - open_.back().second);
    open_.pop_back();
  }
  void Add(const std::string& name, std::chrono::duration<double, std::milli> taken) {
    milliseconds_[name].push_back(taken.count());
  }
  void Print() {
    for (auto& [name, values] : milliseconds_) {
      std::ranges::sort(values);
      double sum = 0.0;
      for (const double value : values) sum += value;
      std::printf("%-24s %6zu times  mean %6.2f  median %6.2f  p95 %6.2f  max %6.2f ms\n", name.c_str(), values.size(),
                  sum / static_cast<double>(values.size()), values[values.size() / 2], values[values.size() * 95 / 100],
                  values.back());
    }
  }

 private:
  std::vector<std::pair<std::string_view, ThreadClock::time_point>> open_;
  std::map<std::string, std::vector<double>> milliseconds_;
};

struct KnownPose {
  std::string world;
  Rigid3d world_from_camera;
};

double Degrees(const Eigen::Quaterniond& rotation) { return LogSo3(rotation).norm() * 180.0 / std::numbers::pi; }

class Replay {
 public:
  Replay(std::vector<Truth> truths, const std::vector<SessionRecord>& sessions,
         std::shared_ptr<const VocabularyTree> vocabulary)
      : truths_(std::move(truths)), recognizer_(std::move(vocabulary), PlaceRecognitionOptions{}) {
    for (const SessionRecord& record : sessions) names_[record.announcement.session] = record.announcement.name;
  }

  Status Take(const JournalEntry& entry) {
    const auto edits = DecodeEdits(entry.envelope.edits);
    if (!edits) return tl::make_unexpected(edits.error());
    const auto apply = entry.envelope.session == 0 ? &Apply : &ApplyAgentEdit;
    for (const MapEdit& edit : *edits) {
      if (auto status = apply(edit, atlas_); !status) return status;
      if (const auto* add = std::get_if<AddKeyframe>(&edit)) waiting_.push_back(add->id);
      if (const auto* remove = std::get_if<RemoveKeyframe>(&edit)) recognizer_.Remove(remove->id);
    }
    // A keyframe's landmarks may come in a later envelope than itself.
    std::erase_if(waiting_, [&](KeyframeId id) { return AskIfComplete(id); });
    return {};
  }

  // Fills the index up with keyframes of no atlas: a third of the features of each are others', the rest have flipped
  // bits.
  void AddCopies(const Atlas& atlas, std::size_t copies) {
    std::vector<const Keyframe*> originals;
    atlas.ForEachKeyframe([&](const Keyframe& keyframe) { originals.push_back(&keyframe); });
    std::mt19937_64 random(1);
    for (std::uint32_t i = 0; i < copies && !originals.empty(); ++i) {
      auto data = std::make_shared<KeyframeData>(*originals[i % originals.size()]->data);
      for (Descriptor& descriptor : data->features.descriptors) {
        const auto& others = originals[random() % originals.size()]->data->features.descriptors;
        if (random() % 3 == 0 && !others.empty()) descriptor = others[random() % others.size()];
        for (int bit = 0; bit < 16; ++bit) {
          const std::uint64_t flipped = random() % 256;
          descriptor.words[flipped / 64] ^= std::uint64_t{1} << (flipped % 64);
        }
      }
      Keyframe copy;
      copy.id = {1, i + 1};
      copy.data = std::move(data);
      recognizer_.Add(copy);
    }
  }

  void Print() {
    std::printf(
        "\n%zu keyframes asked, of them %zu near an earlier one of another map: %zu recognised (%.0f %%)\n", asked_,
        revisits_, recognized_revisits_,
        revisits_ == 0 ? 0.0 : 100.0 * static_cast<double>(recognized_revisits_) / static_cast<double>(revisits_));
    std::printf("%zu matches, %zu FALSE\n", matches_, false_matches_);
    for (auto* errors : {&distances_, &angles_}) {
      std::ranges::sort(*errors);
      if (errors->empty()) continue;
      std::printf("%s error: median %.4f  p90 %.4f  max %.4f\n", errors == &distances_ ? "position (m)" : "angle (deg)",
                  (*errors)[errors->size() / 2], (*errors)[errors->size() * 9 / 10], errors->back());
    }
    for (const auto& [outcome, count] : outcomes_) {
      std::printf("%-18s %5zu keyframes, of them revisits %zu\n", std::string(ToString(outcome)).c_str(), count,
                  revisit_outcomes_[outcome]);
    }
    durations_.Print();
  }

 private:
  std::optional<KnownPose> TruthOf(const Keyframe& keyframe) const {
    const auto name = names_.find(keyframe.id.session);
    if (name == names_.end()) return std::nullopt;
    for (const Truth& truth : truths_) {
      if (truth.name != name->second || !truth.body_from_camera) continue;
      const auto pose = InterpolatePose(truth.poses, keyframe.data->stamp_ns, {});
      if (!pose) return std::nullopt;
      return KnownPose{truth.name.substr(0, truth.name.rfind('_')), *pose * *truth.body_from_camera};
    }
    return std::nullopt;
  }

  bool IsRevisit(const Keyframe& keyframe, const KnownPose& pose) const {
    for (const auto& [id, other] : poses_) {
      const Keyframe* earlier = atlas_.FindKeyframe(id);
      if (earlier == nullptr || earlier->map == keyframe.map || other.world != pose.world) continue;
      const Rigid3d motion = other.world_from_camera.Inverse() * pose.world_from_camera;
      const Eigen::Vector3d axis = motion.rotation() * Eigen::Vector3d::UnitZ();
      if (motion.translation().norm() < kNear && axis.z() > std::cos(kNearAngle * std::numbers::pi / 180.0))
        return true;
    }
    return false;
  }

  // False where it has too few landmarks yet.
  bool AskIfComplete(KeyframeId id) {
    const Keyframe* keyframe = atlas_.FindKeyframe(id);
    if (keyframe == nullptr) return true;
    const auto seen = std::ranges::count_if(keyframe->landmarks, [](LandmarkId landmark) { return landmark.valid(); });
    if (seen < 50 && ++waited_[id] < 5) return false;
    Ask(id);
    return true;
  }

  void Ask(KeyframeId id) {
    const Keyframe& keyframe = *atlas_.FindKeyframe(id);
    const auto begin = ThreadClock::now();
    const PlaceRecognition recognition = recognizer_.Recognize(atlas_, id, durations_);
    const auto end = ThreadClock::now();
    durations_.Add("whole", end - begin);
    durations_.Add("whole, " + std::string(ToString(recognition.report.outcome)), end - begin);
    ++asked_;
    const auto pose = TruthOf(keyframe);
    const bool revisit = pose && IsRevisit(keyframe, *pose);
    revisits_ += revisit ? 1 : 0;
    recognized_revisits_ += revisit && !recognition.matches.empty() ? 1 : 0;
    ++outcomes_[recognition.report.outcome];
    revisit_outcomes_[recognition.report.outcome] += revisit ? 1 : 0;
    for (const PlaceTrial& trial : recognition.report.trials) PrintTrial(keyframe, pose, revisit, trial);
    for (const PlaceMatch& match : recognition.matches) Judge(match, pose);
    if (pose) poses_[id] = *pose;
  }

  void PrintTrial(const Keyframe& keyframe, const std::optional<KnownPose>& pose, bool revisit,
                  const PlaceTrial& trial) const {
    const auto other = poses_.find(trial.candidate);
    double distance = -1.0, angle = -1.0;
    if (pose && other != poses_.end() && other->second.world == pose->world) {
      const Rigid3d motion = other->second.world_from_camera.Inverse() * pose->world_from_camera;
      distance = motion.translation().norm();
      angle = Degrees(motion.rotation());
    }
    std::printf(
        "%s %s/%u %s/%u score %.3f truth %.2f m %.0f deg own %zu matches %zu aligned %zu guided %zu inliers %zu "
        "agreeing %zu "
        "against %zu  %s\n",
        revisit ? "R" : "-", names_.at(keyframe.id.session).c_str(), keyframe.id.counter,
        names_.at(trial.candidate.session).c_str(), trial.candidate.counter, trial.score, distance, angle,
        trial.counts.own_matches, trial.counts.matches, trial.counts.aligned, trial.counts.guided, trial.counts.inliers,
        trial.agreeing, trial.contradicting, std::string(ToString(trial.outcome)).c_str());
    if (trial.witnesses.empty()) return;
    const double off = angle >= 0.0 && trial.candidate_from_query
                           ? (trial.candidate_from_query->translation() -
                              (other->second.world_from_camera.Inverse() * pose->world_from_camera).translation())
                                 .norm()
                           : -1.0;
    std::printf("    %.4f m off, witnesses", off);
    for (const PlaceWitness& witness : trial.witnesses)
      std::printf(" %zu/%zu (%zu/%zu)", witness.found, witness.visible, witness.confirmed_cells,
                  witness.expected_cells);
    std::printf("\n");
  }

  void Judge(const PlaceMatch& match, const std::optional<KnownPose>& pose) {
    ++matches_;
    const auto other = poses_.find(match.candidate);
    if (!pose || other == poses_.end()) return;
    if (other->second.world != pose->world) {
      ++false_matches_;
      std::printf("  FALSE: another world\n");
      return;
    }
    const Rigid3d truth = other->second.world_from_camera.Inverse() * pose->world_from_camera;
    const double distance = (match.candidate_from_query.translation() - truth.translation()).norm();
    const double angle = Degrees(match.candidate_from_query.rotation() * truth.rotation().conjugate());
    distances_.push_back(distance);
    angles_.push_back(angle);
    const bool wrong = distance > kFalseDistance || angle > kFalseAngle;
    false_matches_ += wrong ? 1 : 0;
    std::printf("  %s %.4f m %.3f deg off, scale %.4f, rms %.2f\n", wrong ? "FALSE:" : "match:", distance, angle,
                match.candidate_from_query.scale(), match.evidence.rms_pixels);
  }

  std::vector<Truth> truths_;
  PlaceRecognizer recognizer_;
  std::map<SessionId, std::string> names_;
  Atlas atlas_;
  std::vector<KeyframeId> waiting_;
  std::map<KeyframeId, int> waited_;
  std::map<KeyframeId, KnownPose> poses_;
  Durations durations_;
  std::size_t asked_ = 0, revisits_ = 0, recognized_revisits_ = 0, matches_ = 0, false_matches_ = 0;
  std::vector<double> distances_, angles_;
  std::map<PlaceOutcome, std::size_t> outcomes_, revisit_outcomes_;
};

Status Run(const std::string& path, const std::vector<std::string>& datasets, std::size_t copies) {
  auto store = Store::OpenReadOnly(path);
  if (!store) return tl::make_unexpected(store.error());
  const auto sessions = store->Sessions();
  if (!sessions) return tl::make_unexpected(sessions.error());
  auto truths = ReadTruths(datasets);
  if (!truths) return tl::make_unexpected(truths.error());
  auto vocabulary = OpenVocabulary();
  if (!vocabulary) return tl::make_unexpected(vocabulary.error());
  Replay replay(std::move(*truths), *sessions, std::move(*vocabulary));
  if (copies > 0) {
    const auto recovered = RecoverAtlas(*store);
    if (!recovered) return tl::make_unexpected(recovered.error());
    replay.AddCopies(recovered->atlas, copies);
  }
  const auto take = [&replay](const JournalEntry& entry) { return replay.Take(entry); };
  if (auto status = store->ForEachEditsAfter(0, take); !status) return status;
  replay.Print();
  return {};
}

}  // namespace
}  // namespace pangaea

int main(int argc, char** argv) {
  std::vector<std::string> arguments(argv + 1, argv + argc);
  std::size_t copies = 0;
  if (arguments.size() >= 2 && arguments[0] == "--copies") {
    copies = std::stoul(arguments[1]);
    arguments.erase(arguments.begin(), arguments.begin() + 2);
  }
  if (arguments.empty()) {
    std::fprintf(stderr, "place_replay [--copies N] STORE DATASET...\n");
    return 2;
  }
  const auto status = pangaea::Run(arguments[0], {arguments.begin() + 1, arguments.end()}, copies);
  if (status) return 0;
  std::fprintf(stderr, "%s\n", status.error().message.c_str());
  return 1;
}
