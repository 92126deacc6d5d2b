// SPDX-License-Identifier: Apache-2.0
// OBJ: Wavefront, "Object Files (.obj)", appendix B1 of the Advanced Visualizer manual. OFF: Geomview manual, "OFF Files".
#include <algorithm>
#include <array>
#include <cstdint>
#include <string>

#include <tactus/base/text.h>
#include <tactus/sim/surface/polygon_file.h>

namespace tactus::sim {
namespace {

using Read = tl::expected<void, Diagnostic>;

tl::unexpected<Diagnostic> broken_corner(const LineReader& lines, std::string_view word, std::size_t vertices) {
  return broken_line(lines, "no vertex " + std::string(word) + " among " + std::to_string(vertices), Errc::invalid, "R-SRF-9");
}

// ==== OBJ ====

class ObjReader {
 public:
  explicit ObjReader(std::string_view text) : lines_(text, LineReader::Comments::hash) { soup_.first_number = 1; }

  SoupResult read() {
    while (lines_.next_line()) {
      gather_words();
      const std::string_view kind = words_[0];
      if (kind == "v") TACTUS_CHECK(read_vertex());
      else if (kind == "f" || kind == "fo") TACTUS_CHECK(read_face());
      else note_kind(kind);
    }
    return std::move(soup_);
  }

 private:
  /// The words of a line and of those that continue it.
  void gather_words() {
    words_.clear();
    at_ = lines_.line_number();
    while (true) {
      for (auto word = lines_.word(); !word.empty(); word = lines_.word()) words_.push_back(word);
      if (words_.empty() || !words_.back().ends_with('\\')) break;
      words_.back().remove_suffix(1);
      if (words_.back().empty()) words_.pop_back();
      if (!lines_.any_line()) break;
    }
    if (words_.empty()) words_.emplace_back();
  }

  Read read_vertex() {
    if (soup_.vertices.size() == kMaxMeshVertices) return check_counts(kMaxMeshVertices + 1, soup_.polygons.size(), 0);
    if (words_.size() < 4) return broken_line(lines_);
    Vec3& v = soup_.vertices.emplace_back();
    std::size_t i = 1;
    for (double* c : {&v.x, &v.y, &v.z}) {
      const auto value = parse_coordinate(words_[i++]);
      if (!value) return broken_line(lines_);
      *c = *value;
    }
    soup_.vertex_lines.push_back(static_cast<std::uint32_t>(at_));
    if (words_.size() == 5 && parse_number<double>(words_[4]) != 1.0)
      soup_.notes.add("vertices", "their weight, the fourth number, is left out", location());
    return {};
  }

  /// "7", "7/1", "7//2" or "7/1/2", counted from 1, or back from the last vertex.
  Read read_face() {
    if (soup_.polygons.size() == kMaxMeshTriangles) return check_counts(soup_.vertices.size(), kMaxMeshTriangles + 1, 0);
    if (words_.size() < 4) return broken_line(lines_);
    Polygon& polygon = soup_.polygons.emplace_back();
    polygon.reserve(words_.size() - 1);
    for (std::size_t i = 1; i < words_.size(); ++i) {
      const std::string_view word = words_[i].substr(0, words_[i].find('/'));
      const auto number = parse_number<std::int64_t>(word);
      if (!number) return broken_line(lines_);
      const auto vertices = static_cast<std::int64_t>(soup_.vertices.size());
      const std::int64_t vertex = *number < 0 ? vertices + *number : *number - 1;
      if (vertex < 0 || vertex >= static_cast<std::int64_t>(kMaxMeshVertices))
        return broken_corner(lines_, word, soup_.vertices.size());
      polygon.push_back(static_cast<std::uint32_t>(vertex));
    }
    soup_.polygon_lines.push_back(static_cast<std::uint32_t>(at_));
    return {};
  }

