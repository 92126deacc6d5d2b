// SPDX-License-Identifier: Apache-2.0
/// The columns of export_csv(), and which of them a table has. Internal to the library.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <tactus/trace/csv.h>
#include <tactus/trace/frame.h>

namespace tactus {

// ==== csv columns ====
// Columns of an object and of a user, in order, and the fields that they fill. Shared by import and export.

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
  if (user.forces != RecordedForces::server) std::ranges::for_each(kForceColumns, visit);
  if (user.forces != RecordedForces::rendered) std::ranges::for_each(kServerForceColumns, visit);
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

// ==== csv plan ====
// Maps the fields of a row of export_csv() to quantities, by a line of names.

/// One number of every row.
struct CsvBinding {
  std::size_t column = 0;
  std::uint32_t index = 0;                          ///< of the object or the user
  double& (*object_field)(RigidSample&) = nullptr;  ///< either this or the next is set
  double& (*user_field)(UserSample&) = nullptr;
};

/// What is no number, and whole numbers of a user.
struct CsvUserColumns {
  std::size_t kind = 0, object = 0;                 ///< of the contact
  std::optional<std::size_t> buttons, time;         ///< of the device
  std::optional<std::array<std::size_t, 4>> servo;  ///< kServoColumns
  std::optional<std::size_t> reports;
};

struct CsvPlan {
  std::vector<std::string> names;  ///< of all columns
  TraceInfo info;                  ///< the rows determine tick rate and degrees of freedom
  std::vector<CsvBinding> bindings;
  std::optional<std::size_t> tick, time, shown;
  std::vector<std::size_t> dof;       ///< per object
  std::vector<CsvUserColumns> users;  ///< per user
};

/// Location of a field within its line: "column x, 'oops'".   in  either may be empty
std::string location_of_field(const std::string& column, const std::string& text);

/// Of a table of export_csv().   err  R-CSV-2, R-CSV-8, with the offending column.
tl::expected<CsvPlan, Diagnostic> plan_csv(const std::vector<std::string>& names);

class CsvReader;
/// The rows of such a table, strictly: what export_csv() wrote reads back to the same bits.
/// in   reader  at its names;   out  has_output  a trace was begun;   err  as import_csv()
tl::expected<CsvImport, Diagnostic> import_tactus_csv(CsvReader& reader, const CsvMapping& mapping, CsvPlan plan,
                                                      const std::string& out_path, bool& has_output);

}  // namespace tactus
