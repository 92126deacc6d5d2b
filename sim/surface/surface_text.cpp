// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/surface/surface_text.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include <tactus/base/rule.h>

namespace tactus::sim {
namespace {

using Prepared = tl::expected<SurfaceText, Diagnostic>;

tl::unexpected<Diagnostic> broken(Errc code, RuleName rule, std::string_view detail) {
  constexpr std::size_t kLongest = 60;
  return tl::unexpected(Diagnostic{.error = fail(code, rule).value(), .detail = std::string(detail.substr(0, kLongest))});
}
tl::unexpected<Diagnostic> malformed(std::string_view detail) { return broken(Errc::malformed, "R-SRF-4", detail); }
tl::unexpected<Diagnostic> malformed_line(std::size_t number, std::string_view line) {
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

/// A number that single precision holds.
bool is_real(std::string_view word) {
  double value = 0;
  if (word.starts_with('+')) word.remove_prefix(1);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  constexpr double kMost = std::numeric_limits<float>::max();
  return !word.empty() && error == std::errc() && end == word.data() + word.size() && std::abs(value) <= kMost;  // false for NaN
}

/// A number that an int holds.
bool is_integer(std::string_view word) {
  int value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return !word.empty() && error == std::errc() && end == word.data() + word.size();
}

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  for (auto word = take_word(line); !word.empty(); word = take_word(line)) words.push_back(word);
  return words;
}

/// What a header announces must fit the limits and the bytes behind it.
tl::expected<void, Diagnostic> check_counts(const SurfaceText& announced, std::size_t bytes) {
  if (*announced.vertices > kMaxMeshVertices || announced.faces > kMaxMeshTriangles)
    return broken(Errc::limit_exceeded, "R-SRF-2",
                  std::to_string(*announced.vertices) + " vertices, " + std::to_string(announced.faces) + " faces");
  if (*announced.vertices + announced.faces > bytes) return malformed("the file is shorter than its header says");
  return {};
}

/// Keep only vertices and faces, without the faces' numbers of textures and normals.
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
      if (kind == "f" ? !is_integer(word) : !is_real(word)) return malformed_line(number, line);
      (out.text += ' ') += word;
    }
    if (words < 3) return malformed_line(number, line);
    out.text += '\n';
    ++(kind == "v" ? *out.vertices : out.faces);
  }
  TACTUS_CHECK(check_counts(out, out.text.size()));
  return out;
}

/// Append the first three words of a line of OFF.   out  false: they are not coordinates
bool append_vertex(const std::vector<std::string_view>& words, std::string& out) {
  if (words.size() < 3 || !std::all_of(words.begin(), words.begin() + 3, is_real)) return false;
  for (std::size_t i = 0; i < 3; ++i) (out += words[i]) += i < 2 ? ' ' : '\n';
  return true;
}

/// Append the number of corners and the corners.   out  false: they are missing
bool append_face(const std::vector<std::string_view>& words, std::string& out) {
  const std::size_t corners = whole_number(words[0]).value_or(words.size());
  if (corners >= words.size()) return false;
  for (std::size_t i = 0; i <= corners; ++i) {
    if (!is_integer(words[i])) return false;
    (out += words[i]) += i < corners ? ' ' : '\n';
  }
  return true;
}

/// Keep only coordinates and corners, one element per line. The header is "OFF" and "vertices faces edges", on one line or two.
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
      TACTUS_CHECK(check_counts(out, text.size()));
      out.text = "OFF\n" + std::to_string(*vertices) + ' ' + std::to_string(*faces) + " 0\n";
      continue;
    }
    const std::vector<std::string_view> words = words_of(line);
    if (words.empty() || done == *out.vertices + out.faces) continue;
    if (done++ < *out.vertices ? !append_vertex(words, out.text) : !append_face(words, out.text))
      return malformed_line(number, line);
  }
  if (header.size() < 4) return malformed("header");
  if (done < *out.vertices + out.faces) return malformed("the file is shorter than its header says");
  return out;
}

struct PlyType {
  std::string_view name, other;
  std::size_t bytes;
};
constexpr std::array kPlyTypes{PlyType{"char", "int8", 1},     PlyType{"uchar", "uint8", 1},   PlyType{"short", "int16", 2},
                               PlyType{"ushort", "uint16", 2}, PlyType{"int", "int32", 4},     PlyType{"uint", "uint32", 4},
                               PlyType{"float", "float32", 4}, PlyType{"double", "float64", 8}};

const PlyType* ply_type(std::string_view word) {
  const auto* found =
      std::find_if(kPlyTypes.begin(), kPlyTypes.end(), [&](const PlyType& t) { return word == t.name || word == t.other; });
  return found == kPlyTypes.end() ? nullptr : found;
}

/// A property: a number, or the list of a face's corners, counted by one byte.
struct PlyColumn {
  const PlyType* type;
  bool is_list;
};

/// Header of a PLY file: vertices, then faces; what follows them is not read.
struct PlyHeader {
  bool binary = false, ended = false;
  std::size_t elements = 0;  ///< in the header
  std::array<std::size_t, 2> counts{};
  std::array<std::vector<PlyColumn>, 2> columns;
  std::string text = "ply\n";  ///< the header again without comments, in words that OpenMesh knows
};

