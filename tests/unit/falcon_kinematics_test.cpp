// SPDX-License-Identifier: Apache-2.0
/// Geometry and frames of a Falcon.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <string>

#include <tactus/device/falcon/falcon_frame.h>
#include <tactus/device/falcon/falcon_kinematics.h>
#include "tests/property/allocated.h"
#include "tests/unit/falcon_fixture.h"

namespace tactus::device::falcon {
namespace {

using testing::frame_of;

// ==== falcon kinematics ====

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Calls f(position) on a grid of so many points per edge over the workspace, faces included.
template <class F>
void over_workspace(int points, F f) {
  const auto at = [points](int i) { return kHalfWidth * (2.0 * i / (points - 1) - 1); };
  for (int i = 0; i < points; ++i)
    for (int j = 0; j < points; ++j)
      for (int k = 0; k < points; ++k) f(Vec3{at(i), at(j), kMiddle + at(k)});
}

double off_by(const Vec3& a, const Vec3& b) { return norm(a - b); }

template <class T>
void expect_refused(const Result<T>& result) {
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, Errc::invalid);
  EXPECT_STREQ(result.error().rule, "R-DEV-6");
}

TEST(FalconKinematics, ForwardUndoesInverseToAMicrometre) {
  double worst = 0;
  over_workspace(21, [&](const Vec3& position) {
    const auto there = pose_at(position);
    ASSERT_TRUE(there);
    const auto back = pose_with(there->angles);
    ASSERT_TRUE(back);
    worst = std::max(worst, off_by(back->position, position));
  });
  RecordProperty("worst_nm", std::to_string(worst * 1e9));
  EXPECT_LT(worst, 1e-9);
}

TEST(FalconKinematics, ACountIsAFractionOfAMillimetre) {
  double worst = 0;
  over_workspace(7, [&](const Vec3& position) {
    Triple angles = pose_at(position)->angles;
    for (double& angle : angles) angle = angle_of(std::round(count_of(angle)));
    const auto back = pose_with(angles);
    ASSERT_TRUE(back);
    worst = std::max(worst, off_by(back->position, position));
  });
  EXPECT_LT(worst, 1e-4);
}

TEST(FalconKinematics, TheMechanismIsTheOneThatWasPublished) {
  // A count of zero on every axis: the arms stand at 35 degrees and the handle nearly in the axis.
  const auto pose = pose_with({angle_of(0), angle_of(0), angle_of(0)});
  ASSERT_TRUE(pose);
  EXPECT_NEAR(pose->angles[0], 35 * std::numbers::pi / 180, 1e-15);
  EXPECT_NEAR(pose->position.x, 0, 1e-12);
  EXPECT_NEAR(pose->position.y, 0, 1e-12);
  // In the plane of an arm: joint at u = 40 mm, arm 60 mm, rod with its joints, handle's joint at 14.43 mm; out of it 1.91 mm.
  const double rod = 0.0225 + 0.1025 * std::sqrt(1 - std::pow(0.00191 / 0.1025, 2));
  const double across = 0.040 - 0.01443 + 0.060 * std::cos(pose->angles[0]);
  EXPECT_NEAR(pose->position.z, 0.060 * std::sin(pose->angles[0]) + std::sqrt(rod * rod - across * across), 1e-9);
}

TEST(FalconKinematics, AThirdOfATurnShiftsTheAxes) {
  const Vec3 position{0.02, -0.013, 0.12};
  const double c = std::cos(2 * std::numbers::pi / 3), s = std::sin(2 * std::numbers::pi / 3);
  const Vec3 turned{c * position.x - s * position.y, s * position.x + c * position.y, position.z};
  const Triple before = pose_at(position)->angles, after = pose_at(turned)->angles;
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(after[i], before[(i + 1) % 3], 1e-12) << i;
}

TEST(FalconKinematics, TheJacobianIsTheSlopeOfTheAngles) {
  constexpr double kStep = 1e-6;
  over_workspace(7, [](const Vec3& position) {
    const Pose pose = pose_at(position).value();
    for (const Vec3& displacement : {Vec3{kStep, 0, 0}, Vec3{0, kStep, 0}, Vec3{0, 0, kStep}}) {
      const Triple ahead = pose_at(position + displacement)->angles, behind = pose_at(position - displacement)->angles;
      for (std::size_t i = 0; i < 3; ++i)
        EXPECT_NEAR((ahead[i] - behind[i]) / 2, dot(pose.jacobian[i], displacement), 1e-6 * kStep * 100) << i;
    }
  });
}

TEST(FalconKinematics, TorquesDoTheWorkOfTheForce) {
  constexpr double kStep = 1e-6;
  over_workspace(7, [](const Vec3& position) {
    const Pose pose = pose_at(position).value();
    for (const Vec3& force : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}, Vec3{-2, 3, -1}}) {
      const Triple torque = torques(pose, force);
      for (const Vec3& displacement : {Vec3{kStep, 0, 0}, Vec3{0, kStep, 0}, Vec3{0, 0, kStep}}) {
        const Triple ahead = pose_at(position + displacement)->angles, behind = pose_at(position - displacement)->angles;
        double work = 0;  // [J]
        for (std::size_t i = 0; i < 3; ++i) work += torque[i] * (ahead[i] - behind[i]) / 2;
        EXPECT_NEAR(work, dot(force, displacement), 1e-5 * kStep);
      }
    }
  });
}

