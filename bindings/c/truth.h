// SPDX-License-Identifier: Apache-2.0
/// The truth of a tick as the library takes it.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <tactus/sender.h>

#include "handles.h"

namespace tactus::c {

/// Takes the caller's structs over; allocates nothing after it was made, but for more contacts than ever before.
class TruthBuffer {
 public:
  explicit TruthBuffer(const Scene& scene);

  /// out  valid until the next call, and as long as the caller's shapes
  /// err  R-API-12 a null pointer; R-API-5 a wrong count
  Result<Truth> of(const tactus_truth* truth);
  std::optional<std::uint64_t> number() const noexcept { return number_; }  ///< of its packets; nothing: they are counted

 private:
  void take(const tactus_contact& contact);
  static Result<void> take(const tactus_shape& shape, DeformableTruth& out) noexcept;
  void take_loads(const double* vectors) noexcept;

  std::size_t users_;  // whose forces are sent
  std::vector<RigidSample> objects_;
  std::vector<Contact> contacts_;
  std::vector<DeformableTruth> shapes_;
  std::vector<ObjectLoad> loads_;
  std::vector<Vec3> pushes_;  // of all loads
  std::optional<std::uint64_t> number_;
};

/// What came of a truth, for the caller.
class Answer {
 public:
  /// Room for what may be held, so that no tick allocates.
  explicit Answer(const Scene& scene);

  /// Take what came of a tick.   in  packets  they live as long as the answer is used
  void take(const Scene& scene, std::int64_t tick, std::span<const Packet> packets, std::span<const HeldPart> held);
  void clear() noexcept;
  tactus_encoded given() const noexcept;

 private:
  std::vector<tactus_packet> packets_;
  std::vector<tactus_held> held_;
};

/// err  as given_or(); R-API-4 there is no such reduction or baseline
Result<SenderOptions> options_of(const tactus_sender_options* options) noexcept;

}  // namespace tactus::c
