// SPDX-License-Identifier: Apache-2.0
/// A server and a participant through the C interface, over a network that does nothing.
#include <tactus_session.h>

#include "tests/bindings/fixture.h"

namespace tactus::c_test {
namespace {

using Server = std::unique_ptr<tactus_server, Destroy<tactus_server_destroy>>;
using Client = std::unique_ptr<tactus_client, Destroy<tactus_client_destroy>>;

struct Ends {
  Scene scene = make_scene();
  Server server;
  Client client;
  std::vector<std::uint32_t> events;  // of the client

  Ends() {
    tactus_server* s = nullptr;
    tactus_client* c = nullptr;
    EXPECT_EQ(tactus_server_create(scene.get(), nullptr, 1, 0, &s, nullptr), TACTUS_OK);
    auto options = filled<tactus_client_options_init, tactus_client_options>();
    options.role = TACTUS_ROLE_PARTICIPANT;
    EXPECT_EQ(tactus_client_create(&options, &c, nullptr), TACTUS_OK);
    server.reset(s);
    client.reset(c);
  }
  void exchange(std::uint64_t now) {
    std::uint8_t bytes[TACTUS_DATAGRAM_BYTES];
    std::size_t size = 0;
    std::uint64_t peer = 0;
    while (tactus_client_poll_datagram(client.get(), now, bytes, sizeof bytes, &size, nullptr) == TACTUS_OK)
      EXPECT_EQ(tactus_server_handle_datagram(server.get(), now, 7, bytes, size, nullptr), TACTUS_OK);
    while (tactus_server_poll_datagram(server.get(), now, &peer, bytes, sizeof bytes, &size, nullptr) == TACTUS_OK) {
      EXPECT_EQ(peer, 7u);
      EXPECT_EQ(tactus_client_handle_datagram(client.get(), now, bytes, size, nullptr), TACTUS_OK);
    }
    auto event = sized<tactus_event>();
    while (tactus_client_poll_event(client.get(), &event, nullptr) == TACTUS_OK) events.push_back(event.kind);
  }
};

TEST(CSession, BringsSceneStatesAndDevice) {
  Ends ends;
  Truth truth;
  ASSERT_EQ(tactus_client_receiver(ends.client.get()), nullptr);
  ASSERT_EQ(tactus_client_open(ends.client.get(), 0, 2, nullptr), TACTUS_OK);
  double worst = 0;
  int shown_ticks = 0;
  for (std::int64_t tick = 0; tick < 2000; ++tick) {
    const auto now = static_cast<std::uint64_t>(1000 * tick);
    ASSERT_EQ(tactus_server_handle_timeout(ends.server.get(), now, nullptr), TACTUS_OK);
    ASSERT_EQ(tactus_client_handle_timeout(ends.client.get(), now, nullptr), TACTUS_OK);
    ASSERT_EQ(tactus_server_submit(ends.server.get(), now, tick, truth.at(tick), nullptr), TACTUS_OK);
    const tactus_device_sample sample{{0.01, 0.02, 0.03}, {1, 0, 0, 0}, {0, 0, 0}, 1, 0, 0};
    ASSERT_EQ(tactus_client_submit(ends.client.get(), now, &sample, nullptr, nullptr), TACTUS_OK);
    ends.exchange(now);
    std::int64_t shown = 0;
    if (tactus_client_shown_tick(ends.client.get(), now, &shown, nullptr) != TACTUS_OK) continue;
    tactus_pose pose;
    ASSERT_EQ(tactus_receiver_poses(tactus_client_receiver(ends.client.get()), shown, 1, 1, &pose, nullptr), TACTUS_OK);
    truth.at(shown);
    worst = std::max(worst, std::abs(pose.position[0] - truth.objects[1].pose.position[0]));
    ++shown_ticks;
  }
  EXPECT_EQ(ends.events, (std::vector<std::uint32_t>{TACTUS_EVENT_WELCOMED, TACTUS_EVENT_LIVE}));
  EXPECT_GT(shown_ticks, 1500);
  EXPECT_LE(worst, 0.006);
  tactus_device_sample device;
  ASSERT_EQ(tactus_server_device(ends.server.get(), 0, 2'000'000, &device, nullptr), TACTUS_OK);
  EXPECT_NEAR(device.position[1], 0.02, 1e-4);
  EXPECT_EQ(device.buttons, 1u);
  auto status = sized<tactus_session_status>();
  ASSERT_EQ(tactus_server_status(ends.server.get(), 0, &status, nullptr), TACTUS_OK);
  EXPECT_EQ(status.state, std::uint32_t{TACTUS_SESSION_LIVE});
  EXPECT_EQ(status.peer, 7u);
  EXPECT_EQ(status.wrong_states, 0u);
  ASSERT_EQ(tactus_client_status(ends.client.get(), &status, nullptr), TACTUS_OK);
  EXPECT_EQ(status.declaration_bytes, status.declaration_received);
  EXPECT_GT(status.packets_heard, 5u);
  double share = 0;
  EXPECT_EQ(tactus_client_force_share(ends.client.get(), 2'000'000, &share, nullptr), TACTUS_OK);
  EXPECT_GE(share, 0);
  EXPECT_LE(share, 1);
}

TEST(CSession, Refuses) {
  Ends ends;
  Truth truth;
  std::uint8_t bytes[TACTUS_DATAGRAM_BYTES] = {};
  std::size_t size = 0;
  std::uint64_t peer = 0;
  auto event = sized<tactus_event>();
  tactus_server* server = ends.server.get();
  tactus_client* client = ends.client.get();
  tactus_server* other = nullptr;
  auto options = filled<tactus_server_options_init, tactus_server_options>();
  options.clients = 1u << 16;
  EXPECT_REFUSED("R-API-4", tactus_server_create, ends.scene.get(), &options, 1, 0, &other);
  EXPECT_REFUSED("R-API-12", tactus_server_create, nullptr, nullptr, 1, 0, &other);
  EXPECT_REFUSED("R-SES-1", tactus_server_handle_datagram, server, 0, 7, bytes, 30);
  EXPECT_REFUSED("R-API-12", tactus_server_handle_datagram, server, 0, 0, bytes, 30);
  EXPECT_REFUSED("R-API-12", tactus_server_handle_datagram, server, 0, 7, nullptr, 30);
  EXPECT_REFUSED("R-API-12", tactus_server_poll_datagram, server, 0, &peer, bytes, sizeof bytes - 1, &size);
  EXPECT_REFUSED("R-API-12", tactus_server_close_client, server, 8, TACTUS_LEAVE_BYE);
  EXPECT_REFUSED("R-API-12", tactus_server_close_client, server, 0, 99);
  EXPECT_REFUSED("R-API-12", tactus_server_submit, server, 0, 0, nullptr);
  event.size = 0;
  EXPECT_REFUSED("R-API-12", tactus_server_poll_event, server, &event);
  EXPECT_REFUSED("R-API-12", tactus_client_poll_event, client, &event);
  EXPECT_REFUSED("R-API-12", tactus_client_handle_datagram, client, 0, nullptr, 3);
  EXPECT_REFUSED("R-SES-1", tactus_client_handle_datagram, client, 0, bytes, 3);
  EXPECT_REFUSED("R-API-12", tactus_client_submit, client, 0, nullptr, nullptr);
  EXPECT_REFUSED("R-API-12", tactus_client_handle_timeout, client, UINT64_MAX);
  EXPECT_EQ(tactus_client_handle_timeout(client, 50, nullptr), TACTUS_OK);
  EXPECT_REFUSED("R-API-5", tactus_client_handle_timeout, client, 49);  // time steps back
  EXPECT_EQ(tactus_server_close(server, nullptr), TACTUS_OK);
  EXPECT_EQ(tactus_client_close(client, nullptr), TACTUS_OK);
}

}  // namespace
}  // namespace tactus::c_test
