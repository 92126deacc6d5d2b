// SPDX-License-Identifier: Apache-2.0
/// A trace from arrays: samples of objects and users at the same times, evenly spaced or not.
///
/// Ticks lie on a grid of the tick rate. Rows that lie on it are taken as they are; between others poses follow a parabola where the motion
/// bends alike at both rows, else a straight line and an arc; forces and velocities follow lines (sample_track.h). A sample with a value that is not finite, or a rotation whose length is off 1 by more than 2 %, is missing: it
/// is interpolated where its neighbours are at most `gap` apart, else the last one is held, a force no longer than `gap` and a velocity not
/// at all: then they are 0. No ticks are made between rows that are farther apart than that. Rows that share a time or come in groups, as of
/// a clock that is coarser than the samples, are spread evenly, as those of a table are (csv_rate.h).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <tactus/base/result.h>
#include <tactus/trace/declared_contact.h>
#include <tactus/trace/frame.h>
#include <tactus/trace/read_notes.h>

namespace tactus {

/// Row-major, one row per time; empty: not there.
struct SampledObject {
  std::string name;
  std::span<const double> position{};          ///< T x 3 [m] world
  std::span<const double> rotation{};          ///< T x 4, w x y z; empty: it does not turn
  std::span<const double> velocity{};          ///< T x 3 [m/s]; empty: backward differences
  std::span<const double> angular_velocity{};  ///< T x 3 [rad/s] world; empty: likewise
};

struct SampledUser {
  std::string name;
  std::span<const double> device{};    ///< T x 3 [m] world
  std::span<const double> rotation{};  ///< T x 4 of the device, w x y z; empty: it is not known
  std::span<const double> force{};     ///< T x 3 [N] on the user, world
};

struct SampledArrays {
  static constexpr std::int64_t kNoTime = INT64_MIN;

  std::span<const std::int64_t> time{};  ///< [ns], not falling; kNoTime: missing
  std::vector<SampledObject> objects{};
  std::vector<SampledUser> users{};
  std::vector<DeclaredContact> contacts{};  ///< what users touched: is written into the trace
  std::uint32_t tick_rate = 0;              ///< [1/s]; 0: found from the times
  double gap = 0.1;                         ///< [s]
  std::string source = "arrays";
};

/// Write a trace. Tick 0 is the first time.
/// out  notes  what was decided, also after an error: then the last one says where
/// err  invalid_argument R-CSV-8 nothing to record, or an array of another length; R-CSV-7 the rate is unknown; invalid R-CSV-5 most times do
///      not increase; malformed R-CSV-4 of an array every sample is missing; those of ContactDeclarations
///      and of TraceWriter
Result<TickSpan> write_arrays(const SampledArrays& arrays, const std::string& path, ReadNotes& notes);

}  // namespace tactus
