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
    Agreement{"--tune alpha", "--haptic", "isotropic", {"cone"}},
    Agreement{"--tune fixed", "--haptic", "isotropic", {"fixed"}},
    Agreement{"--tune jnd_fraction", "--haptic", "isotropic", {"perceptual"}},
    Agreement{"--tune force_floor", "--haptic", "isotropic", {"isotropic", "cone", "perceptual"}},
    Agreement{"--tune layered", "--haptic", "isotropic", {"isotropic", "cone", "fixed", "perceptual"}},
    Agreement{"--tune rings", "--haptic", "isotropic", {"isotropic", "cone", "fixed", "perceptual"}},
    Agreement{"--interpolate", "--profile", "main", {"thesis"}},
    Agreement{"--tune haptic_fraction", "--haptic", "isotropic", {"isotropic", "cone", "fixed", "perceptual"}},
    Agreement{"--tune haptic_fraction", "--profile", "main", {"main"}},
    Agreement{"--tune visual_fraction", "--profile", "main", {"main"}},
    Agreement{"--basis", "--profile", "main", {"main"}},
    Agreement{"--tune clusters", "--profile", "main", {"main"}},
    Agreement{"--tune fade", "--profile", "main", {"main"}},
    Agreement{"--tune nugget", "--profile", "main", {"main"}},
    Agreement{"--tune quant_bits", "--profile", "main", {"thesis"}},
    Agreement{"--tune keep_models", "--profile", "main", {"thesis"}},
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
    Need{"--tune jnd_fraction", Subject::rigid},
    Need{"--tune alpha", Subject::rigid},
    Need{"--tune fixed", Subject::rigid},
    Need{"--tune force_floor", Subject::rigid},
    Need{"--tune heartbeat", Subject::rigid},
    Need{"--tune reduction", Subject::rigid},
    Need{"--tune gravity", Subject::rigid},
    Need{"--tune friction", Subject::rigid},
    Need{"--interpolate", Subject::rigid},
    Need{"--deformable-visual", Subject::mesh},
    Need{"--basis", Subject::mesh},
    Need{"--tune clusters", Subject::mesh},
    Need{"--tune nugget", Subject::mesh},
    Need{"--tune visual_fraction", Subject::mesh},
    Need{"--tune quant_bits", Subject::mesh},
    Need{"--tune keep_models", Subject::mesh},
    Need{"--tune rings", Subject::touched_mesh},
    Need{"--tune haptic_fraction", Subject::touched_mesh},
    Need{"--tune layered", Subject::touched_mesh},
    // simulation
    Need{"--tune duration_scale", Subject::user},
    Need{"--tune tremor", Subject::user},
    Need{"--rate", Subject::deformed},
    Need{"--method", Subject::deformable},
    Need{"--tune solver", Subject::deformable},
    Need{"--tune deformable_noise", Subject::deformable},
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
  if (typed(command, "--tune fade") && !typed(command, "--basis") && !typed(command, "--tune clusters"))
    refuse_option("--tune fade",
                  command.find("--tune clusters") != nullptr ? "needs --basis or --tune clusters" : "needs --basis");
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
