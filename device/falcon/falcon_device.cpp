// SPDX-License-Identifier: Apache-2.0
#include <tactus/device/falcon/falcon_device.h>

#include <array>
#include <atomic>
#include <optional>

#include <tactus/base/rule.h>
#include <tactus/base/text.h>
#include <tactus/device/falcon/falcon_frame.h>
#include <tactus/device/falcon/falcon_kinematics.h>

namespace tactus::device::falcon {
namespace {

constexpr Time kAskAgain = 10 * kMillisecond;  // after so long without an answer
constexpr int kMostBroken = 3;                 // broken frames in a row; the line between the Falcon's chips has no checksum

Capabilities capabilities_of(std::size_t index) {
  Capabilities out;
  out.name = "falcon:" + std::to_string(index);
  out.model = "Novint Falcon";
  out.senses.buttons = true;
  out.buttons = 4;
  out.force_axes = 3;
  out.low = {-kHalfWidth, -kHalfWidth, -kHalfWidth};
  out.high = {kHalfWidth, kHalfWidth, kHalfWidth};
  out.nominal_force = kNominalForce;
  out.peak_force = kPeakForce;
  out.rate = 1000;
  out.has_clock = true;
  return out;
}

class FalconDevice final : public Device {
 public:
  FalconDevice(std::unique_ptr<UsbPort> port, std::size_t index)
      : port_(std::move(port)), capabilities_(capabilities_of(index)), answered_(port_->now()) {
    capabilities_.serial = port_->serial();
  }
  ~FalconDevice() override { halt(); }

  const Capabilities& capabilities() const noexcept override { return capabilities_; }
  Result<Reading> read(Time deadline) noexcept override;
  Result<void> write(const GuardedForce& force) noexcept override;
  void halt() noexcept override;

 private:
  Result<void> ask() noexcept;
  Result<void> listen(Time deadline) noexcept;
  void take(const Reply& reply) noexcept;
  Result<void> exert() noexcept;
  Result<void> send(const Motors& motors) noexcept;
  tl::unexpected<Error> end(const Error& error) noexcept;

  std::unique_ptr<UsbPort> port_;
  Capabilities capabilities_;

  // of the thread that reads and writes
  ReplyParser parser_;
  std::array<std::uint8_t, kPacketBytes> packet_{};
  Reading newest_{{}, 0, Reading::State::not_homed};
  std::optional<Pose> pose_;  // the last one since it was homed
  Motors motors_{};           // of the last write,
  unsigned written_ = 0;      // computed after so many halts
  Time answered_;
  int broken_ = 0;
  bool has_news_ = false;
  std::optional<Error> failure_;

