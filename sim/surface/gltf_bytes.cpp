// SPDX-License-Identifier: Apache-2.0
// Bytes of a glTF: the chunks of a GLB, buffers in base64 and beside the scene, and the numbers of accessors.
#include <algorithm>
#include <bit>
#include <charconv>
#include <filesystem>
#include <fstream>

#include <tactus/sim/surface/gltf_file.h>
#include <tactus/sim/surface/polygon_file.h>

namespace tactus::sim {
namespace {

std::uint32_t word_at(std::string_view bytes, std::size_t at) noexcept {
  std::uint32_t value = 0;
  for (std::size_t b = 4; b-- > 0;) value = value << 8 | static_cast<std::uint8_t>(bytes[at + b]);
  return value;
}

std::optional<std::string> decode_percent(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      out += text[i];
      continue;
    }
    unsigned value = 0;
    const char *first = text.data() + std::min(i + 1, text.size()), *last = text.data() + std::min(i + 3, text.size());
    if (const auto [end, error] = std::from_chars(first, last, value, 16); error != std::errc() || end != first + 2)
      return std::nullopt;
    out += static_cast<char>(value);
    i += 2;
  }
  return out;
}

double component_at(const char* at, std::size_t component, bool normalized) noexcept {
  std::uint32_t bits = 0;
  for (std::size_t b = gltf_component_size(component); b-- > 0;) bits = bits << 8 | static_cast<std::uint8_t>(at[b]);
  const auto scaled = [&](double value, double most) { return normalized ? std::max(value / most, -1.0) : value; };
  switch (component) {
    case 5120:
      return scaled(static_cast<std::int8_t>(bits), 127);
    case 5121:
      return scaled(bits, 255);
    case 5122:
      return scaled(static_cast<std::int16_t>(bits), 32767);
    case 5123:
      return scaled(bits, 65535);
    case 5125:
      return scaled(bits, 4294967295.0);
    default:
      return std::bit_cast<float>(bits);
  }
}

/// Calls use(element, number within it, value) for `count` elements of a view.   err  false: they do not fit into it
template <class Use>
bool read_elements(const GltfView& view, std::size_t offset, std::size_t count, std::size_t width, std::size_t component,
                   bool normalized, Use use) {
  const std::size_t one = gltf_component_size(component), element = one * width,
                    stride = view.stride == 0 ? element : view.stride;
  const std::size_t bytes = view.bytes.size();
  if (count == 0) return true;
  if (stride < std::max<std::size_t>(element, 1) || offset > bytes || element > bytes - offset ||
      count - 1 > (bytes - offset - element) / stride)
    return false;
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < width; ++k)
      use(i, k, component_at(view.bytes.data() + offset + i * stride + k * one, component, normalized));
  return true;
}

}  // namespace

std::size_t gltf_component_size(std::size_t component) noexcept {
  switch (component) {
    case 5120:
    case 5121:
      return 1;
    case 5122:
    case 5123:
      return 2;
    case 5125:
    case 5126:
      return 4;
    default:
      return 0;
  }
}

// ==== container ====

// GLB: "glTF", version, length, then chunks of a length, a kind and bytes; or all of it is JSON.
tl::expected<GltfChunks, Diagnostic> split_chunks(std::string_view bytes, ReadNotes& notes) {
  constexpr std::size_t kHeader = 12, kChunk = 8;
  constexpr std::uint32_t kJson = 0x4E4F534A, kBinary = 0x004E4942;
  if (!bytes.starts_with("glTF")) {
    if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);
    return GltfChunks{bytes, {}};
  }
  if (bytes.size() < kHeader + kChunk) return broken(Errc::malformed, "R-SRF-5", "the header of a GLB");
  if (word_at(bytes, 4) != 2) {
    auto old = broken(Errc::unsupported, "R-SRF-3", "GLB of version " + std::to_string(word_at(bytes, 4)) + ", not 2");
    old.value().remedy = kOldGltf;
    return old;
  }
  const std::size_t length = word_at(bytes, 8);
  if (length > bytes.size())
    return broken(Errc::malformed, "R-SRF-5",
                  "it announces " + std::to_string(length) + " bytes and has " + std::to_string(bytes.size()));
  if (length < bytes.size())
    notes.add("", std::to_string(bytes.size() - length) + " bytes behind the announced length are left out");
  GltfChunks out;
  for (std::size_t at = kHeader; at + kChunk <= length;) {
    const std::size_t size = word_at(bytes, at), kind = word_at(bytes, at + 4);
    if (size > length - at - kChunk) return broken(Errc::malformed, "R-SRF-5", "a chunk is longer than the file");
    const std::string_view content = bytes.substr(at + kChunk, size);
    if (at == kHeader && kind != kJson) return broken(Errc::malformed, "R-SRF-4", "its first chunk is not JSON");
    if (at == kHeader) out.json = content;
    else if (kind == kBinary && out.binary.data() == nullptr) out.binary = content;
    at += kChunk + size;
  }
  return out;
}

// ==== buffers ====

