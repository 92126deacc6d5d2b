// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/deformable/deformable_objects.h>

#include <algorithm>
#include <utility>

#include <tactus/sim/deformable/deformable_body.h>
#include <tactus/sim/deformable/deformable_probes.h>

namespace tactus::sim {
namespace {

using Bodies = std::vector<std::unique_ptr<DeformableBody>>;

SeenSurface as_computed(const DeformableBody& body) noexcept {
  return {body.vertices(), body.tree(), body.inside(), body.begins_frame()};
}

std::vector<TouchedSurface> surfaces_of(const Bodies& bodies, const Scene& scene, bool as_bodies) {
  std::vector<TouchedSurface> out;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const SceneDeformable& object = scene.deformables[i];
    out.push_back({bodies[i]->surface().mesh, bodies[i]->topology(), object.stiffness, object.friction, object.rate,
                   as_bodies && object.corotated});
  }
  return out;
}

/// The deformable objects of clients that see the truth.
class TrueView final : public Touchable {
 public:
  TrueView(const Bodies& bodies, const Scene& scene)
      : bodies_(bodies), probes_(surfaces_of(bodies, scene, false), scene.users.size(), Following::linearly) {}

  Touch touch(std::size_t user, const DeviceSample& device, bool) noexcept override {
    return probes_.touch(user, device.position, [&](std::uint32_t i) { return as_computed(*bodies_[i]); });
  }
  DeformableProbes& probes() noexcept { return probes_; }

 private:
  const Bodies& bodies_;
  DeformableProbes probes_;
};

class Objects final : public DeformableObjects {
 public:
  Objects(Bodies bodies, const Scene& scene, const DeformableOptions& options);

  Touch touch(std::size_t user, const DeviceSample& device, bool) noexcept override {
    return touches_[user] = probes_.touch(user, device.position, [&](std::uint32_t i) { return as_computed(*bodies_[i]); });
  }
  void push(std::size_t user, double fraction) noexcept override {
    const auto& [contact, surface, proxy, force] = touches_[user];
    if (surface) bodies_[surface->mesh]->push(surface->triangle, surface->weights, -(fraction * force));
  }
  tl::expected<void, Diagnostic> step() override;
  void observe(TraceFrame& frame) noexcept override;
  bool is_due(std::size_t object) const noexcept override { return last_[object] != DeformableBody::Tick::between; }
  Touchable& true_view() noexcept override { return *true_view_; }
  std::span<const TraceDeformable> meshes() const noexcept override { return meshes_; }
  std::span<const DeformableInfo> info() const noexcept override { return info_; }
  DeformationTime time(std::size_t object) const noexcept override { return bodies_[object]->time(); }
  std::optional<DeformableError> error(std::size_t object) const override;
  double energy(std::size_t object) noexcept override { return bodies_[object]->energy(); }

 private:
  void deform(std::uint32_t object) noexcept;

  Bodies bodies_;
  DeformableProbes probes_;
  std::vector<Touch> touches_;           // of this tick, one per user
  std::unique_ptr<TrueView> true_view_;  // none: clients have their own
  std::vector<TraceDeformable> meshes_;
  std::vector<DeformableInfo> info_;
  std::vector<DeformableBody::Tick> last_;  // results of the last tick, one per object
  std::int64_t tick_ = 0;
  bool report_at_rest_ = false;
};

/// The method of a shared body that is that of the server, or comes nearest to it.
ElasticStep shared_step(const IntegratorOptions& options) {
  switch (options.method) {
    case Method::velocity_verlet:
      return {ElasticBody::Method::velocity_verlet, options.substeps};
    case Method::backward_euler:
    case Method::projective:
      return {ElasticBody::Method::backward_euler};
    default:
      return {ElasticBody::Method::tr_bdf2};
  }
}

/// Those vertices of a surface that are fixed.
std::vector<std::uint32_t> fixed_of(const TetSurface& surface, std::span<const std::uint32_t> fixed) {
  std::vector<std::uint32_t> out;
  for (std::uint32_t v = 0; v < surface.vertex.size(); ++v)
    if (std::ranges::binary_search(fixed, surface.vertex[v])) out.push_back(v);
  return out;
}

Objects::Objects(Bodies bodies, const Scene& scene, const DeformableOptions& options)
    : bodies_(std::move(bodies)),
      probes_(surfaces_of(bodies_, scene, options.as_bodies), scene.users.size(), Following::at_once),
      touches_(scene.users.size()),
      true_view_(options.true_views ? std::make_unique<TrueView>(bodies_, scene) : nullptr),
      last_(bodies_.size(), DeformableBody::Tick::between),
      report_at_rest_(options.report_at_rest) {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const SceneDeformable& object = scene.deformables[i];
    const Choice& choice = bodies_[i]->choice();
    info_.push_back({object.name, object.mesh.vertices.size(), to_string(choice.options), choice.reason, choice.options.step,
                     choice.largest_frequency, shared_step(choice.options)});
    const TetSurface& surface = bodies_[i]->surface();
    meshes_.push_back({object.name, surface.mesh, fixed_of(surface, object.fixed), static_cast<double>(object.rate)});
  }
}

