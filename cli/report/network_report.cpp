// SPDX-License-Identifier: Apache-2.0
#include "cli/report/network_report.h"

#include <nlohmann/json.hpp>

#include "cli/report/figures.h"
#include "cli/report/table.h"
#include "cli/report/traffic_layers.h"

namespace tactus::cli {
namespace {

using Json = nlohmann::ordered_json;

void direction_row(Table& table, const std::string& name, const DirectionReport& direction, double seconds) {
  const TrafficLayers l = sent_layers(direction.traffic, seconds);
  const auto whole = [](double value) { return fmt::format("{:.0f}", value); };
  table.row({name, fmt::format("{:.1f}", l.packets), fmt::format("{:.1f}", l.datagrams), whole(l.payload), whole(l.session),
             whole(l.headers), whole(l.all()),
             percent(per(static_cast<double>(direction.lost), static_cast<double>(direction.sent)))});
}

Json direction_json(const DirectionReport& direction, double seconds) {
  const TrafficLayers l = sent_layers(direction.traffic, seconds);
  return {{"packets_per_s", l.packets},     {"datagrams_per_s", l.datagrams},     {"payload_bit_per_s", l.payload},
          {"session_bit_per_s", l.session}, {"udp_ipv4_bit_per_s", l.headers},    {"datagrams", direction.sent},
          {"lost", direction.lost},         {"duplicated", direction.duplicated}, {"overtaken", direction.overtaken}};
}

double mean_delay(const NetworkReport& user) { return per(user.delay_sum, static_cast<double>(user.shown)); }

}  // namespace

Json widening_json(const Widening& widened) {
  return {{"widest", widened.widest}, {"for_s", 1e-6 * static_cast<double>(widened.time)}};
}

std::string widening_text(const Widening& widened) {
  if (widened.time == 0) return "";
  return fmt::format(", bounds up to {:.1f} times as wide for {:.1f} s, as the network did not carry more", widened.widest,
                     1e-6 * static_cast<double>(widened.time));
}

void network_rows(Table& table, const NetworkReport& user, double seconds) {
  table.heading(
      {"session " + user.user, "packets/s", "datagrams/s", "payload [bit/s]", "session", "UDP/IPv4", "all [bit/s]", "lost"});
  direction_row(table, "  up, to the server", user.up, seconds);
  direction_row(table, "  down, to the client", user.down, seconds);
}

Json network_json(const NetworkReport& user, double seconds) {
  Json out{{"user", user.user},
           {"up", direction_json(user.up, seconds)},
           {"down", direction_json(user.down, seconds)},
           {"shown_behind_s", mean_delay(user)},
           {"ticks_not_shown", user.not_shown},
           {"ticks_without_full_force", user.without_force},
           {"packets_refused", user.status.traffic.packets_refused},
           {"wrong_states", user.down.traffic.wrong_states},
           {"bounds_widened", widening_json(user.widened)}};
  if (const auto& trip = user.status.round_trip) {
    out["round_trip_s"] = {{"smoothed", 1e-6 * static_cast<double>(trip->smoothed)},
                           {"variation", 1e-6 * static_cast<double>(trip->variation)},
                           {"least", 1e-6 * static_cast<double>(trip->least)}};
  }
  if (user.status.clock_offset) out["clock_offset_s"] = 1e-6 * static_cast<double>(*user.status.clock_offset);
  return out;
}

std::string network_note(const NetworkReport& user) {
  std::string text = fmt::format("{}: shows the tick of {:.1f} ms ago on average", user.user, 1e3 * mean_delay(user));
  if (const auto& trip = user.status.round_trip)
    text += fmt::format(", round trip {:.1f} ms (least {:.1f})", 1e-3 * static_cast<double>(trip->smoothed),
                        1e-3 * static_cast<double>(trip->least));
  if (user.without_force > 0) text += fmt::format(", less than the full force for {}", counted(user.without_force, "tick"));
  text += widening_text(user.widened);
  return text;
}

}  // namespace tactus::cli
