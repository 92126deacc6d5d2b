// SPDX-License-Identifier: Apache-2.0
/// Compressors of bytes: zstd, brotli, lzma. How numbers become bytes decides as much as the compressor, so two layouts compete.
#ifdef TACTUS_PEER_BROTLI
#include <brotli/decode.h>
#include <brotli/encode.h>
#endif
#ifdef TACTUS_PEER_LZMA
#include <lzma.h>
#endif
#ifdef TACTUS_PEER_ZSTD
#include <zstd.h>
#endif

#include <bit>

#include "tests/bench/peers/coder.h"

namespace tactus::peers {
namespace {

constexpr std::uint32_t zigzag(std::int32_t v) {
  return static_cast<std::uint32_t>(v) << 1 ^ static_cast<std::uint32_t>(v >> 31);
}
constexpr std::int32_t unzigzag(std::uint32_t v) { return static_cast<std::int32_t>(v >> 1 ^ (~(v & 1) + 1)); }

/// Zigzag numbers, all lowest bytes first, axis by axis, then the next bytes; no more than the largest number needs.
struct Planes {
  static constexpr const char* kName = "byte planes";

  static Bytes pack(std::span<const Vec3i> values) {
    std::uint32_t all = 1;
    for (const Vec3i& v : values)
      for (const std::int32_t c : v) all |= zigzag(c);
    const auto planes = static_cast<std::size_t>(std::bit_width(all) + 7) / 8;
    Bytes out;
    for (std::size_t byte = 0; byte < planes; ++byte)
      for (std::size_t axis = 0; axis < 3; ++axis)
        for (const Vec3i& v : values) out.push_back(static_cast<std::uint8_t>(zigzag(v[axis]) >> (8 * byte)));
    return out;
  }
  static bool unpack(const Bytes& in, std::span<Vec3i> values) {
    const std::size_t n = values.size(), planes = in.size() / (3 * n);
    if (planes == 0 || planes > 4 || in.size() != planes * 3 * n) return false;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t v = 0; v < n; ++v) {
        std::uint32_t z = 0;
        for (std::size_t byte = 0; byte < planes; ++byte)
          z |= static_cast<std::uint32_t>(in[(byte * 3 + axis) * n + v]) << (8 * byte);
        values[v][axis] = unzigzag(z);
      }
    }
    return true;
  }
};

/// Zigzag numbers in 7 bits a byte, vertex by vertex.
struct Varints {
  static constexpr const char* kName = "varints";

  static Bytes pack(std::span<const Vec3i> values) {
    Bytes out;
    for (const Vec3i& v : values) {
      for (const std::int32_t c : v) {
        std::uint32_t z = zigzag(c);
        for (; z >= 128; z >>= 7) out.push_back(static_cast<std::uint8_t>(z | 128));
        out.push_back(static_cast<std::uint8_t>(z));
      }
    }
    return out;
  }
  static bool unpack(const Bytes& in, std::span<Vec3i> values) {
    std::size_t at = 0;
    for (Vec3i& v : values) {
      for (std::int32_t& c : v) {
        std::uint32_t z = 0;
        for (unsigned shift = 0;; shift += 7) {
          if (at == in.size() || shift > 28) return false;
          z |= static_cast<std::uint32_t>(in[at] & 127) << shift;
          if (in[at++] < 128) break;
        }
        c = unzigzag(z);
      }
    }
    return at == in.size();
  }
};

template <class Compressor, class Layout>
class GeneralCoder final : public VertexCoder {
 public:
  Bytes encode(std::span<const Vec3i> values) override { return Compressor::compress(Layout::pack(values)); }
  bool decode(std::span<const std::uint8_t> packet, std::span<Vec3i> values) override {
    return Layout::unpack(Compressor::expand(packet, 16 * values.size() + 64), values);
  }
};

