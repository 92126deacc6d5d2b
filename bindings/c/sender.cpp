// SPDX-License-Identifier: Apache-2.0
#include <tactus/sender.h>

#include <algorithm>
#include <array>
#include <memory>
#include <span>

#include "bounds.h"
#include "handles.h"
#include "truth.h"

struct tactus_sender {
  tactus::Sender sender;
  tactus::c::TruthBuffer truth;
  tactus::c::Answer answer;  // of this tick
};

namespace tactus::c {
namespace {

static_assert(TACTUS_REDUCTION_NONE == static_cast<int>(Reduction::none) &&
              TACTUS_REDUCTION_DEAD_RECKONING == static_cast<int>(Reduction::dead_reckoning));
static_assert(TACTUS_BASELINE_PREVIOUS == static_cast<int>(Baseline::previous) &&
              TACTUS_BASELINE_ACKNOWLEDGED == static_cast<int>(Baseline::acknowledged));

constexpr tactus_sender_options kOptions{.size = sizeof(tactus_sender_options),
                                         .reduction = static_cast<std::int32_t>(RigidTriggers{}.reduction),
                                         .baseline = static_cast<std::int32_t>(SenderPolicy{}.baseline),
                                         .reserved = 0,
                                         .key_interval = SenderPolicy{}.key_interval,
                                         .visual_fraction = 0,
                                         .haptic_fraction = 0,
                                         .rigid = nullptr,
                                         .deformable = nullptr,
                                         .load = nullptr};

std::optional<double> fraction_of(double fraction) noexcept { return fraction == 0 ? std::nullopt : std::optional(fraction); }

}  // namespace

template <>
tactus_sender_options defaults<tactus_sender_options>() noexcept {
  return kOptions;
}

Result<SenderOptions> options_of(const tactus_sender_options* options) noexcept {
  TACTUS_TRY(const tactus_sender_options o, given_or(options, kOptions));
  if (o.reduction < TACTUS_REDUCTION_NONE || o.reduction > TACTUS_REDUCTION_DEAD_RECKONING ||
      o.baseline < TACTUS_BASELINE_PREVIOUS || o.baseline > TACTUS_BASELINE_ACKNOWLEDGED)
    return fail(Errc::invalid_argument, "R-API-4");
  SenderOptions out;
  TACTUS_TRY(out.triggers, bounds_of(o.rigid));
  out.triggers.reduction = static_cast<Reduction>(o.reduction);
  TACTUS_TRY(out.deformable.thresholds, bounds_of(o.deformable));
  out.deformable.visual_fraction = fraction_of(o.visual_fraction);
  out.deformable.haptic_fraction = fraction_of(o.haptic_fraction);
  TACTUS_TRY(out.load, bounds_of(o.load));
  out.policy = {.key_interval = o.key_interval, .baseline = static_cast<Baseline>(o.baseline)};
  return out;
}

}  // namespace tactus::c

using namespace tactus;
using namespace tactus::c;

tactus_status tactus_sender_create(const tactus_scene* scene, const tactus_sender_options* options, tactus_sender** sender,
                                   tactus_error* error) {
  return call(error, [&]() -> Outcome {
    if (scene == nullptr || !scene->shared || sender == nullptr) return refuse();
    TACTUS_TRY(const SenderOptions chosen, options_of(options));
    TACTUS_TRY(Sender made, Sender::create(scene->shared, chosen));
    *sender = new tactus_sender{std::move(made), TruthBuffer(*scene->shared), Answer(*scene->shared)};
    return TACTUS_OK;
  });
}

void tactus_sender_destroy(tactus_sender* sender) { delete sender; }

tactus_status tactus_sender_encode(tactus_sender* sender, int64_t tick, const tactus_truth* truth, tactus_encoded* encoded,
                                   tactus_error* error) {
  return call(error, [&]() -> Outcome {
    if (sender == nullptr) return refuse();
    TACTUS_CHECK(check_answer(encoded));
    sender->answer.clear();
    TACTUS_TRY(const Truth taken, sender->truth.of(truth));
    TACTUS_TRY(const auto packets, sender->sender.encode(tick, taken, sender->truth.number()));
    sender->answer.take(*sender->sender.scene(), tick, packets, sender->sender.held());
    answer(encoded, sender->answer.given());
    return TACTUS_OK;
  });
}

tactus_status tactus_sender_request_key(tactus_sender* sender, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    if (sender == nullptr) return refuse();
    sender->sender.request_key();
    return TACTUS_OK;
  });
}

tactus_status tactus_sender_acknowledge(tactus_sender* sender, uint32_t substream, uint64_t number, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    if (sender == nullptr || substream >= substreams_of(*sender->sender.scene())) return refuse();
    sender->sender.acknowledge(substream, number);
    return TACTUS_OK;
  });
}

tactus_status tactus_sender_set_link(tactus_sender* sender, int64_t ack_timeout, double loss, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    if (sender == nullptr) return refuse();
    if (ack_timeout < 0 || ack_timeout > kLastTick || !(loss >= 0 && loss <= 1)) return fail(Errc::invalid_argument, "R-API-4");
    sender->sender.set_link({.ack_timeout = ack_timeout, .loss = loss});
    return TACTUS_OK;
  });
}

tactus_status tactus_sender_set_viewpoints(tactus_sender* sender, const double* viewpoints, size_t count, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    if (sender == nullptr || (viewpoints == nullptr && count > 0)) return refuse();
    std::array<Vec3, 2> out;
    const std::size_t used = std::min(count, out.size());
    for (std::size_t i = 0; i < used; ++i) out[i] = {viewpoints[3 * i], viewpoints[3 * i + 1], viewpoints[3 * i + 2]};
    sender->sender.set_viewpoints(std::span(out).first(used));
    return TACTUS_OK;
  });
}
