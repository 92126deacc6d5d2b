// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/declared_contact.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace tactus {
namespace {

const Pose kPose{{0.1, 0.2, 0.3}, {std::sqrt(0.5), 0, 0, std::sqrt(0.5)}};  // a quarter turn about z
const Vec3 kDevice{0.15, 0.2, 0.35}, kForce{1, -2, 2};

TEST(DeclaredContact, GivesTheRecordedForceAtTheTruePose) {
  for (const ContactKind kind : {ContactKind::surface, ContactKind::spring}) {
    const Contact contact = contact_of_force(kPose, kDevice, kForce, 500, kind, 0);
    EXPECT_NEAR(norm(contact_force(contact, kPose) - kForce), 0, 1e-12);
    EXPECT_EQ(contact.stiffness, 500);
  }
  EXPECT_EQ(contact_of_force(kPose, kDevice, {}, 500, ContactKind::surface, 0).kind, ContactKind::none);
}

TEST(DeclaredContact, AForceChangesByStiffnessTimesDisplacement) {
  const Contact plane = contact_of_force(kPose, kDevice, kForce, 500, ContactKind::surface, 0);
  const Contact spring = contact_of_force(kPose, kDevice, kForce, 500, ContactKind::spring, 0);
  Pose along = kPose, across = kPose;
  along.position = along.position + (1e-3 / 3) * kForce;    // 1 mm along the force of 3 N
  across.position = across.position + Vec3{0, 1e-3, 1e-3};  // at right angles to it
  EXPECT_NEAR(norm(contact_force(plane, along)), 3.5, 1e-12);
  EXPECT_NEAR(norm(contact_force(plane, across) - kForce), 0, 1e-12);
  EXPECT_NEAR(norm(contact_force(spring, across) - kForce), 0.5 * std::sqrt(2), 1e-12);
}

TEST(DeclaredContact, LeavesRecordedContactsAndRefusesWrongNames) {
  TraceInfo info;
  info.objects = {{"cup"}};
  info.users = {{.name = "hand"}};
  const std::array declared{DeclaredContact{"hand", "cup", 500}};
  const auto of = ContactDeclarations::create(info, declared);
  ASSERT_TRUE(of);
  TraceFrame frame;
  frame.objects.resize(1);
  frame.users.resize(1);
  frame.users[0].server_force = {0, 0, 1};
  of->apply(frame);
  EXPECT_EQ(frame.users[0].contact.kind, ContactKind::surface);
  frame.users[0].contact.stiffness = 7;
  of->apply(frame);
  EXPECT_EQ(frame.users[0].contact.stiffness, 7);
  for (const DeclaredContact& wrong :
       {DeclaredContact{"foot", "cup", 500}, DeclaredContact{"hand", "pot", 500}, DeclaredContact{"hand", "cup", 0}})
    EXPECT_FALSE(ContactDeclarations::create(info, std::span(&wrong, 1)));
}

}  // namespace
}  // namespace tactus
