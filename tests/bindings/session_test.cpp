// SPDX-License-Identifier: Apache-2.0
/// A server and a participant through the C interface, over a network that does nothing.
#include <tactus_session.h>

#include "tests/bindings/fixture.h"

namespace tactus::c_test {
namespace {

using Server = std::unique_ptr<tactus_server, Destroy<tactus_server_destroy>>;
using Client = std::unique_ptr<tactus_client, Destroy<tactus_client_destroy>>;

struct Ends {
  Scene scene;
  Server server;
  Client client;
  std::vector<std::uint32_t> events;  // of the client

  explicit Ends(const tactus_scene_options* of = nullptr, std::int32_t role = TACTUS_ROLE_PARTICIPANT, std::uint32_t seat = 0)
      : scene(make_scene(false, of)) {
    tactus_server* s = nullptr;
    EXPECT_EQ(tactus_server_create(scene.get(), nullptr, 1, 0, &s, nullptr), TACTUS_OK);
    server.reset(s);
    enter(role, seat, 0);
  }
  /// Another client takes the place of the one before.
  void enter(std::int32_t role, std::uint32_t seat, std::uint64_t token) {
    auto options = filled<tactus_client_options>();
    options.role = role;
    options.seat = seat;
    options.token = token;
    tactus_client* c = nullptr;
    EXPECT_EQ(tactus_client_create(&options, &c, nullptr), TACTUS_OK);
    client.reset(c);
  }
  tactus_session_status status(bool of_client) const {
    auto out = sized<tactus_session_status>();
    const auto done = of_client ? tactus_client_status(client.get(), now_, &out, nullptr)
                                : tactus_server_status(server.get(), 0, now_, &out, nullptr);
    EXPECT_EQ(done, TACTUS_OK);
    return out;
  }
  /// Ticks of 1 ms, without a device.
  void run(Truth& truth, std::int64_t from, std::int64_t to, std::uint64_t peer = 7) {
    for (std::int64_t tick = from; tick < to; ++tick) {
      const auto now = static_cast<std::uint64_t>(1000 * tick);
      EXPECT_EQ(tactus_server_handle_timeout(server.get(), now, nullptr), TACTUS_OK);
      EXPECT_EQ(tactus_client_handle_timeout(client.get(), now, nullptr), TACTUS_OK);
      EXPECT_EQ(tactus_server_submit(server.get(), now, tick, truth.at(tick), nullptr, nullptr), TACTUS_OK);
      exchange(now, peer);
    }
  }
  void exchange(std::uint64_t now, std::uint64_t from = 7) {
    now_ = now;
    std::uint8_t bytes[TACTUS_DATAGRAM_BYTES];
    std::size_t size = 0;
    std::uint64_t peer = 0;
    while (tactus_client_poll_datagram(client.get(), now, bytes, sizeof bytes, &size, nullptr) == TACTUS_OK)
      EXPECT_EQ(tactus_server_handle_datagram(server.get(), now, from, bytes, size, nullptr), TACTUS_OK);
    while (tactus_server_poll_datagram(server.get(), now, &peer, bytes, sizeof bytes, &size, nullptr) == TACTUS_OK) {
      if (peer != from) continue;  // where a client was before
      EXPECT_EQ(tactus_client_handle_datagram(client.get(), now, bytes, size, nullptr), TACTUS_OK);
    }
    auto event = sized<tactus_event>();
    while (tactus_client_poll_event(client.get(), &event, nullptr) == TACTUS_OK) events.push_back(event.kind);
  }

