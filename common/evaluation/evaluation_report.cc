#include "common/evaluation/evaluation_report.h"

#include <cstdio>
#include <nlohmann/json.hpp>

namespace pangaea {
namespace {

constexpr int kNameWidth = 24;

std::string Count(const std::optional<std::size_t>& count) { return count ? std::to_string(*count) : "-"; }

std::string Line(const std::string& name, const ErrorStatistics& error, std::size_t estimated, std::size_t frames,
                 double coverage, const MapCounts& counts, double scale) {
  char covered[32] = "-";
  if (frames > 0) std::snprintf(covered, sizeof(covered), "%.1f %%", 100.0 * coverage);
  char line[256];
  std::snprintf(line, sizeof(line), "%-*.*s %8zu %8zu %9s %9.4f %9.4f %9.4f %8.4f %5s %9s %10s\n", kNameWidth,
                kNameWidth, name.c_str(), frames, estimated, covered, error.rms, error.median, error.max, scale,
                Count(counts.maps).c_str(), Count(counts.keyframes).c_str(), Count(counts.landmarks).c_str());
  return line;
}

std::string JointLine(const AbsoluteError& joint, const MapCounts& total) {
  std::size_t estimated = 0;
  std::size_t frames = 0;
  for (const SessionError& session : joint.sessions) {
    estimated += session.estimated;
    frames += session.dataset_frames;
  }
  return Line("jointly", joint.error, estimated, frames, joint.coverage, total, joint.truth_from_estimate.scale());
}

nlohmann::json ErrorJson(const ErrorStatistics& error) {
  return {{"poses", error.count},
          {"rms_m", error.rms},
          {"mean_m", error.mean},
          {"median_m", error.median},
          {"max_m", error.max}};
}

void AddCounts(const MapCounts& counts, nlohmann::json& json) {
  if (counts.maps) json["maps"] = *counts.maps;
  if (counts.keyframes) json["keyframes"] = *counts.keyframes;
  if (counts.landmarks) json["landmarks"] = *counts.landmarks;
}

nlohmann::json SessionJson(const SessionError& session) {
  nlohmann::json json = {{"name", session.name},
                         {"ate", ErrorJson(session.error)},
                         {"tracked", session.estimated},
                         {"path_length_m", session.path_length}};
  if (session.dataset_frames > 0) {
    json["frames"] = session.dataset_frames;
    json["coverage"] = session.coverage;
  }
  return json;
}

nlohmann::json AlignmentJson(const Similarity3d& alignment) {
  const Eigen::Vector3d& t = alignment.translation();
  const Eigen::Quaterniond& q = alignment.rotation();
  return {{"scale", alignment.scale()},
          {"translation", {t.x(), t.y(), t.z()}},
          {"rotation_xyzw", {q.x(), q.y(), q.z(), q.w()}}};
}

}  // namespace

std::string FormatTable(const EvaluationReport& report) {
  char header[256];
  std::snprintf(header, sizeof(header), "%-*s %8s %8s %9s %9s %9s %9s %8s %5s %9s %10s\n", kNameWidth, "session",
                "frames", "tracked", "coverage", "ATE rms m", "median m", "max m", "scale", "maps", "keyframes",
                "landmarks");
  std::string table = header;
  for (const EvaluationReport::Row& row : report.alone) {
    for (const SessionError& session : row.error.sessions) {
      table += Line(session.name, session.error, session.estimated, session.dataset_frames, session.coverage,
                    row.counts, row.error.truth_from_estimate.scale());
    }
  }
  if (report.joint) table += JointLine(*report.joint, report.total);
  return table + (report.with_scale ? "(after Sim(3) alignment)\n" : "(after SE(3) alignment)\n");
}

nlohmann::json ToJson(const EvaluationReport& report) {
  nlohmann::json json = {{"alignment", report.with_scale ? "sim3" : "se3"}, {"sessions", nlohmann::json::array()}};
  for (const EvaluationReport::Row& row : report.alone) {
    for (const SessionError& session : row.error.sessions) {
      nlohmann::json entry = SessionJson(session);
      entry["truth_from_estimate"] = AlignmentJson(row.error.truth_from_estimate);
      AddCounts(row.counts, entry);
      json["sessions"].push_back(std::move(entry));
    }
  }
  if (report.joint) {
    nlohmann::json joint = {{"ate", ErrorJson(report.joint->error)},
                            {"coverage", report.joint->coverage},
                            {"truth_from_estimate", AlignmentJson(report.joint->truth_from_estimate)},
                            {"sessions", nlohmann::json::array()}};
    for (const SessionError& session : report.joint->sessions) joint["sessions"].push_back(SessionJson(session));
    json["joint"] = std::move(joint);
  }
  AddCounts(report.total, json);
  return json;
}

}  // namespace pangaea
