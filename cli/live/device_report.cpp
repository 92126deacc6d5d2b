// SPDX-License-Identifier: Apache-2.0
#include "cli/live/device_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>
#include <utility>

#include "cli/commands/stop.h"
#include "cli/live/keyboard.h"
#include "cli/live/meter.h"
#include "cli/live/ticker.h"
#include "cli/report/json.h"
#include "cli/report/table.h"

namespace tactus::cli {
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
