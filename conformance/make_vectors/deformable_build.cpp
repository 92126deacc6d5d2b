// SPDX-License-Identifier: Apache-2.0
#include "conformance/make_vectors/deformable_build.h"

#include <algorithm>
#include <bit>
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

Bytes RawDeformable::bytes() const {
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
    w.u8(layered);
    w.u16(fade);
    w.u8(weight_sets);
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
  if (basis) {
    append(out, *basis);
    return out;
  }
  if (clusters.count > 0) {
    append(out, Bytes{3, clusters.count, clusters.blend} + varint(clusters.surprises.size()));
    for (const auto& [gap, cluster] : clusters.surprises) append(out, varint(gap) + varint(cluster));
    return out;
  }
  if (spring_modes > 0) {
    append(out, Bytes{2} + varint(spring_modes) + varint(runs.size()));
    for (const auto& [gap, more] : runs) append(out, varint(gap) + varint(more));
    return out;
  }
  if (mode_steps.empty() && !mode_count) {
    out.push_back(0);
    return out;
  }
  out.push_back(1);
  append(out, mode_count.value_or(varint(mode_steps.size())));
  for (std::size_t k = 0; k < mode_steps.size(); ++k) {
    ByteWriter(out).u16(mode_steps[k]);
    const std::size_t components = 3 * shape.rest.size();
    for (std::size_t i = 0; i < components; ++i) append(out, zigzag_varint(entries[k * components + i]));
  }
  return out;
}

RawHeader with_deformables(RawHeader header, const std::vector<RawDeformable>& items) {
  header.flags = 1;
  header.deformables = varint(items.size());
  for (const RawDeformable& item : items) append(header.deformables, item.bytes());
  return header;
}

std::vector<RawDeformable> with_large_states(int count) {
  std::vector<RawDeformable> out;
  out.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i)
    out.push_back({.shape = one_vertex(), .profile = 0, .name = std::to_string(i), .quant_bits = 12, .models_kept = 1});
  return out;
}

RawHeader only(const RawDeformable& item, std::uint8_t baseline_span) {
  RawHeader header;
  header.objects.clear();
  header.baseline_span = baseline_span;
  return with_deformables(header, {item});
}

Bytes around(const Bytes& items) {
  RawHeader header;
  header.objects.clear();
  header.flags = 1;
  header.deformables = items;
  return header.bytes();
}

Bytes counted(std::uint64_t vertices, std::uint64_t triangles, const Bytes& rest) {
  return around(Bytes{1, 1, 1, 'm', 2, 0, 1, 0, 0, 0, 0, 0, 1} + varint(vertices) + varint(triangles) + rest);
}

RawDeformable with_modes(RawDeformable item, std::size_t modes, std::uint64_t seed) {
  Random random(seed);
  for (std::size_t k = 0; k < modes; ++k) {
    item.mode_steps.push_back(static_cast<std::uint16_t>(512 + random.below(4096)));
    std::array<std::int32_t, 3> slope{}, offset{};
    for (auto& c : slope) c = random.integer(9);
    for (auto& c : offset) c = random.integer(9);
    for (const Vec3i& p : item.shape.rest)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::int64_t entry = offset[axis] + ((std::int64_t{slope[axis]} * (p[axis] + 2 * p[(axis + 1) % 3])) >> 14);
        item.entries.push_back(static_cast<std::int32_t>(std::clamp<std::int64_t>(entry, -2047, 2047)));
      }
  }
  return item;
}

struct DeformableComposer::Fixed {
  Fixed(const Scene& header, std::size_t index)
      : item(header.deformables[index]),
        span(header.baseline_span),
        initial(initial_main_state(item)),
        initial_thesis(initial_thesis_state(item)),
        hierarchy(vertex_hierarchy(item)),
        rings(item),
        predictor(item),
        pass(hierarchy, item.rest.size()) {}

  const DeformableObject item;
  const std::uint8_t span;
  const MainState initial;
  const ThesisState initial_thesis;
  const VertexHierarchy hierarchy;
  Rings rings;
  ShapePredictor predictor;
  VertexCoder pass;
};

DeformableComposer::DeformableComposer(const Scene& header, std::size_t item) : fixed_(std::make_unique<Fixed>(header, item)) {}
DeformableComposer::DeformableComposer(DeformableComposer&&) noexcept = default;
DeformableComposer::~DeformableComposer() = default;

const DeformableObject& DeformableComposer::item() const { return fixed_->item; }

template <class State>
const State& DeformableComposer::baseline(const PacketPlace& at, const std::map<std::uint16_t, State>& states,
                                          const State& initial) {
  sequence_ = at.sequence.value_or(next_sequence_);
  const auto found = states.find(static_cast<std::uint16_t>(sequence_ - at.baseline));
  return at.key || found == states.end() ? initial : found->second;
}

template <class State>
void DeformableComposer::keep(const PacketPlace& at, std::map<std::uint16_t, State>& states, State state) {
  state.tick = at.tick;
  states[sequence_] = std::move(state);
  next_sequence_ = static_cast<std::uint16_t>(sequence_ + 1);
}

