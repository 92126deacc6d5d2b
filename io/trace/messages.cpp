// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/messages.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <tactus/base/rule.h>
#include <tactus/base/text.h>
#include <tactus/trace/ros_definitions.h>

namespace tactus {

// ==== cdr ====

namespace {

constexpr std::array<std::uint8_t, 4> kLittleEndian{0x00, 0x01, 0x00, 0x00};

constexpr std::size_t padding(std::size_t position, std::size_t size) noexcept { return (size - position % size) % size; }

}  // namespace

CdrWriter::CdrWriter(std::vector<std::uint8_t>& out) : bytes_(out), out_(out) {
  out.assign(kLittleEndian.begin(), kLittleEndian.end());
}

void CdrWriter::align(std::size_t size) {
  if (const std::size_t missing = padding(bytes_.size() - kLittleEndian.size(), size); missing > 0)
    bytes_.insert(bytes_.end(), missing, 0);
}

namespace {

/// Least significant byte first, all in one go: most of what a trace is made of.
template <class Number>
void put(std::vector<std::uint8_t>& out, Number value) {
  std::array<std::uint8_t, sizeof value> bytes;
  for (std::size_t i = 0; i < sizeof value; ++i) bytes[i] = static_cast<std::uint8_t>(value >> (8 * i));
  out.insert(out.end(), bytes.begin(), bytes.end());
}

}  // namespace

void CdrWriter::u32(std::uint32_t value) {
  align(sizeof value);
  put(bytes_, value);
}

void CdrWriter::i64(std::int64_t value) {
  align(sizeof value);
  put(bytes_, static_cast<std::uint64_t>(value));
}

void CdrWriter::f64(double value) { i64(std::bit_cast<std::int64_t>(value)); }

void CdrWriter::text(std::string_view value) {
  u32(static_cast<std::uint32_t>(value.size() + 1));
  out_.bytes({reinterpret_cast<const std::uint8_t*>(value.data()), value.size()});
  u8(0);
}

void CdrWriter::vec3(const Vec3& value) {
  f64(value.x);
  f64(value.y);
  f64(value.z);
}

void CdrWriter::quat(const Quat& value) {
  f64(value.x);
  f64(value.y);
  f64(value.z);
  f64(value.w);
}

CdrReader::CdrReader(std::span<const std::uint8_t> message) noexcept
    : supported_(message.size() >= kLittleEndian.size() &&
                 std::equal(kLittleEndian.begin(), kLittleEndian.begin() + 2, message.begin())),
      body_(message.subspan(std::min(message.size(), kLittleEndian.size()))) {}

void CdrReader::align(std::size_t size) noexcept { body_.bytes(padding(body_.position(), size)); }

std::uint32_t CdrReader::u32() noexcept {
  align(sizeof(std::uint32_t));
  return body_.u32();
}

std::int64_t CdrReader::i64() noexcept {
  align(sizeof(std::int64_t));
  return static_cast<std::int64_t>(body_.u64());
}

double CdrReader::f64() noexcept { return std::bit_cast<double>(i64()); }

std::uint32_t CdrReader::count(std::size_t item_size) noexcept {
  const std::uint32_t items = u32();
  if (items <= body_.remaining() / item_size) return items;
  malformed_ = true;
  return 0;
}

std::string_view CdrReader::text() noexcept {
  const auto raw = body_.bytes(u32());
  if (raw.empty() || raw.back() != 0) {
    malformed_ = true;
    return {};
  }
  return {reinterpret_cast<const char*>(raw.data()), raw.size() - 1};
}

Vec3 CdrReader::vec3() noexcept {
  const double x = f64(), y = f64();
  return {x, y, f64()};
}

Quat CdrReader::quat() noexcept {
  Quat q;
  q.x = f64();
  q.y = f64();
  q.z = f64();
  q.w = f64();
  return q;
}

Pose CdrReader::pose() noexcept {
  const Vec3 position = vec3();
  return {position, quat()};
}

// ==== schemas ====

namespace {

using ros::Definition, ros::definition_text, ros::kPoint, ros::kPose, ros::kQuaternion, ros::kTime, ros::kVector3;

constexpr Definition kHeader{"std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n"};
constexpr Definition kMeshTriangle{"shape_msgs/MeshTriangle", "uint32[3] vertex_indices\n"};
constexpr Definition kTwist{"geometry_msgs/Twist", "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n"};

struct Message {
  std::string_view fields;
  std::vector<Definition> dependencies;
};

Message contact_message() {
  return {
      "# A user's probe touches one object. No message at a tick: no contact.\n"
      "uint8 SURFACE=1\n"
      "uint8 SPRING=2\n"
      "std_msgs/Header header\n"
      "# SURFACE: force along the face's normal only. SPRING: probe tied to a point, whole vector.\n"
      "uint8 kind\n"
      "# The object touched, by its place in the trace and by its name.\n"
      "uint32 object_index\n"
      "string object\n"
      "# [m] in the object's frame: a point of the face, or the spring's anchor.\n"
      "geometry_msgs/Point point\n"
      "# In the object's frame, outward, unit length.\n"
      "geometry_msgs/Vector3 normal\n"
      "# [N/m]\n"
      "float64 stiffness\n",
      {kHeader, kTime, kPoint, kVector3}};
}

Message message_of(MessageType type) {
  switch (type) {
    case MessageType::pose:
      return {"std_msgs/Header header\ngeometry_msgs/Pose pose\n", {kHeader, kTime, kPose, kPoint, kQuaternion}};
    case MessageType::twist:
      return {"std_msgs/Header header\ngeometry_msgs/Twist twist\n", {kHeader, kTime, kTwist, kVector3}};
    case MessageType::point:
      return {"std_msgs/Header header\ngeometry_msgs/Point point\n", {kHeader, kTime, kPoint}};
    case MessageType::vector:
      return {"std_msgs/Header header\ngeometry_msgs/Vector3 vector\n", {kHeader, kTime, kVector3}};
    case MessageType::mesh:
      return {"shape_msgs/MeshTriangle[] triangles\ngeometry_msgs/Point[] vertices\n", {kMeshTriangle, kPoint}};
    case MessageType::displacements:
      return {
          "# How far every vertex of a mesh is from its place at rest. No message at a tick: as before.\n"
          "std_msgs/Header header\n"
          "# [m] x, y, z of the first vertex, then of the second\n"
          "float32[] data\n",
          {kHeader, kTime}};
    case MessageType::contact:
      return contact_message();
    case MessageType::quaternion:
      return {"std_msgs/Header header\ngeometry_msgs/Quaternion quaternion\n", {kHeader, kTime, kQuaternion}};
    case MessageType::buttons:
      return {
          "# Buttons of a device. No message at a tick: as before.\n"
          "std_msgs/Header header\n"
          "# Bit i is set while button i is down.\n"
          "uint32 down\n",
          {kHeader, kTime}};
    case MessageType::time_reference:
      return {"std_msgs/Header header\nbuiltin_interfaces/Time time_ref\nstring source\n", {kHeader, kTime}};
    case MessageType::servo:
      return {
          "# How a tick of a captured device went.\n"
          "std_msgs/Header header\n"
          "# [ns] The tick began so long after its time; the device's sample was so old then.\n"
          "int64 lateness\n"
          "int64 age\n"
          "# Ticks left out before this one.\n"
          "uint32 missed\n"
          "# What was done to the force: 1 not finite, 2 stale, 4 sample not valid, 8 clamp, 16 passivity, 32 slew.\n"
          "uint32 guard\n",
          {kHeader, kTime}};
    case MessageType::log:
      return {
          "byte DEBUG=10\nbyte INFO=20\nbyte WARN=30\nbyte ERROR=40\nbyte FATAL=50\n"
          "builtin_interfaces/Time stamp\nuint8 level\nstring name\nstring msg\nstring file\nstring function\nuint32 line\n",
          {kTime}};
    case MessageType::reports:
      return {
          "# Input reports of a device that came since the tick before, as it sent them. No message at a tick: none came.\n"
          "std_msgs/Header header\n"
          "# [bytes] of each report, the oldest first\n"
          "uint32[] sizes\n"
          "# One report behind the other.\n"
          "uint8[] data\n",
          {kHeader, kTime}};
    case MessageType::surface_contact:
      break;
  }
  return {
      "# A user's probe touches one mesh. No message at a tick: no contact.\n"
      "std_msgs/Header header\n"
      "# The mesh touched, by its place in the trace and by its name, and the triangle.\n"
      "uint32 mesh_index\n"
      "string mesh\n"
      "uint32 triangle\n"
      "# Of the triangle's corners at the touched point, sum 1.\n"
      "float64[3] weights\n"
      "# [m] where the probe is held on the surface, in the world.\n"
      "geometry_msgs/Point proxy\n"
      "# Of the surface there, in the world, outward, unit length.\n"
      "geometry_msgs/Vector3 normal\n"
      "# [N/m]\n"
      "float64 stiffness\n",
      {kHeader, kTime, kPoint, kVector3}};
}

}  // namespace

std::string_view schema_name(MessageType type) noexcept {
  constexpr std::array<std::string_view, 14> kNames{
      "geometry_msgs/msg/PoseStamped",    "geometry_msgs/msg/TwistStamped", "geometry_msgs/msg/PointStamped",
      "geometry_msgs/msg/Vector3Stamped", "tactus_msgs/msg/Contact",        "shape_msgs/msg/Mesh",
      "tactus_msgs/msg/Displacements",    "tactus_msgs/msg/MeshContact",    "geometry_msgs/msg/QuaternionStamped",
      "tactus_msgs/msg/Buttons",          "sensor_msgs/msg/TimeReference",  "tactus_msgs/msg/Servo",
      "rcl_interfaces/msg/Log",           "tactus_msgs/msg/Reports"};
  return kNames[static_cast<std::size_t>(type)];
}

std::string schema_text(MessageType type) {
  const Message message = message_of(type);
  return definition_text(message.fields, message.dependencies);
}

// ==== messages ====

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
