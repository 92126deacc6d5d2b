// SPDX-License-Identifier: Apache-2.0
#include <tactus/scene/scene_syntax.h>

#include <algorithm>
#include <string_view>
#include <unordered_set>

#include <tactus/base/bytes.h>
#include <tactus/base/fixed.h>
#include <tactus/base/hash.h>
#include <tactus/base/out_of_memory.h>
#include <tactus/scene/bounds_syntax.h>
#include <tactus/scene/deformable_syntax.h>

namespace tactus {
namespace {

constexpr std::array<std::uint8_t, 4> kMagic{0x89, 'T', 'C', 'T'};
constexpr std::uint8_t kVersion = 1;
constexpr std::uint8_t kRigid = 1;
constexpr std::uint16_t kHasMeshes = 1;  // flag
constexpr std::size_t kMaxMeshes = 255;  // packets name them by a byte
constexpr std::size_t kFixedSize = 12;   // magic, version, profile, flags, body_size

/// Well-formed UTF-8 without control characters (RFC 3629).
bool is_plain_utf8(std::string_view text) noexcept {
  std::size_t i = 0;
  while (i < text.size()) {
    const auto lead = static_cast<std::uint8_t>(text[i++]);
    if (lead < 0x20 || lead == 0x7f) return false;
    if (lead < 0x80) continue;
    const unsigned tail = lead >= 0xf0 ? 3 : lead >= 0xe0 ? 2 : 1;
    if (lead < 0xc2 || lead > 0xf4 || text.size() - i < tail) return false;
    std::uint32_t point = lead & (0x3fu >> tail);
    for (unsigned k = 0; k < tail; ++k) {
      const auto byte = static_cast<std::uint8_t>(text[i++]);
      if ((byte & 0xc0) != 0x80) return false;
      point = (point << 6) | (byte & 0x3fu);
    }
    constexpr std::uint32_t kFirst[] = {0, 0x80, 0x800, 0x10000};
    if (point < kFirst[tail] || point > 0x10ffff || (point >= 0xd800 && point < 0xe000)) return false;
  }
  return true;
}

bool is_name(std::string_view name) noexcept { return !name.empty() && name.size() <= 255 && is_plain_utf8(name); }

bool is_dof(std::uint8_t dof) noexcept {
  const unsigned turns = static_cast<unsigned>(std::popcount(static_cast<unsigned>(dof >> 3)));
  return dof <= Dof::all && turns != 2;
}

/// Length within 2^-20 of 1: what a rounded unit quaternion and every product of them keep.
bool is_unit(const Quat30& q) noexcept {
  std::int64_t square = 0;
  for (const std::int32_t c : q) {
    if (c > kOne30 || c < -kOne30) return false;
    square += static_cast<std::int64_t>(c) * c;
  }
  constexpr std::int64_t one = std::int64_t{1} << 60;
  return square >= one - (one >> 19) && square <= one + (one >> 19);
}

bool are_exponents(const GridExponents& g) noexcept {
  return g.position >= 8 && g.position <= 30 && g.velocity <= g.position && g.position - g.velocity <= 12 && g.rotation >= 8 &&
         g.rotation <= 28 && g.spin <= g.rotation && g.spin <= 20 && g.rotation - g.spin <= 12;
}

const char* broken_object_rule(const RigidObject& object) noexcept {
  if (!is_name(object.name)) return "R-STR-11";
  if (!is_dof(object.dof)) return "R-STR-12";
  if (!is_unit(object.initial.rotation)) return "R-STR-13";
  return nullptr;
}

/// First rule that the stream parameters break; objects are checked one by one while they are read.
const char* broken_parameter_rule(const StreamHeader& h) noexcept {
  if (h.tick_rate < 1 || h.tick_rate > 1000000) return "R-STR-6";
  if (!are_exponents(h.grid)) return "R-STR-7";
  if (h.max_extrapolation < 1) return "R-STR-8";
  if (h.baseline_span < 1 || h.baseline_span > 64) return "R-STR-9";
  return nullptr;
}

Errc class_of_overflow(const ByteReader& in) noexcept { return in.overrun() ? Errc::truncated : Errc::malformed; }

Result<RigidObject> parse_object(ByteReader& body) {
  const std::uint64_t start = body.bit_offset();
  const std::uint8_t kind = body.u8();
  if (body.ok() && kind != kRigid) return fail(Errc::unsupported, "R-STR-10", start);
  RigidObject object;
  object.dof = body.u8();
  const auto name = body.bytes(body.u8());
  object.name.assign(name.begin(), name.end());
  for (auto& c : object.initial.position) c = body.i32();
  for (auto& c : object.initial.rotation) c = body.i32();
  if (!body.ok()) return fail(class_of_overflow(body), "R-STR-5", body.bit_offset());
  if (const char* rule = broken_object_rule(object)) return fail(Errc::invalid, rule, start);
  return object;
}

/// Records of unknown type are skipped.
Result<void> parse_extensions(ByteReader& body, StreamHeader& header) {
  while (body.remaining() > 0) {
    const std::uint64_t type = body.varint();
    ByteReader data = body.sub(body.varint());
    if (!body.ok()) return fail(Errc::malformed, "R-STR-16", body.bit_offset());
    if (type != kBoundsRecord) continue;
    if (header.bounds) return fail(Errc::invalid, "R-STR-17", data.bit_offset());
    TACTUS_TRY(header.bounds, parse_bounds(data, header));
  }
  return {};
}

Result<void> parse_meshes(ByteReader& body, const DecodeLimits& limits, StreamHeader& header) {
  const std::uint64_t count = body.varint();
  if (!body.ok()) return fail(class_of_overflow(body), "R-STR-5", body.bit_offset());
  if (count < 1) return fail(Errc::malformed, "R-MES-1", body.bit_offset());
  if (count > kMaxMeshes) return fail(Errc::invalid, "R-MES-1", body.bit_offset());
  if (count > limits.objects - header.objects.size()) return fail(Errc::limit_exceeded, "R-STR-14", body.bit_offset());
  DeformableRoom room{limits.vertices, limits.triangles};
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint64_t start = body.bit_offset();
    TACTUS_TRY(auto mesh, parse_deformable(body, room));
    if (!is_name(mesh.name)) return fail(Errc::invalid, "R-STR-11", start);
    room.vertices -= mesh.rest.size();
    room.triangles -= mesh.triangles.size();
    header.meshes.push_back(std::move(mesh));
  }
  return {};
}

Result<StreamHeader> parse_body(ByteReader body, Profile profile, std::uint16_t flags, const DecodeLimits& limits) {
  StreamHeader header;
  header.profile = profile;
  const std::uint64_t start = body.bit_offset();
  header.tick_rate = body.u32();
  header.grid.position = body.u8();
  header.grid.velocity = body.u8();
  header.grid.rotation = body.u8();
  header.grid.spin = body.u8();
  header.max_extrapolation = body.u16();
  header.baseline_span = body.u8();
  const std::uint64_t count = body.varint();
  if (!body.ok()) return fail(class_of_overflow(body), "R-STR-5", body.bit_offset());
  if (const char* rule = broken_parameter_rule(header)) return fail(Errc::invalid, rule, start);
  if (count > limits.objects) return fail(Errc::limit_exceeded, "R-STR-14", body.bit_offset());
  constexpr std::size_t kSmallestObject = 3 + 1 + 7 * 4;
  if (count > body.remaining() / kSmallestObject) return fail(Errc::truncated, "R-STR-5", body.bit_offset());
  header.objects.reserve(static_cast<std::size_t>(count));
  for (std::uint64_t i = 0; i < count; ++i) {
    TACTUS_TRY(auto object, parse_object(body));
    header.objects.push_back(std::move(object));
  }
  if (flags & kHasMeshes) TACTUS_CHECK(parse_meshes(body, limits, header));
  TACTUS_CHECK(parse_extensions(body, header));
  return header;
}

Result<void> find_broken_rule(const StreamHeader& header, const DecodeLimits& limits) {
  if (header.profile != Profile::thesis) return fail(Errc::unsupported, "R-STR-3");
  if (const char* rule = broken_parameter_rule(header)) return fail(Errc::invalid, rule);
  if (header.meshes.size() > kMaxMeshes) return fail(Errc::invalid, "R-MES-1");
  if (header.objects.size() + header.meshes.size() > limits.objects) return fail(Errc::limit_exceeded, "R-STR-14");
  std::unordered_set<std::string_view> names;
  for (const RigidObject& object : header.objects) {
    if (const char* rule = broken_object_rule(object)) return fail(Errc::invalid, rule);
    if (!names.insert(object.name).second) return fail(Errc::invalid, "R-STR-11");
    const RigidState at_rest{0, object.initial.position, object.initial.rotation, {}, {}};
    if (object.initial != at_rest) return fail(Errc::invalid, "R-API-8");
  }
  std::uint64_t vertices = 0, triangles = 0;
  for (const DeformableObject& mesh : header.meshes) {
    if (!is_name(mesh.name) || !names.insert(mesh.name).second) return fail(Errc::invalid, "R-STR-11");
    if (const char* rule = broken_deformable_rule(mesh)) return fail(Errc::invalid, rule);
    vertices += mesh.rest.size();
    triangles += mesh.triangles.size();
    if (vertices > limits.vertices || triangles > limits.triangles) return fail(Errc::limit_exceeded, "R-STR-14");
  }
  if (header.bounds && !are_bounds(header)) return fail(Errc::invalid, "R-STR-17");
  if (state_bytes(header) > limits.state_bytes) return fail(Errc::limit_exceeded, "R-STR-18");
  return {};
}

}  // namespace

