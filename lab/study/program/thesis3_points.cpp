// SPDX-License-Identifier: Apache-2.0
/// Points of `tactus reproduce` for chapter 3 of the thesis: pushes over a perfect network.
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <tactus/metrics/errors.h>
#include <tactus/receiver.h>
#include <tactus/rigid/trigger.h>
#include <tactus/sim/random.h>
#include <tactus/sim/simulation.h>
#include <tactus/sim/user/hand.h>
#include <tactus/thesis/force_signal.h>
#include <tactus/thesis/thesis.h>
#include "cli/report/table.h"
#include "lab/study/program/points.h"

namespace tactus::study {
namespace {

Interpolation interpolation_of(const std::string& name) {
  if (name == "none") return Interpolation::none;
  if (name == "linear") return Interpolation::linear;
  if (name == "hermite") return Interpolation::hermite;
  if (name == "blending") return Interpolation::blending;
  refuse_request("there is no interpolation \"" + name + "\"", "Give none, linear, hermite or blending.");
}

/// "deadband", "visual_position_m", "visual_rotation_rad", "profile".
sim::ChannelOptions channel_of(Request& request) {
  sim::ChannelOptions out;
  out.limits.thesis = &thesis_component;
  RigidTriggers& triggers = out.sender.triggers;
  triggers.weber_fraction = request.get("deadband", triggers.weber_fraction);
  triggers.visual_position = request.get("visual_position_m", triggers.visual_position);
  triggers.visual_rotation = request.get("visual_rotation_rad", triggers.visual_rotation);
  out.coding.rigid = request.get<std::string>("profile", "thesis") == "main" ? RigidProfile::main : RigidProfile::thesis;
  return out;
}

/// A client and what it showed last.
class Watcher {
 public:
  struct Effect {
    std::uint64_t ticks = 0, over = 0;  ///< in contact; out of the haptic rule
    double worst = 0;                   ///< error over what the rule permits
    std::vector<double> steps;          ///< change of the force error within the tick of an update, over the force
    std::vector<double> accelerations;  ///< [m/s^2] of the shown object between updates, in contact
  };

  explicit Watcher(Receiver receiver) : receiver_(std::move(receiver)) {}

  static Result<Watcher> create(const SharedScene& scene, Interpolation interpolation) {
    TACTUS_TRY(Receiver receiver,
               Receiver::create(scene, {.replica = {.interpolation = interpolation}, .limits = {.thesis = &thesis_component}}));
    return Watcher(std::move(receiver));
  }
  Result<void> take(std::span<const Packet> packets) {
    for (const Packet& packet : packets) TACTUS_CHECK(receiver_.push(packet.number, packet.bytes));
    return {};
  }
  /// [N] at the pose shown now; the client keeps what it showed.
  Vec3 look(const TraceFrame& frame, const Contact& contact, bool updated, const RigidTriggers& triggers) {
    const Pose shown = receiver_.pose(contact.object, frame.tick);
    const Vec3 force = contact_force(contact, frame.objects[contact.object].pose), estimate = contact_force(contact, shown);
    const double ratio = haptic_ratio(triggers, force, estimate);
    ++effect_.ticks;
    effect_.over += ratio > 1 ? 1 : 0;
    effect_.worst = std::max(effect_.worst, ratio);
    const Vec3 error = estimate - force;
    if (updated && error_ && norm(force) > triggers.force_floor) effect_.steps.push_back(norm(error - *error_) / norm(force));
    error_ = error;
    since_update_ = updated ? 0 : since_update_ + 1;
    if (since_update_ >= 2 && known_ >= 2)
      effect_.accelerations.push_back(norm(shown.position - 2 * before_ + before_that_) / (sim::kTick * sim::kTick));
    before_that_ = before_;
    before_ = shown.position;
    ++known_;
    return estimate;
  }
  void let_go() {
    error_.reset();
    known_ = 0;
  }
  const Effect& effect() const { return effect_; }

