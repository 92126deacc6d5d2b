// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/foxglove_writer.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include <tactus/base/rule.h>
#include <tactus/trace/cdr.h>
#include <tactus/trace/mcap_writer.h>
#include <tactus/trace/message_schemas.h>
#include <tactus/trace/messages.h>
#include <tactus/trace/ros_definitions.h>

namespace tactus::foxglove {

// ==== foxglove messages ====

namespace {

constexpr std::uint64_t kNanoseconds = 1'000'000'000;

using ros::Definition, ros::kPoint, ros::kPose, ros::kQuaternion, ros::kTime, ros::kVector3;

constexpr Definition kDuration{"builtin_interfaces/Duration", "int32 sec\nuint32 nanosec\n"};
constexpr Definition kColour{"foxglove_msgs/Color", "float64 r\nfloat64 g\nfloat64 b\nfloat64 a\n"};
constexpr Definition kDeletion{"foxglove_msgs/SceneEntityDeletion",
                               "builtin_interfaces/Time timestamp\nuint8 MATCHING_ID=0\nuint8 ALL=1\nuint8 type\nstring id\n"};
constexpr Definition kEntity{
    "foxglove_msgs/SceneEntity",
    "builtin_interfaces/Time timestamp\nstring frame_id\nstring id\nbuiltin_interfaces/Duration lifetime\nbool frame_locked\n"
    "foxglove_msgs/KeyValuePair[] metadata\nfoxglove_msgs/ArrowPrimitive[] arrows\nfoxglove_msgs/CubePrimitive[] cubes\n"
    "foxglove_msgs/SpherePrimitive[] spheres\nfoxglove_msgs/CylinderPrimitive[] cylinders\nfoxglove_msgs/LinePrimitive[] lines\n"
    "foxglove_msgs/TriangleListPrimitive[] triangles\nfoxglove_msgs/TextPrimitive[] texts\nfoxglove_msgs/ModelPrimitive[] "
    "models\n"};
constexpr Definition kKeyValue{"foxglove_msgs/KeyValuePair", "string key\nstring value\n"};
constexpr Definition kArrow{"foxglove_msgs/ArrowPrimitive",
                            "geometry_msgs/Pose pose\nfloat64 shaft_length\nfloat64 shaft_diameter\nfloat64 head_length\n"
                            "float64 head_diameter\nfoxglove_msgs/Color color\n"};
constexpr Definition kCube{"foxglove_msgs/CubePrimitive",
                           "geometry_msgs/Pose pose\ngeometry_msgs/Vector3 size\nfoxglove_msgs/Color color\n"};
constexpr Definition kSphere{"foxglove_msgs/SpherePrimitive", kCube.fields};
constexpr Definition kCylinder{"foxglove_msgs/CylinderPrimitive",
                               "geometry_msgs/Pose pose\ngeometry_msgs/Vector3 size\nfloat64 bottom_scale\nfloat64 top_scale\n"
                               "foxglove_msgs/Color color\n"};
constexpr Definition kLine{"foxglove_msgs/LinePrimitive",
                           "uint8 LINE_STRIP=0\nuint8 LINE_LOOP=1\nuint8 LINE_LIST=2\nuint8 type\ngeometry_msgs/Pose pose\n"
                           "float64 thickness\nbool scale_invariant\ngeometry_msgs/Point[] points\nfoxglove_msgs/Color color\n"
                           "foxglove_msgs/Color[] colors\nuint32[] indices\n"};
constexpr Definition kTriangles{"foxglove_msgs/TriangleListPrimitive",
                                "geometry_msgs/Pose pose\ngeometry_msgs/Point[] points\nfoxglove_msgs/Color color\n"
                                "foxglove_msgs/Color[] colors\nuint32[] indices\n"};
constexpr Definition kText{"foxglove_msgs/TextPrimitive",
                           "geometry_msgs/Pose pose\nbool billboard\nfloat64 font_size\nbool scale_invariant\n"
                           "foxglove_msgs/Color color\nstring text\n"};
constexpr Definition kModel{
    "foxglove_msgs/ModelPrimitive",
    "geometry_msgs/Pose pose\ngeometry_msgs/Vector3 scale\nfoxglove_msgs/Color color\nbool override_color\n"
    "string url\nstring media_type\nuint8[] data\n"};
constexpr Definition kTransform{"foxglove_msgs/FrameTransform",
                                "builtin_interfaces/Time timestamp\nstring parent_frame_id\nstring child_frame_id\n"
                                "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n"};

/// Rotation of the x axis to a direction.
Quat turn_to(const Vec3& direction) noexcept {
  const Vec3 d = (1 / norm(direction)) * direction;
  const Vec3 axis{0, -d.z, d.y};  // x cross d
  const double w = 1 + d.x, length = std::sqrt(w * w + dot(axis, axis));
  if (length < 1e-9) return {0, 0, 0, 1};  // straight back: half a turn about any axis across
  return {w / length, axis.x / length, axis.y / length, axis.z / length};
}

void put_time(CdrWriter& out, std::uint64_t time) {
  out.u32(static_cast<std::uint32_t>(time / kNanoseconds));
  out.u32(static_cast<std::uint32_t>(time % kNanoseconds));
}

void put(CdrWriter& out, const Pose& pose) {
  out.vec3(pose.position);
  out.quat(pose.rotation);
}

void put(CdrWriter& out, const Colour& colour) {
  for (const double part : {colour.r, colour.g, colour.b, colour.a}) out.f64(part);
}

void put(CdrWriter& out, const Arrow& arrow) {
  const double length = norm(arrow.along), head = std::min(length / 2, 3 * arrow.thickness);
  put(out, Pose{arrow.from, turn_to(arrow.along)});
  for (const double part : {length - head, arrow.thickness, head, 2 * arrow.thickness}) out.f64(part);
  put(out, arrow.colour);
}

void put(CdrWriter& out, const Solid& solid) {
  put(out, solid.pose);
  out.vec3(solid.size);
  put(out, solid.colour);
}

std::uint32_t count_of(std::size_t count) { return static_cast<std::uint32_t>(count); }

void put(CdrWriter& out, const Triangles& list) {
  put(out, Pose{});
  out.u32(count_of(list.points.size()));
  for (const Vec3& point : list.points) out.vec3(point);
  put(out, list.colour);
  out.u32(count_of(list.colours.size()));
  for (const Colour& colour : list.colours) put(out, colour);
  out.u32(count_of(3 * list.triangles.size()));
  for (const Triangle& triangle : list.triangles)
    for (const std::uint32_t corner : triangle) out.u32(corner);
}

template <class Item>
void put_all(CdrWriter& out, const std::vector<Item>& items) {
  out.u32(count_of(items.size()));
  for (const Item& item : items) put(out, item);
}

void put_none(CdrWriter& out) { out.u32(0); }

void put(CdrWriter& out, std::uint64_t time, const Entity& entity) {
  put_time(out, time);
  out.text(entity.frame);
  out.text(entity.id);
  put_time(out, 0);  // lifetime: it stays
  out.u8(entity.moves_with_frame ? 1 : 0);
  put_none(out);  // metadata
  put_all(out, entity.arrows);
  put_all(out, entity.cubes);
  put_all(out, entity.spheres);
  put_none(out);  // cylinders
  put_none(out);  // lines
  put_all(out, entity.triangles);
  put_none(out);  // texts
  put_none(out);  // models
}

}  // namespace

std::string scene_update_schema() {
  constexpr Definition kAll[]{kDeletion, kEntity, kTime,    kDuration, kKeyValue, kArrow, kPose,      kPoint, kQuaternion,
                              kColour,   kCube,   kVector3, kSphere,   kCylinder, kLine,  kTriangles, kText,  kModel};
  return ros::definition_text("foxglove_msgs/SceneEntityDeletion[] deletions\nfoxglove_msgs/SceneEntity[] entities\n", kAll);
}

std::string frame_transforms_schema() {
  constexpr Definition kAll[]{kTransform, kTime, kVector3, kQuaternion};
  return ros::definition_text("foxglove_msgs/FrameTransform[] transforms\n", kAll);
}

void encode_scene_update(std::vector<std::uint8_t>& message, std::uint64_t time, std::span<const Entity> entities) {
  CdrWriter out(message);
  put_none(out);  // deletions
  out.u32(count_of(entities.size()));
  for (const Entity& entity : entities) put(out, time, entity);
}

void encode_frame_transforms(std::vector<std::uint8_t>& message, std::uint64_t time, std::span<const Transform> transforms) {
  CdrWriter out(message);
  out.u32(count_of(transforms.size()));
  for (const Transform& transform : transforms) {
    put_time(out, time);
    out.text(kWorld);
    out.text(transform.child);
    out.vec3(transform.pose.position);
    out.quat(transform.pose.rotation);
  }
}

}  // namespace tactus::foxglove

