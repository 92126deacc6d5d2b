// SPDX-License-Identifier: Apache-2.0
// STL: 3D Systems, "Stereolithography Interface Specification" (1988). The size distinguishes binary files from text, not the word solid.
#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstring>
#include <numeric>

#include <tactus/base/text.h>
#include <tactus/sim/surface/polygon_file.h>

namespace tactus::sim {
namespace {

using Read = tl::expected<void, Diagnostic>;

/// 80 bytes, the number of facets, and 50 bytes each: normal, three corners, two bytes more.
constexpr std::size_t kHeader = 84, kFacet = 50, kCorners = 12;
constexpr std::uint32_t kUnknown = 0xFFFFFFFF;  // as programs write it that do not know the number yet

std::uint32_t word_at(std::string_view bytes, std::size_t at) noexcept {
  std::uint32_t value = 0;
  for (std::size_t b = 4; b-- > 0;) value = value << 8 | static_cast<std::uint8_t>(bytes[at + b]);
  return value;
}

/// Corners with the same coordinates become one vertex, in the order of their first one.
void merge_corners(PolygonSoup& soup) {
  std::vector<std::uint32_t> order(soup.vertices.size()), number(soup.vertices.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto key = [&](std::uint32_t v) {  // NaN would have no order; 0 and -0 are one position
    const auto bits = [](double c) { return std::bit_cast<std::int64_t>(c == 0 ? 0.0 : c); };
    return std::array{bits(soup.vertices[v].x), bits(soup.vertices[v].y), bits(soup.vertices[v].z), std::int64_t{v}};
  };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && soup.vertices[order[i]] == soup.vertices[order[i - 1]];
    number[order[i]] = same ? number[order[i - 1]] : order[i];
  }
  std::uint32_t kept = 0;
  for (std::uint32_t v = 0; v < number.size(); ++v) {
    const bool first = number[v] == v;
    if (first) soup.vertices[kept] = soup.vertices[v];
    number[v] = first ? kept++ : number[number[v]];
  }
  soup.vertices.resize(kept);
  for (Polygon& polygon : soup.polygons)
    for (std::uint32_t& corner : polygon) corner = number[corner];
}

// ==== binary ====

/// How many facets to read, and what is odd about the number in the file.
tl::expected<std::size_t, Diagnostic> facets_of(std::string_view bytes, ReadNotes& notes) {
  const std::size_t announced = word_at(bytes, kHeader - 4), held = (bytes.size() - kHeader) / kFacet;
  const std::size_t behind = (bytes.size() - kHeader) % kFacet;
  const std::string figures = "announces " + std::to_string(announced) + " facets";
  if (announced == 0 || announced == kUnknown || (announced < held && behind == 0)) {
    if (behind != 0) return broken(Errc::malformed, "R-SRF-4", figures + ", and its size is not that of whole ones");
    notes.add("", figures + ", its size is that of " + std::to_string(held) + ": so many are read");
    return held;
  }
  if (announced > held) return broken(Errc::malformed, "R-SRF-5", figures + " and holds " + std::to_string(held));
  if (const std::size_t more = bytes.size() - kHeader - announced * kFacet; more > 0)
    notes.add("", std::to_string(more) + " bytes behind the last facet are left out");
  return announced;
}

SoupResult read_binary(std::string_view bytes) {
  PolygonSoup soup;
  TACTUS_TRY(const auto facets, facets_of(bytes, soup.notes));
  TACTUS_CHECK(check_counts(0, facets, bytes.size()));
  soup.vertices.reserve(3 * facets);
  for (std::size_t f = 0; f < facets; ++f) {
    Polygon& polygon = soup.polygons.emplace_back();
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::size_t at = kHeader + f * kFacet + kCorners + corner * kCorners;
      const auto value = [&](std::size_t i) { return double{std::bit_cast<float>(word_at(bytes, at + 4 * i))}; };
      const Vec3 v{value(0), value(1), value(2)};
      if (!is_finite(v)) return broken(Errc::malformed, "R-SRF-4", "facet " + std::to_string(f) + ": a corner is not finite");
      polygon.push_back(static_cast<std::uint32_t>(soup.vertices.size()));
      soup.vertices.push_back(v);
    }
  }
  merge_corners(soup);
  return soup;
}

// ==== text ====

bool is(std::string_view word, std::string_view wanted) noexcept {
  return std::equal(word.begin(), word.end(), wanted.begin(), wanted.end(),
                    [](unsigned char a, char b) { return static_cast<char>(std::tolower(a)) == b; });
}

/// Words in any case, on lines as they like: solid NAME, facet normal, outer loop, vertex x y z, endloop, endfacet, endsolid NAME.
class StlText {
 public:
  explicit StlText(std::string_view text) : lines_(text, LineReader::Comments::none) {}

