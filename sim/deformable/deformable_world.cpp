// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/deformable/deformable_world.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <tactus/deformable/displacement.h>
#include <tactus/sim/contact/intermediate_model.h>
#include <tactus/sim/contact/mesh_proxy.h>
#include <tactus/sim/deformable/deformable_body.h>

namespace tactus::sim {
namespace {

constexpr unsigned kRings = 3;  // of the client's cut-out (thesis 3.3.1.1)

/// What clients see of one object, once they were told: otherwise its true surface.
struct ClientSurface {
  std::vector<Vec3> vertices, next;
  AabbTree tree;
};

/// A probe's proxy on one object: on the surface it sees, or on a cut-out that approaches it.
struct Proxy {
  MeshProxy direct;
  std::unique_ptr<IntermediateModel> cut_out;  // none: direct
};

/// One probe at one end.
struct Probe {
  std::vector<Proxy> proxies;  // one per object
  std::optional<std::uint32_t> touched;
  bool placed = false;

  ProxyTouch move(std::uint32_t object, const DeformableBody& body, const ClientSurface* seen, const Vec3& device) noexcept {
    auto& [direct, cut_out] = proxies[object];
    const auto vertices = seen ? std::span<const Vec3>(seen->vertices) : body.vertices();
    const AabbTree& tree = seen ? seen->tree : body.tree();
    if (cut_out) return placed ? cut_out->move(device) : cut_out->place(device, vertices, tree);
    return placed ? direct.move(device, vertices, tree) : direct.place(device, body.inside(), vertices, tree);
  }
  /// The surface it sees is about to move.
  void expect(std::uint32_t object, double reach, std::span<const Vec3> vertices, std::span<const Vec3> next,
              const AabbTree& tree) noexcept {
    if (Proxy& proxy = proxies[object]; !proxy.cut_out) proxy.direct.expect(reach, vertices, next, tree);
  }
};

/// The longest of the ways from one place to the other [m].
double farthest(std::span<const Vec3> from, std::span<const Vec3> to) {
  double square = 0;
  for (std::size_t i = 0; i < from.size(); ++i) square = std::max(square, dot(to[i] - from[i], to[i] - from[i]));
  return std::sqrt(square);
}

class World final : public DeformableWorld {
 public:
  Result<void> add(const SceneDeformable& object, const Vec3& gravity, const DeformableOptions& options);
  void add_user(const Scene& scene);
  void add_clients() {
    for (const auto& body : bodies_)
      seen_.push_back({body->surface().mesh.vertices, body->surface().mesh.vertices, AabbTree(body->surface().mesh)});
  }

  DeformableTouch touch_server(std::size_t user, const Vec3& device) noexcept override {
    return touch(server_[user], {}, device);
  }
  DeformableTouch touch_client(std::size_t user, const Vec3& device) noexcept override {
    return touch(client_[user], seen_, device);
  }
  void show(std::size_t object, std::span<const std::array<std::int32_t, 3>> displacements,
            unsigned position_exp) noexcept override;
  void push(const SurfaceContact& contact, const Vec3& force) noexcept override {
    bodies_[contact.mesh]->push(contact.triangle, contact.weights, force);
  }
  tl::expected<void, StepError> step() override;
  void observe(std::span<DeformableSample> meshes) noexcept override;
  bool is_due(std::size_t object) const noexcept override { return last_[object] != DeformableBody::Tick::between; }
  std::span<const TraceDeformable> meshes() const noexcept override { return meshes_; }
  std::span<const DeformableInfo> info() const noexcept override { return info_; }
  DeformationTime time(std::size_t object) const noexcept override { return bodies_[object]->time(); }
  std::optional<DeformableError> error(std::size_t object) const override;

 private:
  DeformableTouch touch(Probe& probe, std::span<const ClientSurface> seen, const Vec3& device) noexcept;
  void deform(std::uint32_t object) noexcept;
  void update_clients(std::uint32_t object, std::span<const Vec3> vertices, const AabbTree& tree) noexcept;