namespace tactus {

// ==== foxglove writer ====

namespace {

using foxglove::Colour;
using foxglove::Entity;

constexpr std::size_t kChunkBytes = 1u << 20;
constexpr std::uint64_t kChunkTime = 1'000'000'000;  // [ns]

// Okabe and Ito, as in the figures.
constexpr Colour kObject{0.60, 0.66, 0.72, 1}, kRendered{0.835, 0.369, 0, 1}, kServer{0, 0.447, 0.698, 1},
    kTouched{0, 0.62, 0.451, 1}, kDevice{0.15, 0.15, 0.15, 1}, kRest{0.80, 0.84, 0.88, 1};
constexpr std::array<Colour, 3> kAxes{Colour{0.8, 0.2, 0.2, 1}, Colour{0.2, 0.6, 0.2, 1}, Colour{0.2, 0.3, 0.8, 1}};
constexpr double kAxisLength = 0.03, kDeviceSize = 0.008, kTouchedSize = 0.005, kThickness = 0.002;  // [m]
constexpr double kLeastArrow = 1e-4;                                                                 // [m]
constexpr double kFullColour = 0.1;  // displacement of a vertex in units of its mesh's diagonal that has the full colour

constexpr std::size_t kSteps = 32;  // of the colour: bytes that repeat are compressed well

constexpr std::uint16_t kSceneSchema = 1, kFrameSchema = 2, kPoseSchema = 3, kPointSchema = 4, kVectorSchema = 5;

Vec3 ball(double size) { return {size, size, size}; }

double diagonal_of(const TriMesh& mesh) {
  Vec3 low = mesh.vertices.front(), high = low;
  for (const Vec3& v : mesh.vertices) {
    low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
    high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
  }
  return norm(high - low);
}

/// Half of the bytes are then zero.
Vec3 in_single_precision(const Vec3& v) {
  return {static_cast<double>(static_cast<float>(v.x)), static_cast<double>(static_cast<float>(v.y)),
          static_cast<double>(static_cast<float>(v.z))};
}

Colour mixed(const Colour& a, const Colour& b, double fraction) {
  return {a.r + fraction * (b.r - a.r), a.g + fraction * (b.g - a.g), a.b + fraction * (b.b - a.b), 1};
}

Entity entity_of(const std::string& frame, const FoxgloveShape* shape) {
  Entity out{.frame = frame, .id = frame, .moves_with_frame = true};
  if (shape && !shape->surface.triangles.empty()) {
    out.triangles.push_back({shape->surface.vertices, shape->surface.triangles, kObject, {}});
  } else if (shape && shape->box != Vec3{}) {
    out.cubes.push_back({Pose{}, shape->box, kObject});
  } else {
    const std::array<Vec3, 3> axes{Vec3{kAxisLength, 0, 0}, Vec3{0, kAxisLength, 0}, Vec3{0, 0, kAxisLength}};
    for (std::size_t i = 0; i < axes.size(); ++i) out.arrows.push_back({Vec3{}, axes[i], kThickness, kAxes[i]});
  }
  return out;
}

/// Where a user's probe is held on what it touches.
std::optional<Vec3> touched_point(const UserSample& user, const TraceFrame& frame) {
  if (user.surface_contact) return user.surface_contact->proxy;
  const Contact& contact = user.contact;
  if (contact.kind == ContactKind::none) return std::nullopt;
  const Pose& pose = frame.objects[contact.object].pose;
  const Vec3 point = to_world(pose, contact.point);
  if (contact.kind == ContactKind::spring) return point;
  const Vec3 normal = rotate(pose.rotation, contact.normal);
  return user.device.position + dot(point - user.device.position, normal) * normal;
}

}  // namespace

struct FoxgloveWriter::Impl {
  Impl(mcap::Writer writer, TraceInfo trace_info, std::vector<FoxgloveShape> object_shapes, const FoxgloveOptions& chosen)
      : mcap(std::move(writer)),
        info(std::move(trace_info)),
        shapes(std::move(object_shapes)),
        options(chosen),
        is_new(info.meshes.size(), true) {}

