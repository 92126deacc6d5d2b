// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <tactus/base/tri_mesh.h>

namespace tactus::sim {

/// Why a surface cannot be read, written or filled. Rules: R-SRF-n (surface_file.h), R-SEQ-n (surface_sequence.h), R-TGN-n (tetgen.h), R-SRF-8..14 (tri_mesh.h).
struct SurfaceError {
  Error error;
  std::string file;           ///< empty: no file has to do with it
  std::uint32_t element = 0;  ///< R-SRF-8..14: as its table says
  std::string detail;         ///< the place or the figures, "triangle 17" or "11 of 12 faces"; may be empty
};
std::string to_string(const SurfaceError& error);  ///< "s.obj: 11 of 12 faces: R-SRF-5: ...; ..." with remedy

}  // namespace tactus::sim