Bytes DeformableComposer::packet(const MainStep& step) {
  const DeformableObject& item = fixed_->item;
  const MainState base = baseline(step.at, main_states_, fixed_->initial);
  MainState next = base;
  MainHead head{{step.at.key, step.at.baseline, static_cast<std::uint32_t>(step.at.tick - base.tick)}};
  head.layer = step.layer;
  head.same_frame = step.same_frame;
  head.touched = step.triangle.has_value();
  head.triangle = step.triangle.value_or(base.triangle);
  head.haptic = step.triangle ? step.haptic : base.haptic;
  head.visual = step.visual;
  head.density = step.density;
  head.weight_set = step.weight_set;
  head.following = step.following;
  std::vector<std::int32_t> coefficients = step.coefficients;
  coefficients.resize(item.basis.steps.size());
  Bytes packet = with_payload(sequence_, [&](RangeEncoder& coder) {
    MainModels models = main_start_models();
    code_main_start(coder, models, item, fixed_->span, head);
    code_main_head(coder, models, item, fixed_->rings, base, head);
    fixed_->pass.set_packet(head, fixed_->rings, item.rings);
    std::vector<Vec3i> expected(item.rest.size());
    fixed_->predictor.predict(base, step.at.tick, expected);
    fixed_->pass.fade(item, base, step.at.tick, expected, next);
    if (item.layered) fixed_->pass.begin_layer(base, head.same_frame, expected, next.displacement);
    if (head.layer == Layer::haptic) {
      keep_motion(base, next);
    } else {
      code_coefficients(coder, models, coefficients);
      scale_coefficients(item, mode_reach(head), coefficients);
      fixed_->predictor.add_modes(coefficients, expected);
      fixed_->predictor.update(base, step.at.tick, next);
    }
    const auto residual = [&](std::uint32_t v, const VertexContext& context, const Vec3i& place, std::uint32_t bound,
                              std::int64_t size) {
      Vec3i r = step.residuals ? step.residuals({v, place, bound, size}) : Vec3i{};
      code_vertex(coder, models, head.density, context, r);
      return r;
    };
    fixed_->pass.run(expected, next.displacement, residual);
    fixed_->pass.keep_off_basis(base, head.same_frame, next);
    fixed_->pass.keep_haptic_correction(head.layer, next);
    keep_head(head, base, next);
  });
  keep(step.at, main_states_, std::move(next));
  return packet;
}

Bytes DeformableComposer::packet(const ThesisStep& step) {
  const DeformableObject& item = fixed_->item;
  const ThesisState base = baseline(step.at, thesis_states_, fixed_->initial_thesis);
  ThesisState next = base;
  std::vector<BitModel> models = item.models_kept ? base.models : initial_thesis_models(item);
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
        code_symbol(coder, std::span(models).subspan(kIndexModels), item.quant_bits, symbol);
  });
  if (item.models_kept) next.models = models;
  keep(step.at, thesis_states_, std::move(next));
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
  return [&random, width, share](const VertexPrediction&) {
    Vec3i r{};
    if (random.below(256) < share)
      for (std::int32_t& c : r) c = random.integer(width);
    return r;
  };
}

Residuals towards(std::function<Vec3i(std::uint32_t)> target) {
  return [target = std::move(target)](const VertexPrediction& at) {
    const Vec3i goal = target(at.vertex);
    Vec3i r{};
    std::int64_t square = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::int64_t error = std::int64_t{goal[axis]} - at.predicted[axis];
      square += error * error;
      r[axis] = static_cast<std::int32_t>(round_div(error, at.step));
    }
    return square > std::int64_t{at.bound} * at.bound ? r : Vec3i{};
  };
}

Bytes random_walk(const RawDeformable& item, std::uint64_t seed, int packets, std::uint8_t span, std::int64_t frame) {
  DeformableStream stream(only(item, span));
  Random random(seed);
  const auto sets = static_cast<std::uint32_t>(std::popcount(item.weight_sets));
  const auto triangles = static_cast<std::uint32_t>(item.shape.triangles.size());
  std::int64_t tick = 0;
  for (int i = 0; i < packets; ++i) {
    MainStep step{.at = {.tick = tick, .key = i == 0}};
    if (i > 0 && span > 1) step.at.baseline = 1 + random.below(static_cast<std::uint32_t>(std::min<int>(i, span)));
    if (triangles > 0 && random.below(4) > 0) step.triangle = random.below(triangles);
    step.haptic = random.below(60);
    step.visual = random.below(3) == 0 ? random.below(1000) : 100;
    step.density = random.below(4);
    if (sets > 1) step.weight_set = random.below(sets);
    for (std::size_t k = 0; k < item.modes(); ++k) step.coefficients.push_back(random.integer(6));
    step.residuals = random_residuals(random, 6, 64 * (step.density + 1) - 1);
    stream.add(step);
    tick += frame * random.below(4);
  }
  return stream.finished();
}

RawHeader main_scene(std::uint8_t span) {
  return only(with_modes({.shape = {sheet(2, 2).rest, {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}}}}, 2, 680), span);
}

DeformableStream two_main_packets(std::uint8_t span) {
  DeformableStream stream(main_scene(span));
  stream.add(MainStep{.at = {.tick = 10, .key = true}, .triangle = 0u, .haptic = 12});
  stream.add(MainStep{.at = {.tick = 30}, .triangle = 0u, .haptic = 12});
  return stream;
}

DeformableStream two_thesis_packets(std::uint8_t span) {
  DeformableStream stream(only({.shape = sheet(2, 2), .profile = 0, .quant_bits = 4}, span));
  stream.add(ThesisStep{.at = {.tick = 10, .key = true}, .vertices = {{0}, {4, {1, 2, 3}}}});
  stream.add(ThesisStep{.at = {.tick = 30}, .vertices = {{8}}});
  return stream;
}

Bytes after_one_thesis_packet(std::uint8_t span, RawThesis raw) {
  DeformableStream stream(only({.shape = sheet(2, 2), .profile = 0, .quant_bits = 4}, span));
  stream.add(ThesisStep{.at = {.tick = 10, .key = true}, .vertices = {{0}}});
  raw.sequence = 1;
  raw.key = 0;
  return stream.add_packet(10, raw.bytes()).bytes();
}

}  // namespace tactus::conformance
