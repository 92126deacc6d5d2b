// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/client.h>

#include <algorithm>
#include <cstdint>
#include <ctime>
#include <utility>

#include <tactus/load/load_state.h>
#include <tactus/sim/tets/tet_mesh.h>

namespace tactus::sim {

// ==== compensation ====

Vec3 others_push(std::span<const GridForce> load, std::size_t user, unsigned force_exp) noexcept {
  Vec3 sum;
  for (std::size_t v = kPushes; v < load.size(); ++v)
    if (v != kPushes + user) sum = sum + to_force(load[v], force_exp);
  return sum;
}

Result<Compensation> Compensation::create(const Scene& scene) {
  Compensation out(scene);
  for (std::size_t i = 0; i < scene.users.size(); ++i) {
    TACTUS_TRY(auto reduction,
               StiffnessReduction::create({.as_printed = scene.compensation->method == CompensationMethod::stiffness_thesis,
                                           .filter = scene.compensation->filter}));
    out.reductions_.push_back(std::move(reduction));
  }
  return out;
}

/// [N/m] For the spring between proxy and device.   pre  something is touched
double Compensation::reduced(std::size_t user, const Touch& touch, const Vec3& stretch, const Shown& shown,
                             std::uint32_t delay) noexcept {
  StiffnessReduction& reduction = reductions_[user];
  if (touch.surface) {
    const SurfaceContact& at = *touch.surface;
    if (shown.deformable == nullptr) return at.stiffness;
    const double yields = stiffness_at(*shown.deformable, at.triangle, at.weights);
    return reduction.reduced(StiffnessReduction::DeformableTouch{stretch, at.normal, at.stiffness, yields}, delay);
  }
  const Contact& contact = touch.contact;
  const Vec3 normal = rotate(shown.pose.rotation, contact.normal);
  if (const std::size_t rigid = scene_->objects.size(); contact.object >= rigid) {
    const double yields = scene_->msds[contact.object - rigid].object.stiffness;
    return reduction.reduced(StiffnessReduction::DeformableTouch{stretch, normal, contact.stiffness, yields}, delay);
  }
  if (shown.load.empty()) return contact.stiffness;
  const auto force = [&](std::size_t vector) { return to_force(shown.load[vector], shown.force_exp); };
  return reduction.reduced(StiffnessReduction::RigidTouch{.stretch = stretch,
                                                          .normal = normal,
                                                          .coupling = contact.stiffness,
                                                          .moves = shown.moves,
                                                          .external = force(kExternal),
                                                          .others = others_push(shown.load, user, shown.force_exp),
                                                          .hold = force(kHold)},
                           delay);
}

Vec3 Compensation::soften(std::size_t user, const Touch& touch, const Vec3& device, const Shown& shown,
                          std::uint32_t delay) noexcept {
  const Vec3 stretch = device - (touch.surface ? touch.surface->proxy : touch.proxy);
  const double coupling = touch.surface ? touch.surface->stiffness : touch.contact.stiffness;
  stiffness_[user] = reduced(user, touch, stretch, shown, delay);
  return touch.force + (coupling - stiffness_[user]) * stretch;
}

// ==== client ====

namespace {

constexpr double kPortRests = 0.1;  // [s] without force, then the account of its energy starts anew
constexpr double kStill = 1e-8;     // [m] in a tick: an object that moves less does not

/// Of the mesh's box [m].
Vec3 centre(const TriMesh& mesh) {
  const auto [low, high] = bounds(mesh.vertices);
  return 0.5 * (low + high);
}

ClientCosts::Cost time_now() noexcept {
  timespec wall{}, cpu{};
  clock_gettime(CLOCK_MONOTONIC, &wall);
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &cpu);
  const auto ns = [](const timespec& t) { return std::int64_t{1'000'000'000} * t.tv_sec + t.tv_nsec; };
  return {ns(wall), ns(cpu)};
}

/// Of two readings of the clocks, the least of some.
ClientCosts::Cost cost_of_reading() noexcept {
  ClientCosts::Cost least{INT64_MAX, INT64_MAX};
  for (int i = 0; i < 100; ++i) {
    const ClientCosts::Cost before = time_now(), after = time_now();
    least = {std::min(least.wall, after.wall - before.wall), std::min(least.cpu, after.cpu - before.cpu)};
  }
  return least;
}

}  // namespace

template <class Work>
auto Client::measured(ClientCosts::Cost& cost, Work&& work) noexcept {
  if (!measures_) return work();
  static const ClientCosts::Cost reading = cost_of_reading();
  struct Added {
    ClientCosts::Cost& to;
    ClientCosts::Cost before = time_now();
    ~Added() {
      const ClientCosts::Cost after = time_now();
      to.wall += std::max<std::int64_t>(0, after.wall - before.wall - reading.wall);
      to.cpu += std::max<std::int64_t>(0, after.cpu - before.cpu - reading.cpu);
    }
  } const added{cost};
  return work();
}

Client::Client(Server& server, std::optional<Receiver> receiver)
    : scene_(server.scene()),
      receiver_(std::move(receiver)),
      rigid_(scene_, server.stream_scene() ? RigidView::News::of_all : RigidView::News::of_changed),
      rendered_(scene_.users.size()),
      contacts_(scene_.users.size()),
      stiffness_(scene_.users.size()) {
  poses_.assign(rigid_.poses().begin(), rigid_.poses().end());
  if (scene_.touch && scene_.touch->max_damping > 0)
    ports_.assign(scene_.users.size(),
                  PassivityController({.max_damping = scene_.touch->max_damping, .reset_after = kPortRests}));
  objects_.push_back(&rigid_);
  if (!scene_.msds.empty()) {
    msds_.emplace(scene_);
    poses_.insert(poses_.end(), msds_->poses().begin(), msds_->poses().end());
    objects_.push_back(&*msds_);
  }
  DeformableObjects* deformables = server.deformables();
  if (!deformables) return;
  for (const TraceDeformable& mesh : deformables->meshes()) {
    mesh_poses_.push_back({centre(mesh.rest), {}});
    shown_.push_back({.period = mesh.period});
  }
  if (server.stream_scene()) objects_.push_back(&deformables_.emplace(scene_, deformables->meshes()));
  else objects_.push_back(&deformables->true_view());
}

Result<std::unique_ptr<Client>> Client::create(Server& server, const ReplicaOptions& replica) {
  std::optional<Receiver> receiver;
  if (SharedScene declared = server.stream_scene()) {
    TACTUS_TRY(receiver, Receiver::create(std::move(declared), {.replica = replica, .limits = {}}));
  }
  return std::unique_ptr<Client>(new Client(server, std::move(receiver)));
}

Result<std::unique_ptr<Client>> Client::create_remote(Server& server, std::size_t user, const Scene& own) {
  std::unique_ptr<Client> client(new Client(server, {}));
  const auto& asked = client->scene_.compensation;
  if (!asked) return client;
  if (!asked->is_softer()) {
    TACTUS_TRY(client->prediction_, Prediction::create(own, user));
    return client;
  }
  TACTUS_TRY(client->compensation_, Compensation::create(client->scene_));
  client->moves_.resize(client->poses_.size());
  return client;
}

Result<void> Client::receive(std::span<const Packet> packets) noexcept {
  for (const Packet& packet : packets) TACTUS_CHECK(receiver_->push(packet.number, packet.bytes));
  return {};
}

void Client::show_pose(std::uint32_t object, const Pose& pose) noexcept {
  if (compensation_) moves_[object] = norm(pose.position - poses_[object].position) > kStill;
  poses_[object] = pose;
  if (object < scene_.objects.size()) rigid_.show(object, pose);
  else msds_->show(object - scene_.objects.size(), pose);
}

void Client::show(const TraceFrame& truth) noexcept {
  if (!receiver_) {
    for (const std::uint32_t i : *truth.changed) show_pose(i, truth.objects[i].pose);
    return;
  }
  for (std::size_t i = 0; i < truth.meshes.size(); ++i)
    if (truth.meshes[i].updated) show_shape(*receiver_, truth.tick, i);
  show_poses(*receiver_, truth.tick);
}

void Client::show(Receiver& receiver, std::int64_t tick) noexcept {
  costs_ = {};
  for (std::size_t i = 0; i < shown_.size(); ++i) {
    ShownMesh& mesh = shown_[i];
    const auto frame = static_cast<std::int64_t>(static_cast<double>(tick) / mesh.period);
    const double rests = static_cast<double>(receiver.tick(i + 1) + receiver.scene()->max_extrapolation) + mesh.period;
    const bool follows = receiver.scene()->deformables[i].body.has_value();  // the device, without a packet
    if (frame == mesh.frame || (!follows && static_cast<double>(tick) > rests)) continue;
    mesh.frame = frame;
    show_shape(receiver, tick, i);
  }
  measured(costs_.poses, [&] { show_poses(receiver, tick); });
  shown_by_ = &receiver;
  shown_tick_ = tick;
}

void Client::show_shape(Receiver& receiver, std::int64_t tick, std::size_t mesh) noexcept {
  const auto displacements = measured(costs_.shapes, [&] { return receiver.replica().displacements(mesh, tick); });
  const unsigned exp = receiver.scene()->grid.position;
  if (!prediction_) return deformables_->show(mesh, displacements, exp);
  prediction_->hear(mesh, displacements, exp, tick);
}

void Client::show_poses(Receiver& receiver, std::int64_t tick) noexcept {
  for (std::uint32_t i = 0; i < poses_.size(); ++i) {
    const Pose pose = receiver.pose(i, tick);
    if (prediction_) prediction_->hear(i, pose, tick);
    else show_pose(i, pose);
  }
}

std::span<const GridForce> Client::load(std::uint32_t object) const noexcept {
  return shown_by_ != nullptr ? shown_by_->load(object, shown_tick_) : std::span<const GridForce>();
}

/// Show what the client's own simulation makes of it.   pre  prediction_
void Client::predict(std::size_t user, std::uint32_t delay) noexcept {
  for (std::uint32_t i = 0; i < scene_.objects.size(); ++i) {
    const auto known = load(i);
    prediction_->push(i, known.empty() ? Vec3{} : others_push(known, user, shown_by_->scene()->loads->force_exp));
  }
  prediction_->correct(delay);
  for (std::uint32_t i = 0; i < poses_.size(); ++i) show_pose(i, prediction_->poses()[i]);
  for (std::size_t i = 0; i < shown_.size(); ++i)
    if (const auto shape = prediction_->new_shape(i); !shape.empty()) deformables_->show(i, shape, PastShapes::kExp);
}

void Client::touch(std::span<const DeviceSample> devices) noexcept {
  for (std::size_t i = 0; i < devices.size(); ++i) touch(i, devices[i], Rendering{});
}

/// What a user feels of an object, in spite of the delay.   pre  compensation_
Vec3 Client::soften(std::size_t user, const Touch& touch, const Vec3& device, std::uint32_t delay) noexcept {
  Compensation::Shown shown;
  if (touch.surface) {
    const DeformableObject* declared = shown_by_ != nullptr ? &shown_by_->scene()->deformables[touch.surface->mesh] : nullptr;
    if (declared != nullptr && !declared->stiffness.empty()) shown.deformable = declared;
  } else {
    const std::uint32_t object = touch.contact.object;
    shown.load = load(object);
    if (!shown.load.empty()) shown.force_exp = shown_by_->scene()->loads->force_exp;
    shown.pose = poses_[object];
    shown.moves = moves_[object];
  }
  const Vec3 force = measured(costs_.compensation, [&] { return compensation_->soften(user, touch, device, shown, delay); });
  stiffness_[user] = compensation_->stiffness(user);
  return force;
}

void Client::touch(std::size_t user, const DeviceSample& device, const Rendering& how) noexcept {
  Vec3 force;
  bool held = false;
  contacts_[user].reset();
  stiffness_[user] = 0;
  if (compensation_) compensation_->move(user, device);
  if (prediction_) measured(costs_.compensation, [&] { predict(user, how.delay); });
  for (Touchable* objects : objects_) {
    const Touch touch = objects->touch(user, device, held);
    if (touch.contact.kind != ContactKind::none) contacts_[user] = {touch.proxy, touch.contact.stiffness};
    else if (touch.surface) contacts_[user] = {touch.surface->proxy, touch.surface->stiffness};
    if (contacts_[user]) stiffness_[user] = contacts_[user]->stiffness;
    held = held || touch.contact.kind != ContactKind::none;
    const bool presses = touch.surface || touch.contact.kind == ContactKind::surface;
    force = force + (compensation_ && presses ? soften(user, touch, device.position, how.delay) : touch.force);
  }
  if (compensation_ && !contacts_[user]) compensation_->release(user);
  if (prediction_) measured(costs_.compensation, [&] { prediction_->step(device); });
  rendered_[user] = how.fraction * rendered_fraction(force, scene_.users[user].device.max_force) * force;
  if (ports_.empty()) return;
  const Vec3 passive = ports_[user].limit(device.position, rendered_[user]);
  rendered_[user] = rendered_fraction(passive, scene_.users[user].device.max_force) * passive;
}

const Pose& Client::watched(std::size_t user) const noexcept {
  const std::size_t object = scene_.users[user].object;
  return object < poses_.size() ? poses_[object] : mesh_poses_[object - poses_.size()];
}

}  // namespace tactus::sim
