// SPDX-License-Identifier: Apache-2.0
// Gmsh's format is described in its reference manual, chapter "MSH file format" (4.1) and "MSH file format version 2 (Legacy)".
#include <algorithm>
#include <array>
#include <utility>

#include <tactus/sim/tets/tet_files.h>
#include <tactus/sim/tets/tokenizer.h>

namespace tactus::sim {
namespace {

using Read = tl::expected<void, Diagnostic>;

constexpr std::size_t kTetType = 4;
constexpr std::array<std::size_t, 4> kCurvedTetTypes{11, 29, 30, 31};
constexpr std::size_t kNodeBytes = 8, kElementBytes = 4;  // of the shortest: "1 0 0 0\n", "1 1\n"
constexpr std::size_t kAnyNumber = static_cast<std::size_t>(-1);

class MshReader {
 public:
  explicit MshReader(std::string_view text) : words_(text, "", Tokenizer::Comments::none) {}

  tl::expected<TetFile, Diagnostic> read() {
    TACTUS_CHECK(read_format());
    while (words_.next_line()) TACTUS_CHECK(read_section(words_.word()));
    if (!has_nodes_ || !has_elements_) return words_.broken(Errc::truncated, "R-TET-10");
    if (file_.mesh.tets.empty()) return words_.broken(Errc::invalid, "R-TET-16");
    drop_unused_vertices();
    return std::move(file_);
  }

 private:
  Read read_format() {
    TACTUS_CHECK(expect("$MeshFormat"));
    TACTUS_CHECK(words_.line());
    const std::string_view version = words_.word();
    std::size_t binary = 0, real_bytes = 0;
    TACTUS_CHECK(words_.number(binary));
    TACTUS_CHECK(words_.number(real_bytes));
    if (binary != 0) return words_.broken(Errc::unsupported, "R-TET-14", "binary");
    if (version != "4.1" && version != "2.2") return words_.broken(Errc::unsupported, "R-TET-14", version);
    legacy_ = version == "2.2";
    TACTUS_CHECK(words_.end_of_line());
    return expect("$EndMeshFormat");
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
    const std::string end = "$End" + std::string(name.substr(1));
    do TACTUS_CHECK(words_.line());
    while (words_.word() != end);
    return {};
  }

  /// number, then "tag x y z" each
  Read read_nodes_2() {
    std::size_t count = 0;
    TACTUS_CHECK(words_.line());
    TACTUS_CHECK(words_.count(count, kMaxMeshVertices, kNodeBytes));
    TACTUS_CHECK(words_.end_of_line());
    reserve_vertices(count);
    for (std::size_t i = 0; i < count; ++i) {
      TACTUS_CHECK(words_.line());
      TACTUS_CHECK(read_tag());
      TACTUS_CHECK(words_.coordinates(file_.mesh.vertices.emplace_back()));
      TACTUS_CHECK(words_.end_of_line());
    }
    return {};
  }

  /// "blocks nodes lowest highest", then blocks of "dimension entity parametric nodes", tags, coordinates
  Read read_nodes_4() {
    std::size_t blocks = 0, count = 0;
    TACTUS_CHECK(read_totals(blocks, count, kMaxMeshVertices, kNodeBytes));
    reserve_vertices(count);
    for (std::size_t b = 0; b < blocks; ++b) {
      std::array<std::int64_t, 3> entity{};  // dimension, tag, parametric
      std::size_t nodes = 0;
      TACTUS_CHECK(words_.line());
      for (std::int64_t& value : entity) TACTUS_CHECK(words_.number(value));
      TACTUS_CHECK(words_.count(nodes, count - file_.mesh.vertices.size(), kNodeBytes));
      TACTUS_CHECK(words_.end_of_line());
      for (std::size_t i = 0; i < nodes; ++i) {
        TACTUS_CHECK(words_.line());
        TACTUS_CHECK(read_tag());
        TACTUS_CHECK(words_.end_of_line());
      }
      for (std::size_t i = 0; i < nodes; ++i) {
        TACTUS_CHECK(words_.line());
        TACTUS_CHECK(words_.coordinates(file_.mesh.vertices.emplace_back()));
        if (entity[2] == 0) TACTUS_CHECK(words_.end_of_line());  // else coordinates on the curve or surface follow
      }
    }
    if (file_.mesh.vertices.size() != count) return words_.broken(Errc::malformed, "R-TET-13");
    return {};
  }