  Result<void> declare();
  Result<std::uint16_t> add_channel(std::uint16_t schema, std::string topic);
  void send(std::uint16_t channel);
  bool is_due(std::uint64_t at) const;
  void write_transforms(const TraceFrame& frame);
  void write_objects(const TraceFrame& frame);
  void write_mesh(std::size_t i, const TraceFrame& frame);
  void write_user(std::size_t i, const TraceFrame& frame);

  struct UserChannels {
    std::uint16_t scene = 0, device = 0, force = 0, server_force = 0;  // 0: not known
  };

  mcap::Writer mcap;
  TraceInfo info;
  std::vector<FoxgloveShape> shapes;
  FoxgloveOptions options;
  std::uint16_t channels = 0, transforms = 0, objects = 0;
  std::vector<std::uint16_t> poses, meshes;
  std::vector<UserChannels> users;
  std::vector<std::string> frames;  // of objects, users, meshes
  std::vector<double> diagonals;    // of meshes
  std::vector<bool> is_new;         // mesh: its shape is not yet written
  std::vector<std::uint8_t> message;
  std::uint64_t time = 0, count = 0, due = 0;  // due: how many periods have begun
  std::uint32_t sequence = 0;
};

Result<std::uint16_t> FoxgloveWriter::Impl::add_channel(std::uint16_t schema, std::string topic) {
  if (channels == UINT16_MAX) return fail(Errc::invalid_argument, "R-TRC-17");
  TACTUS_CHECK(mcap.add(mcap::Channel{++channels, schema, std::move(topic), "cdr", {}}));
  return channels;
}

Result<void> FoxgloveWriter::Impl::declare() {
  const auto add = [&](std::uint16_t id, std::string_view name, std::string text) {
    return mcap.add(mcap::Schema{id, std::string(name), "ros2msg", std::move(text)});
  };
  const auto add_known = [&](std::uint16_t id, MessageType type) { return add(id, schema_name(type), schema_text(type)); };
  TACTUS_CHECK(add(kSceneSchema, foxglove::kSceneUpdate, foxglove::scene_update_schema()));
  TACTUS_CHECK(add(kFrameSchema, foxglove::kFrameTransforms, foxglove::frame_transforms_schema()));
  TACTUS_CHECK(add_known(kPoseSchema, MessageType::pose));
  TACTUS_CHECK(add_known(kPointSchema, MessageType::point));
  TACTUS_CHECK(add_known(kVectorSchema, MessageType::vector));
  TACTUS_TRY(transforms, add_channel(kFrameSchema, "/tf"));
  if (!info.objects.empty()) {
    TACTUS_TRY(objects, add_channel(kSceneSchema, "/scene/objects"));
  }
  for (const TraceObject& object : info.objects) {
    frames.push_back("objects/" + object.name);
    TACTUS_TRY(poses.emplace_back(), add_channel(kPoseSchema, "/objects/" + object.name + "/pose"));
  }
  for (const TraceUser& user : info.users) {
    frames.push_back("users/" + user.name);
    UserChannels& own = users.emplace_back();
    TACTUS_TRY(own.scene, add_channel(kSceneSchema, "/scene/users/" + user.name));
    TACTUS_TRY(own.device, add_channel(kPointSchema, "/users/" + user.name + "/device"));
    if (user.forces != RecordedForces::server) {
      TACTUS_TRY(own.force, add_channel(kVectorSchema, "/users/" + user.name + "/force"));
    }
    if (user.forces != RecordedForces::rendered) {
      TACTUS_TRY(own.server_force, add_channel(kVectorSchema, "/users/" + user.name + "/server_force"));
    }
  }
  for (const TraceDeformable& mesh : info.meshes) {
    frames.push_back("meshes/" + mesh.name);
    diagonals.push_back(diagonal_of(mesh.rest));
    TACTUS_TRY(meshes.emplace_back(), add_channel(kSceneSchema, "/scene/meshes/" + mesh.name));
  }
  return {};
}

void FoxgloveWriter::Impl::send(std::uint16_t channel) {
  ++count;
  mcap.add(mcap::Message{channel, sequence, time, time, message});
}

/// One frame in each period of the rate.
bool FoxgloveWriter::Impl::is_due(std::uint64_t at) const {
  return static_cast<double>(at) * 1e-9 * options.rate >= static_cast<double>(due);
}

void FoxgloveWriter::Impl::write_transforms(const TraceFrame& frame) {
  std::vector<foxglove::Transform> list;
  std::size_t next = 0;
  for (const RigidSample& object : frame.objects) list.push_back({frames[next++], object.pose});
  for (const UserSample& user : frame.users) list.push_back({frames[next++], {user.device.position, user.device.orientation}});
  while (next < frames.size()) list.push_back({frames[next++], Pose{}});
  foxglove::encode_frame_transforms(message, time, list);
  send(transforms);
}

void FoxgloveWriter::Impl::write_objects(const TraceFrame& frame) {
  for (std::size_t i = 0; i < frame.objects.size(); ++i) {
    encode_pose(message, time, frame.objects[i].pose);
    send(poses[i]);
  }
  if (info.objects.empty() || due > 0) return;
  std::vector<Entity> entities;
  for (std::size_t i = 0; i < info.objects.size(); ++i)
    entities.push_back(entity_of(frames[i], i < shapes.size() ? &shapes[i] : nullptr));
  foxglove::encode_scene_update(message, time, entities);
  send(objects);
}

void FoxgloveWriter::Impl::write_mesh(std::size_t i, const TraceFrame& frame) {
  const TriMesh& rest = info.meshes[i].rest;
  const std::vector<float>& u = frame.meshes[i].displacements;
  std::vector<Vec3> points(rest.vertices.size());
  std::vector<Colour> colours(points.size());
  std::array<Colour, kSteps + 1> ramp;
  for (std::size_t k = 0; k < ramp.size(); ++k) ramp[k] = mixed(kRest, kRendered, static_cast<double>(k) / kSteps);
  for (std::size_t v = 0; v < points.size(); ++v) {
    const Vec3 moved{u[3 * v], u[3 * v + 1], u[3 * v + 2]};
    points[v] = in_single_precision(rest.vertices[v] + moved);
    colours[v] = ramp[static_cast<std::size_t>(std::min(1.0, norm(moved) / (kFullColour * diagonals[i])) * kSteps)];
  }
  Entity entity{.frame = frames[info.objects.size() + info.users.size() + i], .id = "meshes/" + info.meshes[i].name};
  entity.triangles.push_back({points, rest.triangles, kRest, colours});
  foxglove::encode_scene_update(message, time, {&entity, 1});
  send(meshes[i]);
}

void FoxgloveWriter::Impl::write_user(std::size_t i, const TraceFrame& frame) {
  const UserSample& user = frame.users[i];
  const Vec3 hand = user.device.position;
  Entity entity{.frame = std::string(foxglove::kWorld), .id = "users/" + info.users[i].name};
  entity.spheres.push_back({{hand, {}}, ball(kDeviceSize), kDevice});
  if (const auto point = touched_point(user, frame)) entity.spheres.push_back({{*point, {}}, ball(kTouchedSize), kTouched});
  const auto add_arrow = [&](const Vec3& force, double thickness, const Colour& colour) {
    const Vec3 along = options.metres_per_newton * force;
    if (norm(along) > kLeastArrow) entity.arrows.push_back({hand, along, thickness, colour});
  };
  if (users[i].force > 0) add_arrow(user.force, kThickness, kRendered);
  if (users[i].server_force > 0) add_arrow(user.server_force, kThickness / 2, kServer);
  foxglove::encode_scene_update(message, time, {&entity, 1});
  send(users[i].scene);
  const std::pair<std::uint16_t, Vec3> vectors[] = {
      {users[i].device, hand}, {users[i].force, user.force}, {users[i].server_force, user.server_force}};
  for (const auto& [channel, vector] : vectors) {
    if (channel == 0) continue;
    encode_vector(message, time, vector);
    send(channel);
  }
}

Result<FoxgloveWriter> FoxgloveWriter::create(const std::string& path, const TraceInfo& info, std::vector<FoxgloveShape> shapes,
                                              const FoxgloveOptions& options) try {
  const bool is_positive = options.rate > 0 && options.metres_per_newton > 0;
  if (!is_positive || !std::isfinite(options.rate) || !std::isfinite(options.metres_per_newton))
    return fail(Errc::invalid_argument, "R-TRC-17");
  TACTUS_TRY(auto mcap, mcap::Writer::create(path, ""));
  auto impl = std::make_unique<Impl>(std::move(mcap), info, std::move(shapes), options);
  TACTUS_CHECK(impl->declare());
  return FoxgloveWriter(std::move(impl));
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

Result<void> FoxgloveWriter::write(const TraceFrame& frame) try {
  Impl& w = *impl_;
  for (std::size_t i = 0; i < frame.meshes.size(); ++i) w.is_new[i] = w.is_new[i] || frame.meshes[i].updated;
  const std::uint64_t at = time_of_tick(frame.tick, w.info.tick_rate);
  if (w.due > 0 && !w.is_due(at)) return {};
  if (w.mcap.chunk_size() >= kChunkBytes || (w.mcap.chunk_size() > 0 && at - w.mcap.chunk_start_time() >= kChunkTime))
    TACTUS_CHECK(w.mcap.end_chunk());
  w.time = at;
  w.write_transforms(frame);
  w.write_objects(frame);
  for (std::size_t i = 0; i < frame.meshes.size(); ++i)
    if (w.is_new[i]) w.write_mesh(i, frame);
  w.is_new.assign(frame.meshes.size(), false);
  for (std::size_t i = 0; i < frame.users.size(); ++i) w.write_user(i, frame);
  ++w.sequence;
  w.due = static_cast<std::uint64_t>(static_cast<double>(at) * 1e-9 * w.options.rate) + 1;
  return {};
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

Result<void> FoxgloveWriter::finish() { return impl_->mcap.finish(); }
std::uint64_t FoxgloveWriter::messages() const noexcept { return impl_->count; }

FoxgloveWriter::FoxgloveWriter(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
FoxgloveWriter::FoxgloveWriter(FoxgloveWriter&&) noexcept = default;
FoxgloveWriter& FoxgloveWriter::operator=(FoxgloveWriter&&) noexcept = default;
FoxgloveWriter::~FoxgloveWriter() = default;

}  // namespace tactus
