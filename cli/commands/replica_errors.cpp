// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/replica_errors.h"

#include <fmt/format.h>

#include <tactus/base/shown.h>
#include <tactus/trace/trace_scene.h>
#include "cli/report/messages.h"

namespace tactus::cli {

Outcome check_same_scene(const std::string& truth_path, const TraceInfo& truth, const std::string& replica_path,
                         const TraceInfo& replica) {
  const auto differ = [&](const std::string& what) {
    return refuse(shown_path(replica_path) + ": " + what + " as in " + shown_path(truth_path),
                  "Compare a trace with the replica that was decoded from its own stream.");
  };
  if (truth.shows_past)
    return refuse(shown_path(truth_path) + ": is what a client showed, not the truth", "Give the server's trace first.");
  if (truth.tick_rate != replica.tick_rate)
    return differ(fmt::format("the tick rate is {} Hz, not {} Hz", replica.tick_rate, truth.tick_rate));
  if (truth.objects.size() != replica.objects.size()) {
    return differ(fmt::format("there are {} objects, not {}", replica.objects.size(), truth.objects.size()));
  }
  for (std::size_t i = 0; i < truth.objects.size(); ++i) {
    if (truth.objects[i].name != replica.objects[i].name) {
      return differ(fmt::format("object {} is \"{}\", not \"{}\"", i, replica.objects[i].name, truth.objects[i].name));
    }
    if (truth.objects[i].dof != replica.objects[i].dof) {
      return differ(fmt::format("the degrees of freedom of object \"{}\" are \"{}\", not \"{}\"", truth.objects[i].name,
                                dof_text(replica.objects[i].dof), dof_text(truth.objects[i].dof)));
    }
  }
  if (truth.meshes.size() != replica.meshes.size())
    return differ(fmt::format("there are {} meshes, not {}", replica.meshes.size(), truth.meshes.size()));
  for (std::size_t i = 0; i < truth.meshes.size(); ++i) {
    const TraceDeformable &a = truth.meshes[i], &b = replica.meshes[i];
    if (a.name != b.name) return differ(fmt::format("mesh {} is \"{}\", not \"{}\"", i, b.name, a.name));
    if (a.rest.vertices.size() != b.rest.vertices.size() || a.rest.triangles != b.rest.triangles)
      return differ(fmt::format("mesh \"{}\" does not have the same vertices and triangles", a.name));
  }
  return {};
}

ShownByReplica::ShownByReplica(const TraceInfo& info) : poses(info.objects.size()) {
  for (const TraceDeformable& mesh : info.meshes) shapes.emplace_back(3 * mesh.rest.vertices.size());
}

void ShownByReplica::take(const TraceFrame& frame) {
  for (std::size_t i = 0; i < poses.size(); ++i) poses[i] = frame.objects[i].pose;
  for (std::size_t i = 0; i < shapes.size(); ++i)
    if (frame.meshes[i].updated) shapes[i] = frame.meshes[i].displacements;
}

void add_errors(const TraceFrame& truth, const ShownByReplica& shown, Report& report) {
  report.fidelity->add(truth, shown.poses);
  for (std::size_t i = 0; i < shown.shapes.size(); ++i)
    if (truth.meshes[i].updated)
      report.meshes[i].fidelity->add(truth.meshes[i].displacements, shown.shapes[i], touch_of(truth, i));
}

void judge_by(const TypedBounds* typed, const TraceInfo& info, const std::optional<TraceBounds>& declared, Report& report) {
  const bool is_typed = typed != nullptr && (typed->triggers.any_given() || typed->meshes.any_given());
  report.bounds_from = is_typed ? "options" : declared ? "stream" : "defaults";
  const RigidTriggers rigid = declared && declared->stream.rigid ? *declared->stream.rigid : RigidTriggers{};
  report.fidelity.emplace(info, typed != nullptr ? typed->triggers.over(rigid) : rigid);
  for (std::size_t i = 0; i < info.meshes.size(); ++i) {
    const DeformableBounds bounds = declared ? declared->stream.deformables[i] : DeformableBounds{};
    if (report.meshes.size() == i)
      report.meshes.push_back({.name = info.meshes[i].name, .vertices = info.meshes[i].rest.vertices.size()});
    const std::uint8_t rings = declared ? declared->rings[i] : DeformableObject{}.rings;
    report.meshes[i].fidelity.emplace(
        info.meshes[i].rest, typed != nullptr ? typed->meshes.over(bounds.thresholds, typed->triggers) : bounds.thresholds,
        typed != nullptr ? typed->meshes.rings(rings) : rings, declared ? declared->position_exp : GridExponents{}.position);
    report.meshes[i].guaranteed = bounds.kept || is_typed;
  }
}

}  // namespace tactus::cli
