// SPDX-License-Identifier: Apache-2.0
/// Any bytes as calls of the C interface's scene builder and sender: options, bounds, names, meshes, motions. What the sender takes, a
/// receiver of the declared scene decodes.
#include <array>
#include <string>
#include <vector>

#include "tests/fuzz/c_interface.h"
#include "tests/fuzz/motions.h"

namespace {

using namespace tactus::c_fuzz;
using tactus::ByteReader;

/// Mostly a plain number, now and then one that nobody expects.
double number(ByteReader& in) {
  constexpr std::array<double, 8> kOdd{NAN, INFINITY, -INFINITY, -1, 1e-300, 1e300, 4e9, -0.0};
  const unsigned what = in.u8();
  return what < kOdd.size() ? kOdd[what] : 1e-3 * (what - 8.0);
}
/// 0 changes nothing, most others change a little.
void change(ByteReader& in, auto&... fields) {
  const auto one = [&in](auto& field) {
    const unsigned what = in.u8();
    using Field = std::remove_reference_t<decltype(field)>;
    if constexpr (std::is_floating_point_v<Field>) {
      if (what > 0) field = static_cast<Field>(number(in));
    } else if (what > 0) {
      field = what == 255 ? static_cast<Field>(in.u32()) : static_cast<Field>(what - 1);
    }
  };
  (one(fields), ...);
}

Builder make_builder(ByteReader& in) {
  auto o = filled<tactus_scene_options>();
  change(in, o.tick_rate, o.position_exp, o.velocity_exp, o.rotation_exp, o.angular_velocity_exp, o.baselines, o.rigid_profile,
         o.has_loads, o.load_users, o.force_exp, o.extrapolation, o.gravity[2], o.friction);
  tactus_scene_builder* made = nullptr;
  call(tactus_scene_builder_create, &o, &made);
  return Builder(made);
}

void add_rigid(ByteReader& in, tactus_scene_builder* builder) {
  auto o = filled<tactus_rigid_options>();
  change(in, o.dof, o.initial.position[0], o.initial.rotation[1]);
  const std::string name(in.u8() % 4, static_cast<char>(in.u8()));
  (void)call(tactus_scene_builder_rigid, builder, name.c_str(), &o);
}

void add_mesh(ByteReader& in, tactus_scene_builder* builder) {
  auto o = filled<tactus_deformable_options>();
  std::vector<double> vertices, vectors, stiffness;
  std::vector<std::uint32_t> triangles, fixed;
  const std::uint32_t count = in.u8() % 12;
  for (std::uint32_t v = 0; v < count; ++v) {
    vertices.insert(vertices.end(), {0.01 * (v / 2), 0.01 * (v % 2), 0});
    vectors.insert(vectors.end(), {0, 0, 1.0 + v});
    if (v >= 2) triangles.insert(triangles.end(), {v % 2 ? v - 1 : v - 2, v % 2 ? v - 2 : v - 1, v});
  }
  fixed = {0};
  stiffness.assign(count, 100);
  if (count > 0) change(in, vertices[in.u8() % vertices.size()], stiffness[0], vectors[0], fixed[0]);
  if (!triangles.empty()) change(in, triangles[in.u8() % triangles.size()]);
  change(in, o.profile, o.rings, o.quant_bits, o.models_kept, o.layered, o.weight_sets, o.frame_period, o.fade);
  const unsigned what = in.u8();
  if (what & 1) o.spring_modes = 1, o.fixed = fixed.data(), o.fixed_count = fixed.size();
  if (what & 2) o.vectors = vectors.data(), o.modes = 1;
  if (what & 4) o.stiffness = stiffness.data(), o.stiffness_count = stiffness.size();
  const std::vector<float> shapes(vertices.begin(), vertices.end());
  std::vector<std::uint8_t> clusters(count);
  if (what & 8 && call(tactus_find_clusters, vertices.data(), vertices.size() / 3, triangles.data(), triangles.size() / 3,
                       shapes.data(), std::size_t{1}, in.u8(), clusters.data(), &o.cluster_count, &o.blend)) {
    o.clusters = clusters.data();
    change(in, clusters[0], o.cluster_count, o.blend);
  }
  (void)call(tactus_scene_builder_deformable, builder, "m", vertices.data(), vertices.size() / 3, triangles.data(),
             triangles.size() / 3, &o);
}

struct Bounds {
  tactus_rigid_bounds rigid = filled<tactus_rigid_bounds>();
  tactus_deformable_bounds deformable = filled<tactus_deformable_bounds>();
  tactus_load_bounds load = filled<tactus_load_bounds>();

