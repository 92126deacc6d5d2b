// SPDX-License-Identifier: Apache-2.0
// Motions of many objects for sessions: made here, so that nothing but their seeds chooses them.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <tactus/sim/random.h>
#include "lab/study/session.h"

namespace tactus::sim::study {
namespace {

constexpr double kStep = 1e-3, kGravity = 9.81;  // [s], [m/s^2]

struct Body {
  Vec3 position, velocity, spin;  // spin in the world [rad/s]
  Quat rotation{};
  double rests = 0;  // [s] until it is set going again
};

Vec3 any_in(Random& random, double x, double y, double z) {
  const double a = random.uniform(-x, x), b = random.uniform(-y, y), c = random.uniform(-z, z);
  return {a, b, c};
}

void turn(Body& body) {
  const double angle = norm(body.spin) * kStep;
  if (angle == 0) return;
  const Vec3 half = (std::sin(0.5 * angle) / norm(body.spin)) * body.spin;
  const Quat q = Quat{std::cos(0.5 * angle), half.x, half.y, half.z} * body.rotation;
  const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  body.rotation = {q.w / length, q.x / length, q.y / length, q.z / length};
}

/// 1 mm and 1 deg.
Motion motion_of(std::string name, std::size_t objects) {
  Motion out{
      .name = std::move(name), .info = {.tick_rate = 1000, .objects = {}, .users = {}, .source = {}, .scene = {}}, .frames = {}};
  out.sender.triggers.visual_position = 1e-3;
  out.sender.triggers.visual_rotation = std::numbers::pi / 180;
  out.sender.triggers.haptic = HapticRule::off;
  for (std::size_t i = 0; i < objects; ++i) out.info.objects.push_back({"body " + std::to_string(i)});
  return out;
}

template <class Step>
Motion simulated(std::string name, std::vector<Body>& bodies, std::int64_t ticks, Step&& step) {
  Motion out = motion_of(std::move(name), bodies.size());
  for (std::int64_t tick = 0; tick < ticks; ++tick) {
    step(tick);
    TraceFrame& frame = out.frames.emplace_back();
    frame.tick = tick;
    for (const Body& body : bodies) {
      RigidSample& sample = frame.objects.emplace_back();
      sample.pose = {body.position, body.rotation};
      sample.velocity = body.velocity;
      sample.angular_velocity = body.spin;
    }
  }
  return out;
}

/// Equal balls that touch and near each other exchange what they have along the line of their centres.
void collide(Body& a, Body& b, double diameter, double restitution) {
  const Vec3 between = b.position - a.position;
  const double distance = norm(between);
  if (distance >= diameter || distance == 0) return;
  const Vec3 normal = (1 / distance) * between;
  const double nearing = dot(a.velocity - b.velocity, normal);
  if (nearing > 0) {
    const Vec3 change = (0.5 * (1 + restitution) * nearing) * normal;
    a.velocity = a.velocity - change;
    b.velocity = b.velocity + change;
  }
  const Vec3 apart = (0.25 * (diameter - distance)) * normal;
  a.position = a.position - apart;
  b.position = b.position + apart;
}

/// A box of principal moments 1 : 1.7 : 2.3 turns without a load: Euler's equations.
void tumble(Body& box) {
  constexpr std::array kMoments{1.0, 1.7, 2.3};
  Vec3 own = rotate(conjugate(box.rotation), box.spin);
  own = own + kStep * Vec3{(kMoments[1] - kMoments[2]) / kMoments[0] * own.y * own.z,
                           (kMoments[2] - kMoments[0]) / kMoments[1] * own.z * own.x,
                           (kMoments[0] - kMoments[1]) / kMoments[2] * own.x * own.y};
  box.spin = rotate(box.rotation, own);
}

}  // namespace

Motion tumbling_boxes(std::int64_t ticks, std::uint64_t seed) {
  Random random(seed);
  std::vector<Body> boxes(12);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    boxes[i].position = any_in(random, 0.4, 0.4, 0) + Vec3{0, 0, 0.05};
    boxes[i].rests = 0.05 * static_cast<double>(i + 1);
  }
  const auto fly = [&](Body& box) {
    tumble(box);
    turn(box);
    box.velocity.z -= kGravity * kStep;
    box.position = box.position + kStep * box.velocity;
    if (box.position.z > 0.05 || box.velocity.z > 0) return;
    box.position.z = 0.05;
    box.velocity = {0.7 * box.velocity.x, 0.7 * box.velocity.y, -0.55 * box.velocity.z};
    box.spin = 0.6 * box.spin + any_in(random, 1.5, 1.5, 1.5);
    if (box.velocity.z > 0.25) return;
    box.velocity = box.spin = {};
    box.rests = random.uniform(0.3, 1);
  };
  return simulated("twelve tumbling boxes", boxes, ticks, [&](std::int64_t) {
    for (Body& box : boxes) {
      if (box.rests <= 0) {
        fly(box);
      } else if ((box.rests -= kStep) <= 0) {
        box.velocity = any_in(random, 0.6, 0.6, 0) + Vec3{0, 0, random.uniform(2, 3)};
        box.spin = any_in(random, 6, 6, 6);
      }
    }
  });
}

