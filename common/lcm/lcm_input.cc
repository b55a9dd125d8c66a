#include "common/lcm/lcm_input.h"

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "common/lcm/calibration_codec.h"
#include "common/lcm/frame_assembler.h"
#include "common/lcm/receiver.h"
#include "common/lcm/url.h"
#include "common/sensor/camera_chain.h"

namespace pangaea {
namespace {

class LcmStream final : public FrameStream {
 public:
  LcmStream(std::unique_ptr<LcmReceiver> receiver, FrameAssembler assembler, std::string calibration_channel)
      : receiver_(std::move(receiver)),
        assembler_(std::move(assembler)),
        calibration_channel_(std::move(calibration_channel)) {}

  std::optional<Result<StreamFrame>> Next(const std::stop_token& stop) override {
    while (auto message = receiver_->Next(stop)) {
      if (!*message) return Result<StreamFrame>(tl::make_unexpected(message->error()));
      if ((*message)->channel == calibration_channel_) continue;  // it is repeated for those who come later
      if (auto frame = assembler_.Add(**message)) return frame;
    }
    return std::nullopt;
  }
  bool is_live() const override { return receiver_->is_live(); }
  std::size_t missing() const override { return assembler_.missing(); }

 private:
  std::unique_ptr<LcmReceiver> receiver_;
  FrameAssembler assembler_;
  std::string calibration_channel_;
};

std::vector<std::string> Subscriptions(const LcmChannels& channels) {
  std::vector<std::string> names = {channels.images, channels.calibration};
  if (!channels.right_images.empty()) names.push_back(channels.right_images);
  return names;
}

Result<CameraRig> AwaitCalibration(LcmReceiver& receiver, const LcmInputOptions& options, SensorKind kind,
                                   const std::stop_token& stop) {
  while (const auto message = receiver.Next(stop)) {
    if (*message && (*message)->channel == options.channels.calibration) {
      return DecodeCalibration((*message)->payload, kind);
    }
  }
  return Fail(ErrorCode::kNotFound, options.url + ": no calibration came on channel " + options.channels.calibration +
                                        "; allowed: a calibration_t message, or a calibration file");
}

std::string NameOf(const LcmUrl& url) { return url.log ? url.log->stem().string() : "lcm"; }

}  // namespace

Result<CameraInput> OpenLcmInput(const LcmInputOptions& options, SensorKind kind, const std::stop_token& stop) {
  if (auto status = options.channels.Check(); !status) return tl::make_unexpected(status.error());
  const auto url = LcmUrl::Parse(options.url);
  if (!url) return tl::make_unexpected(url.error());
  auto receiver = LcmReceiver::Open(*url, Subscriptions(options.channels));
  if (!receiver) return tl::make_unexpected(receiver.error());
  auto rig = options.calibration.empty() ? AwaitCalibration(**receiver, options, kind, stop)
                                         : ReadCameraChain(options.calibration, kind);
  if (!rig) return tl::make_unexpected(rig.error());
  if (url->log && options.calibration.empty()) {
    // From the beginning again: images may come before the first calibration.
    receiver = LcmReceiver::Open(*url, Subscriptions(options.channels));
    if (!receiver) return tl::make_unexpected(receiver.error());
  }
  CameraInput input;
  input.name = NameOf(*url);
  input.kind = url->log ? "an LCM log" : "LCM";
  input.rig = std::move(*rig);
  const ImageSize size{input.rig.left.width, input.rig.left.height};
  input.frames = std::make_unique<LcmStream>(std::move(*receiver), FrameAssembler(kind, options.channels, size),
                                             options.channels.calibration);
  return input;
}

}  // namespace pangaea
