#include "common/map/edits/remove_keyframe.h"

#include "common/map/atlas_editor.h"
#include "common/map/frame_correction.h"
#include "common/map/map_bytes.h"
#include "common/map/validation.h"

namespace pangaea {
namespace {

// Its frames, and the frame that it is itself, relative to what it forwards to.
void HandFramesOn(const Keyframe& culled, AtlasEditor& editor) {
  const auto parent = editor.atlas().ResolvePose(culled.id);
  if (!parent) return;
  std::vector<FramePose> frames = {{culled.data->stamp_ns, Rigid3d(), culled.id.session}};
  if (culled.frames) frames.insert(frames.end(), culled.frames->begin(), culled.frames->end());
  for (FramePose& frame : frames) {
    frame.reference_from_frame = parent->keyframe_from_asked * frame.reference_from_frame;
  }
  editor.InsertFrames(parent->keyframe->id, frames);
}

// What came on the way to it keeps its share of what became of it.
void CorrectFramesBefore(const Keyframe& culled, AtlasEditor& editor) {
  const auto correction = FrameCorrection::Of(culled, editor.atlas());
  if (!correction) return;
  const auto frames = editor.atlas().FindKeyframe(correction->holder())->frames;
  if (frames == nullptr) return;
  std::vector<FramePose> corrected;
  for (const FramePose& frame : *frames) {
    if (!correction->Corrects(frame)) continue;
    corrected.push_back(frame);
    corrected.back().reference_from_frame = correction->HolderFromFrame(frame);
  }
  if (!corrected.empty()) editor.InsertFrames(correction->holder(), corrected);
}

// A root with children hangs below the first of them, which becomes the root and takes the others.
void PassRootOn(KeyframeId root, AtlasEditor& editor) {
  const std::vector<KeyframeId> children = editor.atlas().FindKeyframe(root)->children;
  const KeyframeId heir = children.front();
  for (const KeyframeId child : children) editor.SetParent(child, child == heir ? KeyframeId{} : heir);
  editor.SetParent(root, heir);
  editor.WriteMap(editor.atlas().FindKeyframe(root)->map).root = heir;
}

}  // namespace

Status Validate(const RemoveKeyframe& edit, const Atlas& atlas) { return CheckKnown(atlas, edit.id); }

void ApplyValid(const RemoveKeyframe& edit, AtlasEditor& editor) {
  const Keyframe* keyframe = editor.atlas().FindKeyframe(edit.id);
  if (keyframe == nullptr) return;
  CorrectFramesBefore(*keyframe, editor);
  editor.UnobserveAll(edit.id);
  keyframe = editor.atlas().FindKeyframe(edit.id);
  if (!keyframe->parent.valid() && !keyframe->children.empty()) PassRootOn(edit.id, editor);
  const Keyframe culled = *editor.atlas().FindKeyframe(edit.id);
  for (const KeyframeId child : culled.children) editor.SetParent(child, culled.parent);
  editor.RemoveKeyframe(edit.id);
  HandFramesOn(culled, editor);
}

bool TouchesOnly(const RemoveKeyframe& edit, SessionId session) { return edit.id.session == session; }

void Encode(const RemoveKeyframe& edit, MapWriter& writer) { writer.WriteId(edit.id); }

void Decode(MapReader& reader, std::uint8_t, RemoveKeyframe& edit) { edit.id = reader.ReadId<KeyframeTag>(); }

}  // namespace pangaea
