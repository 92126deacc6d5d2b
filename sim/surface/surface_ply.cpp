// SPDX-License-Identifier: Apache-2.0
// PLY: Turk, "The PLY Polygon File Format" (1994). Elements come in any order with any properties; vertices' x, y, z and the corners of faces
// (or of triangle strips) matter, all else is passed over by its size. Both byte orders, and text with one element per line.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include <tactus/base/text.h>
#include <tactus/sim/surface/polygon_file.h>

namespace tactus::sim {
namespace {

using Read = tl::expected<void, Diagnostic>;

constexpr std::size_t kMostColumns = 1024;  // of all elements: a header is not a list of work

struct PlyType {
  std::string_view name, other;
  std::size_t bytes;
  bool real, is_signed;
};
constexpr std::array kPlyTypes{PlyType{"char", "int8", 1, false, true},    PlyType{"uchar", "uint8", 1, false, false},
                               PlyType{"short", "int16", 2, false, true},  PlyType{"ushort", "uint16", 2, false, false},
                               PlyType{"int", "int32", 4, false, true},    PlyType{"uint", "uint32", 4, false, false},
                               PlyType{"float", "float32", 4, true, true}, PlyType{"double", "float64", 8, true, true}};

const PlyType* ply_type(std::string_view word) noexcept {
  const auto* found =
      std::find_if(kPlyTypes.begin(), kPlyTypes.end(), [&](const PlyType& t) { return word == t.name || word == t.other; });
  return found == kPlyTypes.end() ? nullptr : found;
}

enum class Role { none, x, y, z, corners };

/// A number, or a list of them with its length in front.
struct PlyColumn {
  const PlyType* type;
  const PlyType* length;  ///< null: no list
  Role role;
};

struct PlyElement {
  std::string name;
  std::size_t count = 0;
  std::vector<PlyColumn> columns;
  bool has(Role role) const noexcept {
    return std::any_of(columns.begin(), columns.end(), [&](const PlyColumn& c) { return c.role == role; });
  }
};

// ==== header ====

struct PlyHeader {
  bool has_format = false, binary = false, big = false, ended = false;
  std::vector<PlyElement> elements;
  std::size_t columns = 0;
  ReadNotes notes;

  const PlyElement* find(std::string_view name) const noexcept {
    const auto found = std::find_if(elements.begin(), elements.end(), [&](const PlyElement& e) { return e.name == name; });
    return found == elements.end() ? nullptr : &*found;
  }
};

Role role_of(const PlyElement& element, std::string_view name, bool is_list) noexcept {
  if (element.name == "vertex" && !is_list && name.size() == 1 && name[0] >= 'x' && name[0] <= 'z')
    return name == "x" ? Role::x : name == "y" ? Role::y : Role::z;
  const bool faces = element.name == "face" || element.name == "tristrips";
  return faces && is_list && (name == "vertex_indices" || name == "vertex_index") ? Role::corners : Role::none;
}

Read read_format(LineReader& lines, PlyHeader& header) {
  const std::string_view format = lines.word();
  header.binary = format != "ascii";
  header.big = format == "binary_big_endian";
  const bool known = format == "ascii" || format == "binary_little_endian" || header.big;
  if (!known || lines.word() != "1.0" || header.has_format) return broken_line(lines);
  header.has_format = true;
  return {};
}

Read read_element(LineReader& lines, PlyHeader& header) {
  const std::string name(lines.word());
  const auto count = parse_number<std::size_t>(lines.word());
  if (!count) return broken_line(lines);
  if (header.find(name) != nullptr) return broken_line(lines, "the element is there twice");
  header.elements.push_back({name, *count, {}});
  return {};
}

Read read_property(LineReader& lines, PlyHeader& header) {
  if (header.elements.empty() || ++header.columns > kMostColumns) return broken_line(lines);
  PlyElement& element = header.elements.back();
  std::string_view word = lines.word();
  const bool is_list = word == "list";
  const PlyType* length = is_list ? ply_type(lines.word()) : nullptr;
  const PlyType* type = ply_type(is_list ? lines.word() : word);
  const std::string_view name = lines.word();
  if (type == nullptr || name.empty() || (is_list && (length == nullptr || length->real))) return broken_line(lines);
  const Role role = role_of(element, name, is_list);
  if (role == Role::corners && type->real) return broken_line(lines, "corners are whole numbers", Errc::unsupported, "R-SRF-3");
  if (role != Role::none && element.has(role)) return broken_line(lines, "the property is there twice");
  element.columns.push_back({type, length, role});
  return {};
}

Read read_header_line(LineReader& lines, PlyHeader& header) {
  const std::string_view word = lines.word();
  if (word.empty() || word == "comment" || word == "obj_info") return {};
  if (word == "format") return read_format(lines, header);
  if (word == "element") return read_element(lines, header);
  if (word == "property") return read_property(lines, header);
  header.ended = word == "end_header";
  if (header.ended) return {};
  if (!header.has_format || !header.elements.empty()) return broken_line(lines);
  header.notes.add("", "a line of the header that is not one of PLY is left out",  // as Blender 2.4 wrote its name
                   "line " + std::to_string(lines.line_number()));
  return {};
}

Read check_header(const PlyHeader& header, std::size_t bytes) {
  if (!header.ended || !header.has_format)
    return broken(Errc::malformed, "R-SRF-4", header.ended ? "no line 'format'" : "no end_header");
  const PlyElement *vertices = header.find("vertex"), *faces = header.find("face"), *strips = header.find("tristrips");
  if (vertices == nullptr || !vertices->has(Role::x) || !vertices->has(Role::y) || !vertices->has(Role::z))
    return broken(Errc::unsupported, "R-SRF-3", "no element vertex with x, y and z");
  for (const PlyElement* e : {faces, strips})
    if (e != nullptr && e->count > 0 && !e->has(Role::corners))
      return broken(Errc::unsupported, "R-SRF-3", "element " + e->name + ": no list vertex_indices");
  return check_counts(vertices->count, faces == nullptr ? 0 : faces->count, bytes);
}

// ==== body ====

/// One element after another, as text or as bytes.
class PlyBody {
 public:
  PlyBody(std::string_view body, LineReader lines, const PlyHeader& header) : bytes_(body), lines_(lines), header_(header) {}

