// SPDX-License-Identifier: Apache-2.0
#include "cli/live/device_loop.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "cli/live/device_choice.h"

namespace tactus::cli {

using device::Reading;
using device::Servo;
using device::ServoTick;

namespace {

std::int64_t wall_time() {
  using namespace std::chrono;
  return duration_cast<nanoseconds>(system_clock::now().time_since_epoch()).count();
}

}  // namespace

tl::unexpected<Failure> DeviceLoop::device_failed(const Error& error) const {
  return refuse_device(device_.capabilities().name, error);
}

TraceInfo DeviceLoop::describe() const {
  const device::Capabilities& can = device_.capabilities();
  TraceInfo info = felt_.info();
  TraceUser& user = info.users[felt_.user()];
  user.senses = can.senses;
  user.senses.time = true;
  user.has_servo = true;
  user.report_descriptor = can.report_descriptor;
  info.tick_rate = static_cast<std::uint32_t>(std::llround(plan_.servo.rate));
  info.source = plan_.command + " " + can.name;
  info.capture = TraceCapture{.started = wall_time(),
                              .device = can.serial.empty() ? can.model : can.model + " " + can.serial,
                              .backend = plan_.backend,
                              .scheduling = outcomes_.privileges,
                              .subject = plan_.subject,
                              .remarks = plan_.remarks};
  return info;
}

Outcome DeviceLoop::set_up() {
  TACTUS_CHECK(felt_.begin());
  const TraceInfo info = describe();
  frame_.objects.resize(info.objects.size());
  frame_.users.resize(info.users.size());
  if (device_.reports() != nullptr) reserve(frame_.users[felt_.user()].reports);
  for (const TraceDeformable& mesh : info.meshes)
    frame_.meshes.push_back({false, std::vector<float>(3 * mesh.rest.vertices.size())});
  if (plan_.path.empty()) return {};
  auto recorder = TraceRecorder::create(plan_.path, info, frame_);
  if (!recorder) return refuse(plan_.shown_path, recorder.error());
  recorder_.emplace(std::move(*recorder));
  shared_recorder_ = &*recorder_;
  return {};
}

Outcome DeviceLoop::run() {
  const device::RealTime real_time;
  outcomes_.privileges = real_time.granted();
  TACTUS_CHECK(set_up());
  auto servo = Servo::start(device_, plan_.servo);
  if (!servo) return device_failed(servo.error());
  Outcome worked = go_on(**servo);
  conclude(**servo);
  servo->reset();  // zero force before the file is finished
  if (!recorder_) return worked;
  shared_recorder_ = nullptr;
  const auto finished = recorder_->finish();
  outcomes_.recorder = recorder_->status();
  TACTUS_CHECK(worked);
  if (!finished) return refuse(plan_.shown_path, finished.error());
  return {};
}

void DeviceLoop::conclude(Servo& servo) {
  outcomes_.times = servo.times();
  outcomes_.guard = guard_report(servo, begin_);
}

Outcome DeviceLoop::go_on(Servo& servo) {
  const double seconds = plan_.duration > 0 ? plan_.duration : 1e9;
  const double most = 1e9 * seconds / static_cast<double>(servo.period());
  while (!stops_) {
    const auto next = servo.next();
    if (!next) return device_failed(next.error());
    if (next->reading.state == Reading::State::ended || static_cast<double>(next->number) >= most) return {};
    TACTUS_CHECK(tick(servo, *next));
    if (felt_.is_over()) return {};
    if (recorder_ && recorder_->status().error) return {};  // finish() tells it
  }
  return {};
}

Outcome DeviceLoop::tick(Servo& servo, const ServoTick& tick) {
  const auto force = felt_.step(tick, frame_);
  if (!force) return tl::unexpected(force.error());
  if (const auto exerted = servo.exert(*force); !exerted) return device_failed(exerted.error());
  const device::ForceGuard* guard = servo.guard();
  UserSample& user = frame_.users[felt_.user()];
  user.force = guard != nullptr ? guard->written() : Vec3{};
  user.device.time = tick.reading.taken;
  user.servo = {tick.lateness, tick.age, tick.missed, guard != nullptr ? guard->actions() : 0U};
  if (const DeviceReports* const reports = device_.reports()) {
    user.reports = *reports;
    outcomes_.reports += reports->sizes.size();
  }
  frame_.tick = tick.number;
  if (recorder_) recorder_->offer(frame_);
  if (outcomes_.ticks == 0) begin_ = tick.due;
  outcomes_.device_lost += tick.reading.lost;
  outcomes_.last_tick = tick.number;
  ++outcomes_.ticks;
  outcomes_.missed += tick.missed;
  outcomes_.largest_force = std::max(outcomes_.largest_force, norm(user.force));
  publish(tick);
  return {};
}

void DeviceLoop::publish(const ServoTick& tick) noexcept {
  constexpr auto kRelaxed = std::memory_order_relaxed;
  ticks_.store(outcomes_.ticks, kRelaxed);
  missed_.store(outcomes_.missed, kRelaxed);
  lost_.store(outcomes_.device_lost, kRelaxed);
  force_.store(norm(frame_.users[felt_.user()].force), kRelaxed);
  if (tick.lateness > worst_.load(kRelaxed)) worst_.store(tick.lateness, kRelaxed);
  state_.store(tick.reading.state, kRelaxed);
}

DeviceLoop::Now DeviceLoop::now() noexcept {
  TraceRecorder* const recorder = shared_recorder_.load();
  const std::uint64_t unwritten = recorder != nullptr ? recorder->status().lost : 0;
  return {ticks_.load(), missed_.load(), lost_.load() + unwritten, force_.load(), worst_.exchange(0), state_.load()};
}

void DeviceLoop::mark(std::string_view text) {
  if (TraceRecorder* const recorder = shared_recorder_.load()) recorder->mark(text);
}

}  // namespace tactus::cli
