// SPDX-License-Identifier: Apache-2.0
// Gmsh's format is described in its reference manual, chapter "MSH file format" (4.1) and "MSH file format version 2 (Legacy)".
#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include <tactus/base/text.h>
#include <tactus/sim/tets/msh_mesh.h>
#include <tactus/sim/tets/tokenizer.h>

namespace tactus::sim {
namespace {

using Read = tl::expected<void, Diagnostic>;

constexpr std::size_t kNodeBytes = 8, kElementBytes = 4;  // of the shortest: "1 0 0 0\n", "1 1\n"
constexpr std::size_t kAnyNumber = static_cast<std::size_t>(-1);

class MshReader {
 public:
  explicit MshReader(std::string_view text) : words_(text, "", Tokenizer::Comments::none) {}

  tl::expected<TetFile, Diagnostic> read() {
    TACTUS_CHECK(read_format());
    while (words_.next_line()) TACTUS_CHECK(read_section(words_.word()));
    if (!has_nodes_ || !has_elements_) return words_.broken(Errc::truncated, "R-TET-10");
    if (mesh_.file.mesh.tets.empty()) return words_.broken(Errc::invalid, "R-TET-16");
    drop_unused_vertices(mesh_.file);
    return std::move(mesh_.file);
  }

 private:
  /// Sections such as $Comments may stand before the format.
  Read read_format() {
    TACTUS_CHECK(words_.line());
    for (auto name = words_.word(); name != "$MeshFormat"; name = words_.word()) {
      if (!name.starts_with('$')) return words_.broken(Errc::malformed, "R-TET-13", name);
      TACTUS_CHECK(skip_section(name));
      TACTUS_CHECK(words_.line());
    }
    TACTUS_CHECK(words_.end_of_line());
    TACTUS_CHECK(words_.line());
    const std::string_view version = words_.word();
    std::size_t binary = 0, real_bytes = 0;
    TACTUS_CHECK(words_.number(binary));
    TACTUS_CHECK(words_.number(real_bytes));
    const bool known = is_legacy(version) || version == "4" || version == "4.0" || version == "4.1";
    if (binary != 0 || !known || real_bytes != 8)
      return words_.broken(Errc::unsupported, "R-TET-14", binary != 0 ? "binary" : known ? std::to_string(real_bytes) : version);
    legacy_ = is_legacy(version);
    tags_first_ = version == "4" || version == "4.0";
    TACTUS_CHECK(words_.end_of_line());
    return expect("$EndMeshFormat");
  }

  Read skip_section(std::string_view name) {
    const std::string end = "$End" + std::string(name.substr(1));
    do TACTUS_CHECK(words_.line());
    while (words_.word() != end);
    return {};
  }

  Read expect(std::string_view wanted) {
    TACTUS_CHECK(words_.line());
    if (const std::string_view found = words_.word(); found != wanted) return words_.broken(Errc::malformed, "R-TET-13", found);
    return words_.end_of_line();
  }

  Read read_section(std::string_view name) {
    if (name == "$Nodes") {
      if (std::exchange(has_nodes_, true)) return words_.broken(Errc::malformed, "R-TET-13", name);
      TACTUS_CHECK(legacy_ ? read_nodes_2() : read_nodes_4());
      return expect("$EndNodes");
    }
    if (name == "$Elements") {
      if (std::exchange(has_elements_, true) || !has_nodes_) return words_.broken(Errc::malformed, "R-TET-13", name);
      TACTUS_CHECK(sort_tags());
      TACTUS_CHECK(legacy_ ? read_elements_2() : read_elements_4());
      return expect("$EndElements");
    }
    if (!name.starts_with('$')) return words_.broken(Errc::malformed, "R-TET-13", name);
    return skip_section(name);
  }

