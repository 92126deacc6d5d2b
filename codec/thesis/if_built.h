// SPDX-License-Identifier: Apache-2.0
/// For programs of ours that can be built without component thesis. Not installed.
#pragma once

#include <tactus/thesis/thesis.h>

namespace tactus {

/// The component, or null in a program that was built without it (TACTUS_WITH_THESIS).
constexpr const ThesisComponent* thesis_if_built() noexcept {
#ifdef TACTUS_HAS_THESIS
  return &thesis_component;
#else
  return nullptr;
#endif
}

}  // namespace tactus
