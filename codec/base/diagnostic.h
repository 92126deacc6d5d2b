// SPDX-License-Identifier: Apache-2.0
/// Human-readable error of a file, a mesh or a simulation, with its location.
#pragma once

#include <cstdint>
#include <string>
#include <type_traits>

#include <tactus/base/result.h>

namespace tactus {

struct Diagnostic {
  Error error;
  std::string file{};          ///< empty: none
  std::uint64_t line = 0;      ///< from 1; 0: none
  std::int64_t step = -1;      ///< step or tick of a simulation; -1: none
  const char* kind = nullptr;  ///< what `element` counts, such as "triangle"; null: no element
  std::uint64_t element = 0;   ///< from 0
  std::string detail{};  ///< rest of the location: a key, a column, a topic and its time, the wrong word or figures; may be empty
  std::string cause{};   ///< what is wrong in this particular case; empty: the rule's general sentence, describe(error)
  std::string remedy{};  ///< fix for this particular case; empty: the rule's general one, remedy(error)
};

/// The same error with room for words.
template <class T>
tl::expected<T, Diagnostic> diagnosed(Result<T> result) {
  if (!result) return tl::unexpected(Diagnostic{.error = result.error()});
  if constexpr (std::is_void_v<T>) return {};
  else return *std::move(result);
}

/// The location within the file: "line 3, triangle 17, column y, 'oops'"; may be empty.
std::string location_of(const Diagnostic& diagnostic);

/// One line: "m.obj:3: triangle 17: R-SRF-11: an edge belongs to a third triangle; remove the surplus element or take the mesh
/// apart there". Text from the file is escaped for terminals (shown.h).
std::string to_string(const Diagnostic& diagnostic);

}  // namespace tactus
