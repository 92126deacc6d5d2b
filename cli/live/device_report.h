// SPDX-License-Identifier: Apache-2.0
/// What a person sees while a device runs and afterwards, whatever its hand felt.
#pragma once

#include <string>

#include "cli/live/device_loop.h"
#include "cli/options/options_codec.h"

namespace tactus::cli {

struct Value;

/// Run the loop on a thread of its own until it ends. Keys become markers, q and a signal end it, and a meter shows how it goes.
Outcome run_attended(DeviceLoop& loop, const CommonOptions& common);

/// After run_attended().
struct DeviceRun {
  const device::Capabilities& device;
  const DeviceLoop::Outcomes& outcomes;
  const std::string& trace;  ///< as typed; empty: none
  double rate = 0;           ///< [Hz]

  double seconds() const { return static_cast<double>(outcomes.last_tick + 1) / rate; }
  std::uint64_t lost() const { return outcomes.recorder.lost + outcomes.device_lost; }
};
/// Adds what there is to say of every run: `trace` to `privileges`, and `guard` of a device that takes a force.
void add_to(Value& report, const DeviceRun& run);
/// A failure, and what the trace holds after it.
tl::unexpected<Failure> failed(Failure failure, const DeviceRun& run);
/// err  a sample was lost
Outcome check_complete(const DeviceRun& run);

}  // namespace tactus::cli
