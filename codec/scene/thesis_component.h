// SPDX-License-Identifier: Apache-2.0
/// What component thesis gives the codec. A program links the component only if it names `thesis_component` (thesis/thesis.h). Internal to
/// the library.
#pragma once

#include <cstddef>
#include <memory>

#include <tactus/scene/scene.h>

namespace tactus {

class DeformableDecoder;
class DeformableEncoder;
class DevicePath;
class UpdateInterpolation;
struct DeformableOptions;
struct ReplicaOptions;
struct SenderPolicy;

struct ThesisComponent {
  /// DeformableDecoder::create and DeformableEncoder::create of objects of profile thesis, and the size of their largest packet
  std::unique_ptr<DeformableDecoder> (*decoder)(const Scene& scene, std::size_t object, const DecodeLimits& limits);
  std::unique_ptr<DeformableEncoder> (*encoder)(const Scene& scene, std::size_t object, const DeformableOptions& options,
                                                const SenderPolicy& policy);
  std::size_t (*largest_packet)(const DeformableObject& object) noexcept;

  /// pre  Replica::check()
  std::unique_ptr<UpdateInterpolation> (*interpolation)(const Scene& scene, const ReplicaOptions& options,
                                                        const DevicePath* device);
};

}  // namespace tactus
