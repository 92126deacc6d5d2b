// SPDX-License-Identifier: Apache-2.0
// Gmsh's binary forms, of either byte order: its reference manual, "MSH file format" (4.1: ints of 4 bytes, sizes of 8) and "MSH file format
// version 2 (Legacy)" (ints of 4 bytes). fTetWild writes 2.2, meshio 4.1 or 2.2.
#include <algorithm>
#include <bit>
#include <cmath>
#include <string>

#include <tactus/base/text.h>
#include <tactus/sim/tets/msh_mesh.h>
#include <tactus/sim/tets/tokenizer.h>

namespace tactus::sim {
namespace {

using Read = tl::expected<void, Diagnostic>;

class BinaryMsh {
 public:
  BinaryMsh(std::string_view format, std::string_view body) : legacy_(format.starts_with('2')), rest_(body) {}

  tl::expected<TetFile, Diagnostic> read() {
    TACTUS_CHECK(read_order());
    for (auto name = line(); !rest_.empty() || !name.empty(); name = line()) TACTUS_CHECK(read_section(name));
    if (!has_nodes_ || !has_elements_) return broken(Errc::truncated, "R-TET-10", has_nodes_ ? "no $Elements" : "no $Nodes");
    if (mesh_.file.mesh.tets.empty()) return broken(Errc::invalid, "R-TET-16", "");
    drop_unused_vertices(mesh_.file);
    return std::move(mesh_.file);
  }

 private:
  tl::unexpected<Diagnostic> broken(Errc code, RuleName rule, std::string detail) const {
    return tl::unexpected(Diagnostic{.error = fail(code, rule).value(), .detail = std::move(detail)});
  }

  /// The number 1 shows the order of bytes.
  Read read_order() {
    const std::uint64_t one = number(4);
    swapped_ = one == 0x01000000;
    if (one != 1 && !swapped_) return broken(Errc::malformed, "R-TET-11", "the number that shows the order of bytes");
    (void)line();
    return expect("$EndMeshFormat");
  }

  /// A line without its end and blanks behind.
  std::string_view line() noexcept {
    std::string_view found = rest_.substr(0, rest_.find('\n'));
    rest_.remove_prefix(std::min(found.size() + 1, rest_.size()));
    while (found.ends_with('\r') || found.ends_with(' ')) found.remove_suffix(1);
    return found;
  }

  Read expect(std::string_view wanted) {
    std::string_view found = line();
    if (found.empty() && !rest_.empty()) found = line();  // a line may end behind the bytes
    if (rest_.empty() && found != wanted) return broken(Errc::truncated, "R-TET-10", "no " + std::string(wanted));
    return found == wanted ? Read() : broken(Errc::malformed, "R-TET-13", "no " + std::string(wanted));
  }

  Read read_section(std::string_view name) {
    if (name.empty()) return {};
    if (name == "$Nodes") {
      if (has_nodes_) return broken(Errc::malformed, "R-TET-13", "$Nodes twice");
      has_nodes_ = true;
      TACTUS_CHECK(legacy_ ? read_nodes_2() : read_nodes_4());
      return expect("$EndNodes");
    }
    if (name == "$Elements") {
      if (has_elements_ || !has_nodes_)
        return broken(Errc::malformed, "R-TET-13", has_elements_ ? "$Elements twice" : "$Elements before $Nodes");
      has_elements_ = true;
      if (const auto twice = mesh_.sort_tags())
        return broken(Errc::invalid, "R-TET-15", "node " + std::to_string(*twice) + " twice");
      TACTUS_CHECK(legacy_ ? read_elements_2() : read_elements_4());
      return expect("$EndElements");
    }
    if (!name.starts_with('$')) return broken(Errc::malformed, "R-TET-13", "no section's name");
    const std::string end = "$End" + std::string(name.substr(1));
    const std::size_t at = rest_.find(end);
    if (at == std::string_view::npos) return broken(Errc::truncated, "R-TET-10", "no " + end);
    rest_.remove_prefix(at);
    (void)line();
    return {};
  }

