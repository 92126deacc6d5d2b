// SPDX-License-Identifier: Apache-2.0
/// Open3DGC: triangles go along in every packet. Its quantiser is set so that its steps are those of the grid.
#include <o3dgc/o3dgcSC3DMCDecoder.h>
#include <o3dgc/o3dgcSC3DMCEncoder.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "tests/bench/peers/coder.h"

namespace tactus::peers {
namespace {

using Index = std::uint16_t;

template <o3dgc::O3DGCSC3DMCPredictionMode Prediction>
class Open3dgc final : public VertexCoder {
 public:
  explicit Open3dgc(const Animation& animation) {
    for (const Triangle& t : animation.triangles)
      for (const std::uint32_t v : t) corners_.push_back(static_cast<Index>(v));
    if (animation.rest.size() > 0xffff || corners_.empty()) return;  // it counts vertices in 16 bits here
    const Bytes packet = encode(VertexOrder::numbers(animation.rest.size()));
    order_.learn(points_of(packet));
  }

  Bytes encode(std::span<const Vec3i> values) override {
    if (corners_.empty()) return {};
    o3dgc::IndexedFaceSet<Index> mesh;
    std::vector<o3dgc::Real> points;
    for (const Vec3i& v : values)
      for (const std::int32_t c : v) points.push_back(static_cast<o3dgc::Real>(c));
    std::vector<Index> corners = corners_;
    mesh.SetNCoord(values.size());
    mesh.SetCoord(points.data());
    mesh.SetNCoordIndex(corners.size() / 3);
    mesh.SetCoordIndex(corners.data());
    Vec3i low = values[0], high = values[0];
    std::uint32_t range = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (const Vec3i& v : values) {
        low[axis] = std::min(low[axis], v[axis]);
        high[axis] = std::max(high[axis], v[axis]);
      }
      range = std::max(range, static_cast<std::uint32_t>(high[axis] - low[axis]));
    }
    const auto bits = static_cast<unsigned>(std::bit_width(range));
    for (int axis = 0; axis < 3; ++axis) {
      const std::int32_t least = low[static_cast<std::size_t>(axis)];
      mesh.SetCoordMin(axis, static_cast<o3dgc::Real>(least));
      mesh.SetCoordMax(axis, static_cast<o3dgc::Real>(least + (1 << bits) - 1));
    }
    o3dgc::SC3DMCEncodeParams parameters;
    parameters.SetStreamType(o3dgc::O3DGC_STREAM_TYPE_BINARY);
    parameters.SetCoordQuantBits(bits);
    parameters.SetCoordPredMode(Prediction);
    o3dgc::BinaryStream out;
    o3dgc::SC3DMCEncoder<Index> encoder;
    if (encoder.Encode(parameters, mesh, out) != o3dgc::O3DGC_OK) return {};
    return {out.GetBuffer(), out.GetBuffer() + out.GetSize()};
  }

  bool decode(std::span<const std::uint8_t> packet, std::span<Vec3i> values) override {
    return order_.restore(points_of(packet), values);
  }

 private:
  static std::vector<Vec3i> points_of(std::span<const std::uint8_t> packet) {
    o3dgc::BinaryStream in(packet.size());
    Bytes copy(packet.begin(), packet.end());
    in.LoadFromBuffer(copy.data(), copy.size());
    o3dgc::SC3DMCDecoder<Index> decoder;
    o3dgc::IndexedFaceSet<Index> mesh;
    if (decoder.DecodeHeader(mesh, in) != o3dgc::O3DGC_OK) return {};
    std::vector<o3dgc::Real> points(3 * mesh.GetNCoord());
    std::vector<Index> corners(3 * mesh.GetNCoordIndex());
    mesh.SetCoord(points.data());
    mesh.SetCoordIndex(corners.data());
    if (decoder.DecodePlayload(mesh, in) != o3dgc::O3DGC_OK) return {};
    std::vector<Vec3i> out(mesh.GetNCoord());
    for (std::size_t v = 0; v < out.size(); ++v)
      for (std::size_t axis = 0; axis < 3; ++axis)
        out[v][axis] = static_cast<std::int32_t>(std::floor(points[3 * v + axis] + o3dgc::Real{0.5}));
    return out;
  }

  std::vector<Index> corners_;
  VertexOrder order_;
};

template <o3dgc::O3DGCSC3DMCPredictionMode Prediction>
std::unique_ptr<VertexCoder> make(const Animation& animation) {
  return std::make_unique<Open3dgc<Prediction>>(animation);
}

}  // namespace

void add_open3dgc(std::vector<Peer>& out) {
  out.push_back({"Open3DGC", "parallelogram", make<o3dgc::O3DGC_SC3DMC_PARALLELOGRAM_PREDICTION>});
  out.push_back({"Open3DGC", "differences", make<o3dgc::O3DGC_SC3DMC_DIFFERENTIAL_PREDICTION>});
}

}  // namespace tactus::peers