std::optional<std::string> decode_base64(std::string_view text) {
  while (text.ends_with('=')) text.remove_suffix(1);
  std::string out;
  out.reserve(text.size() / 4 * 3 + 2);
  std::uint32_t bits = 0, held = 0;
  for (const char c : text) {
    const std::uint32_t value = c >= 'A' && c <= 'Z'   ? static_cast<std::uint32_t>(c - 'A')
                                : c >= 'a' && c <= 'z' ? static_cast<std::uint32_t>(c - 'a') + 26
                                : c >= '0' && c <= '9' ? static_cast<std::uint32_t>(c - '0') + 52
                                : c == '+'             ? 62
                                : c == '/'             ? 63
                                                       : 64;
    if (value == 64) return std::nullopt;
    bits = bits << 6 | value;
    held += 6;
    if (held < 8) continue;
    held -= 8;
    out += static_cast<char>(bits >> held & 0xFF);
  }
  return out;
}

tl::expected<std::string, Diagnostic> read_beside(const std::string& folder, std::string_view uri, std::size_t size) {
  namespace fs = std::filesystem;
  const std::string shown = "buffer '" + std::string(uri.substr(0, 60)) + '\'';
  const auto refused = [&](Errc code, RuleName rule, const std::string& why, std::string remedy) {
    auto error = broken(code, rule, shown + ": " + why);
    error.value().remedy = std::move(remedy);
    return error;
  };
  const auto name = decode_percent(uri);
  const bool is_plain =
      name && !name->empty() && name->find_first_of(std::string_view(":\\\0", 3)) == std::string::npos && !folder.empty();
  const fs::path path = is_plain ? fs::path(*name).lexically_normal() : fs::path();
  if (!is_plain || path.is_absolute() || *path.begin() == "..")
    return refused(Errc::unsupported, "R-SRF-3", "not a file in the folder of the scene",
                   "Put the file beside the scene and name it alone, or write the scene as .glb.");
  std::error_code error, ignored;
  const fs::path home = fs::canonical(folder, error), full = fs::canonical(fs::path(folder) / path, error);
  if (error || !fs::is_regular_file(full, ignored))
    return refused(Errc::io, "R-SRF-1", "no such file", "Copy it beside the scene: a .gltf without its files is not whole.");
  if (const fs::path inside = full.lexically_relative(home); inside.empty() || *inside.begin() == "..")
    return refused(Errc::unsupported, "R-SRF-3", "a link that leads out of the folder of the scene",
                   "Put the file itself there.");
  std::ifstream in(full, std::ios::binary | std::ios::ate);
  const auto there = in ? static_cast<std::size_t>(in.tellg()) : 0;
  std::string bytes(std::min(size, there), '\0');
  in.seekg(0);
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!in) return refused(Errc::io, "R-SRF-1", "it cannot be read", "");
  return bytes;
}

// ==== accessors ====

tl::expected<std::vector<double>, Diagnostic> read_accessor(const GltfFile& file, std::size_t accessor, std::size_t width,
                                                            std::size_t& budget) {
  const GltfAccessor& a = file.accessors[accessor];
  const std::string name = "accessors[" + std::to_string(accessor) + ']';
  if (width != 0 && a.width != width)
    return broken(Errc::malformed, "R-SRF-4",
                  name + ": elements of " + std::to_string(a.width) + " numbers, not " + std::to_string(width));
  if (a.count > budget / a.width)
    return broken(Errc::limit_exceeded, "R-SEQ-7", name + ": " + std::to_string(a.count) + " elements");
  const auto cut = [&] { return broken(Errc::malformed, "R-SRF-5", name + ": it ends behind its view"); };
  std::vector<double> out;
  if (!a.view) {
    out.assign(a.count * a.width, 0);
  } else {
    const bool fits = a.count <= file.views[*a.view].bytes.size();
    if (fits) out.reserve(a.count * a.width);
    if (!fits || !read_elements(file.views[*a.view], a.offset, a.count, a.width, a.component, a.normalized,
                                [&](std::size_t, std::size_t, double v) { out.push_back(v); }))
      return cut();
  }
  budget -= out.size();
  if (!a.sparse) return out;
  std::vector<std::size_t> indices;
  bool rises = true;
  const auto take_index = [&](std::size_t, std::size_t, double v) {
    const auto index = static_cast<std::size_t>(v);
    rises = rises && index < a.count && (indices.empty() || index > indices.back());
    indices.push_back(index);
  };
  const GltfAccessor::Sparse& s = *a.sparse;
  if (s.index_component != 5121 && s.index_component != 5123 && s.index_component != 5125)
    return broken(Errc::malformed, "R-SRF-4", name + ".sparse: indices of another type");
  if (!read_elements(file.views[s.index_view], s.index_offset, s.count, 1, s.index_component, false, take_index)) return cut();
  if (!rises) return broken(Errc::malformed, "R-SRF-4", name + ".sparse: its indices do not rise, or name no element");
  if (!read_elements(file.views[s.value_view], s.value_offset, s.count, a.width, a.component, a.normalized,
                     [&](std::size_t i, std::size_t k, double v) { out[indices[i] * a.width + k] = v; }))
    return cut();
  return out;
}

}  // namespace tactus::sim
