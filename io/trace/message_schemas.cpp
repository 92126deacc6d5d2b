// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/message_schemas.h>

#include <array>
#include <vector>

#include <tactus/trace/ros_definitions.h>

namespace tactus {

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
      "# The object touched, by its index in the trace and by its name.\n"
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
      "# The mesh touched, by its index in the trace and by its name, and the triangle.\n"
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

}  // namespace tactus
