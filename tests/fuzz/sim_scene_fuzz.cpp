// SPDX-License-Identifier: Apache-2.0
/// Any bytes as the TOML of a scene: an error with line, rule and remedy, or a scene that a stream can carry or must refuse by a rule.
#include <algorithm>
#include <cstdint>
#include <string_view>

#include <tactus/sim/scene/scene.h>
#include "tests/fuzz/require.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tactus;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto scene = sim::parse_scene(text, "/nowhere/scene.toml");
  if (!scene) {
    const Diagnostic& error = scene.error();
    require(std::string_view(error.error.rule).starts_with("R-") && !error.remedy.empty());
    require(error.line <= static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')) + 1);
    require(to_string(error).find(error.error.rule) != std::string::npos);
    return 0;
  }
  require(scene->text == text && scene->duration > 0 && (scene->users.empty() || scene->touch));
  for (const sim::SceneObject& object : scene->objects)
    require(is_finite(object.pose.position) && is_finite(object.pose.rotation) && object.mass >= 0);
  const auto shared = scene_builder(*scene).build();
  require(shared || shared.error().error.rule[0] == 'R');
  return 0;
}
