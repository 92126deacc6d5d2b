// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/surface/surface_sequence.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <set>
#include <string_view>

#include <tactus/base/rule.h>
#include <tactus/sim/surface/frame_names.h>
#include <tactus/sim/surface/polygon_file.h>

namespace tactus::sim {
namespace {

namespace fs = std::filesystem;

bool is_surface(const std::string& format) noexcept {
  constexpr std::array<std::string_view, 4> kFormats{".obj", ".ply", ".off", ".stl"};
  return std::find(kFormats.begin(), kFormats.end(), format) != kFormats.end();
}

std::string counted(std::size_t files) { return std::to_string(files) + (files == 1 ? " file" : " files"); }

/// Names of the folder's frames; what is left out is noted.
tl::expected<std::vector<std::string>, Diagnostic> surfaces_in(const std::string& folder, ReadNotes& notes) {
  std::vector<std::string> files, backups, others;
  std::error_code error, ignored;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    const std::string name = at->path().filename().string(), format = surface_format(name);
    if (is_backup(name)) {
      backups.push_back(name);
    } else if (!is_surface(format) || at->is_directory(ignored)) {
      others.push_back(name);
    } else {
      files.push_back(name);
    }
  }
  if (error) return broken(Errc::io, "R-SEQ-1", fs::is_regular_file(folder, ignored) ? "a file, not a folder" : "", folder);
  if (!backups.empty())
    notes.add("", counted(backups.size()) + " left out as hidden or a copy", *std::min_element(backups.begin(), backups.end()));
  if (!others.empty())
    notes.add("", counted(others.size()) + " of another kind left out", *std::min_element(others.begin(), others.end()));
  if (files.empty()) return broken(Errc::invalid, "R-SEQ-2", "no .obj, .ply or .off file", folder);
  return files;
}

tl::expected<void, Diagnostic> check_formats(const std::vector<FrameFile>& frames, const std::string& folder) {
  std::set<std::string> formats;
  for (const FrameFile& frame : frames) formats.insert(surface_format(frame.name));
  if (formats.size() > 1)
    return broken(Errc::invalid, "R-SEQ-2", *formats.begin() + " and " + *formats.rbegin() + " files", folder);
  if (*formats.begin() == ".stl") return broken(Errc::unsupported, "R-SEQ-3", "", folder);
  return {};
}

}  // namespace

tl::expected<SurfaceSequence, Diagnostic> SurfaceSequence::open(const std::string& folder, const SequenceOptions& options) {
  SurfaceSequence out;
  TACTUS_TRY(auto names, surfaces_in(folder, out.notes_));
  if (options.series.empty()) {
    std::vector<FrameFile> all;
    all.reserve(names.size());
    for (const std::string& name : names) all.push_back({name, 0});
    TACTUS_CHECK(check_formats(all, folder));
  }
  auto frames = order_frames(std::move(names), options.series, out.notes_);
  if (!frames) {
    frames.error().file = folder;
    return tl::unexpected(frames.error());
  }
  TACTUS_CHECK(check_formats(*frames, folder));
  for (const FrameFile& frame : *frames) {
    out.files_.push_back((fs::path(folder) / frame.name).string());
    out.offsets_.push_back(frame.offset);
  }
  TACTUS_TRY(auto soup, read_polygons(out.files_[0]));
  out.polygons_ = soup.polygons;
  out.vertices_ = soup.vertices.size();
  auto surface = make_surface(std::move(soup), {.drop_degenerate = options.drop_degenerate});
  if (!surface) {
    surface.error().file = out.files_[0];
    return tl::unexpected(surface.error());
  }
  for (const ReadNote& note : surface->notes.all()) out.notes_.add(note.where, note.what, note.first);
  if (surface->dropped_faces > 0)
    out.notes_.add("", "faces without area in the first frame left out: " + std::to_string(surface->dropped_faces));
  if (surface->unused_vertices > 0)
    out.notes_.add("", "vertices of no face left out: " + std::to_string(surface->unused_vertices));
  if (surface->polygons > 0) out.notes_.add("", "faces cut into triangles: " + std::to_string(surface->polygons));
  out.used_ = std::move(surface->vertex);
  out.rest_ = std::move(surface->mesh);
  return out;
}

tl::expected<std::vector<Vec3>, Diagnostic> SurfaceSequence::positions(std::size_t frame) const {
  const std::string& file = files_[frame];
  TACTUS_TRY(const auto soup, read_polygons(file));
  if (soup.vertices.size() != vertices_)
    return broken(Errc::invalid, "R-SEQ-4",
                  std::to_string(soup.vertices.size()) + " vertices, the first frame has " + std::to_string(vertices_), file);
  if (soup.polygons.size() != polygons_.size())
    return broken(Errc::invalid, "R-SEQ-4",
                  std::to_string(soup.polygons.size()) + " faces, the first frame has " + std::to_string(polygons_.size()), file);
  const auto differs = std::mismatch(polygons_.begin(), polygons_.end(), soup.polygons.begin());
  if (differs.first != polygons_.end())
    return broken(Errc::invalid, "R-SEQ-4", "face " + std::to_string(differs.first - polygons_.begin()), file);
  std::vector<Vec3> out;
  out.reserve(used_.size());
  for (const std::uint32_t v : used_) {
    const Vec3& p = soup.vertices[v];
    if (!(std::abs(p.x) <= 1e6 && std::abs(p.y) <= 1e6 && std::abs(p.z) <= 1e6))
      return tl::unexpected(Diagnostic{.error = fail(Errc::invalid, "R-SRF-8").value(),
                                       .file = file,
                                       .line = v < soup.vertex_lines.size() ? soup.vertex_lines[v] : 0,
                                       .kind = "vertex",
                                       .element = v});
    out.push_back(p);
  }
  return out;
}

}  // namespace tactus::sim
