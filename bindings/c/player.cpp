// SPDX-License-Identifier: Apache-2.0
#include <tactus/player.h>

#include <memory>

#include "handles.h"

struct tactus_player {
  tactus::Player player;
  tactus_receiver receiver{};
};

using namespace tactus;
using namespace tactus::c;

tactus_status tactus_player_open(const uint8_t* file, size_t size, const tactus_receiver_options* options, tactus_player** player,
                                 tactus_error* error) {
  return call(error, [&]() -> Outcome {
    if (player == nullptr) return refuse();
    TACTUS_TRY(const auto bytes, span_of(file, size));
    TACTUS_TRY(const ReceiverOptions chosen, options_of(options));
    TACTUS_TRY(Player opened, Player::open(bytes, chosen));
    auto out = std::make_unique<tactus_player>(tactus_player{std::move(opened)});
    out->receiver.borrow(&out->player.receiver());
    *player = out.release();
    return TACTUS_OK;
  });
}

void tactus_player_destroy(tactus_player* player) { delete player; }

tactus_receiver* tactus_player_receiver(tactus_player* player) { return player != nullptr ? &player->receiver : nullptr; }

tactus_status tactus_player_play(tactus_player* player, int64_t tick, tactus_packet_info* info, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    if (player == nullptr) return refuse();
    if (info != nullptr) TACTUS_CHECK(check_answer(info));
    player->receiver.updates = {};
    TACTUS_TRY(const auto played, player->player.play(tick));
    if (!played) return TACTUS_NOTHING;
    player->receiver.updates = played->updates;
    if (info == nullptr) return TACTUS_OK;
    tactus_packet_info out = info_of(player->player.scene(), *played);
    out.bytes = static_cast<std::uint32_t>(played->bytes);
    out.offset = played->offset;
    answer(info, out);
    return TACTUS_OK;
  });
}

tactus_status tactus_player_get(tactus_player* player, tactus_player_info* info, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    if (player == nullptr) return refuse();
    TACTUS_CHECK(check_answer(info));
    TACTUS_TRY(const auto next, player->player.next_tick());
    answer(info, {.size = 0,
                  .complete = player->player.complete(),
                  .next_tick = next.value_or(INT64_MAX),
                  .header_bytes = player->player.header_bytes()});
    return TACTUS_OK;
  });
}