  Read read_totals(std::size_t& blocks, std::size_t& count, std::size_t most, std::size_t bytes) {
    std::size_t lowest = 0, highest = 0;
    TACTUS_CHECK(words_.line());
    TACTUS_CHECK(words_.count(blocks, kAnyNumber, kNodeBytes));
    TACTUS_CHECK(words_.count(count, most, bytes));
    TACTUS_CHECK(words_.number(lowest));
    TACTUS_CHECK(words_.number(highest));
    return words_.end_of_line();
  }

  void reserve_vertices(std::size_t count) {
    file_.mesh.vertices.reserve(count);
    tags_.reserve(count);
  }

  Read read_tag() {
    std::size_t tag = 0;
    TACTUS_CHECK(words_.number(tag));
    tags_.emplace_back(tag, static_cast<std::uint32_t>(tags_.size()));
    return {};
  }

  Read sort_tags() {
    std::sort(tags_.begin(), tags_.end());
    const auto twice =
        std::adjacent_find(tags_.begin(), tags_.end(), [](const auto& a, const auto& b) { return a.first == b.first; });
    if (twice != tags_.end()) return words_.broken(Errc::invalid, "R-TET-15", std::to_string(twice->first));
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
      TACTUS_CHECK(words_.number(dimension));
      TACTUS_CHECK(words_.number(region));
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
    if (std::find(kCurvedTetTypes.begin(), kCurvedTetTypes.end(), type) != kCurvedTetTypes.end())
      return words_.broken(Errc::unsupported, "R-TET-14", std::to_string(type));
    if (type != kTetType) {
      ++file_.ignored_elements;
      return {};
    }
    if (file_.mesh.tets.size() == kMaxTets) return words_.broken(Errc::limit_exceeded, "R-TET-9");
    for (std::uint32_t& corner : file_.mesh.tets.emplace_back()) {
      std::size_t tag = 0;
      TACTUS_CHECK(words_.number(tag));
      const auto found = std::lower_bound(tags_.begin(), tags_.end(), std::pair{tag, std::uint32_t{0}});
      if (found == tags_.end() || found->first != tag) return words_.broken(Errc::invalid, "R-TET-15", std::to_string(tag));
      corner = found->second;
    }
    file_.regions.push_back(region);
    return words_.end_of_line();
  }

  /// Drop points that only curves and surfaces were made of, such as the centre of a circle.
  void drop_unused_vertices() {
    std::vector<std::uint32_t> number(file_.mesh.vertices.size(), 0);
    for (const Tet& tet : file_.mesh.tets)
      for (const std::uint32_t v : tet) number[v] = 1;
    std::uint32_t kept = 0;
    for (std::size_t v = 0; v < number.size(); ++v) {
      if (number[v] == 0) continue;
      file_.mesh.vertices[kept] = file_.mesh.vertices[v];
      number[v] = kept++;
    }
    for (Tet& tet : file_.mesh.tets)
      for (std::uint32_t& v : tet) v = number[v];
    file_.ignored_vertices = file_.mesh.vertices.size() - kept;
    file_.mesh.vertices.resize(kept);
  }

  Tokenizer words_;
  TetFile file_;
  std::vector<std::pair<std::size_t, std::uint32_t>> tags_;  // a vertex's number in the file, its place in the mesh
  bool legacy_ = false, has_nodes_ = false, has_elements_ = false;
};

}  // namespace

tl::expected<TetFile, Diagnostic> parse_msh(std::string_view text) { return MshReader(text).read(); }

}  // namespace tactus::sim
