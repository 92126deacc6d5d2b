// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/predictor_choice.h>

#include <algorithm>
#include <array>
#include <cmath>

#include <tactus/base/fixed.h>

namespace tactus {
namespace {

constexpr double kSpacing = 0.005, kLongest = 0.15;  // [s]

/// Over what is permitted: 1 at the bound.
double error(const RigidPose& shown, const RigidState& truth, const PermittedError& permitted, unsigned exponent) noexcept {
  double distance = 0, half = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double d = static_cast<double>(truth.position[i]) - shown.position[i];
    distance += d * d;
  }
  const Quat30 turn = multiply(truth.rotation, conjugate(shown.rotation));
  for (std::size_t i = 1; i < 4; ++i) half += static_cast<double>(turn[i]) * turn[i];
  return std::max(std::ldexp(std::sqrt(distance), -static_cast<int>(exponent)) / permitted.position,
                  std::sqrt(half) * 0x1p-29 / permitted.rotation);
}

}  // namespace

PredictorChoice::PredictorChoice(const Scene& scene)
    : scene_(scene),
      predictor_(scene),
      spacing_(static_cast<std::int64_t>(std::ceil(kSpacing * scene.tick_rate))),
      longest_(static_cast<std::int64_t>(std::floor(kLongest * scene.tick_rate))),
      past_(kKept * scene.objects.size()) {}

void PredictorChoice::read(std::int64_t tick, std::span<const RigidState> truth) noexcept {
  if (count_ > 0 && tick - past_[scene_.moving()[0] * kKept + newest_].tick < spacing_) return;
  newest_ = (newest_ + 1) % kKept;
  count_ = std::min(count_ + 1, kKept);
  for (const std::uint32_t i : scene_.moving()) past_[i * kKept + newest_] = truth[i];
}

bool PredictorChoice::is_declared_for(std::uint32_t object, Predictor predictor) const noexcept {
  if (!scene_.motion) return false;
  const MotionConstants& motion = *scene_.motion;
  if (predictor == Predictor::slide) return motion.slide_deceleration != 0;
  for (std::size_t i = 0; i < 3; ++i)
    if (motion.gravity[i] != 0 && !(scene_.objects[object].dof >> i & 1u)) return false;
  return !is_zero(motion.gravity);
}

const RigidState* PredictorChoice::start(std::uint32_t object, std::int64_t now, std::size_t n) const noexcept {
  constexpr std::array<std::size_t, 8> kAges{0, 1, 2, 4, 7, 11, 17, 26};
  const auto kept = [&](std::size_t age) { return &past_[object * kKept + (newest_ + kKept - age) % kKept]; };
  if (count_ > 0 && kept(0)->tick == now) ++n;
  if (n >= kAges.size() || kAges[n] >= count_) return nullptr;
  const RigidState* const out = kept(kAges[n]);
  return now - out->tick > longest_ ? nullptr : out;
}

double PredictorChoice::error_of(Predictor predictor, std::uint32_t object, RigidState from, const RigidState& truth,
                                 const PermittedError& permitted) const noexcept {
  from.predictor = predictor;
  return error(predictor_.shown(object, from, truth.tick), truth, permitted, scene_.grid.position);
}

PredictorChoice::Record PredictorChoice::record_of(Predictor predictor, std::uint32_t object, const RigidState& truth,
                                                   const PermittedError& permitted) const noexcept {
  Record out;
  while (const RigidState* const from = start(object, truth.tick, out.served)) {
    const double e = error_of(predictor, object, *from, truth, permitted);
    if (e > 1) break;
    out.error += e;
    ++out.served;
  }
  return out;
}

bool PredictorChoice::drives_on(std::uint32_t object, const RigidState& truth, const PermittedError& permitted,
                                const RigidState& current) const noexcept {
  if (current.predictor != Predictor::driven) return false;
  std::size_t n = 0;
  const RigidState* from = start(object, truth.tick, n);
  while (from != nullptr && from->tick > current.tick) from = start(object, truth.tick, ++n);
  return from != nullptr && error_of(Predictor::linear, object, *from, truth, permitted) > 1;
}

bool PredictorChoice::is_driven(std::uint32_t object, const RigidState& truth, const PermittedError& permitted, Predictor other,
                                std::size_t served) const noexcept {
  for (std::size_t n = served + 1; n-- > 0;) {
    const RigidState* const from = start(object, truth.tick, n);
    if (from == nullptr || from->contact == DrivenContact{}) continue;
    return error_of(Predictor::driven, object, *from, truth, permitted) < error_of(other, object, *from, truth, permitted);
  }
  return false;
}

Predictor PredictorChoice::choose(std::uint32_t object, const RigidState& truth, const PermittedError& permitted, bool is_touched,
                                  const RigidState& current) const noexcept {
  const bool may_be_driven = predictor_.knows_device() && truth.contact != DrivenContact{};
  Predictor best = Predictor::linear;
  if (is_touched && !may_be_driven) return best;
  if (may_be_driven && drives_on(object, truth, permitted, current)) return Predictor::driven;
  Record most = record_of(best, object, truth, permitted);
  for (const Predictor predictor : {Predictor::ballistic, Predictor::slide}) {
    if (is_touched || !is_declared_for(object, predictor)) continue;
    const Record record = record_of(predictor, object, truth, permitted);
    if (record.served < most.served || (record.served == most.served && record.error >= most.error)) continue;
    best = predictor;
    most = record;
  }
  return may_be_driven && is_driven(object, truth, permitted, best, most.served) ? Predictor::driven : best;
}

}  // namespace tactus
