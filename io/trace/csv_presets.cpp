// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/csv.h>

namespace tactus {
namespace {

CsvPreset tactus_preset() {
  CsvMapping mapping;
  mapping.layout = CsvLayout::tactus;
  return {"tactus", "what `export csv` writes: any objects and users", mapping};
}

CsvPreset cube_tosses_preset() {
  CsvMapping mapping;
  mapping.segment = "toss";
  mapping.position = {"x", "y", "z"};
  mapping.rotation = {"qw", "qx", "qy", "qz"};
  mapping.velocity = {"vx", "vy", "vz"};
  mapping.angular_velocity = {"wx", "wy", "wz"};
  mapping.angular_velocity_frame = AngularVelocityFrame::body;
  mapping.object = "cube";
  mapping.tick_rate = 148;
  return {"cube-tosses", "tosses of a cube (ContactNets, 148 Hz), lengths in metres", mapping};
}

CsvPreset kinaesthetic_preset() {
  CsvMapping mapping;
  mapping.position = {"robot_position_x", "robot_position_y", "robot_position_z"};
  mapping.device = {"human_position_x", "human_position_y", "human_position_z"};
  mapping.force = {"robot_force_x", "robot_force_y", "robot_force_z"};
  mapping.object = "robot";
  mapping.user = "human";
  mapping.tick_rate = 1000;
  return {"kinaesthetic", "a teleoperator and the hand that leads it (Kinaesthetic Interactions, 1 kHz)", mapping};
}

}  // namespace

const std::vector<CsvPreset>& csv_presets() {
  static const std::vector<CsvPreset> presets{tactus_preset(), cube_tosses_preset(), kinaesthetic_preset()};
  return presets;
}

}  // namespace tactus
