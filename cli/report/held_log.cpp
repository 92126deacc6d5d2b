// SPDX-License-Identifier: Apache-2.0
#include "cli/report/held_log.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

namespace tactus::cli {
namespace {

bool is_same(const HeldPart& a, const HeldPart& b) noexcept {
  return a.part == b.part && a.index == b.index && a.since == b.since;
}

const char* what_happens(TruthPart part) noexcept {
  switch (part) {
    case TruthPart::object:
      return "held where it was last";
    case TruthPart::shape:
      return "held in its last shape";
    case TruthPart::load:
      return "held at its last forces";
    case TruthPart::contact:
    case TruthPart::touch:
      break;
  }
  return "left out";
}

}  // namespace

std::string text_of(const Scene& scene, const HeldPart& held) {
  const std::string_view name = name_of(scene, held);
  const std::string who = name.empty() ? fmt::format("contact {}", held.index) : std::string(name);
  const char* const of = held.part == TruthPart::touch ? ", touch" : held.part == TruthPart::load ? ", forces" : "";
  const std::string reach = held.rule == std::string_view("R-API-2")
                                ? fmt::format("; positions reach {:.4g} m", std::ldexp(1.0, 31 - scene.grid.position))
                                : std::string();
  return fmt::format("{}{}: {} ({}{})", who, of, describe(held), held.rule, reach);
}

void HeldLog::look(std::int64_t tick, std::span<const HeldPart> held) {
  begun_.clear();
  ended_.clear();
  const std::int64_t before = std::exchange(tick_, tick);
  if (std::ranges::equal(held, now_, is_same)) return;
  const auto has = [](std::span<const HeldPart> parts, const HeldPart& part) {
    return std::ranges::any_of(parts, [&](const HeldPart& other) { return is_same(other, part); });
  };
  for (Run& run : runs_) {
    if (run.last != kGoesOn || has(held, run.held)) continue;
    run.last = before;
    ended_.push_back(run.held);
  }
  for (const HeldPart& part : held) {
    if (has(now_, part)) continue;
    runs_.push_back({part, kGoesOn});
    begun_.push_back(part);
  }
  now_.assign(held.begin(), held.end());
}

std::vector<std::string> HeldLog::lines(const Scene& scene) const {
  constexpr std::size_t kMost = 20;
  std::vector<std::string> out;
  for (const Run& run : runs_) {
    if (out.size() == kMost) break;
    out.push_back(fmt::format("{}: {} from tick {} to {}. {}", text_of(scene, run.held), what_happens(run.held.part),
                              run.held.since, run.last == kGoesOn ? tick_ : run.last, remedy(run.held)));
  }
  if (runs_.size() > kMost) out.push_back(fmt::format("{} more were held or left out", runs_.size() - kMost));
  return out;
}

}  // namespace tactus::cli