  explicit Bounds(ByteReader& in) {
    change(in, rigid.haptic, rigid.heartbeat, rigid.visual_position, rigid.weber_fraction, rigid.cone_angle, rigid.force_floor);
    change(in, deformable.haptic, deformable.visual, deformable.weber_fraction, deformable.depth_floor, load.weber_fraction);
  }
};

Scene make_scene(ByteReader& in) {
  const Builder builder = make_builder(in);
  if (!builder) return {};
  for (unsigned objects = in.u8() % 4; objects > 0; --objects) add_rigid(in, builder.get());
  if (in.u8() & 1) add_mesh(in, builder.get());
  const Bounds bounds(in);
  (void)call(tactus_scene_builder_declare_bounds, builder.get(), &bounds.rigid, &bounds.deformable, &bounds.load);
  tactus_scene* scene = nullptr;
  const bool built = call(tactus_scene_builder_build, builder.get(), &scene);
  require(built == (scene != nullptr));
  return Scene(scene);
}

/// The truth of one scene, which moves.
class World {
 public:
  explicit World(const tactus_scene* scene) {
    auto info = sized<tactus_scene_info>();
    require(call(tactus_scene_get, scene, &info));
    for (objects_.resize(info.rigid); auto& object : objects_) object = {{{0, 0, 0}, {1, 0, 0, 0}}, {}, {}};
    loads_.resize(info.has_loads ? info.rigid * 3 * (2 + std::size_t{info.load_users}) : 0);
    for (std::uint32_t i = 0; i < info.deformables; ++i) {
      auto mesh = sized<tactus_deformable_info>();
      require(call(tactus_scene_get_deformable, scene, i, &mesh));
      displacements_.resize(std::size_t{3} * mesh.vertices);
      shapes_.push_back({displacements_.data(), mesh.vertices, 0, 0, 0, 500});
    }
    has_loads_ = info.has_loads != 0;
  }
  tactus_truth next(ByteReader& in) {
    if (!objects_.empty()) {
      tactus_rigid_sample& object = objects_[in.u8() % objects_.size()];
      change(in, object.pose.position[0], object.velocity[1], object.pose.rotation[2]);
      contact_ = {TACTUS_CONTACT_SURFACE, 0, {0, 0, 0.02}, {0, 0, 1}, {0, 0, 0.018}, 500};
      change(in, contact_.kind, contact_.object, contact_.device[2], contact_.stiffness);
    }
    if (!displacements_.empty()) tactus::move(in, displacements_);
    if (!shapes_.empty()) change(in, shapes_[0].touched, shapes_[0].triangle, shapes_[0].force, shapes_[0].stiffness);
    if (!loads_.empty()) change(in, loads_[in.u8() % loads_.size()]);
    auto out = sized<tactus_truth>();
    out.objects = objects_.data(), out.object_count = objects_.size();
    out.contacts = &contact_, out.contact_count = objects_.empty() ? 0 : in.u8() & 1;
    out.shapes = shapes_.data(), out.shape_count = shapes_.size();
    if (has_loads_) out.loads = loads_.data(), out.load_count = objects_.size();
    return out;
  }

 private:
  std::vector<tactus_rigid_sample> objects_;
  std::vector<float> displacements_;
  std::vector<tactus_shape> shapes_;
  std::vector<double> loads_;
  tactus_contact contact_{};
  bool has_loads_ = false;
};

/// One packet from the sender to the receiver, and into a file.
void deliver(tactus_sender* sender, const tactus_packet& packet, tactus_receiver* receiver, tactus_writer* writer) {
  const std::vector<std::uint8_t> bytes(packet.data, packet.data + packet.bytes);
  auto info = sized<tactus_packet_info>();
  require(
      call(tactus_receiver_push, receiver, packet.number, bytes.data(), bytes.size(), std::int64_t{TACTUS_PACKET_TICK}, &info));
  require(info.tick == packet.tick && info.number == packet.number && info.updates == packet.updates);
  require(call(tactus_writer_add, writer, packet.tick, packet.number, bytes.data(), bytes.size(), packet.key));
  (void)call(tactus_sender_acknowledge, sender, packet.substream, packet.number);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  ByteReader in({data, size});
  const Scene scene = make_scene(in);
  if (!scene) return 0;
  const Bounds bounds(in);
  auto o = filled<tactus_sender_options>();
  change(in, o.reduction, o.baseline, o.reserved, o.key_interval, o.visual_fraction, o.haptic_fraction);
  o.rigid = &bounds.rigid, o.deformable = &bounds.deformable, o.load = &bounds.load;
  tactus_sender* raw_sender = nullptr;
  if (!call(tactus_sender_create, scene.get(), &o, &raw_sender)) return 0;
  const Sender sender(raw_sender);
  tactus_receiver* raw_receiver = nullptr;
  require(call(tactus_receiver_create, scene.get(), nullptr, &raw_receiver));
  const Receiver receiver(raw_receiver);
  tactus_writer* raw_writer = nullptr;
  require(call(tactus_writer_create, scene.get(), &raw_writer));
  const Writer writer(raw_writer);
  World world(scene.get());
  for (std::int64_t tick = 0; in.ok(); tick += 1 + in.u8() % 4) {
    const tactus_truth truth = world.next(in);
    if (in.u8() % 8 == 0) require(call(tactus_sender_request_key, raw_sender));
    auto encoded = sized<tactus_encoded>();
    if (!call(tactus_sender_encode, raw_sender, tick, &truth, &encoded)) continue;
    const std::vector<tactus_packet> packets(encoded.packets, encoded.packets + encoded.packet_count);
    for (const tactus_packet& packet : packets) deliver(raw_sender, packet, raw_receiver, raw_writer);
  }
  require(call(tactus_writer_finish, raw_writer));
  return 0;
}
