// SPDX-License-Identifier: Apache-2.0
#include "cli/viewer/shapes.h"

#include <toml++/toml.h>
#include <cmath>
#include <optional>

#include <tactus/base/shown.h>
#include <tactus/sim/scene/scene.h>
#include <tactus/sim/scene/toml_reader.h>

namespace tactus::cli {
namespace {

constexpr double kLargest = 1e6;  // [m]
constexpr std::size_t kMostText = std::size_t{4} << 20;
constexpr std::size_t kMostNumbers = std::size_t{1} << 23;  // of surfaces: 500 MB while the page is written

std::optional<double> length_of(const toml::node_view<const toml::node>& node) {
  const auto value = node.value<double>();
  return value && std::isfinite(*value) && std::abs(*value) <= kLargest ? value : std::nullopt;
}

nlohmann::ordered_json box_of(const toml::table& object) {
  const auto name = object["name"].value<std::string>();
  const auto x = length_of(object["size"][0]), y = length_of(object["size"][1]), z = length_of(object["size"][2]);
  if (!name || !x || !y || !z) return nullptr;
  return {{"name", *name}, {"size", {*x, *y, *z}}};
}

}  // namespace

nlohmann::ordered_json attached_shapes(const std::string& text) {
  nlohmann::ordered_json out{{"objects", nlohmann::ordered_json::array()}};
  if (text.size() > kMostText || sim::too_nested_line(text)) return out;
  toml::table scene;
  try {
    scene = toml::parse(text);
  } catch (const toml::parse_error&) {
    return out;
  }
  const toml::table& root = scene;
  if (const auto floor = length_of(root["floor"])) out["floor"] = *floor;
  if (const toml::array* objects = root["object"].as_array())
    for (const toml::node& node : *objects)
      if (const toml::table* object = node.as_table())
        if (auto box = box_of(*object); !box.is_null()) out["objects"].push_back(std::move(box));
  return out;
}

tl::expected<nlohmann::ordered_json, Failure> scene_shapes(const std::string& name) {
  const auto path = sim::find_scene(name);
  if (!path) return refuse(path.error());
  const auto scene = sim::load_scene(*path);
  if (!scene) return refuse(scene.error());
  std::size_t numbers = 0;
  for (const sim::SceneObject& object : scene->objects)
    numbers += 3 * (object.surface.vertices.size() + object.surface.triangles.size());
  if (numbers > kMostNumbers)
    return refuse(shown_path(*path) + ": its surfaces are more than a page can hold", "Give a scene with coarser surfaces.");
  nlohmann::ordered_json out{{"objects", nlohmann::ordered_json::array()}};
  if (scene->floor) out["floor"] = *scene->floor;
  for (const sim::SceneObject& object : scene->objects) {
    nlohmann::ordered_json shape{{"name", object.name}, {"size", {object.size.x, object.size.y, object.size.z}}};
    if (!object.surface.triangles.empty()) {
      for (const Vec3& v : object.surface.vertices)
        for (const double c : {v.x, v.y, v.z}) shape["vertices"].push_back(static_cast<float>(c));
      for (const Triangle& triangle : object.surface.triangles)
        for (const std::uint32_t corner : triangle) shape["triangles"].push_back(corner);
    }
    out["objects"].push_back(std::move(shape));
  }
  return out;
}

}  // namespace tactus::cli
