// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/messages.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <tactus/base/rule.h>
#include <tactus/base/text.h>
#include <tactus/trace/cdr.h>

namespace tactus {

namespace {

constexpr std::uint64_t kNanoseconds = 1'000'000'000;
constexpr std::string_view kFrame = "world";

CdrWriter begin(std::vector<std::uint8_t>& message, std::uint64_t time, std::string_view frame = kFrame) {
  CdrWriter out(message);
  out.u32(static_cast<std::uint32_t>(time / kNanoseconds));
  out.u32(static_cast<std::uint32_t>(time % kNanoseconds));
  out.text(frame);
  return out;
}

/// std_msgs/Header; nothing when the stamp is no time.
std::optional<std::uint64_t> read_header(CdrReader& in) noexcept {
  const std::uint32_t seconds = in.u32();
  const std::uint32_t nanoseconds = in.u32();
  in.text();
  if (seconds >= kMaxSeconds || nanoseconds >= kNanoseconds) return std::nullopt;
  return seconds * kNanoseconds + nanoseconds;
}

bool is_finite(const Pose& pose) noexcept { return is_finite(pose.position) && is_finite(pose.rotation); }
bool is_finite(const Twist& twist) noexcept { return is_finite(twist.linear) && is_finite(twist.angular); }
bool is_finite(const Contact& contact) noexcept { return is_valid(contact); }
bool is_finite(std::uint32_t) noexcept { return true; }
bool is_finite(std::int64_t time) noexcept { return time >= 0; }
bool is_finite(const SurfaceContact& contact) noexcept { return is_valid(contact); }
bool is_finite(const ServoSample& servo) noexcept { return servo.lateness >= 0 && servo.age >= 0; }

Quat read_quaternion(CdrReader& in) noexcept { return in.quat(); }
Pose read_pose(CdrReader& in) noexcept { return in.pose(); }
std::uint32_t read_buttons(CdrReader& in) noexcept { return in.u32(); }

/// Negative: no time.
std::int64_t read_time_reference(CdrReader& in) noexcept {
  const std::uint32_t seconds = in.u32(), nanoseconds = in.u32();
  in.text();  // source
  return seconds >= kMaxSeconds || nanoseconds >= kNanoseconds ? -1
                                                               : static_cast<std::int64_t>(seconds * kNanoseconds + nanoseconds);
}

Twist read_twist(CdrReader& in) noexcept {
  const Vec3 linear = in.vec3();
  return {linear, in.vec3()};
}

Vec3 read_vector(CdrReader& in) noexcept { return in.vec3(); }

Contact read_contact(CdrReader& in) noexcept {
  Contact contact;
  contact.kind = static_cast<ContactKind>(in.u8());
  contact.object = in.u32();
  in.text();
  contact.point = in.vec3();
  contact.normal = in.vec3();
  contact.stiffness = in.f64();
  return contact;
}

SurfaceContact read_mesh_contact(CdrReader& in) noexcept {
  SurfaceContact contact;
  contact.mesh = in.u32();
  in.text();
  contact.triangle = in.u32();
  for (double& weight : contact.weights) weight = in.f64();
  contact.proxy = in.vec3();
  contact.normal = in.vec3();
  contact.stiffness = in.f64();
  return contact;
}

ServoSample read_servo(CdrReader& in) noexcept {
  ServoSample servo;
  servo.lateness = in.i64();
  servo.age = in.i64();
  servo.missed = in.u32();
  servo.guard = in.u32();
  return servo;
}

template <class T>
Result<Stamped<T>> decode(std::span<const std::uint8_t> message, T (*read)(CdrReader&) noexcept) noexcept {
  CdrReader in(message);
  if (!in.is_supported()) return fail(Errc::unsupported, "R-TRC-7");
  const auto time = read_header(in);
  const T value = read(in);
  if (!in.done()) return fail(Errc::malformed, "R-TRC-13");
  if (!time || !is_finite(value)) return fail(Errc::invalid, "R-TRC-14");
  return Stamped<T>{*time, value};
}

}  // namespace

std::uint64_t time_of_tick(std::int64_t tick, std::uint32_t tick_rate) noexcept {
  const auto count = static_cast<std::uint64_t>(tick);
  return count / tick_rate * kNanoseconds + (count % tick_rate * kNanoseconds + tick_rate / 2) / tick_rate;
}

std::int64_t tick_of_time(std::uint64_t time, std::uint32_t tick_rate) noexcept {
  const std::uint64_t rest = (time % kNanoseconds * tick_rate + kNanoseconds / 2) / kNanoseconds;
  return static_cast<std::int64_t>(time / kNanoseconds * tick_rate + rest);
}

bool is_valid(const Contact& contact) noexcept {
  const bool known = contact.kind == ContactKind::surface || contact.kind == ContactKind::spring;
  return known && is_finite(contact.point) && is_finite(contact.normal) && is_finite(contact.device) &&
         std::isfinite(contact.stiffness) && contact.stiffness > 0;
}

bool is_valid(const SurfaceContact& contact) noexcept {
  constexpr double kRounding = 1e-6;  // weights of another program may be single precision
  const auto& [a, b, c] = contact.weights;
  const bool has_weights = std::min({a, b, c}) >= -kRounding && std::abs(a + b + c - 1) <= kRounding;  // so no NaN either
  return has_weights && is_finite(contact.proxy) && is_finite(contact.normal) && std::isfinite(contact.stiffness) &&
         contact.stiffness > 0;
}

void encode_pose(std::vector<std::uint8_t>& message, std::uint64_t time, const Pose& pose) {
  CdrWriter out = begin(message, time);
  out.vec3(pose.position);
  out.quat(pose.rotation);
}

void encode_twist(std::vector<std::uint8_t>& message, std::uint64_t time, const Twist& twist) {
  CdrWriter out = begin(message, time);
  out.vec3(twist.linear);
  out.vec3(twist.angular);
}

void encode_vector(std::vector<std::uint8_t>& message, std::uint64_t time, const Vec3& vector) {
  CdrWriter out = begin(message, time);
  out.vec3(vector);
}

void encode_quaternion(std::vector<std::uint8_t>& message, std::uint64_t time, const Quat& quaternion) {
  CdrWriter out = begin(message, time);
  out.quat(quaternion);
}

void encode_buttons(std::vector<std::uint8_t>& message, std::uint64_t time, std::uint32_t down) {
  CdrWriter out = begin(message, time);
  out.u32(down);
}

void encode_time_reference(std::vector<std::uint8_t>& message, std::uint64_t time, std::int64_t device) {
  CdrWriter out = begin(message, time);
  const auto ns = static_cast<std::uint64_t>(device);
  out.u32(static_cast<std::uint32_t>(ns / kNanoseconds));
  out.u32(static_cast<std::uint32_t>(ns % kNanoseconds));
  out.text("device");
}

void encode_contact(std::vector<std::uint8_t>& message, std::uint64_t time, const Contact& contact, std::string_view object) {
  CdrWriter out = begin(message, time, object);
  out.u8(static_cast<std::uint8_t>(contact.kind));
  out.u32(contact.object);
  out.text(object);
  out.vec3(contact.point);
  out.vec3(contact.normal);
  out.f64(contact.stiffness);
}

Result<Stamped<Pose>> decode_pose(std::span<const std::uint8_t> message) noexcept { return decode(message, read_pose); }
Result<Stamped<Twist>> decode_twist(std::span<const std::uint8_t> message) noexcept { return decode(message, read_twist); }
Result<Stamped<Vec3>> decode_vector(std::span<const std::uint8_t> message) noexcept { return decode(message, read_vector); }
Result<Stamped<Quat>> decode_quaternion(std::span<const std::uint8_t> message) noexcept {
  return decode(message, read_quaternion);
}
Result<Stamped<std::uint32_t>> decode_buttons(std::span<const std::uint8_t> message) noexcept {
  return decode(message, read_buttons);
}
Result<Stamped<std::int64_t>> decode_time_reference(std::span<const std::uint8_t> message) noexcept {
  return decode(message, read_time_reference);
}
Result<Stamped<Contact>> decode_contact(std::span<const std::uint8_t> message) noexcept { return decode(message, read_contact); }

Result<Stamped<SurfaceContact>> decode_mesh_contact(std::span<const std::uint8_t> message) noexcept {
  return decode(message, read_mesh_contact);
}

void encode_servo(std::vector<std::uint8_t>& message, std::uint64_t time, const ServoSample& servo) {
  CdrWriter out = begin(message, time);
  out.i64(servo.lateness);
  out.i64(servo.age);
  out.u32(servo.missed);
  out.u32(servo.guard);
}

Result<Stamped<ServoSample>> decode_servo(std::span<const std::uint8_t> message) noexcept { return decode(message, read_servo); }

void encode_reports(std::vector<std::uint8_t>& message, std::uint64_t time, const DeviceReports& reports) {
  CdrWriter out = begin(message, time);
  out.u32(static_cast<std::uint32_t>(reports.sizes.size()));
  for (const std::uint32_t size : reports.sizes) out.u32(size);
  out.u32(static_cast<std::uint32_t>(reports.bytes.size()));
  for (const std::uint8_t byte : reports.bytes) out.u8(byte);
}

Result<std::uint64_t> decode_reports(std::span<const std::uint8_t> message, DeviceReports& out) {
  CdrReader in(message);
  if (!in.is_supported()) return fail(Errc::unsupported, "R-TRC-7");
  const auto time = read_header(in);
  out.sizes.resize(in.count(sizeof(std::uint32_t)));
  for (std::uint32_t& size : out.sizes) size = in.u32();
  out.bytes.resize(in.count(1));
  for (std::uint8_t& byte : out.bytes) byte = in.u8();
  if (!in.done()) return fail(Errc::malformed, "R-TRC-13");
  if (!time || out.sizes.empty() || !is_valid(out)) return fail(Errc::invalid, "R-TRC-14");
  return *time;
}

void encode_log(std::vector<std::uint8_t>& message, std::uint64_t time, std::string_view text) {
  constexpr std::uint8_t kInfo = 20;
  CdrWriter out(message);
  out.u32(static_cast<std::uint32_t>(time / kNanoseconds));
  out.u32(static_cast<std::uint32_t>(time % kNanoseconds));
  out.u8(kInfo);
  out.text("tactus");
  out.text(text);
  out.text("");  // file, function
  out.text("");
  out.u32(0);  // line
}

Result<Stamped<std::string_view>> decode_log(std::span<const std::uint8_t> message) noexcept {
  CdrReader in(message);
  if (!in.is_supported()) return fail(Errc::unsupported, "R-TRC-7");
  const std::uint32_t seconds = in.u32(), nanoseconds = in.u32();
  in.u8();
  in.text();
  const std::string_view text = in.text();
  in.text();
  in.text();
  in.u32();
  if (!in.done()) return fail(Errc::malformed, "R-TRC-13");
  if (seconds >= kMaxSeconds || nanoseconds >= kNanoseconds) return fail(Errc::invalid, "R-TRC-14");
  if (!is_utf8(text)) return fail(Errc::invalid, "R-TRC-11");
  return Stamped<std::string_view>{seconds * kNanoseconds + nanoseconds, text};
}

void encode_mesh(std::vector<std::uint8_t>& message, const TriMesh& mesh) {
  CdrWriter out(message);
  out.u32(static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t corner : triangle) out.u32(corner);
  out.u32(static_cast<std::uint32_t>(mesh.vertices.size()));
  for (const Vec3& vertex : mesh.vertices) out.vec3(vertex);
}

Result<TriMesh> decode_mesh(std::span<const std::uint8_t> message) {
  CdrReader in(message);
  if (!in.is_supported()) return fail(Errc::unsupported, "R-TRC-7");
  TriMesh mesh;
  mesh.triangles.resize(in.count(3 * sizeof(std::uint32_t)));
  for (Triangle& triangle : mesh.triangles)
    for (std::uint32_t& corner : triangle) corner = in.u32();
  mesh.vertices.resize(in.count(3 * sizeof(double)));
  for (Vec3& vertex : mesh.vertices) vertex = in.vec3();
  if (!in.done()) return fail(Errc::malformed, "R-TRC-13");
  if (const auto sound = check(mesh); !sound) return tl::unexpected(sound.error().error);
  return mesh;
}

void encode_displacements(std::vector<std::uint8_t>& message, std::uint64_t time, std::span<const float> displacements) {
  CdrWriter out = begin(message, time);
  out.u32(static_cast<std::uint32_t>(displacements.size()));
  for (const float value : displacements) out.f32(value);
}

Result<std::uint64_t> decode_displacements(std::span<const std::uint8_t> message, std::span<float> out) noexcept {
  CdrReader in(message);
  if (!in.is_supported()) return fail(Errc::unsupported, "R-TRC-7");
  const auto time = read_header(in);
  const std::uint32_t count = in.count(sizeof(float));
  if (count == out.size())
    for (float& value : out) value = in.f32();
  else
    for (std::uint32_t i = 0; i < count; ++i) in.f32();
  if (!in.done()) return fail(Errc::malformed, "R-TRC-13");
  const bool is_sound =
      count == out.size() && std::all_of(out.begin(), out.end(), [](float value) { return std::isfinite(value); });
  if (!time || !is_sound) return fail(Errc::invalid, "R-TRC-14");
  return *time;
}

void encode_mesh_contact(std::vector<std::uint8_t>& message, std::uint64_t time, const SurfaceContact& contact,
                         std::string_view mesh) {
  CdrWriter out = begin(message, time);
  out.u32(contact.mesh);
  out.text(mesh);
  out.u32(contact.triangle);
  for (const double weight : contact.weights) out.f64(weight);
  out.vec3(contact.proxy);
  out.vec3(contact.normal);
  out.f64(contact.stiffness);
}

}  // namespace tactus
