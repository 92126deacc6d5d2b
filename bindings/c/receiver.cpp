// SPDX-License-Identifier: Apache-2.0
#include <tactus/receiver.h>

#include <algorithm>
#include <memory>
#include <vector>

#include <tactus/packet/substream.h>

#include "handles.h"

namespace tactus::c {
namespace {

static_assert(TACTUS_REASON_REQUEST == static_cast<int>(Reason::request) &&
              TACTUS_REASON_HEARTBEAT == static_cast<int>(Reason::heartbeat) &&
              TACTUS_REASON_VISUAL == static_cast<int>(Reason::visual) &&
              TACTUS_REASON_HAPTIC == static_cast<int>(Reason::haptic));
static_assert(TACTUS_LAYER_HAPTIC == static_cast<int>(Layer::haptic) && TACTUS_LAYER_VISUAL == static_cast<int>(Layer::visual) &&
              TACTUS_LAYER_ALL == static_cast<int>(Layer::all));
static_assert(TACTUS_INTERPOLATION_NONE == static_cast<int>(Interpolation::none) &&
              TACTUS_INTERPOLATION_LINEAR == static_cast<int>(Interpolation::linear) &&
              TACTUS_INTERPOLATION_HERMITE == static_cast<int>(Interpolation::hermite) &&
              TACTUS_INTERPOLATION_BLENDING == static_cast<int>(Interpolation::blending) &&
              TACTUS_INTERPOLATION_PLAYOUT == static_cast<int>(Interpolation::playout));

constexpr tactus_receiver_options kOptions{.size = sizeof(tactus_receiver_options),
                                           .interpolation = TACTUS_INTERPOLATION_NONE,
                                           .fraction = ReplicaOptions{}.fraction,
                                           .shortest = ReplicaOptions{}.shortest,
                                           .longest = ReplicaOptions{}.longest,
                                           .limits = nullptr};

Result<Receiver*> receiver_of(const tactus_receiver* receiver) noexcept {
  if (receiver == nullptr || receiver->at == nullptr) return refuse();
  return receiver->at;
}

}  // namespace

template <>
tactus_receiver_options defaults<tactus_receiver_options>() noexcept {
  return kOptions;
}

Result<ReceiverOptions> options_of(const tactus_receiver_options* options) noexcept {
  TACTUS_TRY(const tactus_receiver_options o, given_or(options, kOptions));
  TACTUS_TRY(const DecodeLimits limits, limits_of(o.limits));
  if (o.interpolation < TACTUS_INTERPOLATION_NONE || o.interpolation > TACTUS_INTERPOLATION_PLAYOUT)
    return fail(Errc::invalid_argument, "R-API-4");
  return ReceiverOptions{.replica = {.interpolation = static_cast<Interpolation>(o.interpolation),
                                     .fraction = o.fraction,
                                     .shortest = o.shortest,
                                     .longest = o.longest},
                         .limits = limits};
}

static Outcome skip(Receiver& receiver, std::uint64_t number) noexcept {
  if (!is_number(number)) return fail(Errc::invalid_argument, "R-API-5");
  receiver.skip_number(number);
  return TACTUS_OK;
}

tactus_packet_info info_of(const Scene& scene, const DecodedPacket& packet) noexcept {
  Reason reason = Reason::request;
  for (const RigidUpdate& update : packet.updates) reason = std::max(reason, update.reason);
  return {.size = 0,
          .bytes = 0,
          .tick = packet.tick,
          .number = packet.number,
          .offset = 0,
          .substream = static_cast<std::uint32_t>(packet.substream),
          .kind = kind_of(scene, packet.substream),
          .key = packet.key,
          .layer = static_cast<std::uint32_t>(packet.layer),
          .reason = static_cast<std::uint32_t>(reason),
          .updates = static_cast<std::uint32_t>(packet.updates.size()) + packet.loads + packet.vertices};
}

}  // namespace tactus::c

using namespace tactus;
using namespace tactus::c;

tactus_status tactus_receiver_create(const tactus_scene* scene, const tactus_receiver_options* options,
                                     tactus_receiver** receiver, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    if (scene == nullptr || !scene->shared || receiver == nullptr) return refuse();
    TACTUS_TRY(const ReceiverOptions chosen, options_of(options));
    TACTUS_TRY(Receiver made, Receiver::create(scene->shared, chosen));
    auto out = std::make_unique<tactus_receiver>();
    out->own.emplace(std::move(made));
    out->borrow(&*out->own);
    *receiver = out.release();
    return TACTUS_OK;
  });
}

void tactus_receiver_destroy(tactus_receiver* receiver) {
  if (receiver != nullptr && receiver->own) delete receiver;
}

const tactus_scene* tactus_receiver_scene(const tactus_receiver* receiver) {
  return receiver_of(receiver) ? &receiver->scene : nullptr;
}

