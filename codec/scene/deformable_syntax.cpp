// SPDX-License-Identifier: Apache-2.0
#include <tactus/scene/deformable_syntax.h>

#include <algorithm>
#include <limits>
#include <utility>

#include <tactus/base/rule.h>
#include <tactus/mesh/basis.h>
#include <tactus/scene/elastic_syntax.h>
#include <tactus/scene/scene_rules.h>

namespace tactus {
namespace {

constexpr std::uint32_t kNoVertex = 0xffffffff;
constexpr std::uint8_t kNoBasis = 0, kDeclared = 1, kComputed = 2, kClusters = 3;  // basis

bool are_parameters(const DeformableObject& m) noexcept {
  if (m.rings > DeformableObject::kMaxRings) return false;
  if (m.profile == DeformableProfile::thesis) return m.quant_bits >= 1 && m.quant_bits <= DeformableObject::kMaxQuantBits;
  if (m.weight_sets < 1 || m.weight_sets >= 1u << DeformableObject::kWeightSets) return false;
  return m.frame_period >= 1 && m.frame_period <= DeformableObject::kMaxFramePeriod;
}

bool is_triangle(const Triangle& t, std::size_t vertices) noexcept {
  return t[0] < vertices && t[1] < vertices && t[2] < vertices && t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
}

/// What has been computed from it does not matter.
bool is_spring_basis(const DeformableObject& m) noexcept {
  const SpringBasis& s = m.spring_basis;
  if (m.profile == DeformableProfile::thesis || s.modes > ModeBasis::kMaxModes) return false;
  return are_runs(s.fixed, m.rest.size()) && s.modes <= 3 * (m.rest.size() - s.fixed.size());
}

bool is_cluster_basis(const DeformableObject& m) noexcept {
  const ClusterBasis& c = m.cluster_basis;
  if (m.profile == DeformableProfile::thesis || m.spring_basis.modes > 0) return false;
  return c.count <= ClusterBasis::kMaxClusters && c.blend <= ClusterBasis::kMaxBlend && c.clusters.size() == m.rest.size() &&
         std::ranges::all_of(c.clusters, [&](std::uint8_t cluster) { return cluster < c.count; });
}

bool is_basis(const DeformableObject& m) noexcept {
  const ModeBasis& b = m.basis;
  if (m.cluster_basis.count > 0) return is_cluster_basis(m);
  if (!m.cluster_basis.clusters.empty() || !b.cluster_entries.items.empty()) return false;
  if (m.spring_basis.modes > 0) return is_spring_basis(m);
  if (!m.spring_basis.fixed.empty()) return false;
  if (b.steps.size() > ModeBasis::kMaxModes || b.entries.size() != 3 * m.rest.size() * b.steps.size()) return false;
  if (m.profile == DeformableProfile::thesis && !b.steps.empty()) return false;
  return std::none_of(b.steps.begin(), b.steps.end(), [](std::uint16_t s) { return s == 0; }) &&
         std::all_of(b.entries.begin(), b.entries.end(),
                     [](std::int16_t e) { return e >= -ModeBasis::kMaxEntry && e <= ModeBasis::kMaxEntry; });
}

Result<void> parse_parameters(ByteReader& in, bool has_thesis, DeformableObject& object) {
  const std::uint8_t profile = in.u8();
  const bool is_main = profile == static_cast<std::uint8_t>(DeformableProfile::main);
  const bool is_thesis = profile == static_cast<std::uint8_t>(DeformableProfile::thesis);
  if (in.ok() && !is_main && !(is_thesis && has_thesis)) return fail(Errc::unsupported, "R-DEF-2", in.bit_offset());
  object.profile = static_cast<DeformableProfile>(profile);
  const auto name = in.bytes(in.u8());
  object.name.assign(name.begin(), name.end());
  object.rings = in.u8();
  if (object.profile == DeformableProfile::thesis) {
    object.quant_bits = in.u8();
    const std::uint8_t kept = in.u8();
    if (in.ok() && kept > 1) return fail(Errc::malformed, "R-DEF-3", in.bit_offset());
    object.models_kept = kept == 1;
  } else {
    object.frame_period = in.u32();
    const std::uint8_t layered = in.u8();
    if (in.ok() && layered > 1) return fail(Errc::malformed, "R-DEF-3", in.bit_offset());
    object.layered = layered == 1;
    object.fade = in.u16();
    object.weight_sets = in.u8();
  }
  return {};
}

/// First corner as a difference from the first corner before, the others from the corner before.
Result<void> parse_triangles(ByteReader& in, std::uint64_t count, DeformableObject& object) {
  object.triangles.reserve(static_cast<std::size_t>(count));
  std::uint32_t first = 0;
  for (std::uint64_t t = 0; t < count; ++t) {
    Triangle triangle{};
    std::int64_t last = first;
    for (std::uint32_t& corner : triangle) {
      constexpr std::uint64_t kFarthest =
          4 * kMaxMeshVertices;  // a difference so large leads to no vertex, nor do those after it
      last += unzigzag(std::min(in.varint(), kFarthest));
      corner = last < 0 || last >= std::int64_t{kMaxMeshVertices} ? kNoVertex : static_cast<std::uint32_t>(last);
    }
    if (!in.ok()) return fail(class_of_overflow(in), "R-STR-5", in.bit_offset());
    if (!is_triangle(triangle, object.rest.size())) return fail(Errc::invalid, "R-DEF-6", in.bit_offset());
    object.triangles.push_back(triangle);
    first = triangle[0];
  }
  return {};
}

Result<void> parse_declared(ByteReader& in, std::uint64_t modes, DeformableObject& object) {
  const std::size_t components = 3 * object.rest.size();
  if (modes * (components + 2) > in.remaining()) return fail(Errc::truncated, "R-STR-5", in.bit_offset());
  object.basis.entries.reserve(static_cast<std::size_t>(modes) * components);
  for (std::uint64_t k = 0; k < modes; ++k) {
    const std::uint16_t step = in.u16();
    if (in.ok() && step == 0) return fail(Errc::invalid, "R-DEF-7", in.bit_offset());
    object.basis.steps.push_back(step);
    for (std::size_t i = 0; i < components; ++i) {
      const std::uint64_t entry = in.varint();
      if (entry > std::uint64_t{2} * ModeBasis::kMaxEntry) return fail(Errc::invalid, "R-DEF-7", in.bit_offset());
      object.basis.entries.push_back(static_cast<std::int16_t>(unzigzag(entry)));
    }
  }
  if (!in.ok()) return fail(class_of_overflow(in), "R-STR-5", in.bit_offset());
  return {};
}

Result<void> parse_springs(ByteReader& in, std::uint64_t modes, DeformableObject& object) {
  TACTUS_TRY(object.spring_basis.fixed, parse_runs(in, object.rest.size(), "R-DEF-7"));
  if (modes > 3 * (object.rest.size() - object.spring_basis.fixed.size())) return fail(Errc::invalid, "R-DEF-7", in.bit_offset());
  object.spring_basis.modes = static_cast<std::uint8_t>(modes);
  return {};
}

/// The cluster of every vertex, coded where it is not as expected.
Result<void> parse_clusters(ByteReader& in, DeformableObject& object) {
  const std::uint64_t count = in.varint();
  const std::uint8_t blend = in.u8();
  const std::uint64_t surprises = in.varint(), vertices = object.rest.size();
  if (!in.ok()) return fail(class_of_overflow(in), "R-STR-5", in.bit_offset());
  if (count < 1 || count > ClusterBasis::kMaxClusters || blend > ClusterBasis::kMaxBlend)
    return fail(Errc::invalid, "R-DEF-7", in.bit_offset());
  if (surprises > in.remaining() / 2) return fail(Errc::truncated, "R-STR-5", in.bit_offset());
  const Neighbours near = neighbours(object);
  object.cluster_basis = {static_cast<std::uint8_t>(count), blend, std::vector<std::uint8_t>(vertices)};
  std::vector<std::uint8_t>& clusters = object.cluster_basis.clusters;
  std::uint64_t end = 0;
  const auto expect_until = [&](std::uint64_t vertex) {
    for (; end < vertex; ++end) {
      const auto v = static_cast<std::uint32_t>(end);
      clusters[v] = expected_cluster(near[v], clusters, v);
    }
  };
  for (std::uint64_t i = 0; i < surprises; ++i) {
    const std::uint64_t gap = in.varint(), cluster = in.varint();
    if (!in.ok()) return fail(class_of_overflow(in), "R-STR-5", in.bit_offset());
    if (gap >= vertices - end || cluster >= count) return fail(Errc::invalid, "R-DEF-7", in.bit_offset());
    expect_until(end + gap);
    const auto v = static_cast<std::uint32_t>(end++);
    if (expected_cluster(near[v], clusters, v) == cluster) return fail(Errc::invalid, "R-DEF-7", in.bit_offset());
    clusters[v] = static_cast<std::uint8_t>(cluster);
  }
  expect_until(vertices);
  return {};
}

Result<void> parse_basis(ByteReader& in, DeformableObject& object) {
  const std::uint8_t basis = in.u8();
  if (!in.ok()) return fail(Errc::truncated, "R-STR-5", in.bit_offset());
  if (basis > kClusters) return fail(Errc::malformed, "R-DEF-7", in.bit_offset());
  if (basis == kNoBasis) return {};
  if (basis == kClusters) return parse_clusters(in, object);
  const std::uint64_t modes = in.varint();
  if (!in.ok()) return fail(class_of_overflow(in), "R-STR-5", in.bit_offset());
  if (modes < 1 || modes > ModeBasis::kMaxModes) return fail(Errc::invalid, "R-DEF-7", in.bit_offset());
  return basis == kDeclared ? parse_declared(in, modes, object) : parse_springs(in, modes, object);
}

void write_clusters(ByteWriter& out, const DeformableObject& object) {
  const ClusterBasis& basis = object.cluster_basis;
  const Neighbours near = neighbours(object);
  std::vector<std::uint32_t> surprises;
  for (std::uint32_t v = 0; v < basis.clusters.size(); ++v)
    if (expected_cluster(near[v], basis.clusters, v) != basis.clusters[v]) surprises.push_back(v);
  out.varint(basis.count);
  out.u8(basis.blend);
  out.varint(surprises.size());
  std::uint32_t end = 0;
  for (const std::uint32_t v : surprises) {
    out.varint(v - end);
    out.varint(basis.clusters[v]);
    end = v + 1;
  }
}

void write_basis(ByteWriter& out, const DeformableObject& object) {
  if (object.cluster_basis.count > 0) {
    out.u8(kClusters);
    return write_clusters(out, object);
  }
  if (object.spring_basis.modes > 0) {
    out.u8(kComputed);
    out.varint(object.spring_basis.modes);
    return write_runs(out, object.spring_basis.fixed);
  }
  if (object.basis.steps.empty()) return out.u8(kNoBasis);
  const std::size_t components = 3 * object.rest.size();
  out.u8(kDeclared);
  out.varint(object.basis.steps.size());
  for (std::size_t k = 0; k < object.basis.steps.size(); ++k) {
    out.u16(object.basis.steps[k]);
    for (std::size_t i = 0; i < components; ++i) out.varint(zigzag(object.basis.entries[k * components + i]));
  }
}

}  // namespace

Result<void> parse_positions(ByteReader& in, std::uint64_t count, std::vector<std::array<std::int32_t, 3>>& out) {
  out.reserve(static_cast<std::size_t>(count));
  std::array<std::int64_t, 3> at{};
  for (std::uint64_t v = 0; v < count; ++v) {
    for (std::int64_t& c : at) {
      const std::uint64_t step = in.varint();
      if (step >= std::uint64_t{1} << 34) return fail(Errc::invalid, "R-DEF-5", in.bit_offset());
      c += unzigzag(step);
      if (c < std::numeric_limits<std::int32_t>::min() || c > std::numeric_limits<std::int32_t>::max())
        return fail(Errc::invalid, "R-DEF-5", in.bit_offset());
    }
    if (!in.ok()) return fail(class_of_overflow(in), "R-STR-5", in.bit_offset());
    out.push_back({static_cast<std::int32_t>(at[0]), static_cast<std::int32_t>(at[1]), static_cast<std::int32_t>(at[2])});
  }
  return {};
}

void write_positions(ByteWriter& out, std::span<const std::array<std::int32_t, 3>> positions) {
  std::array<std::int32_t, 3> before{};
  for (const auto& p : positions) {
    for (std::size_t axis = 0; axis < 3; ++axis) out.varint(zigzag(std::int64_t{p[axis]} - before[axis]));
    before = p;
  }
}

RuleName broken_deformable_rule(const DeformableObject& object) noexcept {
  if (object.profile > DeformableProfile::main) return "R-DEF-2";
  if (!are_parameters(object)) return "R-DEF-3";
  if (object.rest.empty() || object.rest.size() > kMaxMeshVertices || object.triangles.size() > kMaxMeshTriangles)
    return "R-DEF-4";
  const bool triangles = std::all_of(object.triangles.begin(), object.triangles.end(),
                                     [&](const Triangle& t) { return is_triangle(t, object.rest.size()); });
  if (!triangles) return "R-DEF-6";
  if (!is_basis(object)) return "R-DEF-7";
  if (const RuleName rule = broken_elastic_rule(object)) return rule;
  return object.stiffness.empty() || object.stiffness.size() == object.rest.size() ? RuleName() : RuleName("R-STR-20");
}

void write_deformable(ByteWriter& out, const DeformableObject& object) {
  out.u8(static_cast<std::uint8_t>(object.profile));
  out.u8(static_cast<std::uint8_t>(object.name.size()));
  out.bytes({reinterpret_cast<const std::uint8_t*>(object.name.data()), object.name.size()});
  out.u8(object.rings);
  if (object.profile == DeformableProfile::thesis) {
    out.u8(object.quant_bits);
    out.u8(object.models_kept ? 1 : 0);
  } else {
    out.u32(object.frame_period);
    out.u8(object.layered ? 1 : 0);
    out.u16(object.fade);
    out.u8(object.weight_sets);
  }
  out.varint(object.rest.size());
  out.varint(object.triangles.size());
  write_positions(out, object.rest);
  std::uint32_t first = 0;
  for (const Triangle& t : object.triangles) {
    std::uint32_t last = first;
    for (const std::uint32_t corner : t) {
      out.varint(zigzag(std::int64_t{corner} - last));
      last = corner;
    }
    first = t[0];
  }
  if (object.profile == DeformableProfile::main) write_basis(out, object);
}

Result<DeformableObject> parse_deformable(ByteReader& in, const DeformableRoom& room) {
  DeformableObject object;
  TACTUS_CHECK(parse_parameters(in, room.has_thesis, object));
  const std::uint64_t vertices = in.varint(), triangles = in.varint();
  if (!in.ok()) return fail(class_of_overflow(in), "R-STR-5", in.bit_offset());
  if (!are_parameters(object)) return fail(Errc::invalid, "R-DEF-3", in.bit_offset());
  if (vertices < 1 || vertices > kMaxMeshVertices || triangles > kMaxMeshTriangles)
    return fail(Errc::invalid, "R-DEF-4", in.bit_offset());
  if (vertices > room.vertices || triangles > room.triangles) return fail(Errc::limit_exceeded, "R-STR-14", in.bit_offset());
  if (3 * (vertices + triangles) > in.remaining()) return fail(Errc::truncated, "R-STR-5", in.bit_offset());
  TACTUS_CHECK(parse_positions(in, vertices, object.rest));
  TACTUS_CHECK(parse_triangles(in, triangles, object));
  if (object.profile == DeformableProfile::main) TACTUS_CHECK(parse_basis(in, object));
  return object;
}

void write_stiffness(ByteWriter& out, std::uint8_t object, const DeformableObject& of) {
  out.varint(kStiffnessRecord);
  out.varint(1 + of.stiffness.size());
  out.u8(object);
  out.bytes(of.stiffness);
}

Result<void> parse_stiffness(ByteReader& in, std::span<DeformableObject> objects) {
  const std::uint8_t object = in.u8();
  if (!in.ok()) return fail(Errc::truncated, "R-STR-20", in.bit_offset());
  if (object >= objects.size() || !objects[object].stiffness.empty()) return fail(Errc::invalid, "R-STR-20", in.bit_offset());
  const auto levels = in.bytes(objects[object].rest.size());
  if (!in.ok()) return fail(Errc::truncated, "R-STR-20", in.bit_offset());
  objects[object].stiffness.assign(levels.begin(), levels.end());
  return {};
}

}  // namespace tactus