TEST(FalconKinematics, PushingTheHandleAwayTakesEveryMotor) {
  // All arms turn back when the handle moves towards the motors: the torques against that have one sign, the motor values the other.
  const Triple torque = torques(pose_at({0, 0, kMiddle}).value(), {0, 0, 1});
  for (const double one : torque) EXPECT_NEAR(one, torque[0], 1e-12);
  EXPECT_GT(torque[0], 0);
  EXPECT_LT(motors_of(torque)[0], 0);
}

TEST(FalconKinematics, TheNominalForceIsHeldAllOverTheWorkspace) {
  double least = kInfinity, middle = kInfinity;  // [N] that the motors can hold in the direction they find hardest
  const auto hold = [](const Vec3& position, const Vec3& direction) {
    const Triple torque = torques(pose_at(position).value(), direction);
    return kMotorLimit / 1e4 / std::max({std::abs(torque[0]), std::abs(torque[1]), std::abs(torque[2])});
  };
  for (int row = -20; row <= 20; ++row) {
    for (int column = 0; column < 126; ++column) {
      const double up = row / 20.0, turn = column / 20.0;
      const double flat = std::sqrt(std::max(0.0, 1 - up * up));
      const Vec3 direction{flat * std::cos(turn), flat * std::sin(turn), up};
      over_workspace(2, [&](const Vec3& position) { least = std::min(least, hold(position, direction)); });
      middle = std::min(middle, hold({0, 0, kMiddle}, direction));
    }
  }
  EXPECT_GT(least, kNominalForce);
  EXPECT_LT(least, kNominalForce + 0.1);
  EXPECT_GT(middle, kPeakForce);
  EXPECT_LT(middle, kPeakForce + 0.1);
}

TEST(FalconKinematics, ImpossibleAndSingularPosesAreRefused) {
  for (const Vec3& position :
       {Vec3{0, 0, 0.3}, Vec3{0.2, 0, kMiddle}, Vec3{0, -0.2, kMiddle}, Vec3{0, 0, 0}, Vec3{0, 0, -kMiddle}, Vec3{kNaN, 0, 0},
        Vec3{0, kInfinity, 0}, Vec3{0, 0, -kInfinity}, Vec3{1e300, 1e300, 1e300}})
    expect_refused(pose_at(position));
  for (const Triple& angles :
       {Triple{kNaN, 0, 0}, Triple{0, kInfinity, 0}, Triple{1e300, 0, 0}, Triple{-2, -2, -2}, Triple{3.1, 0, 0}})
    expect_refused(pose_with(angles));
  expect_refused(pose_with({-2.52, 1.92, -2.20}));  // behind the motors
  expect_refused(pose_with({0.92, 2.04, 1.40}));    // the rods nearly in one plane
  // Along the axis until the arms and their rods are in line: refused before, and for good.
  double last = 0;
  for (int i = 0; i < 2000; ++i)
    if (const double z = kMiddle + 1e-4 * i; pose_at({0, 0, z})) last = z;
  EXPECT_GT(last, kMiddle + kHalfWidth);
  const double stretched = std::sqrt(std::pow(0.060 + 0.0225 + 0.1025, 2) - std::pow(0.040 - 0.01443, 2));
  EXPECT_LT(last, stretched - 1e-4);
  const Pose outermost = pose_at({0, 0, last}).value();
  for (const Vec3& row : outermost.jacobian) EXPECT_LT(norm(row), 1 / (0.060 * 0.1) + 1);
  // Flat among the motors no arm turns for a motion along the axis.
  for (int i = 0; i < 10; ++i) expect_refused(pose_at({0, 0, 1e-3 * i}));
}

