// SPDX-License-Identifier: Apache-2.0
/// Decoder, encoder and session in C++ and in C behind the same names, for bindings_bench. C++ writes what it gets into the
/// engine's own arrays, as the C functions do.
#pragma once

#include <tactus_encoder.h>
#include <tactus_session.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <span>
#include <vector>

#include <tactus/deformable/displacement.h>
#include <tactus/scene/scene_syntax.h>
#include <tactus/session/datagram.h>
#include <tactus/session/session_client.h>
#include <tactus/session/session_server.h>
#include <tactus/tactus.h>

namespace tactus::bench {

[[noreturn]] inline void give_up(const char* rule) {
  std::fprintf(stderr, "bindings_bench: %s\n", rule);
  std::exit(1);
}
inline void must(tactus_status status) {
  if (status == TACTUS_OK) return;
  tactus_error error;
  tactus_describe(status, nullptr, &error);
  give_up(error.name);
}
template <class T>
T must(Result<T> result) {
  if (!result) give_up(result.error().rule);
  if constexpr (!std::is_void_v<T>) return *std::move(result);
}

/// Datagrams between the ends, which allocate nothing once they have room.
class Datagrams {
 public:
  void put(std::span<const std::uint8_t> bytes) {
    if (count_ == slots_.size()) slots_.emplace_back();
    std::ranges::copy(bytes, slots_[count_].bytes.begin());
    slots_[count_++].size = bytes.size();
  }
  template <class Take>
  void empty(Take&& take) {
    for (std::size_t i = 0; i < count_; ++i) take(std::span(slots_[i].bytes).first(slots_[i].size));
    count_ = 0;
  }

 private:
  struct Slot {
    std::array<std::uint8_t, kLargestDatagram> bytes;
    std::size_t size = 0;
  };
  std::vector<Slot> slots_;
  std::size_t count_ = 0;
};

inline constexpr std::uint64_t kPeer = 7;

// ---------------------------------------------------------------- C++

struct Cpp {
  using Sample = RigidSample;
  using Shown = Pose;
  static std::vector<Sample> samples(std::span<const RigidSample> of) { return {of.begin(), of.end()}; }
  static Truth truth_of(std::span<const Sample> objects) {
    return {.objects = objects, .contacts = {}, .deformables = {}, .loads = {}};
  }

  class Decoder {
   public:
    explicit Decoder(const SharedScene& scene) : receiver_(must(Receiver::create(scene))) {}
    void push(std::uint64_t number, std::span<const std::uint8_t> packet) { must(receiver_.push(number, packet)); }
    void poses(std::int64_t tick, std::span<Pose> out) {
      for (std::uint32_t i = 0; i < out.size(); ++i) out[i] = receiver_.pose(i, tick);
    }
    void displacements(std::int64_t tick, std::span<float> out) {
      std::ranges::copy(receiver_.displacements(0, tick), out.begin());
    }

   private:
    Receiver receiver_;
  };

  class Encoder {
   public:
    Encoder(const SharedScene& scene, Reduction reduction) : sender_(must(Sender::create(scene, options(reduction)))) {}
    std::size_t encode(std::int64_t tick, std::span<const RigidSample> objects, std::span<std::uint8_t> out) {
      const std::span<const Packet> packets = must(sender_.encode(tick, truth_of(objects)));
      for (const Packet& packet : packets) std::ranges::copy(packet.bytes, out.begin());
      return packets.size();
    }

   private:
    static SenderOptions options(Reduction reduction) {
      SenderOptions out;
      out.triggers.reduction = reduction;
      out.triggers.heartbeat = 0;
      out.policy.key_interval = 0;
      return out;
    }
    Sender sender_;
  };

