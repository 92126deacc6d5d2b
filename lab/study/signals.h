// SPDX-License-Identifier: Apache-2.0
/// What a participant's device and force cost on their way, on a recording: each sample goes through the coders of spec/65-signal.md, over
/// a network that loses nothing, and what the other end shows is compared with it at once. Everything but the times is deterministic.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <tactus/base/result.h>
#include <tactus/trace/frame.h>

namespace tactus::sim::study {

enum class Signal : std::uint8_t {
  device,   ///< [m] positions under a bound of length
  contact,  ///< [m] the same, and in contact under a deadband of the force that their error causes
  force,    ///< [N] under a deadband
};

/// One coding of the signal of one user.
struct SignalResult {
  std::size_t user = 0;
  Signal signal = Signal::device;
  std::string name;  ///< "0.3 mm", "4 %, 0.5 mm", "4 %, linear"
  std::uint64_t samples = 0, packets = 0, bytes = 0;
  double largest = 0, rms = 0;  ///< of the error
  double worst = 0;             ///< largest error, as a fraction of what is permitted at that sample
  std::uint64_t over = 0;       ///< samples off by more than permitted
  double time = 0;              ///< [s] median: one sample at the sender
};

/// All users of a recording, each with every coding. Samples are not kept.
class SignalStudy {
 public:
  /// Acknowledgements of a device come so much later, [s].
  static constexpr double kRoundTrip = 0.04;

  /// err  of Sender and ForceSender: the tick rate
  static Result<SignalStudy> create(const TraceInfo& info);

  /// pre  a frame of that recording, ticks rise
  /// err  of Sender::encode and ForceSender::encode
  Result<void> add(const TraceFrame& frame);

  /// A signal that never changes is left out: the recording lacks it.
  std::vector<SignalResult> results() const;

  SignalStudy(SignalStudy&&) noexcept;
  SignalStudy& operator=(SignalStudy&&) noexcept;
  ~SignalStudy();

 private:
  struct Impl;
  explicit SignalStudy(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tactus::sim::study