TEST(FalconKinematics, AnyAnglesEndInAPoseOrARefusal) {
  int reached = 0;
  for (int i = 0; i < 32 * 32 * 32; ++i) {
    const auto angle = [i](int shift) { return -3.2 + 0.2 * (i >> shift & 31); };
    const Triple angles{angle(0), angle(5), angle(10)};
    const auto pose = pose_with(angles);
    if (!pose) continue;
    ++reached;
    EXPECT_GT(pose->position.z, 0);
    // Away from singular poses, a millimetre takes no large turn and a force no large torque.
    for (const Vec3& row : pose->jacobian) EXPECT_LT(norm(row), 2 / (0.060 * 0.1));
    for (const Vec3& force : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}})
      for (const double torque : torques(*pose, force)) EXPECT_LT(std::abs(torque), 0.5);
    const auto again = pose_at(pose->position);
    ASSERT_TRUE(again);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(std::remainder(again->angles[k] - angles[k], 2 * std::numbers::pi), 0, 1e-6);
  }
  EXPECT_GT(reached, 100);
}

TEST(FalconKinematics, CountsAndMotorValuesConvertBothWays) {
  EXPECT_NEAR(angle_of(1) - angle_of(0), 2 * std::numbers::pi * 14.25 / 110 / 1280, 1e-15);
  for (int count = -2000; count <= 2000; count += 7) EXPECT_NEAR(count_of(angle_of(count)), count, 1e-9);
  const auto motors = motors_of({0.1, -0.2, 0.01});
  EXPECT_EQ(motors, (std::array<std::int16_t, 3>{-1000, 2000, -100}));
  EXPECT_EQ(motors_of(torques_of(motors)), motors);
  EXPECT_EQ(motors_of({}), (std::array<std::int16_t, 3>{}));
  // Too much of one scales all: the direction stays.
  EXPECT_EQ(motors_of({1, -0.5, 0.25}), (std::array<std::int16_t, 3>{-4096, 2048, -1024}));
  EXPECT_EQ(motors_of({-1e6, 0, 0}), (std::array<std::int16_t, 3>{4096, 0, 0}));
}

TEST(FalconKinematics, FramesAgree) {
  const Vec3 position{0.01, 0.02, 0.13};  // right, up, towards the user
  EXPECT_EQ(from_native(position), (Vec3{0.01, kMiddle - 0.13, 0.02}));
  EXPECT_LT(norm(to_native(from_native(position)) - position), 1e-15);
  EXPECT_EQ(force_to_native({1, 2, 3}), (Vec3{1, 3, -2}));
  // Both are right-handed, and work is work.
  const Vec3 force{1, 2, 3}, displacement{1e-3, 2e-3, -1e-3};
  EXPECT_NEAR(dot(force, displacement), dot(force_to_native(force), to_native(displacement) - to_native({})), 1e-15);
}

// ==== falcon frame ====

using Bytes = std::vector<std::uint8_t>;

struct Heard {
  std::vector<Reply> replies;
  int broken = 0;
  friend bool operator==(const Heard&, const Heard&) = default;
};

void hear(ReplyParser& parser, const Bytes& transfer, Heard& heard) {
  parser.give(transfer);
  while (const auto next = parser.next()) {
    if (*next) {
      heard.replies.push_back(**next);
    } else {
      EXPECT_EQ(next->error().code, Errc::malformed);
      EXPECT_STREQ(next->error().rule, "R-DEV-5");
      ++heard.broken;
    }
  }
}

/// In transfers of so many bytes, modem bytes before each; those look like the beginning of a frame.
Heard heard_in(const Bytes& bytes, std::size_t piece = 62) {
  ReplyParser parser;
  Heard out;
  for (std::size_t at = 0; at < bytes.size(); at += piece) {
    Bytes transfer{'<', '<'};
    transfer.insert(transfer.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at),
                    bytes.begin() + static_cast<std::ptrdiff_t>(std::min(at + piece, bytes.size())));
    hear(parser, transfer, out);
  }
  return out;
}

