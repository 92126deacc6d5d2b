// SPDX-License-Identifier: Apache-2.0
#include <tactus/device/openhaptics/openhaptics_device.h>

#include <clocale>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string_view>
#include <utility>

#include <tactus/base/rule.h>
#include <tactus/device/openhaptics/hd_runtime.h>
#include <tactus/device/real_time.h>

namespace tactus::device::openhaptics {
namespace {

constexpr unsigned short kPriority = 0x7fff;  // in the middle: the default differs between releases
constexpr double kMillimetre = 1e-3;
constexpr double kOffRotation = 1e-2;  // of a transform's axes from unit length and right angles
constexpr double kMostRate = 10'000;   // [Hz]

/// The runtime's axes (right, up, toward the user) to ours (right, away, up), and back.
Vec3 to_frame(const Vec3& v) noexcept { return {v.x, -v.z, v.y}; }
Vec3 from_frame(const Vec3& v) noexcept { return {v.x, v.z, -v.y}; }

/// Text of numbers is read as in English while this lives: the runtime's configuration has points, whatever the user's language.
class NumbersWithPoints {
 public:
  NumbersWithPoints() noexcept : locale_(newlocale(LC_NUMERIC_MASK, "C", duplocale(uselocale(nullptr)))) {
    if (locale_ != nullptr) before_ = uselocale(locale_);
  }
  ~NumbersWithPoints() {
    if (locale_ == nullptr) return;
    uselocale(before_);
    freelocale(locale_);
  }
  NumbersWithPoints(const NumbersWithPoints&) = delete;
  NumbersWithPoints& operator=(const NumbersWithPoints&) = delete;

 private:
  locale_t locale_, before_ = nullptr;
};

/// Unit quaternion of a rotation with these columns, from its largest component (Shepperd 1978).
Quat quaternion_of(const Vec3& x, const Vec3& y, const Vec3& z) noexcept {
  const std::array<double, 4> squares{1 + x.x + y.y + z.z, 1 + x.x - y.y - z.z, 1 - x.x + y.y - z.z, 1 - x.x - y.y + z.z};
  Quat q;
  switch (std::ranges::max_element(squares) - squares.begin()) {
    case 0:
      q = {squares[0], y.z - z.y, z.x - x.z, x.y - y.x};
      break;
    case 1:
      q = {y.z - z.y, squares[1], y.x + x.y, z.x + x.z};
      break;
    case 2:
      q = {z.x - x.z, y.x + x.y, squares[2], z.y + y.z};
      break;
    default:
      q = {x.y - y.x, z.x + x.z, z.y + y.z, squares[3]};
  }
  const double scale = 1 / std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  return {scale * q.w, scale * q.x, scale * q.y, scale * q.z};
}

bool is_rotation(const Vec3& x, const Vec3& y, const Vec3& z) noexcept {
  const auto is_near = [](double a, double b) { return std::abs(a - b) <= kOffRotation; };  // false for NaN
  return is_near(dot(x, x), 1) && is_near(dot(y, y), 1) && is_near(dot(z, z), 1) && is_near(dot(x, y), 0) &&
         is_near(dot(y, z), 0) && is_near(dot(cross(x, y), z), 1);
}

class OpenHapticsDevice final : public Device {
 public:
  OpenHapticsDevice(const Runtime& runtime, Handle handle) : runtime_(runtime), handle_(handle) {}
  ~OpenHapticsDevice() override;

  /// err  io R-DEV-2: the runtime refuses
  tl::expected<void, std::string> start(const std::string& which);

  const Capabilities& capabilities() const noexcept override { return capabilities_; }
  Result<Reading> read(Time deadline) noexcept override;
  Result<void> write(const GuardedForce& force) noexcept override;
  void halt() noexcept override { force_.halt(); }

 private:
  static std::uint32_t call(void* self) noexcept { return static_cast<OpenHapticsDevice*>(self)->tick(); }
  std::uint32_t tick() noexcept;
  void exert(const Vec3& force) noexcept;

