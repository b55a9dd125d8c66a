#include "common/evaluation/evaluation_report.h"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace pangaea {
namespace {

constexpr std::ptrdiff_t kScaleColumn = 9;  // always 1 after SE(3) alignment: not shown then

using Row = std::vector<std::string>;

std::string Count(const std::optional<std::size_t>& count) { return count ? std::to_string(*count) : "-"; }

std::string Fixed(double value, int decimals) {
  char text[64];
  std::snprintf(text, sizeof(text), "%.*f", decimals, value);
  return text;
}

// What one line of the table says: a session, or all of them under one alignment.
struct Summary {
  std::string name;
  std::size_t frames = 0;
  std::size_t estimated = 0;
  double coverage = 0.0;
  double path_length = 0.0;
  double scale = 1.0;
  ErrorStatistics error;
};

// The columns that compare a session among others with the one that ran alone.
struct Comparison {
  std::optional<double> joint_rms;
  std::optional<SingleRun> single;
};

Row ToRow(const Summary& line, const MapCounts& counts, const Comparison& comparison) {
  Row row{line.name, line.frames > 0 ? std::to_string(line.frames) : "-", std::to_string(line.estimated),
          line.frames > 0 ? Fixed(100.0 * line.coverage, 1) + " %" : "-"};
  const bool is_known = line.error.count > 0;
  for (const double error : {line.error.rms, line.error.median, line.error.max}) {
    row.push_back(is_known ? Fixed(error, 4) : "-");
  }
  row.push_back(is_known ? Fixed(line.error.rotation_rms, 2) : "-");
  row.push_back(is_known ? Fixed(line.path_length, 1) : "-");
  row.push_back(is_known ? Fixed(line.scale, 4) : "-");
  for (const auto& count : {counts.maps, counts.keyframes, counts.landmarks}) row.push_back(Count(count));
  row.push_back(comparison.joint_rms ? Fixed(*comparison.joint_rms, 4) : "-");
  const auto& single = comparison.single;
  row.push_back(single && single->rms ? Fixed(*single->rms, 4) : "-");
  row.push_back(single ? std::to_string(single->keyframes) : "-");
  row.push_back(single ? std::to_string(single->landmarks) : "-");
  return row;
}

Summary SummaryOf(const SessionError& session, double scale) {
  return {session.name, session.dataset_frames, session.estimated, session.coverage, session.path_length,
          scale,        session.error};
}

Summary SummaryOf(const AbsoluteError& joint) {
  Summary all{.name = "jointly", .coverage = joint.coverage, .error = joint.error};
  all.scale = joint.truth_from_estimate.scale();
  for (const SessionError& session : joint.sessions) {
    all.estimated += session.estimated;
    all.frames += session.dataset_frames;
    all.path_length += session.path_length;
  }
  return all;
}

std::optional<double> JointRms(const EvaluationReport& report, const std::string& name) {
  if (!report.joint) return std::nullopt;
  for (const SessionError& session : report.joint->sessions) {
    if (session.name == name && session.error.count > 0) return session.error.rms;
  }
  return std::nullopt;
}

// Of the columns in which no line says anything, nothing is shown. Names stand left, numbers right.
std::string Print(const std::vector<Row>& rows) {
  std::string text;
  std::vector<std::size_t> widths(rows.front().size(), 0);
  for (std::size_t column = 0; column < widths.size(); ++column) {
    const bool is_empty = std::all_of(rows.begin() + 1, rows.end(), [&](const Row& row) { return row[column] == "-"; });
    for (const Row& row : rows) widths[column] = is_empty ? 0 : std::max(widths[column], row[column].size());
  }
  for (const Row& row : rows) {
    text += row[0] + std::string(widths[0] - row[0].size(), ' ');
    for (std::size_t column = 1; column < row.size(); ++column) {
      if (widths[column] > 0) text += "  " + std::string(widths[column] - row[column].size(), ' ') + row[column];
    }
    text += "\n";
  }
  return text;
}

nlohmann::json ErrorJson(const ErrorStatistics& error) {
  return {{"poses", error.count},     {"rms_m", error.rms}, {"mean_m", error.mean},
          {"median_m", error.median}, {"max_m", error.max}, {"rotation_rms_deg", error.rotation_rms}};
}

void AddCounts(const MapCounts& counts, nlohmann::json& json) {
  if (counts.maps) json["maps"] = *counts.maps;
  if (counts.keyframes) json["keyframes"] = *counts.keyframes;
  if (counts.landmarks) json["landmarks"] = *counts.landmarks;
}

nlohmann::json SessionJson(const SessionError& session) {
  nlohmann::json json = {{"name", session.name}, {"tracked", session.estimated}};
  if (session.error.count > 0) {
    json["ate"] = ErrorJson(session.error);
    json["path_length_m"] = session.path_length;
  }
  if (session.dataset_frames > 0) {
    json["frames"] = session.dataset_frames;
    json["coverage"] = session.coverage;
  }
  return json;
}

nlohmann::json SingleJson(const SingleRun& single) {
  nlohmann::json json = {{"keyframes", single.keyframes}, {"landmarks", single.landmarks}};
  if (single.rms) json["rms_m"] = *single.rms;
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

std::optional<SingleRun> SumOfSingleRuns(const EvaluationReport& report) {
  SingleRun sum;
  for (const EvaluationReport::Row& row : report.alone) {
    if (!row.single) return std::nullopt;
    sum.keyframes += row.single->keyframes;
    sum.landmarks += row.single->landmarks;
  }
  return sum;
}

std::string FormatTable(const EvaluationReport& report) {
  std::vector<Row> rows{{"session", "frames", "tracked", "coverage", "ATE rms m", "median m", "max m", "rotation deg",
                         "path m", "scale", "maps", "keyframes", "landmarks", "joint m", "single m", "single keyframes",
                         "single landmarks"}};
  for (const EvaluationReport::Row& row : report.alone) {
    for (const SessionError& session : row.error.sessions) {
      const Summary summary = SummaryOf(session, row.error.truth_from_estimate.scale());
      rows.push_back(ToRow(summary, row.counts, {JointRms(report, session.name), row.single}));
    }
  }
  if (report.joint) rows.push_back(ToRow(SummaryOf(*report.joint), report.total, {{}, SumOfSingleRuns(report)}));
  if (!report.with_scale) {
    for (Row& row : rows) row.erase(row.begin() + kScaleColumn);
  }
  return Print(rows);
}

nlohmann::json ToJson(const EvaluationReport& report) {
  nlohmann::json json = {{"alignment", report.with_scale ? "sim3" : "se3"}, {"sessions", nlohmann::json::array()}};
  for (const EvaluationReport::Row& row : report.alone) {
    for (const SessionError& session : row.error.sessions) {
      nlohmann::json entry = SessionJson(session);
      if (session.error.count > 0) entry["truth_from_estimate"] = AlignmentJson(row.error.truth_from_estimate);
      AddCounts(row.counts, entry);
      if (row.single) entry["single"] = SingleJson(*row.single);
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
  if (report.joint) {
    if (const auto single = SumOfSingleRuns(report)) json["single"] = SingleJson(*single);
  }
  return json;
}

}  // namespace pangaea
