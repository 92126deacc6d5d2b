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

/// OpenMesh's readers and message streams are process-wide: one call at a time, and nothing reaches the terminal. (Redirecting its
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

/// Keeps all that a reader finds. OpenMesh's own importer drops or duplicates what does not fit its half-edges.
class SoupImporter final : public om::IO::BaseImporter {
 public:
  PolygonSoup soup;

  om::VertexHandle add_vertex(const om::Vec3f& p) override { return add_vertex(om::Vec3d(p)); }
  om::VertexHandle add_vertex(const om::Vec3d& p) override {
    soup.vertices.push_back({p[0], p[1], p[2]});
    return om::VertexHandle(static_cast<int>(soup.vertices.size() - 1));
  }
  om::VertexHandle add_vertex() override { return add_vertex(om::Vec3d(0, 0, 0)); }
  void set_point(om::VertexHandle v, const om::Vec3f& p) override {
    if (v.is_valid() && static_cast<std::size_t>(v.idx()) < soup.vertices.size())
      soup.vertices[static_cast<std::size_t>(v.idx())] = {p[0], p[1], p[2]};
  }
  om::FaceHandle add_face(const VHandles& corners) override {
    Polygon& polygon = soup.polygons.emplace_back();
    for (const om::VertexHandle v : corners)
      polygon.push_back(static_cast<std::uint32_t>(v.idx()));  // invalid: no vertex's number
    return om::FaceHandle(static_cast<int>(soup.polygons.size() - 1));
  }
  std::size_t n_vertices() const override { return soup.vertices.size(); }
  std::size_t n_faces() const override { return soup.polygons.size(); }
  std::size_t n_edges() const override { return 0; }

  // Half-edges, normals, colours, textures: not wanted.
  om::HalfedgeHandle add_edge(om::VertexHandle, om::VertexHandle) override { return om::HalfedgeHandle(); }
  om::FaceHandle add_face(om::HalfedgeHandle) override { return om::FaceHandle(); }
  void add_face_texcoords(om::FaceHandle, om::VertexHandle, const std::vector<om::Vec2f>&) override {}
  void add_face_texcoords(om::FaceHandle, om::VertexHandle, const std::vector<om::Vec3f>&) override {}
  void set_face_texindex(om::FaceHandle, int) override {}
  void set_halfedge(om::VertexHandle, om::HalfedgeHandle) override {}
  void set_next(om::HalfedgeHandle, om::HalfedgeHandle) override {}
  void set_face(om::HalfedgeHandle, om::FaceHandle) override {}
  void request_face_texcoords2D() override {}
  void add_texture_information(int, std::string) override {}
  void set_normal(om::VertexHandle, const om::Vec3f&) override {}
  void set_normal(om::VertexHandle, const om::Vec3d&) override {}
  void set_normal(om::FaceHandle, const om::Vec3f&) override {}
  void set_normal(om::FaceHandle, const om::Vec3d&) override {}
  void set_color(om::VertexHandle, const om::Vec3uc&) override {}
  void set_color(om::VertexHandle, const om::Vec4uc&) override {}
  void set_color(om::VertexHandle, const om::Vec3f&) override {}
  void set_color(om::VertexHandle, const om::Vec4f&) override {}
  void set_color(om::EdgeHandle, const om::Vec3uc&) override {}
  void set_color(om::EdgeHandle, const om::Vec4uc&) override {}
  void set_color(om::EdgeHandle, const om::Vec3f&) override {}
  void set_color(om::EdgeHandle, const om::Vec4f&) override {}
  void set_color(om::FaceHandle, const om::Vec3uc&) override {}
  void set_color(om::FaceHandle, const om::Vec4uc&) override {}
  void set_color(om::FaceHandle, const om::Vec3f&) override {}
  void set_color(om::FaceHandle, const om::Vec4f&) override {}
  void set_texcoord(om::VertexHandle, const om::Vec2f&) override {}
  void set_texcoord(om::VertexHandle, const om::Vec3f&) override {}
  void set_texcoord(om::HalfedgeHandle, const om::Vec2f&) override {}
  void set_texcoord(om::HalfedgeHandle, const om::Vec3f&) override {}
  void set_status(om::VertexHandle, const om::Attributes::StatusInfo&) override {}
  void set_status(om::HalfedgeHandle, const om::Attributes::StatusInfo&) override {}
  void set_status(om::EdgeHandle, const om::Attributes::StatusInfo&) override {}
  void set_status(om::FaceHandle, const om::Attributes::StatusInfo&) override {}
};

constexpr std::streamsize kDigits = 9;  // restore a float's bits

}  // namespace

tl::expected<PolygonSoup, std::string> openmesh_read(const std::string& text, const std::string& format) {
  const QuietOpenMesh quiet;
  SoupImporter importer;
  try {
    std::istringstream in(text);
    om::IO::Options options(format == ".stlb" ? om::IO::Options::Binary : om::IO::Options::Default);
    if (!om::IO::IOManager().read(in, format.substr(0, 4), importer, options))
      return tl::unexpected(std::string("OpenMesh refuses it"));
  } catch (const std::exception& e) {
    return tl::unexpected(std::string(e.what()));
  }
  return std::move(importer.soup);
}

tl::expected<std::string, std::string> openmesh_write(const TriMesh& mesh, const std::string& format) {
  const QuietOpenMesh quiet;
  try {
    om::TriMesh_ArrayKernelT<> out;
    for (const Vec3& v : mesh.vertices) out.add_vertex(om::Vec3f(om::Vec3d(v.x, v.y, v.z)));
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
