// SPDX-License-Identifier: Apache-2.0
/// Points of `tactus bench precision`: the reference of a scene, a method at a step size against it, the error of a mesh, a rigid motion.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lab/study/precision.h"
#include "lab/study/precision_rigid.h"
#include "lab/study/precision_space.h"
#include "lab/study/program/points.h"

namespace tactus::study {
namespace {

namespace library = sim::study;
using library::Errors;

constexpr std::pair<const char*, double Errors::*> kErrors[]{{"displacement_error", &Errors::displacement},
                                                             {"displacement_end_error", &Errors::displacement_end},
                                                             {"velocity_error", &Errors::velocity},
                                                             {"force_error", &Errors::force},
                                                             {"energy_error", &Errors::energy},
                                                             {"weight_error", &Errors::weight},
                                                             {"push_error", &Errors::push}};

library::Extent extent_of(Request& request) {
  return request.get("short", false) ? library::Extent::brief : library::Extent::full;
}

library::PrecisionScene precision_scene_of(Request& request, library::Extent extent) {
  const auto name = request.get<std::string>("scene");
  auto scene = library::precision_scene(name, extent);
  if (!scene) refuse_request("there is no scene \"" + name + "\"", "Give membrane, membrane-stiff or cantilever.");
  return *std::move(scene);
}

std::vector<double> values_of(const Eigen::VectorXd& v) { return {v.data(), v.data() + v.size()}; }
Eigen::VectorXd vector_of(const Json& json) {
  const auto values = json.get<std::vector<double>>();
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

Json json_of(const library::Trajectory& t) {
  Json out{{"u", Json::array()}, {"v", Json::array()}, {"energy", values_of(t.energy)}, {"force", values_of(t.force)}};
  for (const auto& u : t.u) out["u"].push_back(values_of(u));
  for (const auto& v : t.v) out["v"].push_back(values_of(v));
  return out;
}
library::Trajectory trajectory_of(const Json& json) {
  library::Trajectory out;
  for (const Json& u : json.at("u")) out.u.push_back(vector_of(u));
  for (const Json& v : json.at("v")) out.v.push_back(vector_of(v));
  out.energy = vector_of(json.at("energy"));
  out.force = vector_of(json.at("force"));
  return out;
}

constexpr std::pair<const char*, library::Trajectory library::Reference::*> kTrajectories[]{
    {"load", &library::Reference::load},
    {"probe", &library::Reference::probe},
    {"weight", &library::Reference::weight},
    {"push", &library::Reference::push}};

/// What measure() needs of the object that the point "reference" printed.
library::Reference read_reference(const std::string& file) {
  std::ifstream in(file);
  const Json json = Json::parse(in, nullptr, false);
  const auto refuse = [&] {
    refuse_request(file + ": no reference", "Give a file that holds what {\"point\": \"reference\"} printed.");
  };
  if (!json.is_object() || !json.contains("trajectories")) refuse();
  library::Reference out;
  try {
    for (const auto& [name, trajectory] : kTrajectories) out.*trajectory = trajectory_of(json.at("trajectories").at(name));
  } catch (const Json::exception&) {
    refuse();
  }
  return out;
}

/// The points that there are.
Json plan(Request& request) {
  const library::Extent extent = extent_of(request);
  const library::PrecisionScene scene = precision_scene_of(request, extent);
  request.check_all_known();
  Json out{{"scene", scene.name},
           {"title", scene.title},
           {"seconds", scene.duration},
           {"vertices", scene.mesh.vertices.size()},
           {"tets", scene.mesh.tets.size()},
           {"steps_per_sample", scene.steps_per_sample},
           {"reference_steps_per_sample", scene.reference_steps_per_sample},
           {"methods", Json::array()},
           {"space", Json::array()}};
  for (const int steps : scene.steps_per_sample) out["step_s"].push_back(scene.step(steps));
  for (const library::PrecisionMethod& method : library::precision_methods(extent))
    out["methods"].push_back({{"name", method.name}, {"is_linear", method.elasticity != sim::Elasticity::corotated}});
  if (scene.name == "membrane-stiff") return out;  // a stiffer material of the same shape has the same relative space error
  for (const library::SpaceJob& job : library::space_jobs(scene.name, extent))
    out["space"].push_back(
        {{"refinement", job.refinement}, {"poisson", job.poisson}, {"transient", job.transient}, {"quadratic", job.quadratic}});
  return out;
}

Json reference(Request& request) {
  const library::PrecisionScene scene = precision_scene_of(request, extent_of(request));
  request.check_all_known();
  const library::Reference made = need(library::make_reference(scene));
  Json out{{"steps_per_sample", scene.reference_steps_per_sample},
           {"step_s", made.step},
           {"seconds_per_second", made.load.step_seconds / scene.duration},
           {"observed_order", made.order}};
  for (const auto& [name, error] : kErrors) out[name] = made.floor.*error;
  for (const auto& [name, trajectory] : kTrajectories) out["trajectories"][name] = json_of(made.*trajectory);
  return out;
}

Json method(Request& request) {
  const library::Extent extent = extent_of(request);
  const library::PrecisionScene scene = precision_scene_of(request, extent);
  const auto name = request.get<std::string>("method");
  const auto steps = request.get<int>("steps_per_sample");
  const library::Timing timing{.runs = request.get("runs", library::Timing{}.runs)};
  const library::Reference reference = read_reference(request.get<std::string>("reference"));
  request.check_all_known();
  const auto methods = library::precision_methods(extent);
  const auto found = std::ranges::find(methods, name, &library::PrecisionMethod::name);
  if (found == methods.end() || steps < 1 || timing.runs < 1)
    refuse_request("\"method\", \"steps_per_sample\" or \"runs\"", "The point \"plan\" lists the methods and the steps.");
  const library::PrecisionPoint p = library::measure(scene, *found, steps, reference, timing);
  Json out{{"method", p.method}, {"steps_per_sample", p.steps_per_sample}, {"step_s", p.step}};
  for (const auto& [key, error] : kErrors) out[key] = p.errors.*error;
  out.update({{"seconds_per_second", p.seconds_per_second},
              {"setup_s", p.setup_seconds},
              {"runs", p.runs},
              {"newton_per_step", p.newton_per_step},
              {"solver_iterations_per_step", p.solver_per_step},
              {"unconverged_steps", p.unconverged_steps},
              {"taken", p.taken},
              {"remark", p.remark}});
  return out;
}

Json space(Request& request) {
  const auto name = request.get<std::string>("scene");
  const library::SpaceJob job{.refinement = request.get<int>("refinement"),
                              .poisson = request.get<double>("poisson"),
                              .transient = request.get("transient", false),
                              .quadratic = request.get("quadratic", false)};
  request.check_all_known();
  if (!library::space_scene(name, 1, job.poisson) || job.refinement < 1)
    refuse_request("\"scene\" or \"refinement\"", "The point \"plan\" of a scene lists the meshes.");
  const library::SpacePoint p = need(library::measure_space(name, job));
  return {{"refinement", p.refinement},
          {"poisson", p.poisson},
          {"vertices", p.vertices},
          {"tets", p.tets},
          {"deflection_m_per_n", p.at_rest.deflection},
          {"solve_s", p.at_rest.seconds},
          {"quadratic_m_per_n", p.quadratic_deflection},
          {"step_s", p.step},
          {"seconds_per_second", p.seconds_per_second},
          {"transient_m", p.deflection}};
}

Json rigid(Request& request) {
  const auto name = request.get<std::string>("motion");
  const sim::RigidEffort effort{.parts = request.get("parts", 1), .iterations = request.get("iterations", 100)};
  const int runs = request.get("runs", library::Timing{}.runs);
  request.check_all_known();
  const auto motions = library::rigid_motions();
  const auto found = std::ranges::find(motions, name, &library::RigidMotion::name);
  if (found == motions.end() || effort.parts < 1 || effort.iterations < 1 || runs < 1)
    refuse_request("\"motion\", \"parts\", \"iterations\" or \"runs\"", "The point \"motions\" lists the motions.");
  std::vector<double> seconds(static_cast<std::size_t>(runs));
  double error = 0;
  for (double& s : seconds) error = found->error(effort, s);
  std::ranges::sort(seconds);
  Json out{{"motion", name},
           {"parts", effort.parts},
           {"iterations", effort.iterations},
           {"runs", runs},
           {"seconds_per_tick", seconds[seconds.size() / 2]}};
  out["error"] = std::isfinite(error) ? Json(error) : Json();
  return out;
}

Json motions(Request& request) {
  request.check_all_known();
  Json out = Json::array();
  for (const library::RigidMotion& m : library::rigid_motions())
    out.push_back({{"name", m.name}, {"title", m.title}, {"unit", m.unit}});
  return {{"motions", out}};
}

}  // namespace

Json precision_point(Request& request) {
  const auto point = request.get<std::string>("point");
  if (point == "plan") return plan(request);
  if (point == "reference") return reference(request);
  if (point == "method") return method(request);
  if (point == "space") return space(request);
  if (point == "motions") return motions(request);
  if (point == "rigid") return rigid(request);
  refuse_request("there is no point \"" + point + "\"", "Give plan, reference, method, space, motions or rigid.");
}

}  // namespace tactus::study