  std::uint64_t number(std::size_t bytes) noexcept {
    if (rest_.size() < bytes) {
      rest_ = {};
      ended_ = true;
      return 0;
    }
    std::uint64_t value = 0;
    for (std::size_t b = 0; b < bytes; ++b) value = value << 8 | static_cast<std::uint8_t>(rest_[swapped_ ? b : bytes - 1 - b]);
    rest_.remove_prefix(bytes);
    return value;
  }
  std::size_t tag() noexcept { return number(legacy_ ? 4 : 8); }

  /// The next number of a text line or of bytes, checked against the limit and what is left.
  Read check_count(std::size_t count, std::size_t most, std::size_t bytes, const char* noun) const {
    if (ended_) return cut();
    if (count > most) return broken(Errc::limit_exceeded, "R-TET-9", std::to_string(count) + ' ' + noun);
    if (count > rest_.size() / bytes) return broken(Errc::truncated, "R-TET-10", std::to_string(count) + ' ' + noun);
    return {};
  }
  Read cut() const { return broken(Errc::truncated, "R-TET-10", "its bytes end within a section"); }

  tl::expected<std::size_t, Diagnostic> count_line(std::size_t most, std::size_t bytes, const char* noun) {
    const std::string_view text = line();
    const auto count = parse_number<std::size_t>(text);
    if (!count) return broken(Errc::malformed, "R-TET-11", "number of " + std::string(noun));
    TACTUS_CHECK(check_count(*count, most, bytes, noun));
    return *count;
  }

  Read read_position() {
    Vec3& v = mesh_.file.mesh.vertices.emplace_back();
    for (double* c : {&v.x, &v.y, &v.z}) {
      *c = std::bit_cast<double>(number(8));
      if (!std::isfinite(*c))
        return broken(Errc::invalid, "R-TET-12", "node " + std::to_string(mesh_.file.mesh.vertices.size() - 1));
    }
    return {};
  }

  Read read_nodes_2() {
    TACTUS_TRY(const auto count, count_line(kMaxMeshVertices, 28, "nodes"));
    mesh_.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
      mesh_.add_tag(tag());
      TACTUS_CHECK(read_position());
    }
    return ended_ ? cut() : Read();
  }

  Read read_nodes_4() {
    const std::size_t blocks = number(8), count = number(8);
    number(8), number(8);  // lowest and highest tag
    TACTUS_CHECK(check_count(count, kMaxMeshVertices, 32, "nodes"));
    TACTUS_CHECK(check_count(blocks, rest_.size(), 20, "blocks"));
    mesh_.reserve(count);
    for (std::size_t b = 0; b < blocks; ++b) {
      const std::uint64_t dimension = number(4);
      number(4);  // the entity
      const std::uint64_t parametric = number(4);
      const std::size_t nodes = number(8);
      TACTUS_CHECK(check_count(nodes, count - mesh_.tags.size(), 32, "nodes in a block"));
      for (std::size_t i = 0; i < nodes; ++i) mesh_.add_tag(tag());
      for (std::size_t i = 0; i < nodes; ++i) {
        TACTUS_CHECK(read_position());
        for (std::uint64_t p = 0; parametric != 0 && p < std::min<std::uint64_t>(dimension, 3); ++p) number(8);
      }
    }
    if (ended_) return cut();
    return mesh_.tags.size() == count ? Read()
                                      : broken(Errc::malformed, "R-TET-13", "the blocks have other nodes than announced");
  }

