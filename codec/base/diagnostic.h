// SPDX-License-Identifier: Apache-2.0
/// An error of a file, a mesh or a simulation, with its place: for people.
#pragma once

#include <cstdint>
#include <string>

#include <tactus/base/result.h>

namespace tactus {

struct Diagnostic {
  Error error;
  std::string file{};          ///< empty: none
  std::uint64_t line = 0;      ///< from 1; 0: none
  std::int64_t step = -1;      ///< of a simulation, or its tick; -1: none
  const char* kind = nullptr;  ///< what `element` counts, such as "triangle"; null: no element
  std::uint64_t element = 0;   ///< from 0
  std::string detail{};        ///< more of the place: a key, a column, the word or the figures that are wrong; may be empty
  std::string remedy{};        ///< what would mend this very case; empty: as the table of rules says, remedy(error)
};

/// The place within the file: "line 3, triangle 17, column y, 'oops'"; may be empty.
std::string place_of(const Diagnostic& diagnostic);

/// One line: "m.obj:3: triangle 17: R-SRF-11: an edge belongs to a third triangle; remove the surplus element or take the mesh apart
/// there". What comes from the file has no power over a terminal (shown.h).
std::string to_string(const Diagnostic& diagnostic);

}  // namespace tactus