  SoupResult read() {
    for (auto word = lines_.next_word(); !word.empty(); word = lines_.next_word()) TACTUS_CHECK(read_word(word));
    if (open_) {
      auto cut = broken(Errc::malformed, "R-SRF-4", "no 'endsolid' at its end");
      cut.value().remedy = "The file may be cut: copy it again, or add a line endsolid if nothing is missing.";
      return cut;
    }
    if (solids_ > 1) soup_.notes.add("", std::to_string(solids_) + " solids are read as one surface");
    merge_corners(soup_);
    return std::move(soup_);
  }

 private:
  Read read_word(std::string_view word) {
    if (is(word, "solid") || is(word, "endsolid")) {
      if (in_facet_) return broken_line(lines_, "within a facet");
      open_ = is(word, "solid");
      if (open_) ++solids_;
      while (lines_.has_word()) lines_.word();  // its name
      return {};
    }
    if (is(word, "facet")) return begin_facet();
    if (is(word, "vertex") && in_facet_) return add_corner();
    if (is(word, "endfacet")) {
      if (!in_facet_ || soup_.polygons.back().size() < 3) return broken_line(lines_, "a facet of fewer than three corners");
      in_facet_ = false;
      return {};
    }
    if (is(word, "endloop") || ((is(word, "outer") || is(word, "end")) && in_facet_) || is(word, "loop")) return {};
    return broken_line(lines_);
  }

  /// The normal's three words do not matter: they may be "nan".
  Read begin_facet() {
    if (in_facet_ || !open_) return broken_line(lines_, in_facet_ ? "within a facet" : "outside a solid");
    if (soup_.polygons.size() == kMaxMeshTriangles) return check_counts(0, kMaxMeshTriangles + 1, 0);
    in_facet_ = true;
    soup_.polygons.emplace_back();
    soup_.polygon_lines.push_back(static_cast<std::uint32_t>(lines_.line_number()));
    if (lines_.has_word() && !is(lines_.word(), "normal")) return broken_line(lines_);
    for (int i = 0; i < 3; ++i) lines_.word();
    return {};
  }

  Read add_corner() {
    const auto v = take_vertex(lines_);
    if (!v || !is_finite(*v)) return broken_line(lines_);
    soup_.polygons.back().push_back(static_cast<std::uint32_t>(soup_.vertices.size()));
    soup_.vertices.push_back(*v);
    return {};
  }

  LineReader lines_;
  PolygonSoup soup_;
  bool open_ = false, in_facet_ = false;
  std::size_t solids_ = 0;
};

/// Begins with solid, and the facets are words.
bool looks_like_text(std::string_view text) noexcept {
  LineReader lines(text.substr(0, 4096), LineReader::Comments::none);
  if (!is(lines.next_word(), "solid") || text.substr(0, 4096).find('\0') != std::string_view::npos) return false;
  while (lines.next_line()) {
    const std::string_view word = lines.word();
    return is(word, "facet") || is(word, "endsolid");
  }
  return text.size() < kHeader || text.find('\n') == std::string_view::npos;
}

}  // namespace

SoupResult read_stl(std::string_view bytes) {
  const bool has_header = bytes.size() >= kHeader;
  if (has_header && (bytes.size() - kHeader) % kFacet == 0 && word_at(bytes, kHeader - 4) == (bytes.size() - kHeader) / kFacet)
    return read_binary(bytes);
  const std::string text = decode_text(bytes);
  if (looks_like_text(text)) return StlText(text).read();
  if (has_header) return read_binary(bytes);
  return broken(Errc::malformed, "R-SRF-4", "neither 'solid' nor the size of a binary file");
}

}  // namespace tactus::sim
