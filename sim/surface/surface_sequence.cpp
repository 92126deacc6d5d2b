// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/surface/surface_sequence.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <set>
#include <string_view>

#include <tactus/base/rule.h>
#include <tactus/sim/surface/frame_names.h>
#include <tactus/sim/surface/gltf_scene.h>
#include <tactus/sim/surface/polygon_file.h>

namespace tactus::sim {
namespace {

namespace fs = std::filesystem;

bool is_surface(const std::string& format) noexcept {
  constexpr std::array<std::string_view, 4> kFormats{".obj", ".ply", ".off", ".stl"};
  return std::find(kFormats.begin(), kFormats.end(), format) != kFormats.end();
}

std::string spelt(double value) {
  char digits[32];
  return {digits, std::to_chars(digits, digits + sizeof digits, value, std::chars_format::general, 6).ptr};
}

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
  const auto note = [&notes](const std::vector<std::string>& names, const char* what) {
    if (!names.empty()) notes.add("", what, *std::min_element(names.begin(), names.end()), names.size());
  };
  note(backups, "a file is left out as hidden or a copy");
  note(others, "a file of another kind is left out");
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

tl::expected<SurfaceSequence, Diagnostic> SurfaceSequence::open_scene(const std::string& path, const SequenceOptions& options) {
  constexpr std::size_t kMostFrames = std::size_t{1} << 18, kMostPositions = std::size_t{1} << 31;
  SurfaceSequence out;
  out.files_ = {path};
  out.period_ = options.period;
  TACTUS_TRY(auto bytes, read_bytes(path));
  TACTUS_TRY(auto scene, GltfScene::open(std::move(bytes), folder_of(path),
                                         {.node = options.node,
                                          .animation = options.animation,
                                          .moves = true,
                                          .drop_degenerate = options.drop_degenerate,
                                          .axes = options.axes}));
  const double frames = std::floor(scene.duration() / options.period + 1e-3) + 1;  // keys are in single precision
  const std::size_t most = std::min(kMostFrames, kMostPositions / scene.rest().mesh.vertices.size());
  if (!(frames <= static_cast<double>(most)))
    return broken(Errc::limit_exceeded, "R-SEQ-7", spelt(scene.duration()) + " s, " + spelt(frames) + " frames");
  for (std::size_t k = 0; static_cast<double>(k) < frames; ++k) out.offsets_.push_back(static_cast<double>(k));
  out.take(SurfaceFile(scene.rest()));
  if (scene.duration() > 0)
    out.notes_.add(
        "", "an animation of " + spelt(scene.duration()) + " s is sampled " + spelt(1 / options.period) + " times per second");
  out.scene_ = std::make_shared<const GltfScene>(std::move(scene));
  return out;
}

/// The shape at rest, and what was decided about it.
void SurfaceSequence::take(SurfaceFile&& first) {
  for (const ReadNote& note : first.notes.all()) notes_.add(note);
  notes_.add("", "a face without area in the first frame is left out", {}, first.dropped_faces);
  notes_.add("", "a vertex of no face is left out", {}, first.unused_vertices);
  notes_.add("", "a face is cut into triangles", {}, first.polygons);
  used_ = std::move(first.vertex);
  rest_ = std::move(first.mesh);
}

tl::expected<SurfaceSequence, Diagnostic> SurfaceSequence::open(const std::string& path, const SequenceOptions& options) {
  std::error_code ignored;
  if (const std::string format = surface_format(path);
      (format == ".gltf" || format == ".glb") && !fs::is_directory(path, ignored))
    return open_scene(path, options).map_error([&](Diagnostic e) {
      if (e.file.empty()) e.file = path;
      return e;
    });
  SurfaceSequence out;
  out.turns_ = options.axes == Axes::y_up;
  TACTUS_TRY(auto names, surfaces_in(path, out.notes_));
  if (options.series.empty()) {
    std::vector<FrameFile> all;
    all.reserve(names.size());
    for (const std::string& name : names) all.push_back({name, 0});
    TACTUS_CHECK(check_formats(all, path));
  }
  auto frames = order_frames(std::move(names), options.series, out.notes_);
  if (!frames) {
    frames.error().file = path;
    return tl::unexpected(frames.error());
  }
  TACTUS_CHECK(check_formats(*frames, path));
  for (const FrameFile& frame : *frames) {
    out.files_.push_back((fs::path(path) / frame.name).string());
    out.offsets_.push_back(frame.offset);
  }
  TACTUS_TRY(auto soup, read_polygons(out.files_[0]));
  out.polygons_ = soup.polygons;
  out.vertices_ = soup.vertices.size();
  if (out.turns_)
    for (Vec3& v : soup.vertices) v = turned_up(v);
  auto surface = make_surface(std::move(soup), {.drop_degenerate = options.drop_degenerate});
  if (!surface) {
    surface.error().file = out.files_[0];
    return tl::unexpected(surface.error());
  }
  out.take(std::move(*surface));
  return out;
}

tl::expected<std::vector<Vec3>, Diagnostic> SurfaceSequence::positions(std::size_t frame) const {
  const std::string& file = this->file(frame);
  const auto is_in_range = [](const Vec3& p) { return std::abs(p.x) <= 1e6 && std::abs(p.y) <= 1e6 && std::abs(p.z) <= 1e6; };
  if (scene_) {
    auto out = scene_->positions(static_cast<double>(frame) * period_);
    const auto wrong = std::find_if_not(out.begin(), out.end(), is_in_range);
    if (wrong == out.end()) return out;
    return tl::unexpected(Diagnostic{.error = fail(Errc::invalid, "R-SRF-8").value(),
                                     .file = file,
                                     .kind = "vertex",
                                     .element = static_cast<std::uint64_t>(wrong - out.begin()),
                                     .detail = "in frame " + std::to_string(frame)});
  }
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
    const Vec3 p = turns_ ? turned_up(soup.vertices[v]) : soup.vertices[v];
    if (!is_in_range(p))
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
