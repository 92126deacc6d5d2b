// SPDX-License-Identifier: Apache-2.0
/// Defaults of all options. The WebAssembly module is the decoder alone, and knows those of tactus.h.
#include "bounds.h"
#include "handles.h"

namespace tactus::c {
namespace {

template <class T>
tactus_status fill(void* options, std::size_t size, const T& with) noexcept {
  return init(static_cast<T*>(options), size, with);
}
template <class T>
tactus_status fill(void* options, std::size_t size) noexcept {
  return fill(options, size, defaults<T>());
}

}  // namespace
}  // namespace tactus::c

using namespace tactus;
using namespace tactus::c;

tactus_status tactus_init(int32_t kind, void* options, size_t size) {
  switch (kind) {
    case TACTUS_RIGID_BOUNDS:
      return fill(options, size, bounds_of(RigidTriggers{}));
    case TACTUS_DEFORMABLE_BOUNDS:
      return fill(options, size, bounds_of(DeformableBounds{}));
    case TACTUS_LOAD_BOUNDS:
      return fill(options, size, bounds_of(LoadThresholds{}));
    case TACTUS_LIMITS:
      return fill<tactus_limits>(options, size);
    case TACTUS_RECEIVER_OPTIONS:
      return fill<tactus_receiver_options>(options, size);
#ifndef __wasm__
    case TACTUS_SCENE_OPTIONS:
      return fill<tactus_scene_options>(options, size);
    case TACTUS_RIGID_OPTIONS:
      return fill<tactus_rigid_options>(options, size);
    case TACTUS_DEFORMABLE_OPTIONS:
      return fill<tactus_deformable_options>(options, size);
    case TACTUS_DRIVEN_PHYSICS:
      return fill<tactus_driven_physics>(options, size);
    case TACTUS_ELASTIC_PHYSICS:
      return fill<tactus_elastic_physics>(options, size);
    case TACTUS_SENDER_OPTIONS:
      return fill<tactus_sender_options>(options, size);
    case TACTUS_TRUTH:
      return fill(options, size, tactus_truth{});
    case TACTUS_SERVER_OPTIONS:
      return fill<tactus_server_options>(options, size);
    case TACTUS_CLIENT_OPTIONS:
      return fill<tactus_client_options>(options, size);
#endif
    default:
      return TACTUS_INVALID_ARGUMENT;
  }
}
