// SPDX-License-Identifier: Apache-2.0
/// Any bytes as a stream file through the C interface: the scene returns what it holds, the player plays, and a receiver of the scene that
/// is given the same packets says and shows the same.
#include <limits>
#include <vector>

#include "tests/fuzz/c_interface.h"

namespace {

using namespace tactus::c_fuzz;

/// All that a scene returns, each into a buffer of exactly its size; one that is too small is refused.
void look(const tactus_scene* scene) {
  auto info = sized<tactus_scene_info>();
  auto bounds = sized<tactus_deformable_bounds>();
  auto rigid = sized<tactus_rigid_info>();
  require(call(tactus_scene_get, scene, &info));
  for (std::uint32_t i = 0; i <= info.rigid; ++i)
    require(call(tactus_scene_get_rigid, scene, i, &rigid) == (i < info.rigid) && (i == info.rigid || rigid.name));
  for (std::uint32_t i = 0; i < info.deformables; ++i) {
    auto mesh = sized<tactus_deformable_info>();
    require(call(tactus_scene_get_deformable, scene, i, &mesh) && mesh.name);
    std::vector<float> rest(std::size_t{3} * mesh.vertices);
    std::vector<std::uint32_t> corners(std::size_t{3} * mesh.triangles);
    std::vector<double> stiffness(mesh.vertices);
    std::vector<std::uint8_t> clusters(mesh.vertices);
    auto arrays = sized<tactus_mesh_arrays>();
    arrays.rest = rest.data(), arrays.vertices = mesh.vertices;
    arrays.corners = corners.data(), arrays.triangles = mesh.triangles;
    if (mesh.has_stiffness) arrays.stiffness = stiffness.data();
    if (mesh.clusters) arrays.clusters = clusters.data();
    require(call(tactus_scene_get_mesh, scene, i, &arrays));
    --arrays.vertices;
    require(!call(tactus_scene_get_mesh, scene, i, &arrays));
    (void)call(tactus_scene_get_bounds, scene, nullptr, i, &bounds, nullptr);
  }
}

/// What is shown of everything.
void show(tactus_receiver* receiver, std::int64_t tick) {
  auto info = sized<tactus_scene_info>();
  require(call(tactus_scene_get, tactus_receiver_scene(receiver), &info));
  std::vector<tactus_pose> poses(info.rigid);
  std::vector<tactus_update> updates(info.rigid);
  std::size_t count = 0;
  require(call(tactus_receiver_poses, receiver, tick, 0u, poses.size(), poses.data(), nullptr));
  require(call(tactus_receiver_updates, receiver, updates.data(), updates.size(), &count) && count <= updates.size());
  std::vector<double> loads(3 * (2 + std::size_t{info.load_users}));
  if (info.rigid > 0) (void)call(tactus_receiver_loads, receiver, 0u, tick, loads.data(), loads.size());
  for (std::uint32_t i = 0; i < info.deformables; ++i) {
    auto mesh = sized<tactus_deformable_info>();
    require(call(tactus_scene_get_deformable, tactus_receiver_scene(receiver), i, &mesh));
    std::vector<float> shown(std::size_t{3} * mesh.vertices);
    require(call(tactus_receiver_displacements, receiver, i, tick, shown.data(), shown.size()));
  }
}

std::uint64_t hash_of(const tactus_receiver* receiver, std::uint32_t substream) {
  std::uint64_t hash = 0;
  require(call(tactus_receiver_hash, receiver, substream, &hash, std::int64_t{0}, nullptr));
  return hash;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  auto limits = filled<tactus_limits>();
  limits.objects = 256;
  limits.vertices = 2048;  // decoding takes vertices x packets
  auto options = filled<tactus_receiver_options>();
  options.limits = &limits;
  const std::vector<std::uint8_t> file(data, data + size);
  tactus_player* opened = nullptr;
  tactus_scene* parsed = nullptr;
  const bool is_scene = call(tactus_scene_parse, file.data(), size, &limits, &parsed, nullptr);
  const Scene scene(parsed);
  if (scene) look(scene.get());
  if (!call(tactus_player_open, file.data(), size, &options, &opened)) return 0;
  require(is_scene);
  const Player player(opened);
  tactus_receiver* made = nullptr;
  require(call(tactus_receiver_create, scene.get(), &options, &made));
  const Receiver receiver(made);
  auto info = sized<tactus_packet_info>();
  while (call(tactus_player_play, opened, std::numeric_limits<std::int64_t>::max(), &info)) {
    auto again = sized<tactus_packet_info>();
    require(info.offset + info.bytes <= size);
    require(call(tactus_receiver_push, made, info.number, &file[info.offset], std::size_t{info.bytes},
                 std::int64_t{TACTUS_PACKET_TICK}, &again));
    require(again.tick == info.tick && again.updates == info.updates && again.number == info.number);
    require(hash_of(made, info.substream) == hash_of(tactus_player_receiver(opened), info.substream));
    show(made, info.tick + 3);
  }
  return 0;
}
