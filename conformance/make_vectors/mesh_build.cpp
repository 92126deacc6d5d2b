// SPDX-License-Identifier: Apache-2.0
#include "conformance/make_vectors/mesh_build.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include <tactus/deformable/graph.h>
#include <tactus/deformable/vertex_coder.h>

namespace tactus::conformance {
namespace {

Bytes differences(std::int64_t& before, std::int64_t value) {
  Bytes out = zigzag_varint(value - before);
  before = value;
  return out;
}

void append(Bytes& to, const Bytes& bytes) { to.insert(to.end(), bytes.begin(), bytes.end()); }

}  // namespace

Bytes zigzag_varint(std::int64_t value) {
  return varint(value < 0 ? 2 * static_cast<std::uint64_t>(-(value + 1)) + 1 : 2 * static_cast<std::uint64_t>(value));
}

Bytes RawMesh::bytes() const {
  Bytes out;
  ByteWriter w(out);
  w.u8(profile);
  w.u8(static_cast<std::uint8_t>(name.size()));
  for (const char c : name) w.u8(static_cast<std::uint8_t>(c));
  w.u8(rings);
  if (profile == 0) {
    w.u8(quant_bits);
    w.u8(models_kept);
  } else {
    w.u32(frame_period);
    w.u8(split);
  }
  w.bytes(vertex_count.value_or(varint(shape.rest.size())));
  w.bytes(triangle_count.value_or(varint(shape.triangles.size())));
  std::array<std::int64_t, 3> place{};
  for (const Vec3i& p : shape.rest)
    for (std::size_t axis = 0; axis < 3; ++axis) append(out, differences(place[axis], p[axis]));
  std::int64_t first = 0;
  for (const Triangle& t : shape.triangles) {
    std::int64_t last = first;
    for (const std::uint32_t corner : t) append(out, differences(last, corner));
    first = t[0];
  }
  if (profile == 0) return out;
  append(out, mode_count.value_or(varint(mode_steps.size())));
  for (std::size_t k = 0; k < mode_steps.size(); ++k) {
    ByteWriter(out).u16(mode_steps[k]);
    const std::size_t components = 3 * shape.rest.size();
    for (std::size_t i = 0; i < components; ++i) append(out, zigzag_varint(entries[k * components + i]));
  }
  return out;
}

RawHeader with_meshes(RawHeader header, const std::vector<RawMesh>& meshes) {
  header.flags = 1;
  header.meshes = varint(meshes.size());
  for (const RawMesh& mesh : meshes) append(header.meshes, mesh.bytes());
  return header;
}

RawHeader only(const RawMesh& mesh, std::uint8_t baseline_span) {
  RawHeader header;
  header.objects.clear();
  header.baseline_span = baseline_span;
  return with_meshes(header, {mesh});
}

Bytes around(const Bytes& meshes) {
  RawHeader header;
  header.objects.clear();
  header.flags = 1;
  header.meshes = meshes;
  return header.bytes();
}

Bytes counted(std::uint64_t vertices, std::uint64_t triangles, const Bytes& rest) {
  return around(Bytes{1, 1, 1, 'm', 2, 0, 1, 0, 0, 0} + varint(vertices) + varint(triangles) + rest);
}

RawMesh with_modes(RawMesh mesh, std::size_t modes, std::uint64_t seed) {
  Random random(seed);
  for (std::size_t k = 0; k < modes; ++k) {
    mesh.mode_steps.push_back(static_cast<std::uint16_t>(512 + random.below(4096)));
    std::array<std::int32_t, 3> slope{}, offset{};
    for (auto& c : slope) c = random.integer(9);
    for (auto& c : offset) c = random.integer(9);
    for (const Vec3i& p : mesh.shape.rest)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::int64_t entry = offset[axis] + ((std::int64_t{slope[axis]} * (p[axis] + 2 * p[(axis + 1) % 3])) >> 14);
        mesh.entries.push_back(static_cast<std::int32_t>(std::clamp<std::int64_t>(entry, -2047, 2047)));
      }
  }
  return mesh;
}

struct MeshComposer::Fixed {
  Fixed(const StreamHeader& header, std::size_t index)
      : mesh(header.meshes[index]),
        span(header.baseline_span),
        initial(initial_state(mesh)),
        hierarchy(vertex_hierarchy(mesh)),
        rings(mesh),
        predictor(mesh),
        pass(hierarchy, mesh.rest.size()) {}

  const DeformableObject mesh;
  const std::uint8_t span;
  const DeformableState initial;
  const VertexHierarchy hierarchy;
  Rings rings;
  ShapePredictor predictor;
  VertexCoder pass;
};

MeshComposer::MeshComposer(const StreamHeader& header, std::size_t mesh) : fixed_(std::make_unique<Fixed>(header, mesh)) {}
MeshComposer::MeshComposer(MeshComposer&&) noexcept = default;
MeshComposer::~MeshComposer() = default;

const DeformableObject& MeshComposer::mesh() const { return fixed_->mesh; }

const DeformableState& MeshComposer::baseline(const MeshPlace& at) {
  sequence_ = at.sequence.value_or(next_sequence_);
  const auto found = states_.find(static_cast<std::uint16_t>(sequence_ - at.baseline));
  return at.key || found == states_.end() ? fixed_->initial : found->second;
}

MainHead MeshComposer::head_of(const MeshPlace& at, const DeformableState& base) const {
  MainHead head;
  head.key = at.key;
  head.baseline_delta = at.baseline;
  head.tick_delta = static_cast<std::uint32_t>(at.tick - base.tick);
  return head;
}

