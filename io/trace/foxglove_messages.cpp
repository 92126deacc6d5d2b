// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/foxglove_messages.h>

#include <algorithm>
#include <cmath>

#include <tactus/trace/cdr.h>
#include <tactus/trace/ros_definitions.h>

namespace tactus::foxglove {
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
