// SPDX-License-Identifier: Apache-2.0
/// meshoptimizer's vertex buffers: i16 where the animation fits, else i32.
#include <meshoptimizer.h>

#include <algorithm>
#include <limits>

#include "tests/bench/peers/coder.h"

namespace tactus::peers {
namespace {

/// Four components: vertices must take a multiple of four bytes.
template <class Component>
class Meshoptimizer final : public VertexCoder {
 public:
  Bytes encode(std::span<const Vec3i> values) override {
    std::vector<std::array<Component, 4>> vertices;
    for (const Vec3i& v : values) {
      for (const std::int32_t c : v)
        if (c < std::numeric_limits<Component>::min() || c > std::numeric_limits<Component>::max()) return {};
      vertices.push_back({static_cast<Component>(v[0]), static_cast<Component>(v[1]), static_cast<Component>(v[2]), 0});
    }
    Bytes out(meshopt_encodeVertexBufferBound(vertices.size(), sizeof vertices[0]));
    out.resize(meshopt_encodeVertexBuffer(out.data(), out.size(), vertices.data(), vertices.size(), sizeof vertices[0]));
    return out;
  }
  bool decode(std::span<const std::uint8_t> packet, std::span<Vec3i> values) override {
    std::vector<std::array<Component, 4>> vertices(values.size());
    if (meshopt_decodeVertexBuffer(vertices.data(), vertices.size(), sizeof vertices[0], packet.data(), packet.size()) != 0)
      return false;
    for (std::size_t v = 0; v < values.size(); ++v) std::copy_n(vertices[v].begin(), 3, values[v].begin());
    return true;
  }
};

}  // namespace

void add_meshoptimizer(std::vector<Peer>& out) {
  out.push_back({"meshoptimizer", "i16", [](const Animation&) -> std::unique_ptr<VertexCoder> {
                   return std::make_unique<Meshoptimizer<std::int16_t>>();
                 }});
  out.push_back({"meshoptimizer", "i32", [](const Animation&) -> std::unique_ptr<VertexCoder> {
                   return std::make_unique<Meshoptimizer<std::int32_t>>();
                 }});
}

}  // namespace tactus::peers
