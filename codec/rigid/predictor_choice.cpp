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

bool PredictorChoice::is_candidate(std::uint32_t object, const RigidState& truth, Predictor predictor) const noexcept {
  if (predictor == Predictor::linear) return true;
  if (predictor == Predictor::driven) return predictor_.knows_device() && truth.contact != DrivenContact{};
  if (!scene_.motion) return false;
  const MotionConstants& motion = *scene_.motion;
  if (predictor == Predictor::slide) return motion.slide_deceleration != 0;
  for (std::size_t i = 0; i < 3; ++i)
    if (motion.gravity[i] != 0 && !(scene_.objects[object].dof >> i & 1u)) return false;
  return motion.gravity != Vec3i{};
}

PredictorChoice::Record PredictorChoice::record_of(Predictor predictor, std::uint32_t object, const RigidState& truth,
                                                   const PermittedError& permitted, std::size_t enough) const noexcept {
  Record out;
  for (std::size_t age = 0; age < count_ && out.served < enough; age += 1 + age / 2) {
    RigidState from = past_[object * kKept + (newest_ + kKept - age) % kKept];
    if (from.tick == truth.tick) continue;
    if (truth.tick - from.tick > longest_) break;
    if (predictor == Predictor::driven && from.contact == DrivenContact{}) break;
    from.predictor = predictor;
    const double e = error(predictor_.shown(object, from, truth.tick), truth, permitted, scene_.grid.position);
    if (e > 1) break;
    out.error += e;
    ++out.served;
  }
  return out;
}

Predictor PredictorChoice::choose(std::uint32_t object, const RigidState& truth, const PermittedError& permitted) const noexcept {
  Predictor best = Predictor::linear;
  Record most = record_of(best, object, truth, permitted, kKept);
  for (const Predictor predictor : {Predictor::ballistic, Predictor::slide, Predictor::driven}) {
    if (!is_candidate(object, truth, predictor)) continue;
    const std::size_t enough = predictor == Predictor::driven ? most.served + 1 : kKept;  // it takes its time
    const Record record = record_of(predictor, object, truth, permitted, enough);
    if (record.served < most.served || (record.served == most.served && record.error >= most.error)) continue;
    best = predictor;
    most = record;
  }
  return best;
}

}  // namespace tactus