tl::expected<void, Diagnostic> read_ply_property(std::string_view rest, PlyHeader& header) {
  const std::string_view line = rest, word = take_word(rest);
  if (header.elements == 0) return malformed(line);
  if (header.elements > 2) return {};
  const bool is_list = word == "list";
  const PlyType* count = ply_type(is_list ? take_word(rest) : "uchar");
  const PlyType* type = ply_type(is_list ? take_word(rest) : word);
  const std::string_view name = take_word(rest);
  if (count == nullptr || type == nullptr) return malformed(line);
  const bool corners = header.elements == 2 && (name == "vertex_indices" || name == "vertex_index");
  if (is_list != corners || count->name != "uchar") return broken(Errc::unsupported, "R-SRF-3", line);
  const bool coordinate = header.elements == 1 && (name == "x" || name == "y" || name == "z");
  if (coordinate && type->name != "float" && type->name != "double") return broken(Errc::unsupported, "R-SRF-3", line);
  std::vector<PlyColumn>& columns = header.columns[header.elements - 1];
  columns.push_back({type, is_list});
  header.text += is_list ? "property list uchar " : "property ";
  header.text.append(type->name) += ' ';
  if (coordinate) header.text.append(name) += '\n';
  else if (is_list) header.text += "vertex_indices\n";
  else
    header.text +=
        "unused_" + std::to_string(columns.size()) + '\n';  // OpenMesh complains of colours and normals it cannot convert
  return {};
}

tl::expected<void, Diagnostic> read_ply_line(std::string_view line, PlyHeader& header) {
  std::string_view rest = line;
  const std::string_view word = take_word(rest);
  if (word == "comment" || word == "obj_info") return {};
  if (word == "property") return read_ply_property(rest, header);
  if (word == "format") {
    const std::string_view format = take_word(rest);
    header.binary = format != "ascii";
    const bool known = format == "ascii" || format == "binary_little_endian" || format == "binary_big_endian";
    if (!known || take_word(rest) != "1.0" || header.text.size() > 4) return malformed(line);
    header.text.append("format ").append(format) += " 1.0\n";
    return {};
  }
  if (word == "element") {
    constexpr std::array<std::string_view, 2> kNames{"vertex", "face"};
    if (header.elements++ >= kNames.size()) return {};
    const std::string_view name = take_word(rest);
    const auto count = whole_number(take_word(rest));
    if (name != kNames[header.elements - 1]) return broken(Errc::unsupported, "R-SRF-3", "element " + std::string(name));
    if (!count) return malformed(line);
    header.counts[header.elements - 1] = *count;
    header.text.append("element ").append(name) += ' ' + std::to_string(*count) + '\n';
    return {};
  }
  header.ended = word == "end_header";
  header.text += "end_header\n";
  return header.ended ? tl::expected<void, Diagnostic>() : malformed(line);
}

/// True if the words of a line match the columns.
bool fits(const std::vector<std::string_view>& words, const std::vector<PlyColumn>& columns) {
  std::size_t at = 0;
  for (const PlyColumn& column : columns) {
    std::size_t items = 1;
    if (column.is_list) {
      if (at == words.size() || whole_number(words[at]).value_or(words.size()) >= words.size() - at) return false;
      items = *whole_number(words[at++]);
    }
    const bool real = column.type->name == "float" || column.type->name == "double";
    for (; items > 0; --items, ++at)
      if (at == words.size() || !(real ? is_real(words[at]) : is_integer(words[at]))) return false;
  }
  return at == words.size();
}

tl::expected<void, Diagnostic> copy_text_body(std::string_view body, const PlyHeader& header, std::size_t number,
                                              SurfaceText& out) {
  std::size_t done = 0;
  for (; done < *out.vertices + out.faces && !body.empty(); ++number) {
    const std::string_view line = take_line(body);
    const std::vector<std::string_view> words = words_of(line);
    if (words.empty()) continue;
    if (!fits(words, header.columns[done++ < *out.vertices ? 0 : 1])) return malformed_line(number, line);
    (out.text += line) += '\n';
  }
  if (done < *out.vertices + out.faces) return malformed("the file is shorter than its header says");
  return {};
}

tl::expected<void, Diagnostic> copy_binary_body(std::string_view body, const PlyHeader& header, SurfaceText& out) {
  std::size_t at = 0;
  for (std::size_t e = 0; e < 2; ++e) {
    for (std::size_t i = 0; i < header.counts[e]; ++i) {
      for (const PlyColumn& column : header.columns[e]) {
        const bool counted = column.is_list && at < body.size();
        at += counted ? 1 + static_cast<std::uint8_t>(body[at]) * column.type->bytes : column.type->bytes;
      }
      if (at > body.size()) return malformed("the file is shorter than its header says");
    }
  }
  out.text += body.substr(0, at);
  return {};
}

Prepared prepare_ply(std::string_view text) {
  if (take_line(text) != "ply") return malformed("no 'ply' in the first line");
  PlyHeader header;
  std::size_t number = 2;
  for (; !text.empty() && !header.ended; ++number) TACTUS_CHECK(read_ply_line(take_line(text), header));
  if (!header.ended || header.elements < 2) return malformed("header");
  SurfaceText out{header.text, ".ply", header.counts[1], header.counts[0]};
  TACTUS_CHECK(check_counts(out, text.size()));
  TACTUS_CHECK(header.binary ? copy_binary_body(text, header, out) : copy_text_body(text, header, number, out));
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
      if (!is_real(take_word(rest))) return malformed_line(number, line);
  }
  if (out.faces > kMaxMeshTriangles) return broken(Errc::limit_exceeded, "R-SRF-2", std::to_string(out.faces) + " faces");
  return out;
}

}  // namespace

tl::expected<SurfaceText, Diagnostic> prepare_surface(std::string_view text, std::string_view format) {
  if (format == ".obj") return prepare_obj(text);
  if (format == ".off") return prepare_off(text);
  if (format == ".ply") return prepare_ply(text);
  if (format == ".stl") return prepare_stl(text);
  return broken(Errc::unsupported, "R-SRF-3", format);
}

}  // namespace tactus::sim
