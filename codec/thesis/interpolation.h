// SPDX-License-Identifier: Apache-2.0
/// Interpolation of a client: how the pose of an object passes to an update that came. Integers. spec/85-thesis.md section 3; thesis 3.2.3.1.
/// Internal to the library; Receiver is the way in.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <tactus/client/replica.h>
#include <tactus/client/update_interpolation.h>
#include <tactus/rigid/curve.h>
#include <tactus/rigid/rigid_predictor.h>

namespace tactus {

/// Interpolation::linear, hermite and blending.
class ThesisInterpolation final : public UpdateInterpolation {
 public:
  /// pre  Replica::check(), and both outlive this.   allocates
  ThesisInterpolation(const Scene& scene, const ReplicaOptions& options, const DevicePath* device);

  void apply(const DecodedPacket& packet, const RigidStates& states, std::int64_t arrival) noexcept override;
  RigidPose pose(std::uint32_t object, std::int64_t now) const noexcept override;
  std::uint8_t lod(std::uint32_t object) const noexcept override { return tracks_[object].state.lod; }

 private:
  static constexpr std::size_t kArrivals = 5;  // M
  struct Track {
    RigidState state;                 // of the newest update
    std::uint64_t number = 0;         // of its packet
    std::int64_t begin = 0, end = 0;  // [begin, end); empty: no interpolation is running
    PoseOffset error;                 // from where the newest state is at `begin` to what was shown there
    PoseOffset change;                // what the velocities of both states differ by until `end`; none with linear
    std::int64_t last_arrival = -1;
    std::array<std::int32_t, kArrivals> gaps{};
    std::uint8_t gap_count = 0, gap_next = 0;
  };

  void update(Track& track, std::uint32_t object, const RigidState& state, std::int64_t now) noexcept;
  std::int64_t interval(const Track& track) const noexcept;
  RigidMotion motion(const Track& track, std::int64_t now) const noexcept;

  const Scene& scene_;
  RigidPredictor predictor_;
  Interpolation interpolation_;
  std::uint32_t fraction_;  // x 2^-16
  std::int64_t shortest_, longest_;
  std::vector<Track> tracks_;
};

std::unique_ptr<UpdateInterpolation> thesis_interpolation(const Scene& scene, const ReplicaOptions& options,
                                                          const DevicePath* device);

}  // namespace tactus