  /// "count", then blocks of "type elements tags" with "number tags... nodes..." each; the second tag is the volume.
  Read read_elements_2() {
    TACTUS_TRY(const auto count, count_line(rest_.size(), 4, "elements"));
    for (std::size_t done = 0; done < count;) {
      const std::size_t type = number(4), elements = number(4), tags = number(4);
      TACTUS_CHECK(check_count(elements, count - done, 4, "elements in a block"));
      TACTUS_CHECK(check_count(tags, rest_.size(), 4, "tags"));
      if (elements == 0) return broken(Errc::malformed, "R-TET-13", "a block of no elements");
      for (std::size_t i = 0; i < elements && !ended_; ++i) {
        number(4);
        std::uint64_t region = 0;
        for (std::size_t t = 0; t < tags; ++t) {
          const std::uint64_t value = number(4);
          if (t == 1) region = value;
        }
        TACTUS_CHECK(read_element(type, static_cast<std::int32_t>(region)));
      }
      if (ended_) return cut();
      done += elements;
    }
    return {};
  }

  Read read_elements_4() {
    const std::size_t blocks = number(8), count = number(8);
    number(8), number(8);
    std::size_t done = 0;
    TACTUS_CHECK(check_count(blocks, rest_.size(), 20, "blocks"));
    for (std::size_t b = 0; b < blocks; ++b) {
      number(4);  // dimension
      const auto region = static_cast<std::int32_t>(number(4));
      const std::size_t type = number(4), elements = number(8);
      TACTUS_CHECK(check_count(elements, count - std::min(done, count), 8, "elements in a block"));
      for (std::size_t i = 0; i < elements && !ended_; ++i) {
        number(8);
        TACTUS_CHECK(read_element(type, region));
      }
      done += elements;
    }
    if (ended_) return cut();
    return done == count ? Read() : broken(Errc::malformed, "R-TET-13", "the blocks have other elements than announced");
  }

  Read read_element(std::size_t type, std::int32_t region) {
    const std::size_t nodes = msh_nodes(type);
    if (nodes == 0 || is_curved_tet(type))
      return broken(Errc::unsupported, "R-TET-14", "elements of type " + std::to_string(type));
    if (type != kMshTet) {
      ++mesh_.file.ignored_elements;
      for (std::size_t n = 0; n < nodes; ++n) tag();
      return {};
    }
    if (mesh_.file.mesh.tets.size() == kMaxTets) return broken(Errc::limit_exceeded, "R-TET-9", "");
    for (std::uint32_t& corner : mesh_.file.mesh.tets.emplace_back()) {
      const std::size_t node = tag();
      if (ended_) return cut();
      const auto vertex = mesh_.vertex(node);
      if (!vertex) return broken(Errc::invalid, "R-TET-15", "no node " + std::to_string(node));
      corner = *vertex;
    }
    mesh_.file.regions.push_back(region);
    return {};
  }

  bool legacy_;
  std::string_view rest_;
  MshMesh mesh_;
  bool swapped_ = false, ended_ = false, has_nodes_ = false, has_elements_ = false;
};

}  // namespace

void drop_unused_vertices(TetFile& file) {
  std::vector<std::uint32_t> number(file.mesh.vertices.size(), 0);
  for (const Tet& tet : file.mesh.tets)
    for (const std::uint32_t v : tet) number[v] = 1;
  const std::size_t attributes = number.empty() ? 0 : file.vertex_attributes.size() / number.size();
  std::uint32_t kept = 0;
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] == 0) continue;
    file.mesh.vertices[kept] = file.mesh.vertices[v];
    for (std::size_t a = 0; a < attributes; ++a)
      file.vertex_attributes[kept * attributes + a] = file.vertex_attributes[v * attributes + a];
    if (!file.vertex_markers.empty()) file.vertex_markers[kept] = file.vertex_markers[v];
    number[v] = kept++;
  }
  for (Tet& tet : file.mesh.tets)
    for (std::uint32_t& v : tet) v = number[v];
  file.ignored_vertices = file.mesh.vertices.size() - kept;
  file.mesh.vertices.resize(kept);
  file.vertex_attributes.resize(attributes * kept);
  if (!file.vertex_markers.empty()) file.vertex_markers.resize(kept);
}

tl::expected<TetFile, Diagnostic> parse_binary_msh(std::string_view format, std::string_view body) {
  return BinaryMsh(format, body).read();
}

}  // namespace tactus::sim