Motion knocked_objects(std::int64_t ticks, std::uint64_t seed) {
  constexpr std::size_t kWanderers = 25;
  Random random(seed);
  std::vector<Body> bodies(100);
  std::vector<Vec3> pushes(kWanderers);
  for (Body& body : bodies) body.position = any_in(random, 0.5, 0.5, 0);
  const auto wander = [&](Body& body, Vec3& push) {
    push = (1 - 4 * kStep) * push + std::sqrt(kStep) * any_in(random, 5, 5, 5);
    body.velocity = body.velocity + kStep * (push - 1.5 * body.velocity - 2 * body.position);
    body.position = body.position + kStep * body.velocity;
    body.spin.z += -2 * kStep * body.spin.z + std::sqrt(kStep) * random.uniform(-1.7, 1.7);
  };
  const auto slide = [&](Body& body) {
    if (random.uniform(0, 1) < 0.2 * kStep) {
      body.velocity = any_in(random, 0.6, 0.6, 0);
      body.spin.z = random.uniform(-3, 3);
    }
    const double speed = norm(body.velocity), slower = 2 * kStep;  // friction
    if (speed <= slower) {
      body.velocity = body.spin = {};
      return;
    }
    body.velocity = (1 - slower / speed) * body.velocity;
    body.spin = 0.997 * body.spin;
    body.position = body.position + kStep * body.velocity;
  };
  return simulated("a hundred objects with knocks", bodies, ticks, [&](std::int64_t) {
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      if (i < kWanderers) wander(bodies[i], pushes[i]);
      else slide(bodies[i]);
      turn(bodies[i]);
    }
  });
}

Motion billiard(std::int64_t ticks, std::uint64_t seed) {
  constexpr double kRadius = 0.028, kHalfLength = 0.6, kHalfWidth = 0.3;  // [m]
  Random random(seed);
  std::vector<Body> balls(16);
  balls[0].position = {-0.3, 0.004, kRadius};
  for (std::size_t i = 1, row = 0, column = 0; i < balls.size(); ++i) {
    balls[i].position = {0.2 + 1.75 * kRadius * static_cast<double>(row),
                         kRadius * 2.002 * (static_cast<double>(column) - 0.5 * static_cast<double>(row)), kRadius};
    if (++column > row) ++row, column = 0;
  }
  const auto bounce = [](double& position, double& velocity, double wall) {
    if (std::abs(position) < wall || position * velocity <= 0) return;
    position = std::copysign(wall, position);
    velocity *= -0.8;
  };
  return simulated("billiard of 16 balls", balls, ticks, [&](std::int64_t tick) {
    if (tick % 2500 == 300) balls[0].velocity = Vec3{random.uniform(1.5, 3), random.uniform(-0.3, 0.3), 0};
    for (std::size_t i = 0; i < balls.size(); ++i)
      for (std::size_t k = i + 1; k < balls.size(); ++k) collide(balls[i], balls[k], 2 * kRadius, 0.94);
    for (Body& ball : balls) {
      const double speed = norm(ball.velocity), slower = 0.15 * kStep;  // rolling resistance
      ball.velocity = speed <= slower ? Vec3{} : (1 - slower / speed) * ball.velocity;
      ball.position = ball.position + kStep * ball.velocity;
      bounce(ball.position.x, ball.velocity.x, kHalfLength - kRadius);
      bounce(ball.position.y, ball.velocity.y, kHalfWidth - kRadius);
      ball.spin = {-ball.velocity.y / kRadius, ball.velocity.x / kRadius, 0};
      turn(ball);
    }
  });
}