  std::vector<std::unique_ptr<DeformableBody>> bodies_;
  std::vector<double> stiffness_;       // of each object's coupling [N/m]
  std::vector<Probe> server_, client_;  // one per user
  std::vector<TraceDeformable> meshes_;
  std::vector<DeformableInfo> info_;
  std::vector<DeformableBody::Tick> last_;  // what the last tick came to, one per object
  std::vector<ClientSurface> seen_;         // by clients, one per object; none: they see the truth
  std::int64_t tick_ = 0;
  bool report_at_rest_ = false;
};

double extent(const TriMesh& mesh) {
  double largest = 0;
  for (const Vec3& v : mesh.vertices) largest = std::max({largest, std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  return largest;
}

/// Those vertices of a surface that are fixed.
std::vector<std::uint32_t> fixed_of(const TetSurface& surface, std::span<const std::uint32_t> fixed) {
  std::vector<std::uint32_t> out;
  for (std::uint32_t v = 0; v < surface.vertex.size(); ++v)
    if (std::ranges::binary_search(fixed, surface.vertex[v])) out.push_back(v);
  return out;
}

Result<void> World::add(const SceneDeformable& object, const Vec3& gravity, const DeformableOptions& options) {
  auto body = DeformableBody::create(object, gravity, options.estimate_every);
  report_at_rest_ = options.report_at_rest;
  if (!body) return tl::unexpected(body.error().error);
  const Choice& choice = (*body)->choice();
  info_.push_back({object.name, object.mesh.vertices.size(), to_string(choice.options), choice.reason, choice.options.step,
                   choice.largest_frequency});
  meshes_.push_back(
      {object.name, (*body)->surface().mesh, fixed_of((*body)->surface(), object.fixed), static_cast<double>(object.rate)});
  stiffness_.push_back(object.stiffness);
  last_.push_back(DeformableBody::Tick::between);
  bodies_.push_back(std::move(*body));
  return {};
}

void World::add_user(const Scene& scene) {
  Probe server, client;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const SceneDeformable& object = scene.deformables[i];
    const TriMesh& surface = bodies_[i]->surface().mesh;
    const MeshProxyOptions proxy{.friction = object.friction};
    server.proxies.push_back({MeshProxy(proxy, extent(surface)), nullptr});
    client.proxies.push_back({MeshProxy(proxy, extent(surface)), nullptr});
    if (object.rate > 1)
      client.proxies.back().cut_out = std::make_unique<IntermediateModel>(surface, bodies_[i]->topology(),
                                                                          IntermediateModelOptions{kRings, object.rate, proxy});
  }
  server_.push_back(std::move(server));
  client_.push_back(std::move(client));
}

DeformableTouch World::touch(Probe& probe, std::span<const ClientSurface> seen, const Vec3& device) noexcept {
  std::optional<std::uint32_t> touched;
  ProxyTouch felt;
  for (std::uint32_t i = 0; i < bodies_.size(); ++i) {
    const ProxyTouch touch = probe.move(i, *bodies_[i], seen.empty() ? nullptr : &seen[i], device);
    if (!touch.touched || (touched && probe.touched != i)) continue;
    touched = i;
    felt = touch;
  }
  probe.placed = true;
  probe.touched = touched;
  if (!touched) return {};
  const SurfaceContact contact{*touched, felt.triangle, felt.weights, felt.proxy, felt.normal, stiffness_[*touched]};
  return {contact, contact.stiffness * (felt.proxy - device)};
}

tl::expected<void, StepError> World::step() {
  for (std::uint32_t i = 0; i < bodies_.size(); ++i) {
    const auto moved = bodies_[i]->tick();
    if (!moved) return tl::unexpected(StepError{moved.error().error, tick_, i, to_string(moved.error())});
    last_[i] = *moved;
    if (*moved == DeformableBody::Tick::stepped) deform(i);
    else if (*moved == DeformableBody::Tick::slept && seen_.empty())
      for (Probe& client : client_)
        if (auto& cut_out = client.proxies[i].cut_out) cut_out->update_at_rest(bodies_[i]->vertices(), bodies_[i]->tree());
  }
  ++tick_;
  return {};
}

/// A new shape is shown to those who see the truth.
void World::deform(std::uint32_t object) noexcept {
  DeformableBody& body = *bodies_[object];
  if (body.reach() > 0) {
    for (Probe& server : server_) server.expect(object, body.reach(), body.vertices(), body.next_vertices(), body.tree());
    if (seen_.empty())
      for (Probe& client : client_) client.expect(object, body.reach(), body.vertices(), body.next_vertices(), body.tree());
    body.show();
  }
  if (seen_.empty()) update_clients(object, body.vertices(), body.tree());
}

void World::update_clients(std::uint32_t object, std::span<const Vec3> vertices, const AabbTree& tree) noexcept {
  for (Probe& client : client_)
    if (auto& cut_out = client.proxies[object].cut_out) cut_out->update(vertices, tree);
}

void World::show(std::size_t object, std::span<const std::array<std::int32_t, 3>> displacements, unsigned position_exp) noexcept {
  ClientSurface& seen = seen_[object];
  const std::vector<Vec3>& rest = meshes_[object].rest.vertices;
  for (std::size_t v = 0; v < rest.size(); ++v) seen.next[v] = rest[v] + to_metres(displacements[v], position_exp);
  if (const double reach = farthest(seen.vertices, seen.next); reach > 0) {
    for (Probe& client : client_) client.expect(static_cast<std::uint32_t>(object), reach, seen.vertices, seen.next, seen.tree);
    std::swap(seen.vertices, seen.next);
    seen.tree.refit(seen.vertices);
  }
  update_clients(static_cast<std::uint32_t>(object), seen.vertices, seen.tree);
}

std::optional<DeformableError> World::error(std::size_t object) const {
  const auto& estimate = bodies_[object]->estimate();
  if (!estimate) return std::nullopt;
  const ErrorEstimate::Result result = estimate->result();
  const EnergyBalance::Result balance = bodies_[object]->balance()->result();
  return DeformableError{result.p50, result.max, result.samples, balance.moved > 0 ? balance.gained / balance.moved : 0};
}

void World::observe(std::span<DeformableSample> meshes) noexcept {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    meshes[i].updated = last_[i] == DeformableBody::Tick::stepped || (report_at_rest_ && is_due(i));
    if (!meshes[i].updated) continue;
    const Eigen::VectorXd& u = bodies_[i]->state().u;
    float* out = meshes[i].displacements.data();
    for (const std::uint32_t vertex : bodies_[i]->surface().vertex)
      for (Eigen::Index k = 0; k < 3; ++k) *out++ = static_cast<float>(u[3 * static_cast<Eigen::Index>(vertex) + k]);
  }
}

}  // namespace

Result<std::unique_ptr<DeformableWorld>> make_deformable_world(const Scene& scene, const DeformableOptions& options) {
  auto world = std::make_unique<World>();
  for (const SceneDeformable& object : scene.deformables) TACTUS_CHECK(world->add(object, scene.gravity, options));
  for (std::size_t i = 0; i < options.users; ++i) world->add_user(scene);
  if (options.clients == DeformableClients::shown) world->add_clients();
  return world;
}

}  // namespace tactus::sim