 private:
  std::uint64_t now_ = 0;  // of the last exchange
};

/// A bad object is named; the other one goes on.
TEST(CSession, NamesWhatIsHeld) {
  Ends ends(nullptr, TACTUS_ROLE_OBSERVER);
  Truth truth;
  ASSERT_EQ(tactus_client_open(ends.client.get(), 0, 2, nullptr), TACTUS_OK);
  ends.run(truth, 0, 300);
  for (std::int64_t tick = 300; tick < 400; ++tick) {
    truth.at(tick);
    if (tick < 350) truth.objects[1].pose.position[0] = -1e6;
    const auto now = static_cast<std::uint64_t>(1000 * tick);
    auto encoded = sized<tactus_encoded>();
    ASSERT_EQ(tactus_server_submit(ends.server.get(), now, tick, &truth.truth, &encoded, nullptr), TACTUS_OK);
    ends.exchange(now);
    EXPECT_EQ(encoded.packet_count, 0u) << "datagrams carry them";
    ASSERT_EQ(encoded.held_count, tick < 350 ? 1u : 0u) << tick;
    if (encoded.held_count == 0) continue;
    const tactus_held& held = encoded.held[0];
    EXPECT_TRUE(held.part == TACTUS_PART_OBJECT && held.index == 1 && held.since == 300);
    EXPECT_STREQ(held.rule, "R-API-2");
    tactus_error error{};
    ASSERT_EQ(tactus_describe(TACTUS_INVALID_ARGUMENT, held.rule, &error), TACTUS_OK);
    EXPECT_NE(std::string(error.remedy).find("world_size"), std::string::npos);
  }
  tactus_encoded unsized{};
  EXPECT_REFUSED("R-API-12", tactus_server_submit, ends.server.get(), 400'000, 400, truth.at(400), &unsized);
}

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
    ASSERT_EQ(tactus_server_submit(ends.server.get(), now, tick, truth.at(tick), nullptr, nullptr), TACTUS_OK);
    const tactus_device_sample sample{{0.01, 0.02, 0.03}, {1, 0, 0, 0}, {0, 0, 0}, 1, 0, 0};
    ASSERT_EQ(tactus_client_submit(ends.client.get(), now, &sample, nullptr, nullptr), TACTUS_OK);
    ends.exchange(now);
    std::int64_t shown = 0;
    if (tactus_client_shown_tick(ends.client.get(), now, &shown, nullptr) != TACTUS_OK) continue;
    tactus_pose pose;
    ASSERT_EQ(tactus_receiver_poses(tactus_client_receiver(ends.client.get()), shown, 1, 1, &pose, nullptr, nullptr), TACTUS_OK);
    truth.at(shown);
    worst = std::max(worst, std::abs(pose.position[0] - truth.objects[1].pose.position[0]));
    ++shown_ticks;
  }
  EXPECT_EQ(ends.events, (std::vector<std::uint32_t>{TACTUS_EVENT_WELCOMED, TACTUS_EVENT_LIVE}));
  EXPECT_GT(shown_ticks, 1500);
  EXPECT_LE(worst, 0.006);
  auto status = sized<tactus_session_status>();
  ASSERT_EQ(tactus_server_status(ends.server.get(), 0, 2'000'000, &status, nullptr), TACTUS_OK);
  ASSERT_EQ(status.has_device, 1u);
  EXPECT_NEAR(status.device.position[1], 0.02, 1e-4);
  EXPECT_EQ(status.device.buttons, 1u);
  EXPECT_EQ(status.state, std::uint32_t{TACTUS_SESSION_LIVE});
  EXPECT_EQ(status.peer, 7u);
  EXPECT_EQ(status.wrong_states, 0u);
  ASSERT_EQ(tactus_client_status(ends.client.get(), 2'000'000, &status, nullptr), TACTUS_OK);
  EXPECT_EQ(status.declaration_bytes, status.declaration_received);
  EXPECT_GT(status.packets_heard, 5u);
  EXPECT_GT(status.force_fraction, 0);
  EXPECT_LE(status.force_fraction, 1);
  EXPECT_EQ(status.has_device, 0u);
}

TEST(CSession, SignalsSeatsAndLetsClientsComeBack) {
  Ends ends(nullptr, TACTUS_ROLE_PARTICIPANT, 2);
  Truth truth;
  ASSERT_EQ(tactus_client_open(ends.client.get(), 0, 2, nullptr), TACTUS_OK);
  ends.run(truth, 0, 300);
  EXPECT_EQ(ends.status(false).wanted_seat, 2u);
  EXPECT_EQ(ends.status(true).seat, 0u);
  ASSERT_EQ(tactus_server_seat(ends.server.get(), 0, 2, nullptr), TACTUS_OK);
  ends.run(truth, 300, 600);
  EXPECT_EQ(ends.status(true).seat, 2u);
  const std::uint64_t token = ends.status(true).token;
  EXPECT_NE(token, 0u);
  ends.enter(TACTUS_ROLE_PARTICIPANT, 0, token);  // the program has crashed, and begins anew at another address
  ASSERT_EQ(tactus_client_open(ends.client.get(), 600'000, 3, nullptr), TACTUS_OK);
  ends.run(truth, 600, 1200, 8);
  EXPECT_EQ(ends.status(true).state, std::uint32_t{TACTUS_SESSION_LIVE});
  EXPECT_EQ(ends.status(false).peer, 8u);
  EXPECT_EQ(ends.status(false).client, 0u);
}

TEST(CSession, SendsWhatIsNear) {
  auto options = filled<tactus_scene_options>();
  options.interest_full = 0.5;
  options.interest_reach = 2;
  Ends ends(&options, TACTUS_ROLE_OBSERVER);
  auto info = sized<tactus_scene_info>();
  ASSERT_EQ(tactus_scene_get(ends.scene.get(), &info, nullptr), TACTUS_OK);
  EXPECT_EQ(info.interest_reach, 2);
  Truth truth;
  const double far[] = {5, 0, 0}, between[] = {0.8, 0, 0}, near_by[] = {0.2, 0, 0};
  ASSERT_EQ(tactus_client_set_viewpoint(ends.client.get(), 0, far, nullptr), TACTUS_OK);
  ASSERT_EQ(tactus_client_open(ends.client.get(), 0, 2, nullptr), TACTUS_OK);
  ends.run(truth, 0, 500);
  const auto level = [&](std::int64_t tick) {
    std::uint8_t out = 99;
    EXPECT_EQ(tactus_receiver_poses(tactus_client_receiver(ends.client.get()), tick, 1, 1, nullptr, &out, nullptr), TACTUS_OK);
    return int{out};
  };
  EXPECT_EQ(level(499), TACTUS_OUT_OF_INTEREST);
  ASSERT_EQ(tactus_client_set_viewpoint(ends.client.get(), 500'000, between, nullptr), TACTUS_OK);
  ends.run(truth, 500, 1000);
  EXPECT_EQ(level(999), 1);
  ASSERT_EQ(tactus_client_set_viewpoint(ends.client.get(), 1'000'000, near_by, nullptr), TACTUS_OK);
  ends.run(truth, 1000, 1500);
  EXPECT_EQ(level(1499), 0);
  EXPECT_REFUSED("R-API-12", tactus_client_set_viewpoint, ends.client.get(), 1'500'000, nullptr);
  EXPECT_REFUSED("R-API-12", tactus_receiver_poses, tactus_client_receiver(ends.client.get()), 1, 1, 2, nullptr, nullptr);

  const Sender sender = make_sender(ends.scene);
  ASSERT_EQ(tactus_sender_set_viewpoints(sender.get(), far, 1, nullptr), TACTUS_OK);
  EXPECT_TRUE(encode(sender, 0, truth.at(0)).empty());
  ASSERT_EQ(tactus_sender_set_viewpoints(sender.get(), near_by, 1, nullptr), TACTUS_OK);
  EXPECT_EQ(encode(sender, 1, truth.at(1)).size(), 1u);
  EXPECT_REFUSED("R-API-12", tactus_sender_set_viewpoints, sender.get(), nullptr, 1);
  options.interest_reach = 0.1;
  tactus_scene_builder* raw = nullptr;
  ASSERT_EQ(tactus_scene_builder_create(&options, &raw, nullptr), TACTUS_OK);
  const Builder builder(raw);
  ASSERT_EQ(tactus_scene_builder_rigid(raw, "cube", nullptr, nullptr), TACTUS_OK);
  tactus_scene* made = nullptr;
  tactus_error error{};
  EXPECT_EQ(tactus_scene_builder_build(raw, &made, &error), TACTUS_INVALID_ARGUMENT);
  EXPECT_STREQ(error.rule, "R-API-4");
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
  auto options = filled<tactus_server_options>();
  options.clients = 1u << 16;
  EXPECT_REFUSED("R-API-4", tactus_server_create, ends.scene.get(), &options, 1, 0, &other);
  EXPECT_REFUSED("R-API-12", tactus_server_create, nullptr, nullptr, 1, 0, &other);
  EXPECT_REFUSED("R-SES-1", tactus_server_handle_datagram, server, 0, 7, bytes, 30);
  EXPECT_REFUSED("R-API-12", tactus_server_handle_datagram, server, 0, 0, bytes, 30);
  EXPECT_REFUSED("R-API-12", tactus_server_handle_datagram, server, 0, 7, nullptr, 30);
  EXPECT_REFUSED("R-API-12", tactus_server_poll_datagram, server, 0, &peer, bytes, sizeof bytes - 1, &size);
  EXPECT_REFUSED("R-API-12", tactus_server_seat, server, 8, 1);
  EXPECT_REFUSED("R-API-12", tactus_server_seat, server, 0, 256);
  EXPECT_REFUSED("R-API-12", tactus_server_close, server, 8, TACTUS_LEAVE_BYE);
  EXPECT_REFUSED("R-API-12", tactus_server_close, server, 0, 99);
  EXPECT_REFUSED("R-API-12", tactus_server_close, server, TACTUS_EVERY_CLIENT, 99);
  EXPECT_REFUSED("R-API-12", tactus_server_submit, server, 0, 0, nullptr, nullptr);
  auto status = sized<tactus_session_status>();
  EXPECT_REFUSED("R-API-12", tactus_server_status, server, 8, 0, &status);
  event.size = 0;
  EXPECT_REFUSED("R-API-12", tactus_server_poll_event, server, &event);
  EXPECT_REFUSED("R-API-12", tactus_client_poll_event, client, &event);
  EXPECT_REFUSED("R-API-12", tactus_client_handle_datagram, client, 0, nullptr, 3);
  EXPECT_REFUSED("R-SES-1", tactus_client_handle_datagram, client, 0, bytes, 3);
  EXPECT_REFUSED("R-API-12", tactus_client_submit, client, 0, nullptr, nullptr);
  EXPECT_REFUSED("R-API-12", tactus_client_handle_timeout, client, UINT64_MAX);
  EXPECT_EQ(tactus_client_handle_timeout(client, 50, nullptr), TACTUS_OK);
  EXPECT_REFUSED("R-API-5", tactus_client_handle_timeout, client, 49);  // time steps back
  EXPECT_EQ(tactus_server_close(server, TACTUS_EVERY_CLIENT, TACTUS_LEAVE_BYE, nullptr), TACTUS_OK);
  EXPECT_EQ(tactus_client_close(client, nullptr), TACTUS_OK);
}

}  // namespace
}  // namespace tactus::c_test