tl::expected<void, Diagnostic> Objects::step() {
  for (std::uint32_t i = 0; i < bodies_.size(); ++i) {
    const auto moved = bodies_[i]->tick();
    if (!moved)
      return tl::unexpected(Diagnostic{.error = moved.error().error,
                                       .step = tick_,
                                       .kind = "deformable object",
                                       .element = i,
                                       .detail = location_of(moved.error()),
                                       .remedy = moved.error().remedy});
    last_[i] = *moved;
    if (*moved == DeformableBody::Tick::stepped) deform(i);
    else if (*moved == DeformableBody::Tick::slept && true_view_)
      true_view_->probes().update_at_rest(i, bodies_[i]->vertices(), bodies_[i]->tree());
  }
  ++tick_;
  return {};
}

/// Deform an object; clients that see the truth see its new shape.
void Objects::deform(std::uint32_t object) noexcept {
  DeformableBody& body = *bodies_[object];
  if (body.reach() > 0) {
    probes_.expect(object, body.reach(), body.vertices(), body.next_vertices(), body.tree());
    if (true_view_) true_view_->probes().expect(object, body.reach(), body.vertices(), body.next_vertices(), body.tree());
    body.show();
  }
  if (true_view_) true_view_->probes().update(object, body.vertices(), body.tree());
}

std::optional<DeformableError> Objects::error(std::size_t object) const {
  const auto& estimate = bodies_[object]->estimate();
  if (!estimate) return std::nullopt;
  const ErrorEstimate::Result result = estimate->result();
  const EnergyBalance::Result balance = bodies_[object]->balance()->result();
  return DeformableError{result.of_motion, result.most_of_motion, result.samples,
                         balance.moved > 0 ? balance.gained / balance.moved : 0};
}

void Objects::observe(TraceFrame& frame) noexcept {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    DeformableSample& mesh = frame.meshes[i];
    mesh.updated = last_[i] == DeformableBody::Tick::stepped || (report_at_rest_ && is_due(i));
    if (!mesh.updated) continue;
    const Eigen::VectorXd& u = bodies_[i]->state().u;
    float* out = mesh.displacements.data();
    for (const std::uint32_t vertex : bodies_[i]->surface().vertex)
      for (Eigen::Index k = 0; k < 3; ++k) *out++ = static_cast<float>(u[3 * static_cast<Eigen::Index>(vertex) + k]);
  }
}

}  // namespace

Result<std::unique_ptr<DeformableObjects>> make_deformable_objects(const Scene& scene, const DeformableOptions& options) {
  Bodies bodies;
  for (const SceneDeformable& object : scene.deformables) {
    auto body = DeformableBody::create(object, scene.gravity, options.estimate_every, options.parts);
    if (!body) return tl::unexpected(body.error().error);
    bodies.push_back(std::move(*body));
  }
  return std::make_unique<Objects>(std::move(bodies), scene, options);
}

}  // namespace tactus::sim