  Runtime runtime_;
  Handle handle_;
  Capabilities capabilities_;
  bool is_scheduled_ = false;
  unsigned long task_ = 0;
  SampleRing samples_;
  ForceBox force_;
  std::atomic<bool> ends_{false}, has_failed_{false};
  Reading last_{};
};

/// The oldest error that the runtime has not returned yet, in words; empty: none.
std::string pending_error(const Runtime& runtime) {
  const ErrorRecord record = runtime.get_error();
  if (record.code == 0) return {};
  const char* const text = runtime.error_text(record.code);
  return text != nullptr ? text : "error " + std::to_string(record.code);
}

tl::expected<void, std::string> OpenHapticsDevice::start(const std::string& which) {
  runtime_.make_current_device(handle_);
  int rate = 0;
  double most = 0;
  runtime_.get_integers(Parameter::rate, &rate);
  runtime_.get_doubles(Parameter::max_force, &most);
  const char* const serial = runtime_.get_string(Parameter::serial);
  capabilities_.name = "openhaptics" + (which.empty() ? "" : ":" + which);
  capabilities_.model = "OpenHaptics device";
  capabilities_.serial = serial != nullptr ? std::string(std::string_view(serial).substr(0, 64)) : "";
  capabilities_.senses = {.orientation = true, .velocity = true, .buttons = true, .time = false};
  capabilities_.buttons = 4;
  capabilities_.force_axes = 3;
  capabilities_.nominal_force = capabilities_.peak_force = most;
  capabilities_.rate = rate;
  capabilities_.has_clock = true;
  if (std::string error = pending_error(runtime_); !error.empty()) return tl::unexpected(std::move(error));
  if (!(most > 0 && most < 100) || !(rate > 0 && rate <= kMostRate))
    return tl::unexpected("it names " + std::to_string(most) + " N and " + std::to_string(rate) + " Hz");
  runtime_.enable(kForceOutput);
  if (std::string error = pending_error(runtime_); !error.empty()) return tl::unexpected(std::move(error));
  task_ = runtime_.schedule(&call, this, kPriority);
  is_scheduled_ = true;
  runtime_.start_scheduler();
  if (std::string error = pending_error(runtime_); !error.empty()) return tl::unexpected(std::move(error));
  return {};
}

OpenHapticsDevice::~OpenHapticsDevice() {
  if (is_scheduled_) {
    constexpr Time kTimeout = 20 * kMillisecond;
    force_.halt();
    ends_ = true;
    const Time until = monotonic_clock().now() + kTimeout;
    while (samples_.take(until)) {  // until tick() has written zero for the last time
    }
    runtime_.unschedule(task_);
    runtime_.stop_scheduler();
  }
  runtime_.disable_device(handle_);
}

void OpenHapticsDevice::exert(const Vec3& force) noexcept {
  const Vec3 native = from_frame(force);
  const std::array<double, 3> numbers{native.x, native.y, native.z};
  runtime_.set_doubles(Parameter::force, numbers.data());
}

/// On the runtime's thread.
std::uint32_t OpenHapticsDevice::tick() noexcept {
  const Time now = monotonic_clock().now();
  const bool is_last = ends_.load(std::memory_order_acquire);
  RawSample raw{.taken = now};
  int buttons = 0;
  runtime_.begin_frame(handle_);
  runtime_.get_doubles(Parameter::position, raw.position.data());
  runtime_.get_doubles(Parameter::velocity, raw.velocity.data());
  runtime_.get_doubles(Parameter::transform, raw.transform.data());
  runtime_.get_integers(Parameter::buttons, &buttons);
  exert(is_last || has_failed_ ? Vec3{} : force_.get(now));
  runtime_.end_frame(handle_);
  raw.buttons = static_cast<std::uint32_t>(buttons);
  if (runtime_.get_error().code != 0) has_failed_.store(true, std::memory_order_release);
  else if (!is_last) samples_.put(raw);
  if (!is_last && !has_failed_) return kContinue;
  samples_.end();
  return is_last ? kDone : kContinue;  // after an error zero is written on and on
}

Result<Reading> OpenHapticsDevice::read(Time deadline) noexcept {
  const auto taken = samples_.take(deadline);
  if (!taken || has_failed_.load(std::memory_order_acquire)) return fail(Errc::io, "R-DEV-4");
  last_.taken = taken->sample.taken;
  last_.lost = taken->lost;
  const auto sample = sample_of(taken->sample);
  last_.state = sample ? Reading::State::valid : Reading::State::out_of_reach;
  if (sample) last_.sample = *sample;
  return last_;
}

Result<void> OpenHapticsDevice::write(const GuardedForce& force) noexcept {
  if (has_failed_.load(std::memory_order_acquire)) return fail(Errc::io, "R-DEV-4");
  force_.put(force.value(), monotonic_clock().now());
  return {};
}

tl::unexpected<Diagnostic> refuse(const std::string& which, const Error& error, const std::string& error_text) {
  return tl::unexpected(Diagnostic{.error = error,
                                   .file = which.empty() ? "openhaptics" : "openhaptics:" + which,
                                   .detail = error_text,
                                   .remedy =
                                       "check cable and power, that the vendor's own test program finds the device, its licence, "
                                       "and that the system shows it as a serial port (ttyACM) where the model needs that"});
}

/// Where the system looks for a library first, as far as one can see without loading it.
bool is_installed(std::string_view library) {
  const char* const path = std::getenv("LD_LIBRARY_PATH");
  std::string folders = path != nullptr ? std::string(path) + ":" : "";
  folders += "/usr/local/lib:/usr/lib:/usr/lib64:/usr/lib/x86_64-linux-gnu:/opt/OpenHaptics/lib";
  for (std::size_t begin = 0; begin <= folders.size();) {
    const std::size_t end = std::min(folders.find(':', begin), folders.size());
    std::string file = folders.substr(begin, end - begin);
    std::error_code ignored;
    if (!file.empty() && std::filesystem::exists(file.append("/").append(library), ignored)) return true;
    begin = end + 1;
  }
  return false;
}

}  // namespace

std::optional<DeviceSample> sample_of(const RawSample& raw) noexcept {
  const auto column = [&](std::size_t i) {
    return Vec3{raw.transform[4 * i], raw.transform[4 * i + 1], raw.transform[4 * i + 2]};
  };
  const Vec3 x = column(0), y = column(1), z = column(2);
  DeviceSample sample;
  sample.position = kMillimetre * to_frame({raw.position[0], raw.position[1], raw.position[2]});
  sample.velocity = kMillimetre * to_frame({raw.velocity[0], raw.velocity[1], raw.velocity[2]});
  sample.buttons = raw.buttons;
  if (!is_finite(sample.position) || !is_finite(sample.velocity) || !is_rotation(x, y, z)) return std::nullopt;
  // The handle's axes change as the device's do, so that a turn about "up" stays one.
  sample.orientation = quaternion_of(to_frame(x), -to_frame(z), to_frame(y));
  return sample;
}

Backend::Listing OpenHapticsBackend::list() const {
  Listing listing;
  if (is_installed("libHD.so")) {
    Capabilities can;
    can.name = "openhaptics";
    can.model = "the vendor's default device, known when it is opened";
    can.force_axes = 3;
    listing.devices.push_back(can);
  } else {
    listing.missing.emplace_back(
        "libHD.so: install OpenHaptics and the device's driver, from its vendor (or name it with --tune runtime=FILE)");
  }
  return listing;
}

tl::expected<std::unique_ptr<Device>, Diagnostic> OpenHapticsBackend::open(const std::string& which,
                                                                           const OpenOptions& options) const {
  const NumbersWithPoints numbers;
  TACTUS_TRY(const Runtime runtime, Runtime::load(options.runtime));
  const Handle handle = runtime.init_device(which.empty() ? nullptr : which.c_str());
  const std::string error_text = pending_error(runtime);
  if (handle == kNoDevice || !error_text.empty()) {
    if (handle != kNoDevice) runtime.disable_device(handle);
    return refuse(which, fail(Errc::io, "R-DEV-2").value(), error_text);
  }
  auto device = std::make_unique<OpenHapticsDevice>(runtime, handle);
  if (const auto started = device->start(which); !started)
    return refuse(which, fail(Errc::io, "R-DEV-2").value(), started.error());
  return device;
}

}  // namespace tactus::device::openhaptics