#ifdef TACTUS_PEER_ZSTD
template <int Level>
struct Zstd {
  static Bytes compress(const Bytes& in) {
    Bytes out(ZSTD_compressBound(in.size()));
    const std::size_t size = ZSTD_compress(out.data(), out.size(), in.data(), in.size(), Level);
    out.resize(ZSTD_isError(size) ? 0 : size);
    return out;
  }
  static Bytes expand(std::span<const std::uint8_t> in, std::size_t limit) {
    Bytes out(limit);
    const std::size_t size = ZSTD_decompress(out.data(), out.size(), in.data(), in.size());
    out.resize(ZSTD_isError(size) ? 0 : size);
    return out;
  }
};
#endif

#ifdef TACTUS_PEER_BROTLI
struct Brotli {
  static Bytes compress(const Bytes& in) {
    Bytes out(BrotliEncoderMaxCompressedSize(in.size()));
    std::size_t size = out.size();
    const bool done = BrotliEncoderCompress(BROTLI_MAX_QUALITY, BROTLI_DEFAULT_WINDOW, BROTLI_MODE_GENERIC, in.size(), in.data(),
                                            &size, out.data()) == BROTLI_TRUE;
    out.resize(done ? size : 0);
    return out;
  }
  static Bytes expand(std::span<const std::uint8_t> in, std::size_t limit) {
    Bytes out(limit);
    std::size_t size = limit;
    const bool done = BrotliDecoderDecompress(in.size(), in.data(), &size, out.data()) == BROTLI_DECODER_RESULT_SUCCESS;
    out.resize(done ? size : 0);
    return out;
  }
};
#endif

#ifdef TACTUS_PEER_LZMA
/// Without container: the smallest that lzma gets.
struct Lzma {
  static Bytes compress(const Bytes& in) {
    Chain chain;
    Bytes out(in.size() + in.size() / 3 + 128);
    std::size_t size = 0;
    const bool done =
        lzma_raw_buffer_encode(chain.filters, nullptr, in.data(), in.size(), out.data(), &size, out.size()) == LZMA_OK;
    out.resize(done ? size : 0);
    return out;
  }
  static Bytes expand(std::span<const std::uint8_t> in, std::size_t limit) {
    Chain chain;
    Bytes out(limit);
    std::size_t read = 0, size = 0;
    const bool done =
        lzma_raw_buffer_decode(chain.filters, nullptr, in.data(), &read, in.size(), out.data(), &size, out.size()) == LZMA_OK;
    out.resize(done ? size : 0);
    return out;
  }

 private:
  struct Chain {
    lzma_options_lzma options{};
    lzma_filter filters[2]{};
    Chain() {
      lzma_lzma_preset(&options, 9 | LZMA_PRESET_EXTREME);
      options.dict_size = 1 << 16;  // no packet is larger; the preset's 64 MiB would be set up for each
      filters[0] = {LZMA_FILTER_LZMA1, &options};
      filters[1] = {LZMA_VLI_UNKNOWN, nullptr};
    }
  };
};
#endif

template <class Compressor, class Layout>
std::unique_ptr<VertexCoder> make_general(const Animation&) {
  return std::make_unique<GeneralCoder<Compressor, Layout>>();
}

template <class Compressor>
[[maybe_unused]] void add(const char* name, std::vector<Peer>& out) {
  out.push_back({name, Planes::kName, make_general<Compressor, Planes>});
  out.push_back({name, Varints::kName, make_general<Compressor, Varints>});
}

}  // namespace

void add_general_peers([[maybe_unused]] std::vector<Peer>& out, [[maybe_unused]] std::vector<std::string>& absent) {
#ifdef TACTUS_PEER_ZSTD
  add<Zstd<3>>("zstd -3", out);
  add<Zstd<19>>("zstd -19", out);
#else
  absent.emplace_back("zstd (apt-get install libzstd-dev)");
#endif
#ifdef TACTUS_PEER_BROTLI
  add<Brotli>("brotli -11", out);
#else
  absent.emplace_back("brotli (apt-get install libbrotli-dev)");
#endif
#ifdef TACTUS_PEER_LZMA
  add<Lzma>("lzma -9e", out);
#else
  absent.emplace_back("lzma (apt-get install liblzma-dev)");
#endif
}

}  // namespace tactus::peers
