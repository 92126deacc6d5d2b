// SPDX-License-Identifier: Apache-2.0
#include <tactus/load/load_encoder.h>

#include <algorithm>
#include <cmath>

#include <tactus/base/rule.h>

namespace tactus {
namespace {

constexpr double kBaselineFraction = 0.5;  // of a bound that the baseline of an object may be off before a packet names it
constexpr double kRoundingFraction = 0.25;
constexpr unsigned kCoarsest = 7;
constexpr double kRounding = 0.87;                  // of the truth to the grid: half the diagonal of a cell
constexpr double kSomeLoss = 0.003, kSoon = 0.020;  // fraction of packets; [s] after the last sending where so many are lost

double square(double v) noexcept { return v * v; }

double length_squared(const Vec3i& v) noexcept {
  return square(static_cast<double>(v[0])) + square(static_cast<double>(v[1])) + square(static_cast<double>(v[2]));
}

/// What a signed magnitude can carry: 31 bits (R-RNG-4).
std::int32_t codable(std::int64_t v) noexcept { return saturate32(std::max<std::int64_t>(v, -0x7fffffff)); }

Vec3i steps_to(const Vec3i& base, const Vec3i& truth, unsigned level) noexcept {
  Vec3i out{};
  for (std::size_t a = 0; a < 3; ++a) out[a] = codable(round_shift(truth[a], 2 * level) - round_shift(base[a], 2 * level));
  return out;
}

}  // namespace

Result<void> LoadEncoder::check(const LoadThresholds& thresholds) noexcept {
  const auto positive = [](double v) { return std::isfinite(v) && v > 0; };
  if (!(thresholds.weber_fraction > 0 && thresholds.weber_fraction <= 1) || !positive(thresholds.force_floor))
    return fail(Errc::invalid_argument, "R-API-4");
  return {};
}

LoadTruth::LoadTruth(const Scene& scene, HeldList& held)
    : scene_(scene), held_(held), vectors_(initial_loads(scene).vectors), next_(vectors_of_load(scene)) {}

bool LoadTruth::fits(std::span<const ObjectLoad> loads) const noexcept {
  return loads.size() == scene_.objects.size() && std::ranges::all_of(scene_.moving(), [&](std::uint32_t object) {
           return loads[object].pushes.size() == scene_.loads->users;
         });
}

void LoadTruth::read(std::int64_t tick, std::span<const ObjectLoad> loads) noexcept {
  auto at = vectors_.begin();
  for (const std::uint32_t object : scene_.moving()) {
    const ObjectLoad& load = loads[object];
    const char* broken = nullptr;
    const auto take = [&](std::size_t i, const Vec3& force) {
      if (const auto on_grid = to_grid_force(force, scene_.loads->force_exp)) next_[i] = *on_grid;
      else broken = on_grid.error().rule;
    };
    take(kExternal, load.external);
    take(kHold, load.hold);
    for (std::size_t user = 0; user < load.pushes.size(); ++user) take(kPushes + user, load.pushes[user]);
    if (broken == nullptr) std::ranges::copy(next_, at);
    else held_.hold({TruthPart::load, object, tick, broken});
    at += static_cast<std::ptrdiff_t>(next_.size());
  }
}

LoadEncoder::LoadEncoder(const Scene& scene, const LoadThresholds& thresholds, Baseline baseline, const LoadTruth& truth)
    : scene_(scene),
      thresholds_(thresholds),
      is_acknowledged_(baseline == Baseline::acknowledged),
      floor_(std::ldexp(thresholds.force_floor, scene.loads->force_exp)),
      truth_(truth.vectors()),
      wanted_(truth_),
      steps_(vectors_of_load(scene)) {
  pending_.reserve(scene.moving().size());
}

void LoadEncoder::set_link(const LinkState& link) noexcept {
  if (!is_acknowledged_) return;
  const auto soon = static_cast<std::int64_t>(std::ceil(kSoon * scene_.tick_rate));
  ack_timeout_ = link.ack_timeout > 0 && link.loss >= kSomeLoss ? std::min(link.ack_timeout, soon) : link.ack_timeout;
}

/// At `fraction` of the permitted error, for the unrounded truth.
bool LoadEncoder::within(const Vec3i& held, const Vec3i& truth, double fraction) const noexcept {
  double distance = 0;
  for (std::size_t a = 0; a < 3; ++a) distance += square(static_cast<double>(truth[a]) - held[a]);
  const double force = std::max(std::sqrt(length_squared(truth)) - kRounding, floor_);
  return distance <= square(std::max(0.0, fraction * bound_scale_ * thresholds_.weber_fraction * force - kRounding));
}

/// A vector of the object is off by more than `fraction` of its bound, and a packet could do better.
bool LoadEncoder::is_out(std::size_t object, const LoadState& state, double fraction) const noexcept {
  for (std::size_t v = object * steps_.size(); v < (object + 1) * steps_.size(); ++v)
    if (!within(state.vectors[v], truth_[v], fraction) && state.vectors[v] != truth_[v]) return true;
  return false;
}

/// Nothing is pending unless a bound is broken, an acknowledgement is overdue, or a packet is asked for.
void LoadEncoder::collect(const EncodeRequest<LoadState>& request) noexcept {
  pending_.clear();
  const std::size_t objects = scene_.moving().size();
  bool fires = request.requested || (!acknowledged_ && ack_timeout_ > 0 && request.tick - sent_ >= ack_timeout_);
  for (std::size_t i = 0; i < objects && !fires; ++i) fires = is_out(i, request.shown, 1);
  if (!fires) return;
  for (std::size_t i = 0; i < objects; ++i)
    if (is_out(i, request.base, kBaselineFraction) || is_out(i, request.shown, 1)) pending_.push_back(i);
}

/// Steps of an object, at the coarsest level that keeps its vectors.
std::uint8_t LoadEncoder::quantise(std::size_t object, const LoadState& base) noexcept {
  const std::size_t first = object * steps_.size();
  const auto keeps = [&](unsigned level) {
    for (std::size_t v = first; v < first + steps_.size(); ++v) {
      const Vec3i rounded = after_step(base.vectors[v], steps_to(base.vectors[v], truth_[v], level), level);
      if (!within(base.vectors[v], truth_[v], kBaselineFraction) && !within(rounded, truth_[v], kRoundingFraction)) return false;
    }
    return true;
  };
  unsigned level = kCoarsest;
  while (level > 0 && !keeps(level)) --level;
  for (std::size_t v = 0; v < steps_.size(); ++v) {
    const Vec3i& from = base.vectors[first + v];
    const Vec3i& truth = truth_[first + v];
    steps_[v].changed = !within(from, truth, kBaselineFraction) && from != truth;
    steps_[v].steps = steps_[v].changed ? steps_to(from, truth, level) : Vec3i{};
    wanted_[first + v] = steps_[v].changed ? after_step(from, steps_[v].steps, level) : from;
  }
  return static_cast<std::uint8_t>(level);
}

Result<Payload> LoadEncoder::encode(const EncodeRequest<LoadState>& request, std::span<std::uint8_t> out) noexcept {
  collect(request);
  if (pending_.empty()) return Payload{};
  RangeEncoder coder(out);
  LoadModels models;
  LoadHead head{request.head, static_cast<std::uint32_t>(pending_.size())};
  code_head(coder, models, scene_, head);
  std::size_t next = 0;
  for (const std::size_t object : pending_) {
    if (scene_.moving().size() > 1) coder.magnitude(models.gap, static_cast<std::uint32_t>(object - next));
    next = object + 1;
    std::uint8_t level = quantise(object, request.base);
    code_load(coder, models, level, steps_);
  }
  const std::size_t size = coder.finish();
  if (coder.overflow() || coder.too_wide()) return fail(Errc::internal, "R-PKT-1");
  number_ = request.number;
  sent_ = request.tick;
  acknowledged_ = false;
  return Payload{size, Reason::request, head.count};
}

void LoadEncoder::commit(const LoadState& base, LoadState& next) noexcept {
  if (&base != &next) std::copy(base.vectors.begin(), base.vectors.end(), next.vectors.begin());
  for (const std::size_t object : pending_)
    std::copy_n(wanted_.begin() + static_cast<std::ptrdiff_t>(object * steps_.size()), steps_.size(),
                next.vectors.begin() + static_cast<std::ptrdiff_t>(object * steps_.size()));
}

}  // namespace tactus
