// SPDX-License-Identifier: Apache-2.0
/// Columns of an object and of a user, in order, and the fields that they fill. Shared by import and export.
#pragma once

#include <algorithm>
#include <array>

#include <tactus/trace/frame.h>

namespace tactus {

template <class T>
struct CsvColumn {
  const char* name;
  double& (*field)(T&);
};

// position [m], rotation, velocity [m/s], angular velocity [rad/s]
inline constexpr std::array<CsvColumn<RigidSample>, 13> kObjectColumns{{
    {"x", [](RigidSample& s) -> double& { return s.pose.position.x; }},
    {"y", [](RigidSample& s) -> double& { return s.pose.position.y; }},
    {"z", [](RigidSample& s) -> double& { return s.pose.position.z; }},
    {"qw", [](RigidSample& s) -> double& { return s.pose.rotation.w; }},
    {"qx", [](RigidSample& s) -> double& { return s.pose.rotation.x; }},
    {"qy", [](RigidSample& s) -> double& { return s.pose.rotation.y; }},
    {"qz", [](RigidSample& s) -> double& { return s.pose.rotation.z; }},
    {"vx", [](RigidSample& s) -> double& { return s.velocity.x; }},
    {"vy", [](RigidSample& s) -> double& { return s.velocity.y; }},
    {"vz", [](RigidSample& s) -> double& { return s.velocity.z; }},
    {"wx", [](RigidSample& s) -> double& { return s.angular_velocity.x; }},
    {"wy", [](RigidSample& s) -> double& { return s.angular_velocity.y; }},
    {"wz", [](RigidSample& s) -> double& { return s.angular_velocity.z; }},
}};

// device [m], forces [N]
inline constexpr std::array<CsvColumn<UserSample>, 3> kDeviceColumns{{
    {"device_x", [](UserSample& u) -> double& { return u.device.position.x; }},
    {"device_y", [](UserSample& u) -> double& { return u.device.position.y; }},
    {"device_z", [](UserSample& u) -> double& { return u.device.position.z; }},
}};
inline constexpr std::array<CsvColumn<UserSample>, 3> kForceColumns{{
    {"force_x", [](UserSample& u) -> double& { return u.force.x; }},
    {"force_y", [](UserSample& u) -> double& { return u.force.y; }},
    {"force_z", [](UserSample& u) -> double& { return u.force.z; }},
}};
inline constexpr std::array<CsvColumn<UserSample>, 3> kServerForceColumns{{
    {"server_force_x", [](UserSample& u) -> double& { return u.server_force.x; }},
    {"server_force_y", [](UserSample& u) -> double& { return u.server_force.y; }},
    {"server_force_z", [](UserSample& u) -> double& { return u.server_force.z; }},
}};

// Valid in contact only: point [m] and normal (object frame), stiffness [N/m].
inline constexpr std::array<CsvColumn<UserSample>, 7> kTouchColumns{{
    {"point_x", [](UserSample& u) -> double& { return u.contact.point.x; }},
    {"point_y", [](UserSample& u) -> double& { return u.contact.point.y; }},
    {"point_z", [](UserSample& u) -> double& { return u.contact.point.z; }},
    {"normal_x", [](UserSample& u) -> double& { return u.contact.normal.x; }},
    {"normal_y", [](UserSample& u) -> double& { return u.contact.normal.y; }},
    {"normal_z", [](UserSample& u) -> double& { return u.contact.normal.z; }},
    {"stiffness", [](UserSample& u) -> double& { return u.contact.stiffness; }},
}};

// Devices that sense more than their position: orientation, velocity [m/s].
inline constexpr std::array<CsvColumn<UserSample>, 4> kOrientationColumns{{
    {"device_qw", [](UserSample& u) -> double& { return u.device.orientation.w; }},
    {"device_qx", [](UserSample& u) -> double& { return u.device.orientation.x; }},
    {"device_qy", [](UserSample& u) -> double& { return u.device.orientation.y; }},
    {"device_qz", [](UserSample& u) -> double& { return u.device.orientation.z; }},
}};
inline constexpr std::array<CsvColumn<UserSample>, 3> kDeviceVelocityColumns{{
    {"device_vx", [](UserSample& u) -> double& { return u.device.velocity.x; }},
    {"device_vy", [](UserSample& u) -> double& { return u.device.velocity.y; }},
    {"device_vz", [](UserSample& u) -> double& { return u.device.velocity.z; }},
}};

/// Columns of real numbers that a user has, in order.
template <class Visit>
void for_each_column(const TraceUser& user, Visit visit) {
  std::ranges::for_each(kDeviceColumns, visit);
  if (user.forces != KnownForces::server) std::ranges::for_each(kForceColumns, visit);
  if (user.forces != KnownForces::felt) std::ranges::for_each(kServerForceColumns, visit);
  std::ranges::for_each(kTouchColumns, visit);
  if (user.senses.orientation) std::ranges::for_each(kOrientationColumns, visit);
  if (user.senses.velocity) std::ranges::for_each(kDeviceVelocityColumns, visit);
}

// Reports of a device at this tick: each in hexadecimal digits, blanks between. What they mean is not in a table.
inline constexpr const char* kReportsColumn = "device_reports";

// Integer columns: TraceObject::dof; the contact's kind (0: none) and object; DeviceSample::buttons and time where the device has
// them; TraceFrame::shown of a client.
inline constexpr const char* kShownColumn = "shown_tick";
inline constexpr const char* kButtonsColumn = "device_buttons";
inline constexpr const char* kDeviceTimeColumn = "device_time_ns";
inline constexpr std::array<const char*, 4> kServoColumns{"late_ns", "age_ns", "missed",
                                                          "guard"};  // of ServoSample, in its order
inline constexpr const char* kDofColumn = "dof";
inline constexpr const char* kContactColumn = "contact";
inline constexpr const char* kContactObjectColumn = "contact_object";

}  // namespace tactus
