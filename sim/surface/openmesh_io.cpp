// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/surface/openmesh_io.h>

#include <mutex>
#include <sstream>

#ifdef __GNUC__  // OpenMesh's headers were not written for -Wconversion
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wsign-conversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wpedantic"
#endif
#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#ifdef __GNUC__
#pragma GCC diagnostic pop
#endif

namespace tactus::sim {
namespace {

namespace om = OpenMesh;

/// OpenMesh's writers and message streams are process-wide: one call at a time, and nothing reaches the terminal. (Redirecting its
/// messages to a stream of ours leaks in OpenMesh 9.)
class QuietOpenMesh {
 public:
  QuietOpenMesh() : lock_(mutex()) {
    omlog().disable();
    omout().disable();
    omerr().disable();
  }
  ~QuietOpenMesh() {
    omerr().enable();
    omout().enable();
    omlog().enable();
  }
  QuietOpenMesh(const QuietOpenMesh&) = delete;
  QuietOpenMesh& operator=(const QuietOpenMesh&) = delete;

 private:
  static std::mutex& mutex() {
    static std::mutex instance;
    return instance;
  }
  std::scoped_lock<std::mutex> lock_;
};

constexpr std::streamsize kDigits = 17;  // restore a double's bits

}  // namespace

tl::expected<std::string, std::string> openmesh_write(const TriMesh& mesh, const std::string& format) {
  const QuietOpenMesh quiet;
  try {
    om::TriMesh_ArrayKernelT<om::DefaultTraitsDouble> out;
    for (const Vec3& v : mesh.vertices) out.add_vertex(om::Vec3d(v.x, v.y, v.z));
    for (const auto& [a, b, c] : mesh.triangles)
      out.add_face(om::VertexHandle(static_cast<int>(a)), om::VertexHandle(static_cast<int>(b)),
                   om::VertexHandle(static_cast<int>(c)));
    std::ostringstream text;
    const om::IO::Options options(format == ".stl" ? om::IO::Options::Binary : om::IO::Options::Default);
    if (!om::IO::write_mesh(out, text, format, options, kDigits)) return tl::unexpected(std::string("OpenMesh refuses it"));
    return std::move(text).str();
  } catch (const std::exception& e) {
    return tl::unexpected(std::string(e.what()));
  }
}

}  // namespace tactus::sim
