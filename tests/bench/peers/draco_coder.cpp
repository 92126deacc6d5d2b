// SPDX-License-Identifier: Apache-2.0
/// Draco at its slowest setting. Sequential: a cloud of points in our order. Edgebreaker: carries the triangles in every packet, because
/// it has no way to leave them out.
#include <draco/compression/decode.h>

#include <algorithm>

#include <draco/compression/encode.h>
#include <draco/mesh/mesh.h>

#include "tests/bench/peers/coder.h"

namespace tactus::peers {
namespace {

void fill(std::span<const Vec3i> values, draco::PointCloud& cloud) {
  cloud.set_num_points(static_cast<std::uint32_t>(values.size()));
  draco::GeometryAttribute attribute;
  attribute.Init(draco::GeometryAttribute::POSITION, nullptr, 3, draco::DT_INT32, false, sizeof(Vec3i), 0);
  const int id = cloud.AddAttribute(attribute, true, static_cast<std::uint32_t>(values.size()));
  for (std::uint32_t v = 0; v < values.size(); ++v)
    cloud.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(v), values[v].data());
}

/// Empty: not a packet of Draco's.
std::vector<Vec3i> points_of(std::span<const std::uint8_t> packet) {
  draco::DecoderBuffer in;
  in.Init(reinterpret_cast<const char*>(packet.data()), packet.size());
  draco::Decoder decoder;
  const auto cloud = decoder.DecodePointCloudFromBuffer(&in);
  if (!cloud.ok()) return {};
  const draco::PointAttribute* attribute = cloud.value()->GetNamedAttribute(draco::GeometryAttribute::POSITION);
  std::vector<Vec3i> out(cloud.value()->num_points());
  for (std::uint32_t i = 0; i < out.size(); ++i) attribute->GetMappedValue(draco::PointIndex(i), out[i].data());
  return out;
}

draco::Encoder slowest(int method) {
  draco::Encoder encoder;
  encoder.SetSpeedOptions(0, 0);
  encoder.SetEncodingMethod(method);
  return encoder;
}

Bytes bytes_of(const draco::EncoderBuffer& buffer) { return {buffer.data(), buffer.data() + buffer.size()}; }

class DracoSequential final : public VertexCoder {
 public:
  Bytes encode(std::span<const Vec3i> values) override {
    draco::PointCloud cloud;
    fill(values, cloud);
    draco::EncoderBuffer out;
    if (!slowest(draco::POINT_CLOUD_SEQUENTIAL_ENCODING).EncodePointCloudToBuffer(cloud, &out).ok()) return {};
    return bytes_of(out);
  }
  bool decode(std::span<const std::uint8_t> packet, std::span<Vec3i> values) override {
    const auto points = points_of(packet);
    if (points.size() != values.size()) return false;
    std::copy(points.begin(), points.end(), values.begin());
    return true;
  }
};

class DracoEdgebreaker final : public VertexCoder {
 public:
  explicit DracoEdgebreaker(const Animation& animation) : triangles_(animation.triangles) {
    order_.learn(points_of(encode(VertexOrder::numbers(animation.rest.size()))));
  }
  Bytes encode(std::span<const Vec3i> values) override {
    draco::Mesh mesh;
    fill(values, mesh);
    for (const Triangle& t : triangles_)
      mesh.AddFace({draco::PointIndex(t[0]), draco::PointIndex(t[1]), draco::PointIndex(t[2])});
    draco::EncoderBuffer out;
    if (!slowest(draco::MESH_EDGEBREAKER_ENCODING).EncodeMeshToBuffer(mesh, &out).ok()) return {};
    return bytes_of(out);
  }
  bool decode(std::span<const std::uint8_t> packet, std::span<Vec3i> values) override {
    return order_.restore(points_of(packet), values);
  }

 private:
  std::vector<Triangle> triangles_;
  VertexOrder order_;
};

}  // namespace

void add_draco(std::vector<Peer>& out) {
  out.push_back({"Draco sequential", "speed 0",
                 [](const Animation&) -> std::unique_ptr<VertexCoder> { return std::make_unique<DracoSequential>(); }});
  out.push_back({"Draco edgebreaker", "speed 0",
                 [](const Animation& a) -> std::unique_ptr<VertexCoder> { return std::make_unique<DracoEdgebreaker>(a); }});
}

}  // namespace tactus::peers