void MeshComposer::keep(const MeshPlace& at, DeformableState state) {
  state.tick = at.tick;
  states_[sequence_] = std::move(state);
  next_sequence_ = static_cast<std::uint16_t>(sequence_ + 1);
}

Bytes MeshComposer::packet(const MainStep& step) {
  const DeformableObject& mesh = fixed_->mesh;
  const DeformableState base = baseline(step.at);
  DeformableState next = base;
  MainHead head = head_of(step.at, base);
  head.half = step.half;
  head.completes = step.completes;
  head.touched = step.triangle.has_value();
  head.triangle = step.triangle.value_or(base.triangle);
  head.haptic = step.triangle ? step.haptic : base.haptic;
  head.visual = step.visual;
  head.density = step.density;
  std::vector<std::int32_t> coefficients = step.coefficients;
  coefficients.resize(mesh.basis.steps.size());
  Bytes packet = with_payload(sequence_, [&](RangeEncoder& coder) {
    MainModels models = main_start_models();
    code_main_start(coder, models, mesh, fixed_->span, head);
    code_main_head(coder, models, mesh, fixed_->rings, base, head);
    std::span<const std::uint32_t> area;
    if (head.touched) {
      fixed_->rings.triangles_around(head.triangle, mesh.rings);
      area = fixed_->rings.vertices();
    }
    fixed_->pass.set_bounds(head.visual, head.touched ? haptic_bound(head.haptic) : head.visual, area, head.half);
    std::vector<Vec3i> expected(mesh.rest.size());
    fixed_->predictor.predict(base, step.at.tick, expected);
    if (mesh.split) fixed_->pass.begin_half(base, head.completes, expected, next.displacement);
    if (head.half == Layer::haptic) {
      keep_motion(base, next);
    } else {
      code_coefficients(coder, models, coefficients);
      scale_coefficients(mesh, head.visual, coefficients);
      fixed_->predictor.add_modes(coefficients, expected);
      fixed_->predictor.learn(base, step.at.tick, next);
    }
    const auto residual = [&](std::uint32_t v, const VertexContext& context, const Vec3i& place, std::uint32_t bound,
                              std::int64_t size) {
      Vec3i r = step.residuals ? step.residuals({v, place, bound, size}) : Vec3i{};
      code_vertex(coder, models, head.density, context, r);
      return r;
    };
    fixed_->pass.run(expected, next.displacement, residual);
    fixed_->pass.keep_felt(head.half, next);
    keep_head(head, base, next);
  });
  keep(step.at, std::move(next));
  return packet;
}

Bytes MeshComposer::packet(const ThesisStep& step) {
  const DeformableObject& mesh = fixed_->mesh;
  const DeformableState base = baseline(step.at);
  DeformableState next = base;
  std::vector<BitModel> models = mesh.models_kept ? base.models : initial_thesis_models(mesh);
  RawThesis raw;
  raw.sequence = sequence_;
  raw.key = step.at.key ? 1 : 0;
  if (!step.at.key && fixed_->span > 1) raw.baseline_delta = static_cast<std::uint8_t>(step.at.baseline);
  raw.tick_delta = varint(static_cast<std::uint64_t>(step.at.tick - base.tick));
  raw.count = varint(step.vertices.size());
  raw.lowest = zigzag_varint(step.lowest);
  raw.range = varint(step.range);
  raw.list = payload([&](RangeEncoder& coder) {
    std::uint32_t unlisted = 0;
    for (const ThesisVertex& v : step.vertices) {
      code_gap(coder, models, v.vertex - unlisted, 0xffffffff);
      unlisted = v.vertex + 1;
    }
  });
  raw.errors = payload([&](RangeEncoder& coder) {
    for (const ThesisVertex& v : step.vertices)
      for (const std::uint32_t symbol : v.symbols)
        code_symbol(coder, std::span(models).subspan(kIndexModels), mesh.quant_bits, symbol);
  });
  if (mesh.models_kept) next.models = models;
  keep(step.at, std::move(next));
  return raw.bytes();
}

Bytes RawThesis::bytes() const {
  Bytes out{static_cast<std::uint8_t>(sequence), static_cast<std::uint8_t>(sequence >> 8), key};
  if (baseline_delta) out.push_back(*baseline_delta);
  return out + tick_delta + count + list_bytes.value_or(varint(list.size())) + lowest + range + list + errors;
}

Bytes thesis_symbols(const std::vector<std::uint32_t>& symbols, unsigned bits) {
  std::vector<BitModel> models(std::size_t{1} << bits);
  return payload([&](RangeEncoder& coder) {
    for (const std::uint32_t symbol : symbols) code_symbol(coder, models, bits, symbol);
  });
}

Residuals random_residuals(Random& random, unsigned width, std::uint32_t share) {
  return [&random, width, share](const VertexPlace&) {
    Vec3i r{};
    if (random.below(256) < share)
      for (std::int32_t& c : r) c = random.integer(width);
    return r;
  };
}

Residuals towards(std::function<Vec3i(std::uint32_t)> target) {
  return [target = std::move(target)](const VertexPlace& at) {
    const Vec3i goal = target(at.vertex);
    Vec3i r{};
    std::int64_t square = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::int64_t error = std::int64_t{goal[axis]} - at.place[axis];
      square += error * error;
      r[axis] = static_cast<std::int32_t>(round_div(error, at.step));
    }
    return square > std::int64_t{at.bound} * at.bound ? r : Vec3i{};
  };
}

}  // namespace tactus::conformance