Bytes operator+(Bytes a, const Bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

constexpr Reply kReply{{-32768, 0x1234, -1}, 5, 3};

TEST(FalconFrame, RequestsAreWrittenDigitByDigit) {
  const Frame frame = encode({{0x1234, -1, -4096}, Light::red});
  EXPECT_EQ(std::string(frame.begin(), frame.end()), "<EDCBPPPPAAAPJA>");
  const Frame none = encode({});
  EXPECT_EQ(std::string(none.begin(), none.end()), "<AAAAAAAAAAAABA>");
}

TEST(FalconFrame, RepliesComeBackAsSaid) {
  for (int value = -32768; value <= 32767; value += 13) {
    const auto count = static_cast<std::int16_t>(value);
    const Reply reply{{count, static_cast<std::int16_t>(-count / 2), static_cast<std::int16_t>(~count)},
                      static_cast<std::uint8_t>(value & 15),
                      static_cast<std::uint8_t>(value & 7)};
    EXPECT_EQ(heard_in(frame_of(reply)), (Heard{{reply}, 0}));
  }
}

TEST(FalconFrame, TransfersEndAnywhere) {
  const Reply other{{1, 2, 3}, 0, 7};
  const Bytes both = frame_of(kReply) + frame_of(other);
  for (std::size_t piece = 1; piece <= both.size(); ++piece)
    EXPECT_EQ(heard_in(both, piece), (Heard{{kReply, other}, 0})) << piece;
  ReplyParser parser;
  Heard heard;
  for (const Bytes& few : {Bytes{}, Bytes{1}, Bytes{1, 2}}) hear(parser, few, heard);
  EXPECT_EQ(heard, Heard{});
}

TEST(FalconFrame, EveryPacketOfALongTransferHasModemBytes) {
  Bytes bytes, transfer;
  for (int i = 0; i < 8; ++i) bytes = bytes + frame_of(kReply);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    if (i % 62 == 0) transfer = transfer + Bytes{'<', '>'};
    transfer.push_back(bytes[i]);
  }
  ReplyParser parser;
  Heard heard;
  hear(parser, transfer, heard);
  EXPECT_EQ(heard, (Heard{std::vector<Reply>(8, kReply), 0}));
}

TEST(FalconFrame, APrefixIsNoFrameAndTheNextOneIsRead) {
  const Bytes whole = frame_of(kReply);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const Bytes prefix(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_EQ(heard_in(prefix), Heard{});
    EXPECT_EQ(heard_in(prefix + whole), (Heard{{kReply}, size > 0 ? 1 : 0})) << size;
  }
}

TEST(FalconFrame, EveryBitFlipIsSeenOrChangesOnlyValues) {
  const Bytes whole = frame_of(kReply);
  for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
    Bytes flipped = whole;
    flipped[bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
    const Heard heard = heard_in(flipped + whole);
    ASSERT_FALSE(heard.replies.empty()) << bit;
    EXPECT_EQ(heard.replies.back(), kReply);
    // Without '<' no frame begins; '<' in place of '>' begins one more.
    const std::size_t begun = bit / 8 == 0 ? 1 : flipped[15] == '<' ? 3 : 2;
    EXPECT_EQ(heard.replies.size() + static_cast<std::size_t>(heard.broken), begun) << bit;
  }
}

TEST(FalconFrame, NoByteOutsideItsRangeIsTaken) {
  for (std::size_t index = 1; index < kFrameBytes; ++index) {
    for (int value = 0; value < 256; ++value) {
      Bytes changed = frame_of(kReply);
      changed[index] = static_cast<std::uint8_t>(value);
      const bool fits = index == 14   ? value != '<'
                        : index == 15 ? value == '>'
                                      : value >= 0x41 && value <= (index == 13 ? 0xc0 : 0x50);
      EXPECT_EQ(heard_in(changed).replies.size(), fits ? 1u : 0u) << index << ' ' << value;
    }
  }
}

TEST(FalconFrame, GarbageHidesNoFrame) {
  std::srand(7);
  for (int round = 0; round < 2000; ++round) {
    Bytes garbage(static_cast<std::size_t>(std::rand() % 100));
    for (std::uint8_t& byte : garbage) byte = static_cast<std::uint8_t>(std::rand() % 4 == 0 ? '<' : std::rand());
    const Heard heard = heard_in(garbage + frame_of(kReply), 1 + static_cast<std::size_t>(std::rand() % 62));
    ASSERT_FALSE(heard.replies.empty());
    EXPECT_EQ(heard.replies.back(), kReply);
  }
}

TEST(FalconFrame, NothingIsAllocated) {
  const Bytes whole = frame_of(kReply) + Bytes{'<', 'x'} + frame_of(kReply);
  ReplyParser parser;
  const std::uint64_t before = testing::allocated_bytes();
  int seen = 0;
  parser.give(whole);
  while (parser.next()) ++seen;
  EXPECT_EQ(encode({})[0], '<');
  EXPECT_EQ(testing::allocated_bytes(), before);
  EXPECT_EQ(seen, 2);  // without the first frame, whose first bytes are taken for the modem's
}

}  // namespace
}  // namespace tactus::device::falcon