  /// number, then "tag x y z" each
  Read read_nodes_2() {
    std::size_t count = 0;
    TACTUS_CHECK(words_.line());
    TACTUS_CHECK(words_.count(count, kMaxMeshVertices, kNodeBytes));
    TACTUS_CHECK(words_.end_of_line());
    mesh_.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
      TACTUS_CHECK(words_.line());
      TACTUS_CHECK(read_tag());
      TACTUS_CHECK(words_.coordinates(mesh_.file.mesh.vertices.emplace_back()));
      TACTUS_CHECK(words_.end_of_line());
    }
    return {};
  }

  /// "blocks nodes lowest highest", then blocks of "dimension entity parametric nodes", tags, coordinates. In 4.0: "blocks nodes", blocks of
  /// "entity dimension parametric nodes", each node's tag before its coordinates.
  Read read_nodes_4() {
    std::size_t blocks = 0, count = 0;
    TACTUS_CHECK(read_totals(blocks, count, kMaxMeshVertices, kNodeBytes));
    mesh_.reserve(count);
    for (std::size_t b = 0; b < blocks; ++b) {
      std::array<std::int64_t, 3> entity{};  // dimension, tag, parametric
      std::size_t nodes = 0;
      TACTUS_CHECK(words_.line());
      for (std::int64_t& value : entity) TACTUS_CHECK(words_.number(value));
      TACTUS_CHECK(words_.count(nodes, count - mesh_.file.mesh.vertices.size(), kNodeBytes));
      TACTUS_CHECK(words_.end_of_line());
      for (std::size_t i = 0; i < nodes && !tags_first_; ++i) {
        TACTUS_CHECK(words_.line());
        TACTUS_CHECK(read_tag());
        TACTUS_CHECK(words_.end_of_line());
      }
      for (std::size_t i = 0; i < nodes; ++i) {
        TACTUS_CHECK(words_.line());
        if (tags_first_) TACTUS_CHECK(read_tag());
        TACTUS_CHECK(words_.coordinates(mesh_.file.mesh.vertices.emplace_back()));
        for (std::int64_t p = 0; entity[2] != 0 && p < std::min<std::int64_t>(entity[tags_first_ ? 1 : 0], 3); ++p) {
          double on_entity = 0;  // coordinates on the curve or surface
          TACTUS_CHECK(words_.number(on_entity));
        }
        TACTUS_CHECK(words_.end_of_line());
      }
    }
    if (mesh_.file.mesh.vertices.size() != count) return words_.broken(Errc::malformed, "R-TET-13");
    return {};
  }

  Read read_totals(std::size_t& blocks, std::size_t& count, std::size_t most, std::size_t bytes) {
    std::size_t lowest = 0, highest = 0;
    TACTUS_CHECK(words_.line());
    TACTUS_CHECK(words_.count(blocks, kAnyNumber, kNodeBytes));
    TACTUS_CHECK(words_.count(count, most, bytes));
    if (tags_first_) return words_.end_of_line();
    TACTUS_CHECK(words_.number(lowest));
    TACTUS_CHECK(words_.number(highest));
    return words_.end_of_line();
  }

  Read read_tag() {
    std::size_t tag = 0;
    TACTUS_CHECK(words_.number(tag));
    mesh_.add_tag(tag);
    return {};
  }

  Read sort_tags() {
    if (const auto twice = mesh_.sort_tags()) return words_.broken(Errc::invalid, "R-TET-15", std::to_string(*twice));
    return {};
  }

  /// number, then "tag type tags... nodes..." each; the second tag is the volume
  Read read_elements_2() {
    std::size_t count = 0;
    TACTUS_CHECK(words_.line());
    TACTUS_CHECK(words_.count(count, kAnyNumber, kElementBytes));
    TACTUS_CHECK(words_.end_of_line());
    for (std::size_t i = 0; i < count; ++i) {
      std::size_t number = 0, type = 0, tags = 0;
      TACTUS_CHECK(words_.line());
      TACTUS_CHECK(words_.number(number));
      TACTUS_CHECK(words_.number(type));
      TACTUS_CHECK(words_.number(tags));
      std::int32_t region = 0;
      for (std::size_t t = 0; t < tags; ++t) {
        std::int32_t tag = 0;
        TACTUS_CHECK(words_.number(tag));
        if (t == 1) region = tag;
      }
      TACTUS_CHECK(read_element(type, region));
    }
    return {};
  }