  /// What is left out is reported unless it only says how things look and what they are called.
  void note_kind(std::string_view kind) {
    constexpr std::array<std::string_view, 14> kLooks{"vt",     "vn",     "vp",     "g",      "o",   "s",     "mg",
                                                      "usemtl", "mtllib", "usemap", "maplib", "lod", "bevel", "c_interp"};
    if (std::find(kLooks.begin(), kLooks.end(), kind) != kLooks.end()) return;
    soup_.notes.add('\'' + std::string(kind.substr(0, 20)) + '\'', "lines that begin with it are left out: only v and f are read",
                    location());
  }

  std::string location() const { return "line " + std::to_string(at_); }

  LineReader lines_;
  PolygonSoup soup_;
  std::vector<std::string_view> words_;
  std::size_t at_ = 0;  // number of the line's first part
};

// ==== OFF ====

/// "[ST][C][N][4][n]OFF", and what a vertex has beside its coordinates.
struct OffKind {
  bool texture = false, colour = false, normal = false, fourth = false, dimension = false;
};

bool take(std::string_view& word, std::string_view front) noexcept {
  const bool found = word.starts_with(front);
  if (found) word.remove_prefix(front.size());
  return found;
}

class OffReader {
 public:
  explicit OffReader(std::string_view text) : lines_(text, LineReader::Comments::hash) { soup_.first_number = 0; }

  SoupResult read() {
    TACTUS_CHECK(read_header());
    TACTUS_CHECK(check_counts(vertices_, faces_, lines_.bytes_left() + 1));
    const LineReader body = lines_;
    if (!lines_.has_word() && lines_left() >= vertices_ + faces_) {
      TACTUS_CHECK(read_vertex_lines());
      TACTUS_CHECK(read_face_lines());
      return std::move(soup_);
    }
    Read first = read_words(body, strides()[0]);
    for (std::size_t i = 1; !first && i < strides().size(); ++i)
      if (read_words(body, strides()[i])) return std::move(soup_);
    if (!first) return tl::unexpected(first.error());
    return std::move(soup_);
  }

 private:
  /// "OFF", "vertices faces edges", on one line or several; the number of edges may be missing and does not matter.
  Read read_header() {
    std::string_view word = lines_.next_word();
    if (word.empty()) return broken(Errc::malformed, "R-SRF-4", "the file is empty");
    TACTUS_CHECK(read_keyword(word));
    if (word.empty()) word = lines_.next_word();
    if (word == "BINARY") return broken(Errc::unsupported, "R-SRF-3", "binary");
    const auto vertices = parse_number<std::size_t>(word), faces = parse_number<std::size_t>(lines_.next_word());
    if (!vertices || !faces) return broken_line(lines_, "not the numbers of vertices and faces");
    vertices_ = *vertices;
    faces_ = *faces;
    LineReader ahead = lines_;
    const bool here = ahead.has_word(), next = !here && ahead.next_line();
    const bool edges = parse_number<std::size_t>(ahead.word()).has_value();
    if (edges && (here || !ahead.has_word()) && (here || next)) lines_ = ahead;
    return {};
  }

  /// Take the keyword away, which may touch the first number: "OFF8".
  Read read_keyword(std::string_view& word) {
    if (parse_number<std::size_t>(word)) {
      soup_.notes.add("", "does not begin with OFF; read as if it did");
      return {};
    }
    std::string_view rest = word;
    kind_.texture = take(rest, "ST");
    kind_.colour = take(rest, "C");
    kind_.normal = take(rest, "N");
    kind_.fourth = take(rest, "4");
    kind_.dimension = take(rest, "n");
    if (!take(rest, "OFF") && !take(rest, "off")) return broken_line(lines_, "no OFF at its beginning");
    if (!rest.empty() && !parse_number<std::size_t>(rest)) return broken_line(lines_, "no OFF at its beginning");
    if (kind_.fourth || kind_.dimension)
      return broken_line(lines_, "vertices of another number of dimensions than 3", Errc::unsupported, "R-SRF-3");
    word = rest;
    return {};
  }

  std::size_t lines_left() const {
    LineReader ahead = lines_;
    std::size_t count = 0;
    while (count < vertices_ + faces_ && ahead.next_line()) ++count;
    return count;
  }

