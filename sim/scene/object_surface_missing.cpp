// SPDX-License-Identifier: Apache-2.0
// In place of object_surface.cpp when the component SURFACE is left out.
#include <tactus/sim/scene/object_surface.h>

#include <tactus/base/rule.h>

namespace tactus::sim {

tl::expected<ObjectSurface, Diagnostic> read_object_surface(const std::string& file) {
  return tl::unexpected(Diagnostic{.error = fail(Errc::unsupported, "R-SRF-3").value(),
                                   .file = file,
                                   .remedy = "this program was built without surface files; install nlohmann-json3-dev and build "
                                             "with TACTUS_WITH_SURFACE=ON, or give the object a size"});
}

}  // namespace tactus::sim
