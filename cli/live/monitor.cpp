// SPDX-License-Identifier: Apache-2.0
#include "cli/live/monitor.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <fstream>
#include <string_view>
#include <type_traits>
#include <utility>

namespace tactus::cli {

// ==== figures ====

void TrafficTotal::add(std::uint16_t client, const Traffic& traffic) noexcept {
  constexpr std::array kAll{&Traffic::datagrams_sent,  &Traffic::bytes_sent,   &Traffic::packets_sent,  &Traffic::payload_sent,
                            &Traffic::datagrams_heard, &Traffic::bytes_heard,  &Traffic::packets_heard, &Traffic::payload_heard,
                            &Traffic::packets_refused, &Traffic::packets_held, &Traffic::lost,          &Traffic::ticks_held,
                            &Traffic::wrong_states};
  static_assert(sizeof(Traffic) == kAll.size() * sizeof(std::uint64_t));
  Traffic& seen = seen_[client];
  for (const auto member : kAll) {
    sum_.*member += traffic.*member >= seen.*member ? traffic.*member - seen.*member : traffic.*member;
    seen.*member = traffic.*member;
  }
}

namespace {

/// Values of labels are quoted: what would end them or the line is escaped, and bytes beyond ASCII may be no UTF-8.
std::string label_text(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\' || c == '"') out += '\\';
    if (c == '\n') out += "\\n";
    else out += c < ' ' || c > '~' ? '?' : c;
  }
  return out;
}

/// Families of the text format, one after the other.
class Exposition {
 public:
  void begin(std::string_view name, std::string_view type, std::string_view help) {
    name_ = name;
    text_ += fmt::format("# HELP {0} {2}\n# TYPE {0} {1}\n", name, type, help);
  }
  /// in   labels  name="value" with commas between, or nothing
  template <class Number>
  void add(std::string_view labels, Number value, std::string_view suffix = "") {
    static_assert(std::is_arithmetic_v<Number>);
    const bool has_labels = !labels.empty();
    text_ += fmt::format("{}{}{}{}{} {}\n", name_, suffix, has_labels ? "{" : "", labels, has_labels ? "}" : "", value);
  }
  template <class Number>
  void one(std::string_view name, std::string_view type, std::string_view help, Number value) {
    begin(name, type, help);
    add("", value);
  }
  void histogram(std::string_view name, std::string_view help, const Durations& durations) {
    begin(name, "histogram", help);
    std::uint64_t count = 0;
    for (std::size_t i = 0; i < Durations::kBounds.size(); ++i)
      add(fmt::format("le=\"{}\"", Durations::kBounds[i] / 1e6), count += durations.counts()[i], "_bucket");
    add("le=\"+Inf\"", count += durations.counts().back(), "_bucket");
    add("", static_cast<double>(durations.sum()) / 1e6, "_sum");
    add("", count, "_count");
  }
  std::string take() { return std::move(text_); }