  /// How many words a vertex may have where lines do not part them.
  std::vector<std::size_t> strides() const {
    const std::size_t least = 3U + (kind_.normal ? 3U : 0U) + (kind_.texture ? 2U : 0U);
    return kind_.colour ? std::vector<std::size_t>{least + 4, least + 3} : std::vector<std::size_t>{least};
  }

  tl::unexpected<Diagnostic> cut_short() const {
    return broken(Errc::malformed, "R-SRF-5", "the file is shorter than its header says");
  }

  /// One vertex per line; what follows its coordinates does not matter.
  Read read_vertex_lines() {
    soup_.vertices.reserve(vertices_);
    for (std::size_t i = 0; i < vertices_; ++i) {
      if (!lines_.next_line()) return cut_short();
      TACTUS_CHECK(add_vertex());
    }
    return {};
  }

  Read add_vertex() {
    const auto vertex = take_vertex(lines_);
    if (!vertex) return broken_line(lines_);
    soup_.vertices.push_back(*vertex);
    soup_.vertex_lines.push_back(static_cast<std::uint32_t>(lines_.line_number()));
    return {};
  }

  /// One face per line: how many corners, corners; its colour does not matter.
  Read read_face_lines() {
    for (std::size_t i = 0; i < faces_; ++i) {
      if (!lines_.next_line()) return cut_short();
      TACTUS_CHECK(add_face([&] { return lines_.word(); }));
    }
    if (lines_.next_line())
      soup_.notes.add("", "lines behind the last face are left out", "line " + std::to_string(lines_.line_number()));
    return {};
  }

  template <class NextWord>
  Read add_face(NextWord next_word) {
    const auto corners = parse_number<std::size_t>(next_word());
    if (!corners || *corners > lines_.bytes_left() + lines_.whole_line().size()) return broken_line(lines_);
    Polygon& polygon = soup_.polygons.emplace_back();
    for (std::size_t c = 0; c < *corners; ++c) {
      const std::string_view word = next_word();
      if (word.empty()) return broken_line(lines_, "a face of " + std::to_string(*corners) + " corners");
      TACTUS_TRY(const auto corner, parse_corner(word, lines_));
      polygon.push_back(corner);
    }
    soup_.polygon_lines.push_back(static_cast<std::uint32_t>(lines_.line_number()));
    return {};
  }

  /// Several elements on a line: vertices of as many words each, then faces without colours, up to the end; or faces line by line.
  Read read_words(const LineReader& body, std::size_t stride) {
    lines_ = body;
    soup_.vertices.clear();
    soup_.polygons.clear();
    soup_.vertex_lines.clear();
    soup_.polygon_lines.clear();
    for (std::size_t i = 0; i < vertices_; ++i) {
      if (!lines_.has_word() && !lines_.next_line()) return cut_short();
      TACTUS_CHECK(add_vertex());
      for (std::size_t word = 3; word < stride; ++word)
        if (!parse_coordinate(lines_.word())) return broken_line(lines_, "a vertex of " + std::to_string(stride) + " numbers");
    }
    LineReader ahead = lines_;
    std::size_t count = 0;
    while (count <= faces_ && ahead.next_line()) ++count;
    if (!lines_.has_word() && count >= faces_) return read_face_lines();
    for (std::size_t i = 0; i < faces_; ++i) TACTUS_CHECK(add_face([&] { return lines_.next_word(); }));
    if (!lines_.next_word().empty()) return broken_line(lines_, "words are left over behind the last face");
    return {};
  }

  LineReader lines_;
  PolygonSoup soup_;
  OffKind kind_;
  std::size_t vertices_ = 0, faces_ = 0;
};

template <class Reader>
SoupResult read_text(std::string_view bytes) {
  const std::string text = decode_text(bytes);
  auto soup = Reader(text).read();
  if (soup) note_open_end(text, *soup);
  return soup;
}

}  // namespace

SoupResult read_obj(std::string_view bytes) { return read_text<ObjReader>(bytes); }
SoupResult read_off(std::string_view bytes) { return read_text<OffReader>(bytes); }

}  // namespace tactus::sim
