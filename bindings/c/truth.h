// SPDX-License-Identifier: Apache-2.0
/// The truth of a tick as the library takes it.
#pragma once

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
};

/// Parts that are held, for the caller.   err  as copy_out()
Outcome copy_held(const Scene& scene, std::span<const HeldPart> held, tactus_held* out, std::size_t capacity,
                  std::size_t* count) noexcept;

/// err  as given_or(); R-API-4 there is no such reduction or baseline
Result<SenderOptions> options_of(const tactus_sender_options* options) noexcept;

}  // namespace tactus::c
