// SPDX-License-Identifier: Apache-2.0
#include "cli/observe/observed_stream.h"

#include <algorithm>
#include <utility>

#include "cli/report/json.h"
#include "cli/viewer/page.h"

namespace tactus::cli {

// ==== tick queue ====

namespace {

constexpr std::size_t kMostBytes = std::size_t{32} << 20;   // of all slots, but for large meshes
constexpr std::size_t kFewestSlots = 16, kMostSlots = 512;  // half a second at 1 kHz

std::size_t slots_for(const TraceFrame& frame, std::size_t loads, std::size_t users) {
  std::size_t bytes = sizeof(ObservedTick) + frame.objects.size() * sizeof(RigidSample) +
                      frame.users.size() * sizeof(UserSample) + loads * (sizeof(ObjectLoad) + users * sizeof(Vec3));
  for (const DeformableSample& mesh : frame.meshes) bytes += mesh.displacements.size() * sizeof(float);
  return std::clamp(kMostBytes / bytes, kFewestSlots, kMostSlots);
}

}  // namespace

TickQueue::TickQueue(const TraceFrame& like, std::size_t loads, std::size_t users)
    : slots_(slots_for(like, loads, users)), owed_(like.meshes.size(), true) {
  for (ObservedTick& slot : slots_) {
    slot.frame = like;
    slot.frame.changed.reset();
    slot.loads.resize(loads);
    slot.pushes.resize(loads * users);
  }
}

void TickQueue::offer(const TraceFrame& frame, std::span<const ObjectLoad> loads) noexcept {
  const std::uint32_t watch = watch_.load(std::memory_order_acquire);
  if (watch % 2 == 0) return;
  if (std::exchange(seen_, watch) != watch) std::fill(owed_.begin(), owed_.end(), true);
  const std::size_t offered = offered_.load(std::memory_order_relaxed);
  if (offered - taken_.load(std::memory_order_acquire) == slots_.size()) {
    for (std::size_t i = 0; i < owed_.size(); ++i) owed_[i] = owed_[i] || frame.meshes[i].updated;
    left_out_.store(left_out_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
    return;
  }
  copy(frame, loads, slots_[offered % slots_.size()]);
  offered_.store(offered + 1, std::memory_order_release);
}

void TickQueue::copy(const TraceFrame& frame, std::span<const ObjectLoad> loads, ObservedTick& to) noexcept {
  to.frame.tick = frame.tick;
  std::ranges::copy(frame.objects, to.frame.objects.begin());
  for (std::size_t i = 0; i < frame.users.size(); ++i) {
    const UserSample& user = frame.users[i];
    to.frame.users[i] = {.device = user.device,
                         .contact = user.contact,
                         .force = user.force,
                         .server_force = user.server_force,
                         .surface_contact = user.surface_contact};
  }
  for (std::size_t i = 0; i < frame.meshes.size(); ++i) {
    DeformableSample& mesh = to.frame.meshes[i];
    mesh.updated = frame.meshes[i].updated || owed_[i];
    owed_[i] = false;
    if (mesh.updated) std::ranges::copy(frame.meshes[i].displacements, mesh.displacements.begin());
  }
  auto push = to.pushes.begin();
  for (std::size_t i = 0; i < loads.size(); ++i) {
    const auto first = push;
    push = std::ranges::copy(loads[i].pushes, push).out;
    to.loads[i] = {loads[i].external, loads[i].hold, {first, push}};
  }
}

void TickQueue::begin_watch() noexcept {
  while (front() != nullptr) pop();
  watch_.store((watch_.load(std::memory_order_relaxed) + 1) | 1U, std::memory_order_release);
}

void TickQueue::end_watch() noexcept {
  watch_.store((watch_.load(std::memory_order_relaxed) + 1) & ~1U, std::memory_order_release);
}

const ObservedTick* TickQueue::front() const noexcept {
  const std::size_t taken = taken_.load(std::memory_order_relaxed);
  return taken == offered_.load(std::memory_order_acquire) ? nullptr : &slots_[taken % slots_.size()];
}

void TickQueue::pop() noexcept { taken_.store(taken_.load(std::memory_order_relaxed) + 1, std::memory_order_release); }

// ==== observed stream ====

Result<std::unique_ptr<ObservedStream>> ObservedStream::create(const ObservedScene& scene, const ObservedTick& first) {
  SenderOptions options = scene.sender;
  options.policy = {.key_interval = 0};  // keys are asked for at the beginning of a batch
  TACTUS_TRY(PacketLog packets, PacketLog::create(scene.declared, options));
  TACTUS_TRY(TruthData truth, TruthData::create(scene.info, first.frame, *scene.declared));
  TACTUS_TRY(std::string declaration, declaration_of(*scene.declared));
  TACTUS_TRY(Json ghost, truth.declare());
  ghost["name"] = "server";
  std::unique_ptr<ObservedStream> stream(new ObservedStream(scene, std::move(packets), std::move(truth)));
  stream->hello_ = page_json({{"version", 1},
                              {"name", scene.name},
                              {"scene", std::move(declaration)},
                              {"shapes", scene.shapes},
                              {"truth", std::move(ghost)}});
  return stream;
}

ObservedStream::ObservedStream(const ObservedScene& scene, PacketLog packets, TruthData truth)
    : frame_truth_(scene.info),
      has_loads_(scene.declared->loads.has_value()),
      key_spacing_(scene.info.tick_rate),
      packets_(std::move(packets)),
      truth_(std::move(truth)) {}

Result<void> ObservedStream::add(const ObservedTick& tick) {
  if (!is_begun_ && (key_tick_ < 0 || tick.frame.tick - key_tick_ >= key_spacing_)) {
    is_key_ = true;
    key_tick_ = tick.frame.tick;
    packets_.request_key();
    truth_.request_key();
  }
  is_begun_ = true;
  tick_ = tick.frame.tick;
  Truth truth = frame_truth_.of(tick.frame);
  if (has_loads_) truth.loads = tick.loads;
  TACTUS_CHECK(packets_.add(tick_, truth));
  return truth_.add(tick.frame, packets_.replica());
}

ObservedStream::Batch ObservedStream::take(std::uint64_t left_out) {
  Json out = packets_.take();
  out["last_tick"] = tick_;
  out["left_out"] = left_out;
  out["key"] = is_key_;
  if (is_key_) out["hashes"] = packets_.hashes();
  out["truth"] = truth_.take();
  is_begun_ = false;
  return {page_json(out), std::exchange(is_key_, false)};
}

}  // namespace tactus::cli
