// SPDX-License-Identifier: Apache-2.0
/// What of a truth is held, as it breaks a rule: one bad object does not stop the others.
#pragma once

#include <cstdint>
#include <string_view>

#include <tactus/scene/scene.h>

namespace tactus {

enum class TruthPart : std::uint8_t {
  object,   ///< a rigid object is coded where it was last, at rest; before its first good sample where the scene declares it
  contact,  ///< a contact does not count
  shape,    ///< a deformable object is coded in its last shape; before its first good one in its rest shape
  touch,    ///< a touch of a deformable object does not count
  load,     ///< the forces on a rigid object are those it had last; before its first good ones none
};

/// A part of the truth that breaks a rule. It is coded anew from the first tick on in which it breaks none.
struct HeldPart {
  TruthPart part = TruthPart::object;
  std::uint32_t index = 0;  ///< into the part's span of Truth
  std::int64_t since = 0;   ///< [ticks] the first of those in a row that break a rule
  const char* rule = "";    ///< R-API-1, 2, 3, 6 or 15

  /// Why, for describe() and remedy().
  operator Error() const noexcept { return {.code = Errc::invalid_argument, .rule = rule, .bit_offset = 0}; }
};

/// Name of the object that is concerned; empty: of a contact, which may name no object.
inline std::string_view name_of(const Scene& scene, const HeldPart& held) noexcept {
  switch (held.part) {
    case TruthPart::object:
    case TruthPart::load:
      return scene.objects[held.index].name;
    case TruthPart::shape:
    case TruthPart::touch:
      return scene.deformables[held.index].name;
    case TruthPart::contact:
      break;
  }
  return {};
}

}  // namespace tactus