 private:
  Receiver receiver_;
  Effect effect_;
  std::optional<Vec3> error_;
  Vec3 before_, before_that_;
  int since_update_ = 0, known_ = 0;
};

/// Adds up packets and the error of what is rendered, tick by tick.
class Counter {
 public:
  void add(const UserSample& user, std::size_t packets, const Vec3& rendered) {
    ++ticks_;
    packets_ += packets;
    if (norm(user.server_force) == 0 && norm(rendered) == 0) return;
    ++contact_;
    contact_packets_ += packets;
    const Vec3 error = rendered - user.server_force;
    square_ += dot(error, error);
  }
  Json json() const {
    const auto per_second = [](std::size_t count, std::size_t ticks) {
      return ticks == 0 ? 0 : static_cast<double>(count) * sim::kTickRate / static_cast<double>(ticks);
    };
    return {{"packets_per_s", per_second(packets_, ticks_)},
            {"packets_per_s_in_contact", per_second(contact_packets_, contact_)},
            {"force_error_rms_N", contact_ == 0 ? 0 : std::sqrt(square_ / static_cast<double>(contact_))}};
  }

 private:
  std::size_t ticks_ = 0, contact_ = 0, packets_ = 0, contact_packets_ = 0;
  double square_ = 0;
};

/// The client renders what it receives of the object.
Json with_states(const sim::Scene& scene, const sim::ChannelOptions& channel, sim::Grip grip, std::uint64_t seed) {
  auto simulation = need(sim::Simulation::create(scene, {.seed = seed, .grip = grip, .channel = channel}), scene.name);
  Counter counter;
  for (std::int64_t tick = 0; tick < simulation.ticks(); ++tick) {
    const auto packets = need(simulation.step());
    const UserSample& user = simulation.frame().users[0];
    counter.add(user, packets.size(), user.force);
  }
  return counter.json();
}

/// The server renders, and the hand feels what it receives of the force.
Json with_forces(const sim::Scene& scene, const ForceCoding& coding, sim::Grip grip, std::uint64_t seed) {
  sim::SimulationOptions settings;
  settings.seed = seed;
  auto simulation = need(sim::Simulation::create(scene, settings), scene.name);
  auto sender = need(ForceSender::create(coding, sim::kTickRate), scene.name);
  ForceReceiver receiver(sim::kTickRate);
  sim::Random seeds(seed);
  sim::Hand hand(scene.users[0], grip, seeds.next());
  std::vector<DeviceSample> devices(1);
  Counter counter;
  for (std::int64_t tick = 0; tick < simulation.ticks(); ++tick) {
    const Vec3 rendered = receiver.force(tick);
    devices[0] = hand.step(rendered, simulation.client_poses()[scene.users[0].object]);
    need(simulation.step(devices));
    const UserSample& user = simulation.frame().users[0];
    const auto sample = need(sender.encode(tick, user.server_force), scene.name, cli::location_of_tick(tick));
    if (!sample.empty()) need(receiver.push(sample), scene.name, cli::location_of_tick(tick));
    counter.add(user, sample.empty() ? 0 : 1, receiver.force(tick));
  }
  return counter.json();
}

}  // namespace

Json push_point(Request& request) {
  const sim::Scene scene = scene_of(request);
  sim::ChannelOptions channel = channel_of(request);
  channel.replica.interpolation = interpolation_of(request.get<std::string>("interpolation", "none"));
  const sim::Grip grip = grip_of_request(request);
  const auto seed = request.get<std::uint64_t>("seed", 1);
  const auto more = request.get<std::int64_t>("ticks_more", 0);
  request.check_all_known();
  auto simulation = need(sim::Simulation::create(scene, {.seed = seed, .grip = grip, .channel = channel}), scene.name);
  Json rendered = Json::array(), server = Json::array(), position = Json::array(), shown = Json::array(), update = Json::array();
  for (std::int64_t tick = 0; tick < simulation.ticks() + more; ++tick) {
    const auto packets = need(simulation.step());
    const TraceFrame& frame = simulation.frame();
    rendered.push_back(frame.users[0].force.x);
    server.push_back(frame.users[0].server_force.x);
    position.push_back(frame.objects[0].pose.position.x);
    shown.push_back(simulation.client_poses()[0].position.x);
    update.push_back(packets.empty() ? Json(nullptr) : Json(cli::kReasons[static_cast<std::size_t>(packets.front().reason)]));
  }
  return {{"force_rendered_N", std::move(rendered)},
          {"force_server_N", std::move(server)},
          {"position_m", std::move(position)},
          {"position_shown_m", std::move(shown)},
          {"update", std::move(update)}};
}

Json interpolations_point(Request& request) {
  const sim::Scene scene = scene_of(request);
  const sim::ChannelOptions channel = channel_of(request);
  const auto names = request.get<std::vector<std::string>>("interpolations");
  const sim::Grip grip = grip_of_request(request);
  const auto seed = request.get<std::uint64_t>("seed", 1);
  const bool wants_curves = request.get("curves", false);
  request.check_all_known();
  auto simulation = need(sim::Simulation::create(scene, {.seed = seed, .grip = grip, .channel = channel}), scene.name);
  std::vector<Watcher> watchers;
  for (const std::string& name : names)
    watchers.push_back(need(Watcher::create(simulation.stream_scene(), interpolation_of(name)), scene.name));
  std::uint64_t sent = 0;
  Json curves = Json::array();
  for (std::int64_t tick = 0; tick < simulation.ticks(); ++tick) {
    const auto packets = need(simulation.step());
    sent += packets.size();
    const TraceFrame& frame = simulation.frame();
    const Contact& contact = frame.users[0].contact;
    std::vector<double> row(1 + watchers.size());
    if (contact.kind != ContactKind::none) row[0] = norm(contact_force(contact, frame.objects[contact.object].pose));
    for (std::size_t i = 0; i < watchers.size(); ++i) {
      need(watchers[i].take(packets), scene.name, cli::location_of_tick(tick));
      if (contact.kind == ContactKind::none) watchers[i].let_go();
      else row[1 + i] = norm(watchers[i].look(frame, contact, !packets.empty(), channel.sender.triggers));
    }
    if (wants_curves) curves.push_back(row);
  }
  Json out{{"packets_per_s", static_cast<double>(sent) / (sim::kTick * static_cast<double>(simulation.ticks()))},
           {"interpolations", Json::array()}};
  for (std::size_t i = 0; i < watchers.size(); ++i) {
    const Watcher::Effect& e = watchers[i].effect();
    out["interpolations"].push_back({{"interpolation", names[i]},
                                     {"ticks_in_contact", e.ticks},
                                     {"ticks_over", e.over},
                                     {"worst_ratio", e.worst},
                                     {"force_steps", e.steps},
                                     {"accelerations_m_per_s2", e.accelerations}});
  }
  if (wants_curves) out["curves"] = std::move(curves);
  return out;
}

Json rates_point(Request& request) {
  sim::Scene scene = scene_of(request);
  if (request.has("duration_scale")) sim::scale_durations(scene, request.get<double>("duration_scale"));
  if (request.has("tremor_m")) sim::set_tremor(scene, request.get<double>("tremor_m"));
  const sim::Grip grip = grip_of_request(request);
  const auto seed = request.get<std::uint64_t>("seed", 1);
  const auto sent = request.get<std::string>("sent");
  if (sent == "states") {
    sim::ChannelOptions channel = channel_of(request);
    channel.replica.interpolation = interpolation_of(request.get<std::string>("interpolation", "none"));
    request.check_all_known();
    return with_states(scene, channel, grip, seed);
  }
  if (sent != "forces") refuse_request("\"sent\": \"" + sent + "\"", "Give states or forces.");
  const auto predictor = request.get<std::string>("predictor");
  if (predictor != "hold" && predictor != "linear")
    refuse_request("there is no predictor \"" + predictor + "\"", "Give hold or linear.");
  const ForceCoding coding{.rule = ForceRule::weber,
                           .predictor = predictor == "hold" ? ForcePredictor::hold : ForcePredictor::linear,
                           .weber_fraction = request.get<double>("deadband")};
  request.check_all_known();
  return with_forces(scene, coding, grip, seed);
}

}  // namespace tactus::study
