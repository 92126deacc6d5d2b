// SPDX-License-Identifier: Apache-2.0
/// A user of the component session: a server and a client in one program, whose datagrams arrive at once.
#include <tactus/session/session_client.h>
#include <tactus/session/session_server.h>
#include <tactus/tactus.h>

#include <cstdint>
#include <cstdio>

int main() {
  const auto scene = tactus::SceneBuilder().rigid("cube").baselines(64).build();
  if (!scene) return 1;
  auto server = tactus::SessionServer::create(*scene, {}, 1, 0);
  auto client = tactus::SessionClient::create({.role = tactus::Role::observer});
  if (!server || !client) return 1;
  client->open(0, 2);
  const tactus::RigidSample cube{.pose = {{0.25, 0, 0}, {}}, .velocity = {}, .angular_velocity = {}};
  std::int64_t shown = -1;
  for (std::int64_t tick = 0; tick < 1000 && shown < 0; ++tick) {
    const auto now = static_cast<std::uint64_t>(1000 * tick);  // [us]
    client->handle_timeout(now);
    while (const auto datagram = client->poll_datagram(now)) (void)server->handle_datagram(now, 1, *datagram);
    server->handle_timeout(now);
    if (!server->submit(now, tick, {.objects = {&cube, 1}})) return 1;
    while (const auto datagram = server->poll_datagram(now)) (void)client->handle_datagram(now, datagram->bytes);
    shown = client->shown_tick(now);
  }
  if (shown < 0) {
    std::puts("no client within a second");
    return 1;
  }
  tactus::Receiver& receiver = *client->receiver();
  const tactus::Pose pose = tactus::to_pose(receiver.replica().pose(0, shown), receiver.scene()->grid.position);
  if (tactus::norm(pose.position - cube.pose.position) > tactus::RigidTriggers{}.visual_position) {
    std::puts("the client sees the cube elsewhere");
    return 1;
  }
  std::printf("a client of a session sees tick %d\n", static_cast<int>(shown));
  return 0;
}