  SoupResult read() {
    soup_.first_number = 0;
    soup_.notes = header_.notes;
    for (const PlyElement& element : header_.elements) {
      if (element.columns.empty()) continue;
      for (std::size_t i = 0; i < element.count; ++i) TACTUS_CHECK(read_item(element, i));
    }
    return std::move(soup_);
  }

 private:
  Read read_item(const PlyElement& element, std::size_t index) {
    if (!header_.binary && !lines_.next_line()) return short_of(element, index);
    Vec3 vertex;
    Polygon corners;
    for (const PlyColumn& column : element.columns) {
      std::size_t items = 1;
      if (column.length != nullptr) {
        TACTUS_TRY(const auto length, integer(*column.length, element, index));
        if (length < 0) return failed(element, index, "a list of a negative length");
        items = static_cast<std::size_t>(length);
      }
      if (column.role == Role::none) TACTUS_CHECK(skip(*column.type, items, element, index));
      else if (column.role == Role::corners) TACTUS_CHECK(take_corners(*column.type, items, element, index, corners));
      else TACTUS_CHECK(take_coordinate(column, element, index, vertex));
    }
    if (!header_.binary && lines_.has_word()) return failed(element, index, "more words than properties");
    return keep(element, index, vertex, std::move(corners));
  }

  Read keep(const PlyElement& element, std::size_t index, const Vec3& vertex, Polygon&& corners) {
    const auto line = static_cast<std::uint32_t>(lines_.line_number());
    if (element.name == "vertex") {
      soup_.vertices.push_back(vertex);
      if (!header_.binary) soup_.vertex_lines.push_back(line);
    } else if (element.name == "face") {
      soup_.polygons.push_back(std::move(corners));
      if (!header_.binary) soup_.polygon_lines.push_back(line);
    } else if (element.name == "tristrips") {
      return keep_strips(corners, element, index, line);
    }
    return {};
  }

  /// Every three corners in a row are a triangle, every other one turned round; kNoVertex (-1 in the file) begins a new strip.
  Read keep_strips(const Polygon& strip, const PlyElement& element, std::size_t index, std::uint32_t line) {
    std::size_t first = 0;
    for (std::size_t i = 0; i < strip.size(); ++i) {
      if (strip[i] == kNoVertex) first = i + 1;
      if (i < first + 2) continue;
      Polygon triangle{strip[i - 2], strip[i - 1], strip[i]};
      if ((i - first) % 2 == 1) std::swap(triangle[0], triangle[1]);
      if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0]) continue;  // a strip's stitch
      if (soup_.polygons.size() == kMaxMeshTriangles) return failed(element, index, "more than 2^21 triangles");
      soup_.polygons.push_back(std::move(triangle));
      if (!header_.binary) soup_.polygon_lines.push_back(line);
    }
    return {};
  }

  Read take_corners(const PlyType& type, std::size_t items, const PlyElement& element, std::size_t index, Polygon& corners) {
    if (items > left()) return short_of(element, index);
    corners.reserve(items);
    for (; items > 0; --items) {
      TACTUS_TRY(const auto corner, integer(type, element, index));
      const bool stitch = corner == -1 && element.name == "tristrips";
      if (!stitch && (corner < 0 || corner >= std::int64_t{kNoVertex}))
        return failed(element, index, "no vertex " + std::to_string(corner), "R-SRF-9");
      corners.push_back(stitch ? kNoVertex : static_cast<std::uint32_t>(corner));
    }
    return {};
  }