Result<void> check_header(const StreamHeader& header, const DecodeLimits& limits) try {
  return find_broken_rule(header, limits);
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

Result<std::vector<std::uint8_t>> write_header(const StreamHeader& header) try {
  if (auto checked = find_broken_rule(header, {}); !checked) return fail(Errc::invalid_argument, checked.error().rule);
  std::vector<std::uint8_t> body;
  ByteWriter b(body);
  b.u32(header.tick_rate);
  b.u8(header.grid.position);
  b.u8(header.grid.velocity);
  b.u8(header.grid.rotation);
  b.u8(header.grid.spin);
  b.u16(header.max_extrapolation);
  b.u8(header.baseline_span);
  b.varint(header.objects.size());
  for (const RigidObject& object : header.objects) {
    b.u8(kRigid);
    b.u8(object.dof);
    b.u8(static_cast<std::uint8_t>(object.name.size()));
    b.bytes({reinterpret_cast<const std::uint8_t*>(object.name.data()), object.name.size()});
    for (const std::int32_t c : object.initial.position) b.i32(c);
    for (const std::int32_t c : object.initial.rotation) b.i32(c);
  }
  if (!header.meshes.empty()) b.varint(header.meshes.size());
  for (const DeformableObject& mesh : header.meshes) write_deformable(b, mesh);
  if (header.bounds) {
    const auto bounds = write_bounds(*header.bounds);
    b.varint(kBoundsRecord);
    b.varint(bounds.size());
    b.bytes(bounds);
  }
  std::vector<std::uint8_t> out;
  out.reserve(kFixedSize + body.size() + 4);
  ByteWriter w(out);
  for (const std::uint8_t byte : kMagic) w.u8(byte);
  w.u8(kVersion);
  w.u8(static_cast<std::uint8_t>(header.profile));
  w.u16(header.meshes.empty() ? 0 : kHasMeshes);
  w.u32(static_cast<std::uint32_t>(body.size()));
  w.bytes(body);
  w.u32(crc32(out));
  return out;
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

Result<ParsedHeader> parse_header(std::span<const std::uint8_t> bytes, const DecodeLimits& limits) try {
  ByteReader in(bytes);
  const auto magic = in.bytes(kMagic.size());
  if (!in.ok()) return fail(Errc::truncated, "R-STR-1");
  if (!std::ranges::equal(magic, kMagic)) return fail(Errc::malformed, "R-STR-1");
  const std::uint8_t version = in.u8();
  const std::uint8_t profile = in.u8();
  const std::uint16_t flags = in.u16();
  const std::uint32_t body_size = in.u32();
  if (!in.ok()) return fail(Errc::truncated, "R-STR-5", in.bit_offset());
  if (version != kVersion) return fail(Errc::unsupported, "R-STR-2", 32);
  if (profile > static_cast<std::uint8_t>(Profile::main)) return fail(Errc::malformed, "R-STR-3", 40);
  if (profile != static_cast<std::uint8_t>(Profile::thesis)) return fail(Errc::unsupported, "R-STR-3", 40);
  if (flags > kHasMeshes) return fail(Errc::malformed, "R-STR-4", 48);
  if (body_size > limits.header_bytes) return fail(Errc::limit_exceeded, "R-STR-14", 64);
  ByteReader body = in.sub(body_size);
  const std::uint32_t crc = in.u32();
  if (!in.ok()) return fail(Errc::truncated, "R-STR-5", in.bit_offset());
  if (crc != crc32(bytes.first(kFixedSize + body_size))) return fail(Errc::checksum, "R-STR-15", in.bit_offset() - 32);
  TACTUS_TRY(auto header, parse_body(body, static_cast<Profile>(profile), flags, limits));
  if (auto checked = check_header(header, limits); !checked) return fail(checked.error().code, checked.error().rule, 96);
  return ParsedHeader{std::move(header), in.position()};
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

std::uint64_t state_bytes(const StreamHeader& header) noexcept {
  const std::uint64_t states = header.baseline_span + 2u;  // the initial one and that of the packet at hand
  std::uint64_t sum = 64 * states * header.objects.size();
  for (const DeformableObject& mesh : header.meshes) {
    sum += states * ((mesh.split ? 24 : 12) * mesh.rest.size() + 48 * mesh.basis.steps.size());
    if (mesh.profile == DeformableProfile::thesis)
      sum += (mesh.models_kept ? states + 2 : 2) * 4 * (254 + (std::uint64_t{1} << mesh.quant_bits));
  }
  return sum;
}

StreamHeader without_meshes(const StreamHeader& header) {
  StreamHeader out;
  out.profile = header.profile;
  out.tick_rate = header.tick_rate;
  out.grid = header.grid;
  out.max_extrapolation = header.max_extrapolation;
  out.baseline_span = header.baseline_span;
  out.objects = header.objects;
  return out;
}

std::size_t max_packet_size(const StreamHeader& header) noexcept {
  const auto moving =
      static_cast<std::size_t>(std::ranges::count_if(header.objects, [](const RigidObject& o) { return o.dof != Dof::none; }));
  constexpr std::size_t kHead = 64;     // sequence, key, baseline, tick, count, tail
  constexpr std::size_t kUpdate = 192;  // gap, reason, level and 12 components at 15 bits per adaptive bit
  return kHead + kUpdate * moving;
}

std::size_t max_deformable_packet_size(const DeformableObject& mesh) noexcept {
  constexpr std::size_t kHead = 96;                       // fields, bounds, tails
  constexpr std::size_t kCoefficient = 16;                // a signed value at 15 bits per adaptive bit
  constexpr std::size_t kVertex = 40;                     // main: a flag and three signed values
  const std::size_t listed = 17u + 6u * mesh.quant_bits;  // thesis: a gap and three symbols at 15 bits per adaptive bit
  return kHead + kCoefficient * mesh.basis.steps.size() +
         (mesh.profile == DeformableProfile::main ? kVertex : listed) * mesh.rest.size();
}

}  // namespace tactus