  /// A server and a participant. Each step is what a tick asks of an end.
  class Session {
   public:
    explicit Session(const SharedScene& scene)
        : server_(must(SessionServer::create(scene, {}, 1, 0))),
          client_(must(SessionClient::create({.role = Role::participant}))) {
      client_.open(0, 2);
    }
    void serve(std::uint64_t now, std::int64_t tick, std::span<const Sample> objects) {
      up_.empty([&](auto bytes) { must(server_.handle_datagram(now, kPeer, bytes)); });
      server_.handle_timeout(now);
      must(server_.submit(now, tick, truth_of(objects)));
      while (const auto datagram = server_.poll_datagram(now)) down_.put(datagram->bytes);
    }
    /// out  ticks shown
    std::size_t join(std::uint64_t now, std::span<Pose> shown) {
      down_.empty([&](auto bytes) { must(client_.handle_datagram(now, bytes)); });
      client_.handle_timeout(now);
      must(client_.submit(now, DeviceSample{}, std::nullopt));
      while (const auto datagram = client_.poll_datagram(now)) up_.put(*datagram);
      const std::int64_t tick = client_.shown_tick(now);
      if (tick < 0) return 0;
      for (std::uint32_t i = 0; i < shown.size(); ++i) shown[i] = client_.pose(i, tick);
      return 1;
    }

   private:
    SessionServer server_;
    SessionClient client_;
    Datagrams up_, down_;
  };
};

// ---------------------------------------------------------------- C

struct C {
  template <auto destroy>
  struct Destroy {
    void operator()(auto* handle) const { destroy(handle); }
  };
  using Scene = std::unique_ptr<tactus_scene, Destroy<tactus_scene_destroy>>;

  static Scene scene_of(const SharedScene& scene) {
    const std::vector<std::uint8_t> bytes = must(write_scene(*scene));
    tactus_scene* out = nullptr;
    must(tactus_scene_parse(bytes.data(), bytes.size(), nullptr, &out, nullptr, nullptr));
    return Scene(out);
  }

  using Sample = tactus_rigid_sample;
  using Shown = tactus_pose;
  static std::vector<Sample> samples(std::span<const RigidSample> of) {
    std::vector<Sample> out;
    for (const RigidSample& s : of) {
      const auto& [p, q] = s.pose;
      out.push_back({{{p.x, p.y, p.z}, {q.w, q.x, q.y, q.z}},
                     {s.velocity.x, s.velocity.y, s.velocity.z},
                     {s.angular_velocity.x, s.angular_velocity.y, s.angular_velocity.z}});
    }
    return out;
  }
  static tactus_truth truth_of(std::span<const Sample> objects) {
    tactus_truth out;
    must(tactus_init(TACTUS_TRUTH, &out, sizeof out));
    out.objects = objects.data();
    out.object_count = objects.size();
    return out;
  }

  class Decoder {
   public:
    explicit Decoder(const SharedScene& scene) {
      tactus_receiver* made = nullptr;
      must(tactus_receiver_create(scene_of(scene).get(), nullptr, &made, nullptr));
      receiver_.reset(made);
    }
    void push(std::uint64_t number, std::span<const std::uint8_t> packet) {
      must(tactus_receiver_push(receiver_.get(), number, packet.data(), packet.size(), TACTUS_PACKET_TICK, nullptr, nullptr));
    }
    void poses(std::int64_t tick, std::span<tactus_pose> out) {
      must(tactus_receiver_poses(receiver_.get(), tick, 0, out.size(), out.data(), nullptr, nullptr));
    }
    void displacements(std::int64_t tick, std::span<float> out) {
      must(tactus_receiver_displacements(receiver_.get(), 0, tick, out.data(), out.size(), nullptr));
    }

   private:
    std::unique_ptr<tactus_receiver, Destroy<tactus_receiver_destroy>> receiver_;
  };

