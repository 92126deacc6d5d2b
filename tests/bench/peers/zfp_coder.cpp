// SPDX-License-Identifier: Apache-2.0
/// zfp, reversible, over integers: one row per axis, or all in one row.
#include <zfp.h>

#include "tests/bench/peers/coder.h"

namespace tactus::peers {
namespace {

template <bool TwoDimensions>
class Zfp final : public VertexCoder {
 public:
  Bytes encode(std::span<const Vec3i> values) override {
    std::vector<std::int32_t> rows;
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const Vec3i& v : values) rows.push_back(v[axis]);
    Bytes out(16 * values.size() + 1024);
    out.resize(run(rows, out, zfp_compress));
    return out;
  }
  bool decode(std::span<const std::uint8_t> packet, std::span<Vec3i> values) override {
    std::vector<std::int32_t> rows(3 * values.size());
    Bytes in(packet.begin(), packet.end());
    in.resize(in.size() + 64);  // it reads whole words
    if (run(rows, in, zfp_decompress) == 0) return false;
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (std::size_t v = 0; v < values.size(); ++v) values[v][axis] = rows[axis * values.size() + v];
    return true;
  }

 private:
  template <class Operation>
  static std::size_t run(std::vector<std::int32_t>& rows, Bytes& buffer, Operation operation) {
    zfp_field* field = TwoDimensions ? zfp_field_2d(rows.data(), zfp_type_int32, rows.size() / 3, 3)
                                     : zfp_field_1d(rows.data(), zfp_type_int32, rows.size());
    zfp_stream* zfp = zfp_stream_open(nullptr);
    zfp_stream_set_reversible(zfp);
    bitstream* bits = stream_open(buffer.data(), buffer.size());
    zfp_stream_set_bit_stream(zfp, bits);
    zfp_stream_rewind(zfp);
    const std::size_t size = operation(zfp, field);
    stream_close(bits);
    zfp_stream_close(zfp);
    zfp_field_free(field);
    return size;
  }
};

template <bool TwoDimensions>
std::unique_ptr<VertexCoder> make(const Animation&) {
  return std::make_unique<Zfp<TwoDimensions>>();
}

}  // namespace

void add_zfp(std::vector<Peer>& out) {
  out.push_back({"zfp", "reversible, 1-D", make<false>});
  out.push_back({"zfp", "reversible, 2-D", make<true>});
}

}  // namespace tactus::peers