Motion juggled_clubs(std::int64_t ticks, std::uint64_t seed) {
  constexpr double kHeld = 0.25;  // [s] in a hand, which moves to the other side meanwhile
  Random random(seed);
  std::vector<Body> clubs(9);
  for (std::size_t i = 0; i < clubs.size(); ++i) {
    clubs[i].position = {i % 2 == 0 ? 0.2 : -0.2, 0.15 * static_cast<double>(i / 3), 1};
    clubs[i].rests = kHeld + 0.17 * static_cast<double>(i);
  }
  const auto carry = [&](Body& club) {
    club.rests -= kStep;
    const double phase = std::clamp(1 - club.rests / kHeld, 0.0, 1.0) * std::numbers::pi;
    club.velocity = phase > 0 ? Vec3{0, 0, -0.3 * std::sin(2 * phase)} : Vec3{};
    club.spin = {};
    if (club.rests > 0) return;
    const double height = random.uniform(0.5, 0.9), flight = 2 * std::sqrt(2 * height / kGravity);
    club.velocity = {-2 * club.position.x / flight, random.uniform(-0.05, 0.05), std::sqrt(2 * kGravity * height)};
    club.spin = {0, 2 * std::numbers::pi * (random.uniform(0, 1) < 0.5 ? 1 : 2) / flight, 0};
  };
  return simulated("nine juggled clubs", clubs, ticks, [&](std::int64_t) {
    for (Body& club : clubs) {
      if (club.rests > 0) {
        carry(club);
      } else {
        club.velocity.z -= kGravity * kStep;
        if (club.position.z < 1 && club.velocity.z < 0) club.rests = kHeld;  // caught
      }
      club.position = club.position + kStep * club.velocity;
      turn(club);
    }
  });
}

Motion drawn_sheet(std::int64_t ticks, std::uint64_t seed) {
  constexpr std::uint32_t kSide = 71;
  constexpr std::int64_t kPeriod = 17;            // [ticks]
  constexpr double kWidth = 0.3, kFinger = 0.03;  // [m]
  Motion out{.name = "sheet of 5041 vertices",
             .info = {.tick_rate = 1000, .objects = {}, .users = {}, .source = {}, .scene = {}},
             .frames = {}};
  out.sender.deformable.thresholds.visual = 0.25e-3;
  TraceDeformable sheet{.name = "sheet", .rest = {}, .period = kPeriod};
  const auto along = [](std::uint32_t i) { return kWidth * (static_cast<double>(i) / (kSide - 1) - 0.5); };
  for (std::uint32_t i = 0; i < kSide * kSide; ++i) sheet.rest.vertices.push_back({along(i % kSide), along(i / kSide), 0});
  for (std::uint32_t y = 0; y + 1 < kSide; ++y)
    for (std::uint32_t x = 0; x + 1 < kSide; ++x) {
      const std::uint32_t a = y * kSide + x;
      sheet.rest.triangles.push_back({a, a + 1, a + kSide + 1});
      sheet.rest.triangles.push_back({a, a + kSide + 1, a + kSide});
    }
  Random random(seed);
  const double turn[] = {random.uniform(1.5, 2.3), random.uniform(2.3, 3.1), random.uniform(8, 14)};  // [rad/s]
  const auto depth = [&](const Vec3& at, double time) {
    const double x = 0.08 * std::sin(turn[0] * time) - at.x, y = 0.08 * std::sin(turn[1] * time + 1) - at.y;
    const double pressed = 0.01 * std::min(time, 1.0) * (1 + 0.3 * std::sin(5 * time));
    const double held = (1 - std::pow(2 * at.x / kWidth, 4)) * (1 - std::pow(2 * at.y / kWidth, 4));  // at its rim
    const double ripple = 0.0006 * std::sin(40 * (at.x + at.y) - turn[2] * time);
    return held * (pressed * std::exp(-(x * x + y * y) / (2 * kFinger * kFinger)) + ripple);
  };
  for (std::int64_t tick = 0; tick < ticks; ++tick) {
    TraceFrame& frame = out.frames.emplace_back();
    frame.tick = tick;
    DeformableSample& shape = frame.meshes.emplace_back();
    shape.updated = tick % kPeriod == 0;
    for (std::size_t i = 0; shape.updated && i < sheet.rest.vertices.size(); ++i) {
      const auto down = static_cast<float>(-depth(sheet.rest.vertices[i], kStep * static_cast<double>(tick)));
      shape.displacements.insert(shape.displacements.end(), {0.0F, 0.0F, down});
    }
  }
  out.info.meshes.push_back(std::move(sheet));
  return out;
}

}  // namespace tactus::sim::study
