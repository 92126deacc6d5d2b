// SPDX-License-Identifier: Apache-2.0
#include "cli/live/device_loop.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <thread>
#include <utility>

#include "cli/live/device_choice.h"
#include "cli/live/ticker.h"
#include "cli/report/json.h"
#include "cli/report/table.h"

namespace tactus::cli {

// ==== guard report ====

using device::GuardAction;

std::optional<GuardReport> guard_report(device::Servo& servo, device::Time begin) {
  const device::ForceGuard* const guard = servo.guard();
  if (guard == nullptr) return std::nullopt;
  GuardReport report{
      .log = {guard->log().begin(), guard->log().end()}, .energy = guard->energy(), .halted = servo.times().halted};
  for (std::size_t i = 0; i < report.ticks.size(); ++i) report.ticks[i] = guard->count(static_cast<GuardAction>(i));
  for (device::GuardEntry& entry : report.log) entry.time -= begin;
  return report;
}

Value value_of(const GuardReport& report) {
  Json ticks = Json::object(), log = Json::array();
  for (std::size_t i = 0; i < report.ticks.size(); ++i) ticks[name_of(static_cast<GuardAction>(i))] = report.ticks[i];
  const auto vector = [](const Vec3& v) { return Json{v.x, v.y, v.z}; };
  for (const device::GuardEntry& entry : report.log)
    log.push_back({{"time_s", 1e-9 * static_cast<double>(entry.time)},
                   {"action", name_of(entry.action)},
                   {"asked_N", is_finite(entry.asked) ? vector(entry.asked) : Json(nullptr)},
                   {"passed_N", vector(entry.passed)}});
  return Json{{"energy_given_J", report.energy}, {"halted", report.halted}, {"ticks", std::move(ticks)}, {"log", std::move(log)}};
}

// ==== keyboard ====

Keyboard::Keyboard() noexcept {
  termios settings{};
  if (isatty(STDIN_FILENO) == 0 || tcgetpgrp(STDIN_FILENO) != getpgrp() || tcgetattr(STDIN_FILENO, &settings) != 0) return;
  before_ = settings;
  settings.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);  // Ctrl-C still interrupts
  settings.c_cc[VMIN] = 0;
  settings.c_cc[VTIME] = 0;
  tcsetattr(STDIN_FILENO, TCSANOW, &settings);
}

Keyboard::~Keyboard() {
  if (before_) tcsetattr(STDIN_FILENO, TCSANOW, &*before_);
}

std::optional<char> Keyboard::pressed() noexcept {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  char key = 0;
  if (!before_ || poll(&input, 1, 0) <= 0 || read(STDIN_FILENO, &key, 1) != 1) return std::nullopt;
  return key;
}

// ==== device loop ====

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
  TraceInfo info = rendered_.info();
  TraceUser& user = info.users[rendered_.user()];
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
  TACTUS_CHECK(rendered_.begin());
  const TraceInfo info = describe();
  frame_.objects.resize(info.objects.size());
  frame_.users.resize(info.users.size());
  if (device_.reports() != nullptr) reserve(frame_.users[rendered_.user()].reports);
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
    if (rendered_.is_over()) return {};
    if (recorder_ && recorder_->status().error) return {};  // finish() reports it
  }
  return {};
}

Outcome DeviceLoop::tick(Servo& servo, const ServoTick& tick) {
  const auto force = rendered_.step(tick, frame_);
  if (!force) return tl::unexpected(force.error());
  if (const auto exerted = servo.exert((1 / rendered_.scale()) * *force); !exerted) return device_failed(exerted.error());
  const device::ForceGuard* guard = servo.guard();
  UserSample& user = frame_.users[rendered_.user()];
  const Vec3 written = guard != nullptr ? guard->written() : Vec3{};
  user.force = rendered_.scale() * written;
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
  outcomes_.largest_force = std::max(outcomes_.largest_force, norm(written));
  publish(tick, norm(written));
  return {};
}