 private:
  std::string name_, text_;
};

void add_ticks(Exposition& out, const ServerFigures& figures) {
  out.one("tactus_ticks_total", "counter", "Ticks of 1 ms that began in time.", figures.ticks);
  out.one("tactus_ticks_missed_total", "counter", "Ticks that did not begin in time; the world catches up on them.",
          figures.missed);
  out.histogram("tactus_tick_work_seconds", "What a tick took: datagrams heard, simulation, coding, datagrams sent.",
                figures.work);
  out.histogram("tactus_tick_lateness_seconds", "How late ticks began.", figures.lateness);
}

void add_clients(Exposition& out, const ServerFigures& figures) {
  const auto count = [&](SessionState state) { return std::ranges::count(figures.clients, state, &ClientStatus::state); };
  out.begin("tactus_clients", "gauge", "Clients by state: receiving the scene, or live.");
  out.add("state=\"receiving\"", count(SessionState::receiving));
  out.add("state=\"live\"", count(SessionState::live));
  out.one("tactus_clients_limit", "gauge", "Most clients at a time, as --clients says.", figures.clients.size());
  out.one("tactus_seats", "gauge", "Users of the scene that somebody can play.", figures.seats);
  out.one("tactus_seats_taken", "gauge", "Those that somebody plays.", figures.seats_taken);
  out.begin("tactus_client_events_total", "counter", "Clients that joined, left, or moved to another address.");
  out.add("event=\"joined\"", figures.joined);
  out.add("event=\"left\"", figures.left);
  out.add("event=\"moved\"", figures.moved);
  out.begin("tactus_joins_refused_total", "counter", "Joins that were refused, by reason.");
  for (const auto& [reason, name] : {std::pair(LeaveReason::full, "full"), std::pair(LeaveReason::version, "version"),
                                     std::pair(LeaveReason::limits, "limits")})
    out.add(fmt::format("reason=\"{}\"", name), figures.refused[static_cast<std::size_t>(reason)]);
}

/// One sample for each live client.
template <class Value>
void add_each(Exposition& out, const ServerFigures& figures, std::string_view name, std::string_view help, Value value) {
  out.begin(name, "gauge", help);
  for (const ClientStatus& client : figures.clients) {
    if (client.state != SessionState::live) continue;
    const char* const role = client.role == Role::observer ? "observer" : "participant";
    out.add(fmt::format("client=\"{}\",role=\"{}\"", client.client, role), value(client));
  }
}

void add_paths(Exposition& out, const ServerFigures& figures) {
  add_each(out, figures, "tactus_client_round_trip_seconds", "Round trip to a live client, smoothed; 0: not known yet.",
           [](const ClientStatus& c) { return c.round_trip ? static_cast<double>(c.round_trip->smoothed) / 1e6 : 0.0; });
  add_each(out, figures, "tactus_client_loss_ratio", "Fraction of the last 256 datagrams to a live client that were lost.",
           [](const ClientStatus& c) { return c.loss; });
  add_each(out, figures, "tactus_client_bound_scale_ratio",
           "Factor of the error bounds of a live client now; 1: as they were asked for.",
           [](const ClientStatus& c) { return c.bound_scale; });
  add_each(out, figures, "tactus_client_seat", "User of the scene that a live client plays, from 1; 0: none.",
           [](const ClientStatus& c) { return unsigned{c.seat}; });
}

void add_layers(Exposition& out, const ServerFacts& facts, std::uint64_t datagrams, std::uint64_t bytes, std::uint64_t payload) {
  out.add("layer=\"payload\"", payload);
  out.add("layer=\"session\"", bytes - payload);
  out.add("layer=\"seal\"", datagrams * facts.seal);
  out.add("layer=\"udp_ip\"", datagrams * facts.headers);
}

void add_traffic(Exposition& out, const ServerFigures& figures, const ServerFacts& facts) {
  const Traffic& sum = figures.traffic;
  out.begin("tactus_sent_bytes_total", "counter", "Sent in sessions, by layer.");
  add_layers(out, facts, sum.datagrams_sent, sum.bytes_sent, sum.payload_sent);
  out.begin("tactus_received_bytes_total", "counter", "Heard in sessions, by layer.");
  add_layers(out, facts, sum.datagrams_heard, sum.bytes_heard, sum.payload_heard);
  out.one("tactus_datagrams_sent_total", "counter", "Datagrams sent in sessions.", sum.datagrams_sent);
  out.one("tactus_datagrams_received_total", "counter", "Datagrams heard in sessions.", sum.datagrams_heard);
  out.one("tactus_datagrams_lost_total", "counter", "Datagrams sent that were lost, as far as clients reported.", sum.lost);
  out.one("tactus_datagrams_refused_total", "counter", "Datagrams that belong to no session or break its rules.",
          figures.datagrams_refused);
  out.one("tactus_receive_dropped_total", "counter", "Datagrams that the system dropped, as too many waited for this program.",
          figures.datagrams_dropped);
  out.one("tactus_receive_limited_total", "counter", "Datagrams dropped unread, as their sender sent too much.",
          figures.datagrams_limited);
  out.one("tactus_ticks_held_total", "counter", "Ticks that were not coded for a client, as its network carried no more.",
          sum.ticks_held);
  out.one("tactus_wrong_states_total", "counter", "States of clients that were not those of the server: 0, or there is a defect.",
          sum.wrong_states);
  if (!figures.seal) return;
  out.begin("tactus_seal_datagrams_total", "counter", "Sealed datagrams from elsewhere, by what became of them.");
  out.add("outcome=\"opened\"", figures.seal->opened);
  out.add("outcome=\"unauthentic\"", figures.seal->unauthentic);
  out.add("outcome=\"replayed\"", figures.seal->replayed);
  out.add("outcome=\"strangers\"", figures.seal->strangers);
  out.one("tactus_seal_handshakes_total", "counter", "Handshakes that ended well.", figures.seal->handshakes);
}

std::uint64_t resident_bytes() {
  std::ifstream status("/proc/self/status");
  std::uint64_t kilobytes = 0;
  for (std::string word; status >> word;)
    if (word == "VmRSS:" && status >> kilobytes) return 1024 * kilobytes;
  return 0;
}

double seconds_of(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// By the names that all programs use.
void add_process(Exposition& out) {
  out.one("process_cpu_seconds_total", "counter", "Time of processors that this program used.",
          seconds_of(CLOCK_PROCESS_CPUTIME_ID));
  out.one("process_resident_memory_bytes", "gauge", "Memory of this program.", resident_bytes());
}

}  // namespace

std::string prometheus_text(const ServerFigures& figures, const ServerFacts& facts) {
  Exposition out;
  out.begin("tactus_info", "gauge", "What is served, and by which version.");
  out.add(fmt::format("version=\"{}\",scene=\"{}\"", TACTUS_VERSION, label_text(facts.scene)), 1);
  out.one("tactus_objects", "gauge", "Rigid objects of the scene.", facts.objects);
  out.one("tactus_meshes", "gauge", "Deformable objects of the scene.", facts.meshes);
  add_ticks(out, figures);
  add_clients(out, figures);
  add_paths(out, figures);
  add_traffic(out, figures, facts);
  add_process(out);
  return out.take();
}

Health health_of(const ServerFigures& figures, std::uint64_t last_tick, std::uint64_t now) {
  constexpr std::uint64_t kStill = 1'000'000;  // [us]
  constexpr std::uint64_t kMost = 10;          // [%] of ticks
  if (last_tick == 0) return {false, "the first tick has not been made yet"};
  if (now > last_tick + kStill)
    return {false,
            fmt::format("the last tick was {:.1f} s ago: the program stands still", 1e-6 * static_cast<double>(now - last_tick))};
  if (100 * figures.recent_missed > kMost * figures.recent_ticks)
    return {false, fmt::format("{} of the last {} ticks did not begin in time, more than {} %: this machine has no time for them",
                               figures.recent_missed, figures.recent_ticks, kMost)};
  const auto live = std::ranges::count(figures.clients, SessionState::live, &ClientStatus::state);
  return {true, fmt::format("well: {} of {} clients live, {} of the last {} ticks did not begin in time", live,
                            figures.clients.size(), figures.recent_missed, figures.recent_ticks)};
}

// ==== monitor ====

ServerFigures* Monitor::tick(std::uint64_t now, const Tick& tick) noexcept {
  loop_.lateness.add(tick.lateness);
  loop_.work.add(tick.work);
  last_tick_.store(now, std::memory_order_relaxed);
  if (now < next_) return nullptr;
  next_ = now + kEvery;
  loop_.ticks = tick.ticks;
  loop_.missed = tick.missed;
  const std::uint64_t due = tick.ticks + tick.missed;
  const Second before = std::exchange(seconds_[second_++ % seconds_.size()], {due, tick.missed});
  loop_.recent_ticks = due - before.due;
  loop_.recent_missed = tick.missed - before.missed;
  return &loop_;
}

/// Who reads holds the lock for a copy. Then these figures are not seen, and those of the next second are.
void Monitor::show() noexcept {
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (lock) shown_ = loop_;
}

ServerFigures Monitor::figures() const {
  const std::lock_guard lock(mutex_);
  return shown_;
}

}  // namespace tactus::cli