  // of every thread
  std::atomic<Light> light_{Light::none};
  std::atomic<unsigned> halts_{0};
  std::atomic<int> due_{0};  // answers
  std::atomic<Time> asked_{0};
};

/// A frame on its way.
Result<void> FalconDevice::send(const Motors& motors) noexcept {
  const UsbTransfer out = port_->write(encode({motors, light_}));
  if (out.status != UsbStatus::done || out.bytes != kFrameBytes) return fail(Errc::io, "R-DEV-4");
  ++due_;
  asked_ = port_->now();
  return {};
}

/// What was written before a halt is not exerted after it: if the frame of the halt came first, another one follows.
Result<void> FalconDevice::exert() noexcept {
  if (halts_ != written_) motors_ = {};
  TACTUS_CHECK(send(motors_));
  if (motors_ == Motors{} || halts_ == written_) return {};
  motors_ = {};
  return send(motors_);
}

void FalconDevice::halt() noexcept {
  ++halts_;
  static_cast<void>(send({}));
}

tl::unexpected<Error> FalconDevice::end(const Error& error) noexcept {
  failure_ = error;
  halt();
  return tl::unexpected<Error>(error);
}

/// A frame, if no answer is due or the one that is due does not come.
Result<void> FalconDevice::ask() noexcept {
  if (due_ > 0 && port_->now() - asked_ < kAskAgain) return {};
  return exert();
}

/// One transfer.
Result<void> FalconDevice::listen(Time deadline) noexcept {
  const UsbTransfer in = port_->read(packet_, deadline);
  if (in.status != UsbStatus::done && in.status != UsbStatus::timeout) return fail(Errc::io, "R-DEV-4");
  int answers = 0;
  parser_.give(std::span(packet_).first(in.bytes));
  while (const auto reply = parser_.next()) {
    ++answers;
    if (!*reply) {
      if (++broken_ > kMostBroken) return tl::unexpected<Error>(reply->error());
      continue;
    }
    broken_ = 0;
    has_news_ = true;
    take(**reply);
  }
  const bool is_silent = has_news_ && in.bytes <= 2;  // what was due beyond the news got lost
  int due = due_;
  while (!due_.compare_exchange_weak(due, is_silent || answers > due ? 0 : due - answers)) {
  }
  return {};
}

void FalconDevice::take(const Reply& reply) noexcept {
  newest_.taken = answered_ = port_->now();
  newest_.sample.buttons = reply.buttons;
  if (reply.homed != kAllHomed) {
    newest_.state = Reading::State::not_homed;
    light_ = Light::red;
    pose_.reset();
    return;
  }
  const Result<Pose> pose = pose_with({angle_of(reply.counts[0]), angle_of(reply.counts[1]), angle_of(reply.counts[2])});
  if (!pose) {
    newest_.state = Reading::State::out_of_reach;
    light_ = Light::blue;
    return;
  }
  newest_.state = Reading::State::valid;
  newest_.sample.position = from_native(pose->position);
  pose_ = *pose;
  light_ = Light::green;
}

Result<Reading> FalconDevice::read(Time deadline) noexcept {
  if (failure_) return tl::unexpected<Error>(*failure_);
  has_news_ = false;
  do {
    if (auto asked = ask(); !asked) return end(asked.error());
    if (auto heard = listen(deadline); !heard) return end(heard.error());
    if (has_news_ && due_ == 0) return newest_;
  } while (port_->now() < deadline);
  if (port_->now() - answered_ >= kAnswerTime) return end(fail(Errc::io, "R-DEV-4").value());
  return newest_;
}

Result<void> FalconDevice::write(const GuardedForce& force) noexcept {
  if (failure_) return tl::unexpected<Error>(*failure_);
  written_ = halts_;
  const bool is_none = force.value() == Vec3{};
  motors_ = is_none || !pose_ ? Motors{} : motors_of(torques(*pose_, force_to_native(force.value())));
  if (auto sent = exert(); !sent) return end(sent.error());
  if (!is_none && !pose_) return fail(Errc::state, "R-DEV-6");
  return {};
}

std::string remedy_of(UsbStatus status) {
  switch (status) {
    case UsbStatus::denied:
      return std::string("Write this line to /etc/udev/rules.d/70-falcon.rules, then unplug the Falcon and plug it in again: ") +
             kUdevRule;
    case UsbStatus::busy:
      return "End the program that has the Falcon.";
    case UsbStatus::no_library:
      return "Install libusb (apt-get install libusb-1.0-0).";
    default:
      return {};
  }
}

Diagnostic not_opened(UsbStatus status, const std::string& name) {
  Diagnostic out;
  switch (status) {
    case UsbStatus::gone:
      out.error = fail(Errc::invalid_argument, "R-DEV-1").value();
      break;
    case UsbStatus::denied:
    case UsbStatus::busy:
      out.error = fail(Errc::io, "R-DEV-2").value();
      break;
    case UsbStatus::no_library:
      out.error = fail(Errc::unsupported, "R-DEV-3").value();
      break;
    default:
      out.error = fail(Errc::io, "R-DEV-4").value();
      break;
  }
  out.detail = name;
  out.remedy = remedy_of(status);
  return out;
}

/// A number; none: it is none.
std::optional<std::size_t> index_of(const std::string& which) { return which.empty() ? 0 : parse_number<std::size_t>(which); }

}  // namespace

FalconBackend::FalconBackend(std::unique_ptr<UsbBus> bus) : bus_(std::move(bus)) {}

Backend::Listing FalconBackend::list() const {
  Listing out;
  const auto found = bus_->list();
  if (!found) {
    out.missing.push_back(found.error());
    return out;
  }
  for (std::size_t i = 0; i < found->size(); ++i) {
    out.devices.push_back(capabilities_of(i));
    if (!(*found)[i]) out.missing.push_back(out.devices.back().name + ": you may not open it. " + remedy_of(UsbStatus::denied));
  }
  if (!found->empty())
    out.missing.emplace_back(
        "A Falcon that was switched on needs its firmware once: name the file that came with the vendor's driver.");
  return out;
}

tl::expected<std::unique_ptr<Device>, Diagnostic> FalconBackend::open(const std::string& which,
                                                                      const OpenOptions& options) const {
  const std::optional<std::size_t> index = index_of(which);
  if (!index) return tl::unexpected(not_opened(UsbStatus::gone, "falcon:" + which));
  auto port = bus_->open(*index, encode(Request{}));
  if (!port) return tl::unexpected(not_opened(port.error(), "falcon:" + std::to_string(*index)));
  TACTUS_CHECK(start(**port, options.firmware));
  return std::make_unique<FalconDevice>(*std::move(port), *index);
}

}  // namespace tactus::device::falcon