void DeviceLoop::publish(const ServoTick& tick, double force) noexcept {
  constexpr auto kRelaxed = std::memory_order_relaxed;
  ticks_.store(outcomes_.ticks, kRelaxed);
  missed_.store(outcomes_.missed, kRelaxed);
  lost_.store(outcomes_.device_lost, kRelaxed);
  force_.store(force, kRelaxed);
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

// ==== device report ====

namespace {

using device::Reading;
using device::Time;

double us(Time time) { return 1e-3 * static_cast<double>(time); }

const char* name_of(Reading::State state) {
  switch (state) {
    case Reading::State::valid:
      return "";
    case Reading::State::not_homed:
      return "  move the handle through its whole workspace: not homed";
    case Reading::State::out_of_reach:
      return "  out of reach";
    case Reading::State::ended:
      return "  ended";
  }
  return "";
}

std::string meter_text(const DeviceLoop::Now& now, double seconds, double rate) {
  return fmt::format("{:8.1f} s  {:6.0f} ticks/s  missed {}  lost {}  latest {:.0f} us  force {:.2f} N{}", seconds, rate,
                     now.missed, now.lost, us(now.worst), now.force, name_of(now.state));
}

/// Keys become markers, and the meter shows how it goes, until the loop has ended.
void attend(DeviceLoop& loop, const std::atomic<bool>& has_ended, const CommonOptions& common) {
  constexpr auto kLook = std::chrono::milliseconds(20);
  const StopOnSignal stop;
  Keyboard keyboard;
  Meter meter(common.progress());
  const std::uint64_t begin = microseconds_now();
  std::uint64_t drawn = begin, ticks = 0;
  while (!has_ended) {
    std::this_thread::sleep_for(kLook);
    if (StopOnSignal::caught() != 0) loop.stop();
    while (const auto key = keyboard.pressed()) {
      if (*key == 'q') loop.stop();
      else if (*key > ' ' && *key < 127) loop.mark(std::string(1, *key));
    }
    const std::uint64_t now = microseconds_now();
    if (!meter.is_due(now)) continue;
    const DeviceLoop::Now state = loop.now();
    const double rate = 1e6 * static_cast<double>(state.ticks - std::exchange(ticks, state.ticks)) /
                        static_cast<double>(now - std::exchange(drawn, now));
    meter.draw(now, meter_text(state, 1e-6 * static_cast<double>(now - begin), rate));
  }
}

Json times_json(const device::Histogram& times) {
  return {{"p50_us", us(times.quantile(0.5))},
          {"p99_us", us(times.quantile(0.99))},
          {"p999_us", us(times.quantile(0.999))},
          {"max_us", us(times.longest())}};
}

}  // namespace

Outcome run_attended(DeviceLoop& loop, const CommonOptions& common) {
  Outcome worked;
  std::atomic<bool> has_ended{false};
  std::thread thread([&] {
    worked = loop.run();
    has_ended = true;
  });
  attend(loop, has_ended, common);
  thread.join();
  return worked;
}

void add_to(Value& report, const DeviceRun& run) {
  Json& out = report.json;
  const DeviceLoop::Outcomes& of = run.outcomes;
  if (!run.trace.empty()) out["trace"] = run.trace;
  out["device"] = {{"name", run.device.name},
                   {"model", run.device.model},
                   {"serial", run.device.serial},
                   {"nominal_force_N", run.device.nominal_force},
                   {"rate_Hz", run.device.rate}};
  out["seconds"] = run.seconds();
  out["ticks"] = of.ticks;
  out["missed"] = of.missed;
  out["lost"] = {{"at_the_device", of.device_lost}, {"at_the_file", of.recorder.lost}};
  if (run.device.report_descriptor) out["reports"] = of.reports;
  out["lateness"] = times_json(of.times.lateness);
  out["age"] = times_json(of.times.age);
  out["busy"] = times_json(of.times.busy);
  out["privileges"] = of.privileges;
  if (!run.trace.empty()) out["most_waiting_frames"] = of.recorder.most_waiting;
  if (!of.guard) return;
  out["largest_force_N"] = of.largest_force;
  out["guard"] = value_of(*of.guard);
}

tl::unexpected<Failure> failed(Failure failure, const DeviceRun& run) {
  const DeviceLoop::Outcomes& of = run.outcomes;
  if (of.recorder.last_written < 0) return tl::unexpected(std::move(failure));
  failure.remedy +=
      fmt::format("{}{} holds the ticks up to {}", failure.remedy.empty() ? "" : " ", run.trace, of.recorder.last_written);
  failure.remedy +=
      of.recorder.error ? fmt::format(" at most, {} are lost; `tactus recover` makes it whole.", of.recorder.lost) : ".";
  return tl::unexpected(std::move(failure));
}

Outcome check_complete(const DeviceRun& run) {
  if (run.lost() == 0) return {};
  Failure failure{fmt::format("{}: {} lost", run.trace.empty() ? run.device.name : run.trace, counted(run.lost(), "sample")),
                  run.outcomes.recorder.lost > 0 ? "The disk was too slow: write to another one."
                                                 : "The machine was too slow: close other programs."};
  failure.cause = Failure::Cause::bound;
  return tl::unexpected(std::move(failure));
}

}  // namespace tactus::cli