  Read take_coordinate(const PlyColumn& column, const PlyElement& element, std::size_t index, Vec3& vertex) {
    double value = 0;
    if (column.type->real && header_.binary) {
      TACTUS_TRY(const auto bits, raw(*column.type, element, index));
      value = column.type->bytes == 4 ? std::bit_cast<float>(static_cast<std::uint32_t>(bits)) : std::bit_cast<double>(bits);
    } else if (column.type->real) {
      const auto parsed = parse_coordinate(lines_.word());
      if (!parsed) return failed(element, index, "not a number");
      value = *parsed;
    } else {
      TACTUS_TRY(const auto whole, integer(*column.type, element, index));
      value = static_cast<double>(whole);
    }
    (column.role == Role::x ? vertex.x : column.role == Role::y ? vertex.y : vertex.z) = value;
    return {};
  }

  Read skip(const PlyType& type, std::size_t items, const PlyElement& element, std::size_t index) {
    if (header_.binary) {
      if (items > bytes_.size() / type.bytes) return short_of(element, index);
      bytes_.remove_prefix(items * type.bytes);
      return {};
    }
    for (; items > 0; --items)
      if (lines_.word().empty()) return failed(element, index, "fewer words than properties");
    return {};
  }

  tl::expected<std::int64_t, Diagnostic> integer(const PlyType& type, const PlyElement& element, std::size_t index) {
    if (!header_.binary) {
      const auto value = parse_number<std::int64_t>(lines_.word());
      if (!value) return failed(element, index, "not a whole number");
      return *value;
    }
    TACTUS_TRY(const auto bits, raw(type, element, index));
    if (!type.is_signed) return static_cast<std::int64_t>(bits);
    const unsigned shift = 64 - 8 * static_cast<unsigned>(type.bytes);
    return static_cast<std::int64_t>(bits << shift) >> shift;
  }

  tl::expected<std::uint64_t, Diagnostic> raw(const PlyType& type, const PlyElement& element, std::size_t index) {
    if (bytes_.size() < type.bytes) return short_of(element, index);
    std::uint64_t bits = 0;
    for (std::size_t b = 0; b < type.bytes; ++b) {
      const std::size_t at = header_.big ? b : type.bytes - 1 - b;
      bits = bits << 8 | static_cast<std::uint8_t>(bytes_[at]);
    }
    bytes_.remove_prefix(type.bytes);
    return bits;
  }

  std::size_t left() const noexcept { return header_.binary ? bytes_.size() : lines_.bytes_left(); }

  tl::unexpected<Diagnostic> short_of(const PlyElement& element, std::size_t index) const {
    return broken(Errc::malformed, "R-SRF-5",
                  "it ends at " + element.name + ' ' + std::to_string(index) + " of " + std::to_string(element.count));
  }

  tl::unexpected<Diagnostic> failed(const PlyElement& element, std::size_t index, const std::string& why,
                                    RuleName rule = "R-SRF-4") const {
    const Errc code = rule == RuleName("R-SRF-4") ? Errc::malformed : Errc::invalid;
    if (!header_.binary) return broken_line(lines_, why, code, rule);
    return broken(code, rule, element.name + ' ' + std::to_string(index) + ": " + why);
  }

  static constexpr std::uint32_t kNoVertex = 0xFFFFFFFF;
  std::string_view bytes_;
  LineReader lines_;
  const PlyHeader& header_;
  PolygonSoup soup_;
};

/// The header's bytes, up to its last line's end; lines end as the first one does.
std::size_t header_size(std::string_view bytes) noexcept {
  const std::size_t first = bytes.find_first_of("\r\n");
  if (first == std::string_view::npos) return bytes.size();
  const bool both = bytes.substr(first).starts_with("\r\n");
  const std::string_view end = both ? "\r\n" : bytes.substr(first, 1);
  for (std::size_t at = first; at != std::string_view::npos; at = bytes.find(end, at + end.size())) {
    std::string_view line = bytes.substr(at + end.size(), bytes.find(end, at + end.size()) - at - end.size());
    while (line.ends_with(' ') || line.ends_with('\t') || line.ends_with('\r')) line.remove_suffix(1);
    if (line == "end_header") return std::min(bytes.find(end, at + end.size()), bytes.size() - end.size()) + end.size();
  }
  return bytes.size();
}

SoupResult read_lines(LineReader lines, std::string_view body) {
  if (!lines.next_line() || lines.word() != "ply") return broken(Errc::malformed, "R-SRF-4", "no 'ply' in the first line");
  PlyHeader header;
  while (!header.ended && lines.any_line()) TACTUS_CHECK(read_header_line(lines, header));
  TACTUS_CHECK(check_header(header, header.binary ? body.size() : lines.bytes_left()));
  return PlyBody(body, lines, header).read();
}

}  // namespace

SoupResult read_ply(std::string_view bytes) {
  if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);
  const std::size_t size = bytes.starts_with("ply") ? header_size(bytes) : bytes.size();
  if (bytes.substr(0, size).find("format binary") != std::string_view::npos) {
    const std::string header = decode_text(bytes.substr(0, size));
    return read_lines(LineReader(header, LineReader::Comments::none), bytes.substr(size));
  }
  const std::string text = decode_text(bytes);
  auto soup = read_lines(LineReader(text, LineReader::Comments::none), {});
  if (soup) note_open_end(text, *soup);
  return soup;
}

}  // namespace tactus::sim