  /// "blocks elements lowest highest", then blocks of "dimension entity type elements" and "tag nodes..." each
  Read read_elements_4() {
    std::size_t blocks = 0, count = 0, done = 0;
    TACTUS_CHECK(read_totals(blocks, count, kAnyNumber, kElementBytes));
    for (std::size_t b = 0; b < blocks; ++b) {
      std::size_t dimension = 0, type = 0, elements = 0;
      std::int32_t region = 0;
      TACTUS_CHECK(words_.line());
      if (tags_first_) TACTUS_CHECK(words_.number(region));
      TACTUS_CHECK(words_.number(dimension));
      if (!tags_first_) TACTUS_CHECK(words_.number(region));
      TACTUS_CHECK(words_.number(type));
      TACTUS_CHECK(words_.count(elements, count - done, kElementBytes));
      TACTUS_CHECK(words_.end_of_line());
      for (std::size_t i = 0; i < elements; ++i) {
        std::size_t number = 0;
        TACTUS_CHECK(words_.line());
        TACTUS_CHECK(words_.number(number));
        TACTUS_CHECK(read_element(type, region));
      }
      done += elements;
    }
    if (done != count) return words_.broken(Errc::malformed, "R-TET-13");
    return {};
  }

  /// The nodes of an element, up to the end of the line.
  Read read_element(std::size_t type, std::int32_t region) {
    if (is_curved_tet(type)) return words_.broken(Errc::unsupported, "R-TET-14", std::to_string(type));
    if (type != kMshTet) {
      ++mesh_.file.ignored_elements;
      return {};
    }
    if (mesh_.file.mesh.tets.size() == kMaxTets) return words_.broken(Errc::limit_exceeded, "R-TET-9");
    for (std::uint32_t& corner : mesh_.file.mesh.tets.emplace_back()) {
      std::size_t tag = 0;
      TACTUS_CHECK(words_.number(tag));
      const auto vertex = mesh_.vertex(tag);
      if (!vertex) return words_.broken(Errc::invalid, "R-TET-15", std::to_string(tag));
      corner = *vertex;
    }
    mesh_.file.regions.push_back(region);
    return words_.end_of_line();
  }

  static bool is_legacy(std::string_view version) noexcept {
    return version == "2" || version == "2.0" || version == "2.1" || version == "2.2";
  }

  Tokenizer words_;
  MshMesh mesh_;
  bool legacy_ = false, tags_first_ = false, has_nodes_ = false, has_elements_ = false;
};

}  // namespace

tl::expected<TetFile, Diagnostic> parse_msh(std::string_view bytes) {
  constexpr std::string_view kFormat = "$MeshFormat";
  const std::size_t at = bytes.find(kFormat), end = at == std::string_view::npos ? at : bytes.find('\n', at);
  if (end != std::string_view::npos && (at == 0 || bytes[at - 1] == '\n' || bytes[at - 1] == '\xBF')) {
    LineReader line(bytes.substr(end + 1, 64), LineReader::Comments::none);
    const std::string_view version = line.next_word(), binary = line.word(), real_bytes = line.word();
    const bool known = version == "2" || version == "2.1" || version == "2.2" || version == "4.1";
    if (binary == "1" && known && real_bytes == "8")
      return parse_binary_msh(version, bytes.substr(std::min(bytes.find('\n', end + 1), bytes.size() - 1) + 1));
  }
  const std::string text = decode_text(bytes);
  return MshReader(text).read();
}

}  // namespace tactus::sim
