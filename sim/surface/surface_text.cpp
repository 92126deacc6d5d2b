// SPDX-License-Identifier: Apache-2.0
#include "sim/surface/surface_text.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <vector>

namespace tactus {
namespace {

using Prepared = tl::expected<SurfaceText, SurfaceError>;

tl::unexpected<SurfaceError> broken(Errc code, const char* rule, std::string_view detail) {
  constexpr std::size_t kLongest = 60;
  return tl::unexpected(SurfaceError{fail(code, rule).value(), {}, 0, std::string(detail.substr(0, kLongest))});
}
tl::unexpected<SurfaceError> malformed(std::string_view detail) { return broken(Errc::malformed, "R-SRF-4", detail); }
tl::unexpected<SurfaceError> malformed_line(std::size_t number, std::string_view line) {
  return malformed("line " + std::to_string(number) + ", '" + std::string(line.substr(0, 40)) + '\'');
}

/// The next line, without its end.
std::string_view take_line(std::string_view& text) {
  const std::string_view line = text.substr(0, text.find('\n'));
  text.remove_prefix(std::min(line.size() + 1, text.size()));
  return line.ends_with('\r') ? line.substr(0, line.size() - 1) : line;
}

/// The next word of a line; empty at its end.
std::string_view take_word(std::string_view& line) {
  constexpr std::string_view kBlank = " \t\r\f\v";
  line.remove_prefix(std::min(line.find_first_not_of(kBlank), line.size()));
  const std::string_view word = line.substr(0, line.find_first_of(kBlank));
  line.remove_prefix(word.size());
  return word;
}

std::optional<std::size_t> whole_number(std::string_view word) {
  std::size_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (word.empty() || error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

bool is_finite_number(std::string_view word) {
  double value = 0;
  if (word.starts_with('+')) word.remove_prefix(1);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return !word.empty() && error == std::errc() && end == word.data() + word.size() && std::isfinite(value);
}

/// What a header announces must fit the limits and the bytes behind it.
tl::expected<void, SurfaceError> check_counts(const SurfaceText& announced, std::size_t bytes) {
  if (*announced.vertices > kMaxMeshVertices || announced.faces > kMaxMeshTriangles)
    return broken(Errc::limit_exceeded, "R-SRF-2",
                  std::to_string(*announced.vertices) + " vertices, " + std::to_string(announced.faces) + " faces");
  if (*announced.vertices + announced.faces > bytes) return malformed("the file is shorter than its header says");
  return {};
}

/// Vertices and faces alone, faces without numbers of textures and normals.
Prepared prepare_obj(std::string_view text) {
  SurfaceText out{{}, ".obj", 0, 0};
  std::string line;
  for (std::size_t number = 1; !text.empty(); ++number) {
    line = take_line(text);
    for (; line.ends_with('\\') && !text.empty(); ++number) line.replace(line.size() - 1, 1, " ").append(take_line(text));
    std::string_view rest = std::string_view(line).substr(0, line.find('#'));
    const std::string_view kind = take_word(rest);
    if (kind != "v" && kind != "f") continue;
    out.text += kind;
    std::size_t words = 0;
    for (auto word = take_word(rest); !word.empty() && !(kind == "v" && words == 3); word = take_word(rest), ++words) {
      if (kind == "f") word = word.substr(0, word.find('/'));
      if (!is_finite_number(word)) return malformed_line(number, line);
      (out.text += ' ') += word;
    }
    if (words < 3) return malformed_line(number, line);
    out.text += '\n';
    ++(kind == "v" ? *out.vertices : out.faces);
  }
  if (auto counts = check_counts(out, out.text.size()); !counts) return tl::unexpected(counts.error());
  return out;
}

/// Append the first words of a line, which must be numbers.   in  count  0: the first word tells how many follow it
bool append_numbers(std::string_view line, std::size_t count, std::string& out) {
  for (std::size_t i = 0; i < std::max<std::size_t>(count, 1); ++i) {
    const std::string_view word = take_word(line);
    if (!is_finite_number(word)) return false;
    if (count == 0) count = 1 + whole_number(word).value_or(0);
    (out += word) += ' ';
  }
  out.back() = '\n';
  return true;
}

/// Coordinates and corners alone, one element a line. The header is "OFF" and "vertices faces edges", on one line or two.
Prepared prepare_off(std::string_view text) {
  SurfaceText out{{}, ".off", 0, 0};
  std::vector<std::string_view> header;
  std::size_t done = 0;
  for (std::size_t number = 1; !text.empty(); ++number) {
    std::string_view line = take_line(text);
    line = line.substr(0, line.find('#'));
    std::string_view rest = line;
    if (header.size() < 4) {
      for (auto word = take_word(rest); !word.empty(); word = take_word(rest)) header.push_back(word);
      if (header.size() > 1 && header[1] == "BINARY") return broken(Errc::unsupported, "R-SRF-3", "binary");
      if (header.size() < 4) continue;
      const auto vertices = whole_number(header[1]), faces = whole_number(header[2]);
      if (header.size() != 4 || header[0] != "OFF" || !vertices || !faces) return malformed(line);
      out.vertices = *vertices;
      out.faces = *faces;
      if (auto counts = check_counts(out, text.size()); !counts) return tl::unexpected(counts.error());
      out.text = "OFF\n" + std::to_string(*vertices) + ' ' + std::to_string(*faces) + " 0\n";
      continue;
    }
    if (take_word(rest).empty() || done == *out.vertices + out.faces) continue;
    if (!append_numbers(line, done < *out.vertices ? 3 : 0, out.text)) return malformed_line(number, line);
    ++done;
  }
  if (header.size() < 4) return malformed("header");
  if (done < *out.vertices + out.faces) return malformed("the file is shorter than its header says");
  return out;
}

/// Bytes of a PLY number; 0: no such type.
std::size_t ply_size(std::string_view type) {
  struct Type {
    std::string_view name, other;
    std::size_t bytes;
  };
  constexpr std::array kTypes{Type{"char", "int8", 1},     Type{"uchar", "uint8", 1},   Type{"short", "int16", 2},
                              Type{"ushort", "uint16", 2}, Type{"int", "int32", 4},     Type{"uint", "uint32", 4},
                              Type{"float", "float32", 4}, Type{"double", "float64", 8}};
  const auto* found =
      std::find_if(kTypes.begin(), kTypes.end(), [&](const Type& t) { return type == t.name || type == t.other; });
  return found == kTypes.end() ? 0 : found->bytes;
}

/// An element of a PLY header and the least bytes that one of them takes.
struct PlyElement {
  std::string_view name;
  std::size_t count = 0, bytes = 0;
};

tl::expected<void, SurfaceError> read_ply_property(std::string_view rest, bool binary, PlyElement& element) {
  std::string_view type = take_word(rest);
  const bool is_list = type == "list";
  if (is_list) type = take_word(rest);
  const std::size_t size = ply_size(type);
  if (size == 0) return malformed(type);
  if (is_list && (size > 2 || type == "char" || type == "int8" || type == "short" || type == "int16"))
    return broken(Errc::unsupported, "R-SRF-3", "list counts of type " + std::string(type));
  const std::size_t item = is_list ? ply_size(take_word(rest)) : 0;
  if (is_list && item == 0) return malformed("property list");
  const std::size_t corners = is_list && element.name == "face" ? 3 : 0;
  element.bytes += binary ? size + corners * item : 2 * (1 + corners);
  return {};
}

Prepared prepare_ply(std::string_view text) {
  const std::string_view whole = text;
  if (take_line(text) != "ply") return malformed("no 'ply' in the first line");
  std::vector<PlyElement> elements;
  bool binary = false, ended = false;
  while (!text.empty() && !ended) {
    std::string_view rest = take_line(text);
    const std::string_view line = rest, word = take_word(rest);
    ended = word == "end_header";
    if (word == "format") binary = take_word(rest) != "ascii";
    if (word == "element") {
      const std::string_view name = take_word(rest);
      const auto count = whole_number(take_word(rest));
      if (!count) return malformed(line);
      elements.push_back({name, *count});
    }
    if (word == "property") {
      if (elements.empty()) return malformed(line);
      if (auto read = read_ply_property(rest, binary, elements.back()); !read) return tl::unexpected(read.error());
    }
  }
  SurfaceText out{std::string(whole), ".ply", 0, std::nullopt};
  std::size_t left = text.size() + 1;  // the last line of text may lack its end
  for (const PlyElement& e : elements) {
    if (e.name == "vertex") out.vertices = e.count;
    if (e.name == "face") out.faces = e.count;
    if (e.bytes == 0 || e.count > left / e.bytes) return malformed("the file is shorter than its header says");
    left -= e.count * e.bytes;
  }
  if (!ended || !out.vertices) return malformed("header");
  if (auto counts = check_counts(out, text.size()); !counts) return tl::unexpected(counts.error());
  return out;
}

/// Binary STL: 80 bytes, the number of facets, and 50 bytes each: normal, three corners, two bytes more.
constexpr std::size_t kStlHeader = 84, kStlFacet = 50;
static_assert(std::endian::native == std::endian::little, "OpenMesh reads STL as little-endian machines lay it out");

std::size_t stl_facets(std::string_view text) {
  std::uint32_t count = 0;
  if (text.size() >= kStlHeader) std::memcpy(&count, text.data() + kStlHeader - sizeof count, sizeof count);
  return count;
}

Prepared prepare_binary_stl(std::string_view text) {
  SurfaceText out{std::string(text), ".stlb", stl_facets(text), std::nullopt};
  if (out.faces > kMaxMeshTriangles) return broken(Errc::limit_exceeded, "R-SRF-2", std::to_string(out.faces) + " faces");
  for (std::size_t f = 0; f < out.faces; ++f) {
    std::array<float, 12> values{};
    std::memcpy(values.data(), text.data() + kStlHeader + f * kStlFacet, sizeof values);
    if (!std::all_of(values.begin() + 3, values.end(), [](float v) { return std::isfinite(v); }))
      return malformed("facet " + std::to_string(f));
  }
  return out;
}

Prepared prepare_stl(std::string_view text) {
  if (text.size() == kStlHeader + stl_facets(text) * kStlFacet) return prepare_binary_stl(text);
  SurfaceText out{std::string(text), ".stla", 0, std::nullopt};
  if (!text.starts_with("solid")) return malformed("neither 'solid' nor the size of a binary file");
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::string_view line = take_line(text);
    std::string_view rest = line;
    const std::string_view word = take_word(rest);
    if (word == "facet") ++out.faces;
    if (word != "vertex") continue;
    for (int i = 0; i < 3; ++i)
      if (!is_finite_number(take_word(rest))) return malformed_line(number, line);
  }
  if (out.faces > kMaxMeshTriangles) return broken(Errc::limit_exceeded, "R-SRF-2", std::to_string(out.faces) + " faces");
  return out;
}

}  // namespace

tl::expected<SurfaceText, SurfaceError> prepare_surface(std::string_view text, std::string_view format) {
  if (format == ".obj") return prepare_obj(text);
  if (format == ".off") return prepare_off(text);
  if (format == ".ply") return prepare_ply(text);
  if (format == ".stl") return prepare_stl(text);
  return broken(Errc::unsupported, "R-SRF-3", format);
}

}  // namespace tactus