tactus_status tactus_receiver_push(tactus_receiver* receiver, uint64_t number, const uint8_t* packet, size_t size, int64_t now,
                                   tactus_packet_info* info, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    TACTUS_TRY(Receiver * to, receiver_of(receiver));
    if (!receiver->own) return refuse();  // a player or a session pushes to its own
    TACTUS_TRY(const auto bytes, span_of(packet, size));
    if (packet == nullptr) return skip(*to, number);
    if (info != nullptr) TACTUS_CHECK(check_answer(info));
    std::optional<std::int64_t> applied;
    if (now != TACTUS_PACKET_TICK) {
      TACTUS_CHECK(check_tick(now));
      applied = now;
    }
    receiver->updates = {};
    TACTUS_TRY(const DecodedPacket decoded, to->push(number, bytes, applied));
    receiver->updates = decoded.updates;
    if (info == nullptr) return TACTUS_OK;
    tactus_packet_info out = info_of(*to->scene(), decoded);
    out.bytes = static_cast<std::uint32_t>(size);
    answer(info, out);
    return TACTUS_OK;
  });
}

tactus_status tactus_receiver_updates(const tactus_receiver* receiver, tactus_update* out, size_t capacity, size_t* count,
                                      tactus_error* error) {
  return call(error, [&]() -> Outcome {
    TACTUS_CHECK(receiver_of(receiver));
    if (count == nullptr || (out == nullptr && capacity > 0)) return refuse();
    *count = receiver->updates.size();
    if (out == nullptr || capacity < *count) return *count == 0 ? TACTUS_OK : TACTUS_BUFFER_TOO_SMALL;
    for (const RigidUpdate& update : receiver->updates)
      *out++ = {update.object, static_cast<std::uint32_t>(update.reason), update.level};
    return TACTUS_OK;
  });
}

tactus_status tactus_receiver_poses(const tactus_receiver* receiver, int64_t tick, uint32_t first, size_t count,
                                    tactus_pose* poses, uint8_t* levels, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    TACTUS_TRY(Receiver * of, receiver_of(receiver));
    TACTUS_CHECK(check_tick(tick));
    const std::size_t there = of->scene()->objects.size();
    if (first > there || count > there - first) return refuse();
    for (std::size_t i = 0; i < count; ++i) {
      const auto object = first + static_cast<std::uint32_t>(i);
      if (poses != nullptr) poses[i] = pose_of(of->pose(object, tick));
      if (levels != nullptr) levels[i] = of->replica().lod(object, tick);
    }
    return TACTUS_OK;
  });
}

tactus_status tactus_receiver_displacements(tactus_receiver* receiver, uint32_t object, int64_t tick, float* out, size_t capacity,
                                            tactus_error* error) {
  return call(error, [&]() -> Outcome {
    TACTUS_TRY(Receiver * of, receiver_of(receiver));
    TACTUS_CHECK(check_tick(tick));
    const Scene& scene = *of->scene();
    if (object >= scene.deformables.size() || out == nullptr) return refuse();
    if (capacity < 3 * scene.deformables[object].rest.size()) return TACTUS_BUFFER_TOO_SMALL;
    metres_of(of->replica().displacements(object, tick), scene.grid.position, out);
    return TACTUS_OK;
  });
}

tactus_status tactus_receiver_loads(const tactus_receiver* receiver, uint32_t object, int64_t tick, double* out, size_t capacity,
                                    tactus_error* error) {
  return call(error, [&]() -> Outcome {
    TACTUS_TRY(Receiver * of, receiver_of(receiver));
    TACTUS_CHECK(check_tick(tick));
    const Scene& scene = *of->scene();
    if (object >= scene.objects.size() || out == nullptr) return refuse();
    const auto load = of->load(object, tick);
    if (load.empty()) return TACTUS_NOTHING;
    if (capacity < 3 * load.size()) return TACTUS_BUFFER_TOO_SMALL;
    for (const GridForce& vector : load) {
      const Vec3 force = to_force(vector, scene.loads->force_exp);
      for (const double component : {force.x, force.y, force.z}) *out++ = component;
    }
    return TACTUS_OK;
  });
}

tactus_status tactus_receiver_hash(const tactus_receiver* receiver, uint32_t substream, uint64_t* state, int64_t tick,
                                   uint64_t* poses, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    TACTUS_TRY(Receiver * of, receiver_of(receiver));
    if (state != nullptr && substream >= substreams_of(*of->scene())) return refuse();
    if (poses != nullptr) TACTUS_CHECK(check_tick(tick));
    if (state != nullptr) *state = of->state_hash(substream);
    if (poses != nullptr) *poses = of->replica().pose_hash(tick);
    return TACTUS_OK;
  });
}
