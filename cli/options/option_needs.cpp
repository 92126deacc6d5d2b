// SPDX-License-Identifier: Apache-2.0
#include "cli/options/option_needs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include <tactus/trace/frame.h>
#include "cli/command.h"

namespace tactus::cli {
namespace {

/// `option` does something only if `other` has one of these values.
struct Agreement {
  const char *option, *other;
  const char* otherwise;  ///< value of `other` when it was not typed
  std::array<std::string_view, 4> values;
};

constexpr std::array kAgreements{
    Agreement{"--deadband",
              "--haptic",
              "isotropic",
              {"isotropic", "cone", "fixed", "perceptual"}},  // the last two: it is that of meshes
    Agreement{"--alpha", "--haptic", "isotropic", {"cone"}},
    Agreement{"--fixed", "--haptic", "isotropic", {"fixed"}},
    Agreement{"--jnd-fraction", "--haptic", "isotropic", {"perceptual"}},
    Agreement{"--force-floor", "--haptic", "isotropic", {"isotropic", "cone", "perceptual"}},
    Agreement{"--layered", "--haptic", "isotropic", {"isotropic", "cone", "fixed", "perceptual"}},
    Agreement{"--rings", "--haptic", "isotropic", {"isotropic", "cone", "fixed", "perceptual"}},
    Agreement{"--interpolate", "--profile", "main", {"thesis"}},
    Agreement{"--haptic-share", "--haptic", "isotropic", {"isotropic", "cone", "fixed", "perceptual"}},
    Agreement{"--haptic-share", "--profile", "main", {"main"}},
    Agreement{"--visual-share", "--profile", "main", {"main"}},
    Agreement{"--basis", "--profile", "main", {"main"}},
    Agreement{"--clusters", "--profile", "main", {"main"}},
    Agreement{"--fade", "--profile", "main", {"main"}},
    Agreement{"--nugget", "--profile", "main", {"main"}},
    Agreement{"--quant-bits", "--profile", "main", {"thesis"}},
    Agreement{"--keep-models", "--profile", "main", {"thesis"}},
};

struct Need {
  const char* option;
  Subject subject;
  const char* value = nullptr;  ///< only when typed with it
};

constexpr std::array kNeeds{
    // coding
    Need{"--deadband", Subject::user},
    Need{"--visual", Subject::rigid},
    Need{"--haptic", Subject::rigid, "cone"},
    Need{"--haptic", Subject::rigid, "fixed"},
    Need{"--haptic", Subject::rigid, "perceptual"},
    Need{"--jnd-fraction", Subject::rigid},
    Need{"--alpha", Subject::rigid},
    Need{"--fixed", Subject::rigid},
    Need{"--force-floor", Subject::rigid},
    Need{"--heartbeat", Subject::rigid},
    Need{"--no-reduction", Subject::rigid},
    Need{"--gravity", Subject::rigid},
    Need{"--friction", Subject::rigid},
    Need{"--interpolate", Subject::rigid},
    Need{"--deformable-visual", Subject::mesh},
    Need{"--basis", Subject::mesh},
    Need{"--clusters", Subject::mesh},
    Need{"--nugget", Subject::mesh},
    Need{"--visual-share", Subject::mesh},
    Need{"--quant-bits", Subject::mesh},
    Need{"--keep-models", Subject::mesh},
    Need{"--rings", Subject::touched_mesh},
    Need{"--haptic-share", Subject::touched_mesh},
    Need{"--layered", Subject::touched_mesh},
    // simulation
    Need{"--duration-scale", Subject::user},
    Need{"--tremor", Subject::user},
    Need{"--rate", Subject::deformed},
    Need{"--method", Subject::deformable},
    Need{"--solver", Subject::deformable},
    Need{"--deformable-noise", Subject::deformable},
    Need{"--stiffness-map", Subject::deformable},
    // info
    Need{"--packets", Subject::packets},
    // mesh
    Need{"--edge", Subject::surface},
    Need{"--quality", Subject::surface},
    Need{"--split-surface", Subject::surface},
    Need{"--time-limit", Subject::surface},
    Need{"--axes", Subject::surface},
    Need{"--node", Subject::gltf},
    Need{"--animation", Subject::gltf},
    Need{"--series", Subject::frames},
};

const char* lack_of(Subject subject) {
  switch (subject) {
    case Subject::rigid:
      return "no moving rigid object";
    case Subject::user:
      return "no user";
    case Subject::mesh:
      return "no deformable object";
    case Subject::touched_mesh:
      return "no deformable object with a user to touch it";
    case Subject::deformable:
      return "no deformable object";
    case Subject::deformed:
      return "neither a deformable nor a one-dimensional object";
    case Subject::packets:
      return "no packets";
    case Subject::surface:
      return "no surface to fill";
    case Subject::gltf:
      return "no glTF scene";
    case Subject::frames:
      return "no folder of frames";
  }
  return "";
}

/// An option of the command that was typed.
const Option* typed(const Command& command, const char* name) {
  const Option* option = command.find(name);
  return option != nullptr && option->count() > 0 ? option : nullptr;
}

std::string list(const std::array<std::string_view, 4>& values) {
  const auto* last = std::find(values.begin(), values.end(), std::string_view()) - 1;
  if (last == values.begin()) return std::string(*last);
  return fmt::format("{} or {}", fmt::join(values.begin(), last, ", "), *last);
}

}  // namespace

std::set<Subject> subjects_of(const TraceInfo& info) {
  std::set<Subject> held;
  const bool moves =
      std::any_of(info.objects.begin(), info.objects.end(), [](const TraceObject& o) { return o.dof != Dof::none; });
  if (moves || info.meshes.empty()) held.insert(Subject::rigid);
  if (!info.users.empty()) held.insert(Subject::user);
  if (!info.meshes.empty()) held.insert(Subject::mesh);
  if (!info.meshes.empty() && !info.users.empty()) held.insert(Subject::touched_mesh);
  return held;
}

void check_options_agree(const Command& command) {
  if (typed(command, "--fade") && !typed(command, "--basis") && !typed(command, "--clusters"))
    refuse_option("--fade", command.find("--clusters") != nullptr ? "needs --basis or --clusters" : "needs --basis");
  for (const Agreement& a : kAgreements) {
    if (!typed(command, a.option) || command.find(a.other) == nullptr) continue;
    const Option* other = typed(command, a.other);
    const std::string value = other ? other->last() : a.otherwise;
    if (std::find(a.values.begin(), a.values.end(), value) == a.values.end())
      refuse_option(a.option, fmt::format("needs {} {}", a.other, list(a.values)));
  }
}

void note_idle_options(const Command& command, const std::set<Subject>& held, const std::string& source) {
  for (const Need& need : kNeeds) {
    const Option* option = typed(command, need.option);
    if (!option || held.contains(need.subject) || (need.value && option->last() != need.value)) continue;
    fmt::print(stderr, "note: {}{}{} has no effect: this {} has {}\n", need.option, need.value ? " " : "",
               need.value ? need.value : "", source, lack_of(need.subject));
  }
}

}  // namespace tactus::cli
