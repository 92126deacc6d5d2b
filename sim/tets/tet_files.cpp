// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/tets/tet_files.h>

#include <array>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <ostream>

#include <tactus/base/rule.h>
#include <tactus/base/text.h>
#include <tactus/sim/tets/msh_mesh.h>
#include <tactus/sim/tets/tokenizer.h>

namespace tactus::sim {
namespace {

using Read = tl::expected<void, Diagnostic>;

constexpr std::size_t kMaxFileBytes = std::size_t{512} << 20;
constexpr std::size_t kMaxAttributes = 64;
constexpr std::size_t kNodeLine = 8, kEleLine = 10;  // bytes of the shortest: "0 0 0 0\n", "0 1 2 3 4\n"

/// "<number> <dimension> <attributes> <markers 0|1>", all but the first may be missing.
struct NodeHeader {
  std::size_t vertices = 0, dimension = 3, attributes = 0, markers = 0;
};

tl::expected<NodeHeader, Diagnostic> read_node_header(Tokenizer& words) {
  NodeHeader header;
  TACTUS_CHECK(words.line());
  TACTUS_CHECK(words.count(header.vertices, kMaxMeshVertices, kNodeLine));
  if (words.has_word()) TACTUS_CHECK(words.number(header.dimension));
  if (header.dimension != 3) return words.broken(Errc::unsupported, "R-TET-14", std::to_string(header.dimension));
  if (words.has_word()) TACTUS_CHECK(words.count(header.attributes, kMaxAttributes, 1));
  if (words.has_word()) TACTUS_CHECK(words.count(header.markers, 1, 1));
  TACTUS_CHECK(words.end_of_line());
  return header;
}

/// The number at the front of a line. That of the first line shows whether numbering starts at 0 or 1.
Read expect_number(Tokenizer& words, std::size_t index, std::size_t& base) {
  std::size_t number = 0;
  TACTUS_CHECK(words.number(number));
  if (index == 0 && number <= 1) base = number;
  if (number != base + index) return words.broken(Errc::invalid, "R-TET-15", std::to_string(number));
  return {};
}

Read read_attributes(Tokenizer& words, std::size_t count, std::vector<double>& attributes) {
  for (std::size_t i = 0; i < count; ++i) TACTUS_CHECK(words.number(attributes.emplace_back()));
  return {};
}

/// out  the first vertex's number
tl::expected<std::size_t, Diagnostic> read_node(Tokenizer& words, TetFile& file) {
  TACTUS_TRY(const auto header, read_node_header(words));
  file.mesh.vertices.reserve(header.vertices);
  std::size_t base = 0;
  for (std::size_t i = 0; i < header.vertices; ++i) {
    TACTUS_CHECK(words.line());
    TACTUS_CHECK(expect_number(words, i, base));
    TACTUS_CHECK(words.coordinates(file.mesh.vertices.emplace_back()));
    TACTUS_CHECK(read_attributes(words, header.attributes, file.vertex_attributes));
    if (header.markers == 1) TACTUS_CHECK(words.number(file.vertex_markers.emplace_back()));
    TACTUS_CHECK(words.end_of_line());
  }
  if (words.next_line()) return words.broken(Errc::malformed, "R-TET-13", words.word());
  return base;
}

/// "<number> <corners each> <attributes>", all but the first may be missing.
Read read_ele(Tokenizer& words, std::size_t base, TetFile& file) {
  std::size_t tets = 0, corners = 4, attributes = 0;
  TACTUS_CHECK(words.line());
  TACTUS_CHECK(words.count(tets, kMaxTets, kEleLine));
  if (words.has_word()) TACTUS_CHECK(words.number(corners));
  if (corners != 4) return words.broken(Errc::unsupported, "R-TET-14", std::to_string(corners));
  if (words.has_word()) TACTUS_CHECK(words.count(attributes, kMaxAttributes, 1));
  TACTUS_CHECK(words.end_of_line());
  if (tets == 0) return words.broken(Errc::invalid, "R-TET-16");
  file.mesh.tets.reserve(tets);
  for (std::size_t i = 0; i < tets; ++i) {
    TACTUS_CHECK(words.line());
    TACTUS_CHECK(expect_number(words, i, base));
    for (std::uint32_t& corner : file.mesh.tets.emplace_back()) {
      std::size_t number = 0;
      TACTUS_CHECK(words.number(number));
      if (number < base || number - base >= file.mesh.vertices.size())
        return words.broken(Errc::invalid, "R-TET-15", std::to_string(number));
      corner = static_cast<std::uint32_t>(number - base);
    }
    TACTUS_CHECK(read_attributes(words, attributes, file.tet_attributes));
    TACTUS_CHECK(words.end_of_line());
  }
  if (words.next_line()) return words.broken(Errc::malformed, "R-TET-13", words.word());
  return {};
}

tl::expected<std::string, Diagnostic> read_text(const std::string& path) {
  const auto refused = [&](Errc code, RuleName rule) {
    return tl::unexpected(Diagnostic{.error = fail(code, rule).value(), .file = path});
  };
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) return refused(Errc::io, "R-TET-8");
  std::ifstream in(path, std::ios::binary);
  std::string text;
  std::array<char, 1 << 16> piece{};
  while (in) {
    in.read(piece.data(), piece.size());
    const auto count = static_cast<std::size_t>(in.gcount());
    if (count > kMaxFileBytes - text.size()) return refused(Errc::limit_exceeded, "R-TET-9");
    text.append(piece.data(), count);
  }
  if (!in.eof() || in.bad()) return refused(Errc::io, "R-TET-8");
  return text;
}

/// Append numbers with the shortest digits that read back as the same.
template <class... T>
void append_line(std::string& text, T... values) {
  std::array<char, 32> digits{};
  const auto append = [&](auto value) {
    text.append(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr);
    text += ' ';
  };
  (append(values), ...);
  text.back() = '\n';
}

void append_vertices(std::string& text, const std::vector<Vec3>& vertices) {
  append_line(text, vertices.size(), 3, 0, 0);
  for (std::size_t i = 0; i < vertices.size(); ++i) append_line(text, i, vertices[i].x, vertices[i].y, vertices[i].z);
}

}  // namespace

