// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/viewer_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

#include "cli/report/json.h"

namespace tactus::cli {
namespace {

constexpr std::array<const char*, 3> kAxes{"x", "y", "z"};
constexpr std::array<const char*, 6> kColours{"#0072b2", "#d55e00", "#009e73",
                                              "#56b4e9", "#e69f00", "#cc79a7"};  // as in the figures

/// A vector that is drawn over time.
struct Curve {
  std::string topic, field, label;
};

struct Panel {
  std::string title;
  std::vector<Curve> curves;
};

std::vector<Panel> panels_of(const TraceInfo& info) {
  std::vector<Panel> out;
  for (const TraceUser& user : info.users) {
    const std::string topic = "/users/" + user.name;
    Panel& forces = out.emplace_back(Panel{"force on " + user.name + " [N]", {}});
    if (user.forces != RecordedForces::server) forces.curves.push_back({topic + "/force", "vector", "rendered"});
    if (user.forces != RecordedForces::rendered) forces.curves.push_back({topic + "/server_force", "vector", "server"});
    out.push_back({"device of " + user.name + " [m]", {{topic + "/device", "point", "device"}}});
  }
  for (const TraceObject& object : info.objects)
    out.push_back({"position of " + object.name + " [m]", {{"/objects/" + object.name + "/pose", "pose.position", object.name}}});
  return out;
}

Json plot_of(const Panel& panel) {
  Json out{{"title", panel.title}, {"showLegend", true}, {"xAxisVal", "timestamp"}, {"isSynced", true}};
  out["paths"] = Json::array();
  for (const Curve& curve : panel.curves)
    for (const char* axis : kAxes)
      out["paths"].push_back({{"value", fmt::format("\"{}\".{}.{}", curve.topic, curve.field, axis)},
                              {"label", curve.label + " " + axis},
                              {"color", kColours[out["paths"].size() % kColours.size()]},
                              {"enabled", true},
                              {"timestampMethod", "receiveTime"}});
  return out;
}

Json scene_of(const TraceInfo& info) {
  Json topics = Json::object();
  const auto show = [&](const std::string& topic) { topics[topic] = {{"visible", true}}; };
  if (!info.objects.empty()) show("/scene/objects");
  for (const TraceUser& user : info.users) show("/scene/users/" + user.name);
  for (const TraceDeformable& mesh : info.meshes) show("/scene/meshes/" + mesh.name);
  const Json camera{{"perspective", true}, {"distance", 0.5}, {"phi", 60}, {"thetaOffset", 45},
                    {"fovy", 45},          {"near", 0.01},    {"far", 100}};
  const Json grid{{"layerId", "foxglove.Grid"},
                  {"instanceId", "grid"},
                  {"visible", true},
                  {"frameId", "world"},
                  {"size", 1},
                  {"divisions", 20}};
  return {{"followTf", "world"},
          {"cameraState", camera},
          {"topics", topics},
          {"layers", {{"grid", grid}}},
          {"scene", {{"transforms", {{"axisScale", 0.02}, {"showLabel", false}}}}}};
}

/// As XML has it in an attribute. It has neither U+FFFE nor U+FFFF, which become U+FFFD.
std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&') out += "&amp;";
    else if (c == '<') out += "&lt;";
    else if (c == '"') out += "&quot;";
    else if ((c == '\xBE' || c == '\xBF') && out.ends_with("\xEF\xBF")) out += '\xBD';
    else out += c;
  }
  return out;
}

std::string area_of(const Panel& panel) {
  std::string out =
      fmt::format("     <DockArea name=\"{}\">\n      <plot mode=\"TimeSeries\" style=\"Lines\">\n", escaped(panel.title));
  std::size_t count = 0;
  for (const Curve& curve : panel.curves) {
    std::string path = curve.topic + "/" + curve.field;
    for (std::size_t dot = path.find('.', curve.topic.size()); dot != std::string::npos; dot = path.find('.', dot))
      path[dot] = '/';
    for (const char* axis : kAxes)
      out +=
          fmt::format("       <curve name=\"{}/{}\" color=\"{}\"/>\n", escaped(path), axis, kColours[count++ % kColours.size()]);
  }
  return out + "      </plot>\n     </DockArea>\n";
}

}  // namespace

std::string foxglove_layout(const TraceInfo& info) {
  constexpr std::size_t kPlots = 3;  // beside the scene
  Json configs{{"3D!scene", scene_of(info)}}, layout;
  auto panels = panels_of(info);
  panels.resize(std::min(panels.size(), kPlots));
  for (std::size_t i = panels.size(); i-- > 0;) {
    const std::string id = fmt::format("Plot!{}", i + 1);
    configs[id] = plot_of(panels[i]);
    layout = layout.is_null() ? Json(id) : Json{{"first", id}, {"second", layout}, {"direction", "column"}};
  }
  layout = layout.is_null() ? Json("3D!scene")
                            : Json{{"first", "3D!scene"}, {"second", layout}, {"direction", "row"}, {"splitPercentage", 62}};
  return text_of_json({{"configById", configs},
                       {"globalVariables", Json::object()},
                       {"userNodes", Json::object()},
                       {"playbackConfig", {{"speed", 1}}},
                       {"layout", layout}}) +
         "\n";
}

std::string plotjuggler_layout(const TraceInfo& info) {
  const auto panels = panels_of(info);
  std::string sizes, areas;
  for (const Panel& panel : panels) {
    sizes += fmt::format("{}{:.4f}", sizes.empty() ? "" : ";", 1.0 / static_cast<double>(panels.size()));
    areas += area_of(panel);
  }
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<root>\n"
      " <tabbed_widget name=\"Main Window\" parent=\"main_window\">\n"
      "  <Tab containers=\"1\" tab_name=\"tactus\">\n"
      "   <Container>\n"
      "    <DockSplitter orientation=\"-\" sizes=\"{}\" count=\"{}\">\n"
      "{}"
      "    </DockSplitter>\n"
      "   </Container>\n"
      "  </Tab>\n"
      "  <currentTabIndex index=\"0\"/>\n"
      " </tabbed_widget>\n"
      " <use_relative_time_offset enabled=\"1\"/>\n"
      "</root>\n",
      sizes, panels.size(), areas);
}

}  // namespace tactus::cli
