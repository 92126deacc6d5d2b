// SPDX-License-Identifier: Apache-2.0
#include <tactus/device/replay_device.h>

#include <utility>

namespace tactus::device {
namespace {

class ReplayDevice final : public Device {
 public:
  ReplayDevice(Capabilities capabilities, Recording recording)
      : capabilities_(std::move(capabilities)), recording_(std::move(recording)) {}

  const Capabilities& capabilities() const noexcept override { return capabilities_; }

  Result<Reading> read(Time deadline) noexcept override {
    if (begin_ < 0) begin_ = deadline;
    const Recording::Moment moment = recording_.at(deadline - begin_);
    return Reading{
        .sample = moment.sample, .taken = deadline, .state = moment.is_over ? Reading::State::ended : Reading::State::valid};
  }

  Result<void> write(const GuardedForce&) noexcept override { return {}; }
  void halt() noexcept override {}

 private:
  Capabilities capabilities_;
  Recording recording_;
  Time begin_ = -1;  // of the first sample
};

}  // namespace

tl::expected<std::unique_ptr<Device>, Diagnostic> open_replay_device(const std::string& path, const RecordingOptions& options) {
  TACTUS_TRY(auto recording, Recording::read(path, options));
  const TraceUser& user = recording.user();
  Capabilities capabilities{.name = "replay:" + path, .model = "recording of " + user.name, .senses = user.senses};
  capabilities.buttons = user.senses.buttons ? 32 : 0;
  capabilities.rate = recording.rate();
  capabilities.low = recording.low();
  capabilities.high = recording.high();
  return std::make_unique<ReplayDevice>(std::move(capabilities), std::move(recording));
}

}  // namespace tactus::device
