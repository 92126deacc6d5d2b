// SPDX-License-Identifier: Apache-2.0
#include <tactus/device/inverse3/inverse3_device.h>

#include <atomic>
#include <mutex>
#include <utility>

#include <tactus/base/rule.h>
#include <tactus/device/inverse3/inverse3_messages.h>
#include <tactus/device/inverse3/web_socket.h>
#include <tactus/device/real_time.h>

namespace tactus::device::inverse3 {
namespace {

constexpr const char* kService = "127.0.0.1:10001";
constexpr Time kOpenTime = 2000 * kMillisecond;
constexpr Time kStale = 20 * kMillisecond;  // a force that is asked for again is not older

Capabilities capabilities_of(const std::string& id) {
  constexpr double kNominal = 3;  // [N] the service does not report it; chosen, so that the device can hold it
  Capabilities out;
  out.name = "inverse3:" + id;
  out.model = "Haply Inverse3";
  out.serial = id;
  out.senses.velocity = true;
  out.force_axes = 3;
  out.nominal_force = out.peak_force = kNominal;
  out.rate = 1000;
  return out;
}

class Inverse3Device final : public Device {
 public:
  Inverse3Device(std::unique_ptr<WebSocket> socket, const State& first)
      : socket_(std::move(socket)), capabilities_(capabilities_of(first.id)) {
    take(first);
  }
  ~Inverse3Device() override { halt(); }

  const Capabilities& capabilities() const noexcept override { return capabilities_; }
  Result<Reading> read(Time) noexcept override;
  Result<void> write(const GuardedForce& force) noexcept override;
  void halt() noexcept override;

 private:
  Result<void> ask(const Vec3& force) noexcept;
  Result<void> listen(Time until) noexcept;
  void take(const State& state) noexcept;
  tl::unexpected<Error> end(const Error& error) noexcept;

  std::unique_ptr<WebSocket> socket_;
  Capabilities capabilities_;
  std::mutex mutex_;  // of everything below
  std::atomic<bool> is_halted_{false};
  Reading newest_{};
  Vec3 force_{};
  Time written_ = 0;
  unsigned due_ = 0;  // answers
  std::optional<Error> failure_;
};

void Inverse3Device::take(const State& state) noexcept {
  newest_.sample.position = state.position;
  newest_.sample.velocity = state.velocity;
  newest_.taken = monotonic_clock().now();
}

tl::unexpected<Error> Inverse3Device::end(const Error& error) noexcept {
  failure_ = error;
  char command[kMostCommand];
  const std::size_t size = write_command(command, capabilities_.serial, {});
  static_cast<void>(socket_->send({command, size}, monotonic_clock().now() + kMillisecond));
  return tl::unexpected<Error>(error);
}

/// pre  mutex_ is held
Result<void> Inverse3Device::ask(const Vec3& force) noexcept {
  char command[kMostCommand];
  const std::size_t size = write_command(command, capabilities_.serial, is_halted_ ? Vec3{} : force);
  if (socket_->send({command, size}, monotonic_clock().now() + kAnswerTime) != WebSocket::Status::done)
    return fail(Errc::io, "R-DEV-4");
  ++due_;
  return {};
}

/// Until every command has its answer, or the time is over.   pre  mutex_ is held
Result<void> Inverse3Device::listen(Time until) noexcept try {
  while (due_ > 0) {
    const WebSocket::Status status = socket_->receive(until);
    if (status != WebSocket::Status::done) return fail(Errc::io, "R-DEV-4");
    TACTUS_TRY(const auto state, read_state(socket_->message(), capabilities_.serial));
    --due_;
    if (state) take(*state);
  }
  return {};
} catch (const std::bad_alloc&) {
  return fail(Errc::limit_exceeded, "R-API-11");
}

/// What answers the last force is old by now: it is asked for again.
Result<Reading> Inverse3Device::read(Time) noexcept {
  const std::scoped_lock lock(mutex_);
  if (failure_) return tl::unexpected<Error>(*failure_);
  const Time begin = monotonic_clock().now(), until = begin + kAnswerTime;
  if (const auto heard = listen(until); !heard) return end(heard.error());
  if (const auto asked = ask(begin - written_ > kStale ? Vec3{} : force_); !asked) return end(asked.error());
  if (const auto heard = listen(until); !heard) return end(heard.error());
  if (newest_.taken < begin) return end(fail(Errc::io, "R-DEV-4").value());
  return newest_;
}

Result<void> Inverse3Device::write(const GuardedForce& force) noexcept {
  const std::scoped_lock lock(mutex_);
  if (failure_) return tl::unexpected<Error>(*failure_);
  is_halted_ = false;
  force_ = force.value();
  written_ = monotonic_clock().now();
  if (const auto asked = ask(force_); !asked) return end(asked.error());
  return {};
}

/// A thread that is between question and answer sends the zero itself, with its next question.
void Inverse3Device::halt() noexcept {
  is_halted_ = true;
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (lock.owns_lock() && !failure_) static_cast<void>(ask({}));
}

tl::unexpected<Diagnostic> refuse(tl::unexpected<Error> error, const std::string& service, std::string detail,
                                  std::string remedy) {
  return tl::unexpected(
      Diagnostic{.error = error.value(), .file = service, .detail = std::move(detail), .remedy = std::move(remedy)});
}

}  // namespace

Backend::Listing Inverse3Backend::list() const {
  Listing out;
  out.missing.push_back(std::string("known only to the vendor's service; run it, then --device inverse3 (at ") + kService +
                        ", or --tune service=HOST:PORT)");
  return out;
}

tl::expected<std::unique_ptr<Device>, Diagnostic> Inverse3Backend::open(const std::string& which,
                                                                        const OpenOptions& options) const {
  const std::string service = options.service.empty() ? kService : options.service;
  const Time until = monotonic_clock().now() + kOpenTime;
  auto socket = WebSocket::connect(service, kMostMessage, until);
  if (!socket)
    return refuse(fail(Errc::unsupported, "R-DEV-3"), service, socket.error(), "start the vendor's service on this machine");
  // The first message comes unasked.
  while ((*socket)->receive(until) == WebSocket::Status::done) {
    const auto state = read_state((*socket)->message(), which);
    if (!state) return refuse(tl::unexpected(state.error()), service, {}, {});
    if (*state) return std::make_unique<Inverse3Device>(*std::move(socket), **state);
    if (which.empty()) break;
  }
  return refuse(fail(Errc::invalid_argument, "R-DEV-1"), service,
                which.empty() ? "it has no device" : "it has no device " + which,
                "connect the device, and let the vendor's program show it");
}

}  // namespace tactus::device::inverse3
