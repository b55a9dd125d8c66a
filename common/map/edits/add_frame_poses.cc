#include "common/map/edits/add_frame_poses.h"

#include <algorithm>

#include "common/map/atlas_editor.h"
#include "common/map/frame_pose.h"
#include "common/map/validation.h"

namespace pangaea {
namespace {

// Frames as their keyframe holds them; the frames of one reference, which follow one another, in one go.
void InsertRun(std::span<const TrackedFrame> run, AtlasEditor& editor) {
  const KeyframeId reference = run.front().reference;
  const auto resolved = editor.atlas().ResolvePose(reference);
  if (!resolved) return;
  const KeyframeId holder = resolved->keyframe->id;
  std::vector<FramePose> frames;
  frames.reserve(run.size());
  for (const TrackedFrame& frame : run) {
    frames.push_back(frame.pose);
    frames.back().session = reference.session;
    Rigid3d& pose = frames.back().reference_from_frame;
    pose = ScaleLengths(pose, LengthFactor(*resolved->keyframe, frame.reference_scale));
    if (holder != reference) pose = resolved->keyframe_from_asked * pose;
  }
  editor.InsertFrames(holder, frames);
}

}  // namespace

Status Validate(const AddFramePoses& edit, const Atlas& atlas) {
  KeyframeId checked;
  for (std::size_t i = 0; i < edit.frames.size(); ++i) {
    const TrackedFrame& frame = edit.frames[i];
    if (frame.reference != checked) {
      if (auto status = CheckKnown(atlas, frame.reference); !status) return status;
      checked = frame.reference;
    }
    if (auto status = CheckPose(frame.pose.reference_from_frame); !status) return status;
    if (auto status = CheckScale(frame.reference_scale); !status) return status;
    if (i == 0 || edit.frames[i - 1].pose.stamp_ns < frame.pose.stamp_ns) continue;
    return Fail(ErrorCode::kInvalidArgument, "frame poses are not ascending by stamp");
  }
  return {};
}

void ApplyValid(const AddFramePoses& edit, AtlasEditor& editor) {
  const std::span<const TrackedFrame> frames(edit.frames);
  for (std::size_t begin = 0, end = 0; begin < frames.size(); begin = end) {
    while (end < frames.size() && frames[end].reference == frames[begin].reference) ++end;
    InsertRun(frames.subspan(begin, end - begin), editor);
  }
}

bool TouchesOnly(const AddFramePoses& edit, SessionId session) {
  return std::all_of(edit.frames.begin(), edit.frames.end(),
                     [&](const TrackedFrame& frame) { return frame.reference.session == session; });
}

void Encode(const AddFramePoses& edit, MapWriter& writer) {
  writer.bytes().Varint(edit.frames.size());
  for (const TrackedFrame& frame : edit.frames) {
    writer.WriteId(frame.reference);
    WriteFramePose(frame.pose, writer);
    WriteScale(frame.reference_scale, writer);
  }
}

void Decode(MapReader& reader, std::uint8_t version, AddFramePoses& edit) {
  edit.frames.resize(reader.bytes().Count(1 + kMinFramePoseBytes));
  for (TrackedFrame& frame : edit.frames) {
    frame.reference = reader.ReadId<KeyframeTag>();
    frame.pose = ReadFramePose(reader);
    if (version >= 2) frame.reference_scale = ReadScale(reader);
  }
}

}  // namespace pangaea