  class Encoder {
   public:
    Encoder(const SharedScene& scene, Reduction reduction) {
      tactus_sender_options options;
      must(tactus_init(TACTUS_SENDER_OPTIONS, &options, sizeof options));
      tactus_rigid_bounds bounds;
      must(tactus_init(TACTUS_RIGID_BOUNDS, &bounds, sizeof bounds));
      options.reduction = static_cast<std::int32_t>(reduction);
      options.key_interval = bounds.heartbeat = 0;
      options.rigid = &bounds;
      tactus_sender* made = nullptr;
      must(tactus_sender_create(scene_of(scene).get(), &options, &made, nullptr));
      sender_.reset(made);
    }
    std::size_t encode(std::int64_t tick, std::span<const tactus_rigid_sample> objects, std::span<std::uint8_t> out) {
      const tactus_truth truth = truth_of(objects);
      tactus_encoded encoded{};
      encoded.size = sizeof encoded;
      must(tactus_sender_encode(sender_.get(), tick, &truth, &encoded, nullptr));
      for (std::size_t i = 0; i < encoded.packet_count; ++i)
        std::ranges::copy(std::span(encoded.packets[i].data, encoded.packets[i].bytes), out.begin());
      return encoded.packet_count;
    }

   private:
    std::unique_ptr<tactus_sender, Destroy<tactus_sender_destroy>> sender_;
  };

  class Session {
   public:
    explicit Session(const SharedScene& scene) {
      tactus_server* server = nullptr;
      must(tactus_server_create(scene_of(scene).get(), nullptr, 1, 0, &server, nullptr));
      server_.reset(server);
      tactus_client_options options;
      must(tactus_init(TACTUS_CLIENT_OPTIONS, &options, sizeof options));
      options.role = TACTUS_ROLE_PARTICIPANT;
      tactus_client* client = nullptr;
      must(tactus_client_create(&options, &client, nullptr));
      client_.reset(client);
      must(tactus_client_open(client, 0, 2, nullptr));
    }
    void serve(std::uint64_t now, std::int64_t tick, std::span<const Sample> objects) {
      tactus_server* server = server_.get();
      up_.empty(
          [&](auto bytes) { must(tactus_server_handle_datagram(server, now, kPeer, bytes.data(), bytes.size(), nullptr)); });
      must(tactus_server_handle_timeout(server, now, nullptr));
      const tactus_truth truth = truth_of(objects);
      must(tactus_server_submit(server, now, tick, &truth, nullptr, nullptr));
      std::uint64_t peer = 0;
      std::size_t size = 0;
      while (tactus_server_poll_datagram(server, now, &peer, room_.data(), room_.size(), &size, nullptr) == TACTUS_OK)
        down_.put(std::span(room_).first(size));
    }
    std::size_t join(std::uint64_t now, std::span<tactus_pose> shown) {
      tactus_client* client = client_.get();
      down_.empty([&](auto bytes) { must(tactus_client_handle_datagram(client, now, bytes.data(), bytes.size(), nullptr)); });
      must(tactus_client_handle_timeout(client, now, nullptr));
      const tactus_device_sample device{
          .position = {}, .orientation = {1, 0, 0, 0}, .velocity = {}, .buttons = 0, .reserved = 0, .time = 0};
      must(tactus_client_submit(client, now, &device, nullptr, nullptr));
      std::size_t size = 0;
      while (tactus_client_poll_datagram(client, now, room_.data(), room_.size(), &size, nullptr) == TACTUS_OK)
        up_.put(std::span(room_).first(size));
      std::int64_t tick = 0;
      if (tactus_client_shown_tick(client, now, &tick, nullptr) != TACTUS_OK) return 0;
      must(tactus_receiver_poses(tactus_client_receiver(client), tick, 0, shown.size(), shown.data(), nullptr, nullptr));
      return 1;
    }

   private:
    std::unique_ptr<tactus_server, Destroy<tactus_server_destroy>> server_;
    std::unique_ptr<tactus_client, Destroy<tactus_client_destroy>> client_;
    std::array<std::uint8_t, TACTUS_DATAGRAM_BYTES> room_{};
    Datagrams up_, down_;
  };
};

}  // namespace tactus::bench
