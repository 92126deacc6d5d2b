// SPDX-License-Identifier: Apache-2.0
#include "cli/figure/motion_figure.h"

#include <gtest/gtest.h>

namespace tactus::cli {
namespace {

using Names = std::vector<std::string>;

/// Names of the lines of a user's forces.
Names lines_of(KnownForces known, const Vec3& felt, const Vec3& server) {
  MotionFigure figure({.objects = {}, .users = {{.name = "hand", .forces = known}}, .source = {}, .scene = {}});
  TraceFrame frame{.objects = {}, .users = {{}}};
  frame.users[0].force = felt;
  frame.users[0].server_force = server;
  figure.add(frame);
  Names out;
  for (const Panel& panel : figure.panels())
    if (panel.label == "force on hand [N]")
      for (const Panel::Line& line : panel.lines) out.push_back(line.name);
  return out;
}

TEST(MotionFigure, NamesAForceAfterWhoseItIs) {
  const Vec3 some{0, 0, 1}, none;
  EXPECT_EQ(lines_of(KnownForces::both, some, some), Names{"force"});
  EXPECT_EQ(lines_of(KnownForces::both, some, none), (Names{"felt", "of the server"}));
  EXPECT_EQ(lines_of(KnownForces::felt, some, none), Names{"felt"});
  EXPECT_EQ(lines_of(KnownForces::server, some, some), Names{"of the server"});
}

}  // namespace
}  // namespace tactus::cli