tl::expected<TetFile, Diagnostic> parse_node_ele(std::string_view node, std::string_view ele) {
  TetFile file;
  const std::string node_text = decode_text(node), ele_text = decode_text(ele);
  Tokenizer nodes(node_text, ".node", Tokenizer::Comments::hash), elements(ele_text, ".ele", Tokenizer::Comments::hash);
  TACTUS_TRY(const auto base, read_node(nodes, file));
  TACTUS_CHECK(read_ele(elements, base, file));
  drop_unused_vertices(file);
  return file;
}

tl::expected<TetFile, Diagnostic> read_tet_mesh(const std::string& path) {
  const std::filesystem::path name(path);
  if (name.extension() == ".msh") {
    TACTUS_TRY(const auto text, read_text(path));
    return parse_msh(text).map_error([&](Diagnostic e) {
      e.file = path;
      return e;
    });
  }
  if (name.extension() != ".node" && name.extension() != ".ele")
    return tl::unexpected(Diagnostic{.error = fail(Errc::unsupported, "R-TET-17").value(), .file = path});
  const std::string stem = path.substr(0, path.size() - name.extension().string().size());
  TACTUS_TRY(const auto node, read_text(stem + ".node"));
  TACTUS_TRY(const auto ele, read_text(stem + ".ele"));
  return parse_node_ele(node, ele).map_error([&](Diagnostic e) {
    e.file = stem + e.file;
    return e;
  });
}

void write_node(std::ostream& out, const TetMesh& mesh) {
  std::string text;
  append_vertices(text, mesh.vertices);
  out << text;
}

void write_ele(std::ostream& out, const TetMesh& mesh) {
  std::string text;
  append_line(text, mesh.tets.size(), 4, 0);
  for (std::size_t i = 0; i < mesh.tets.size(); ++i) {
    const auto& [a, b, c, d] = mesh.tets[i];
    append_line(text, i, a, b, c, d);
  }
  out << text;
}

void write_msh(std::ostream& out, const TetMesh& mesh) {
  const std::size_t vertices = mesh.vertices.size(), tets = mesh.tets.size();
  std::string text = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 0 1\n";
  const auto [low, high] = bounds(mesh.vertices);
  append_line(text, 1, low.x, low.y, low.z, high.x, high.y, high.z, 0, 0);
  text += "$EndEntities\n$Nodes\n";
  append_line(text, 1, vertices, 1, vertices);
  append_line(text, 3, 1, 0, vertices);
  for (std::size_t i = 1; i <= vertices; ++i) append_line(text, i);
  for (const Vec3& v : mesh.vertices) append_line(text, v.x, v.y, v.z);
  text += "$EndNodes\n$Elements\n";
  append_line(text, 1, tets, 1, tets);
  append_line(text, 3, 1, 4, tets);
  for (std::size_t i = 0; i < tets; ++i) {
    const auto& [a, b, c, d] = mesh.tets[i];
    append_line(text, i + 1, a + 1, b + 1, c + 1, d + 1);
  }
  out << text << "$EndElements\n";
}

void write_smesh(std::ostream& out, const TriMesh& mesh) {
  std::string text;
  append_vertices(text, mesh.vertices);
  append_line(text, mesh.triangles.size(), 0);
  for (const auto& [a, b, c] : mesh.triangles) append_line(text, 3, a, b, c);
  out << text << "0\n0\n";
}

}  // namespace tactus::sim
