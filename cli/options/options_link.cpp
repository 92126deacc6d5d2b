// SPDX-License-Identifier: Apache-2.0
#include "cli/options/options_link.h"

#include <fmt/format.h>
#include <array>
#include <charconv>
#include <cmath>

#include <tactus/base/text.h>
#include <tactus/trace/csv_reader.h>
#include "cli/options/options_codec.h"
#include "cli/options/units.h"

namespace tactus::cli {

// ==== options link ====

namespace {

using Text = std::string_view;
template <class T>
using Parsed = tl::expected<T, std::string>;

Parsed<double> quantity(Text text, Dimension dimension) {
  TACTUS_TRY(const Quantity q, parse_quantity(text, dimension));
  return q.value;
}

Parsed<sim::Microseconds> time(Text text) {
  TACTUS_TRY(const double seconds, quantity(text, Dimension::time));
  if (seconds > 3600) return tl::unexpected(fmt::format("'{}': at most 3600s", text));
  return std::llround(1e6 * seconds);
}

/// A number of bits per second or bytes.
Parsed<double> amount(Text text, std::array<Text, 3> units) {
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const Text unit(end, static_cast<std::size_t>(text.data() + text.size() - end));
  for (std::size_t i = 0; i < units.size() && error == std::errc(); ++i)
    if (unit == units[i] && number > 0 && number <= 1e6) return number * std::pow(1e3, static_cast<double>(i));
  return tl::unexpected(
      fmt::format("'{}': not a number above 0 with its unit: {}, {} or {}", text, units[0], units[1], units[2]));
}

/// Splits at a sign; the last piece takes the rest.
template <std::size_t N>
std::array<Text, N> split(Text text, char sign) {
  std::array<Text, N> out{};
  for (std::size_t i = 0; i < N; ++i) {
    const std::size_t end = i + 1 < N ? text.find(sign) : Text::npos;
    out[i] = text.substr(0, end);
    text = end == Text::npos ? Text() : text.substr(end + 1);
  }
  return out;
}

template <class T>
Parsed<void> put(T& to, Parsed<T> from) {
  TACTUS_TRY(to, std::move(from));
  return {};
}

Parsed<void> read_gamma(sim::LinkOptions& link, Text value) {
  const auto [mean, deviation, piece] = split<3>(value, '/');
  TACTUS_CHECK(put(link.gamma_mean, time(mean)));
  TACTUS_CHECK(put(link.gamma_deviation, time(deviation)));
  return piece.empty() ? Parsed<void>() : put(link.gamma_piece, time(piece));
}

Parsed<void> read_delays(sim::LinkOptions& link, Text value) {
  const std::string path(value);
  auto reader = CsvReader::open(path);
  const auto wrong = [&](const std::string& why) { return tl::unexpected(fmt::format("'{}': {}", path, why)); };
  if (!reader) return wrong("cannot be read");
  if (const auto more = reader->names(); !more || !*more || reader->fields() != std::vector<std::string>{"time_s", "delay_s"})
    return wrong("the first line must be time_s,delay_s");
  while (true) {
    const auto more = reader->next();
    if (!more) return wrong("cannot be read");
    if (!*more)
      return link.recorded.size() >= 2 ? Parsed<void>() : wrong("fewer than two delays; the last says when they begin anew");
    const auto& fields = reader->fields();
    const auto at = fields.size() == 2 ? parse_number<double>(fields[0]) : std::nullopt;
    const auto delay = fields.size() == 2 ? parse_number<double>(fields[1]) : std::nullopt;
    const bool good = at && delay && *at >= 0 && *at <= 1e6 && *delay >= 0 && *delay <= 3600;  // refuses NaN
    if (!good || link.recorded.size() == 10'000'000)
      return wrong(fmt::format("line {}: not a time and a delay in seconds", reader->line()));
    link.recorded.push_back({std::llround(1e6 * *at), std::llround(1e6 * *delay)});
  }
}

Parsed<void> read_late(sim::LinkOptions& link, Text value) {
  const auto [fraction, by] = split<2>(value, '/');
  TACTUS_CHECK(put(link.held_back, quantity(fraction, Dimension::fraction)));
  return put(link.held_back_by, time(by));
}

Parsed<void> read_queue(sim::LinkOptions& link, Text value) {
  TACTUS_TRY(const double bytes, amount(value, {"B", "kB", "MB"}));
  link.queue = static_cast<std::size_t>(bytes);
  return {};
}

Parsed<void> read_burst(sim::LinkOptions& link, Text value) {
  const auto burst = parse_number<double>(value);
  if (!burst || !(*burst >= 1 && *burst <= 1e6))
    return tl::unexpected(fmt::format("'{}': not a number of datagrams from 1", value));
  link.burst = *burst;
  return {};
}

Parsed<void> read_outage(sim::LinkOptions& link, Text value) {
  const auto [begin, length] = split<2>(value, '+');
  sim::Outage& outage = link.outages.emplace_back();
  TACTUS_CHECK(put(outage.begin, time(begin)));
  TACTUS_TRY(const sim::Microseconds lasting, time(length));
  outage.end = outage.begin + lasting;
  return {};
}

Parsed<void> read_seed(sim::LinkOptions& link, Text value) {
  const auto seed = parse_number<std::uint64_t>(value);
  if (!seed) return tl::unexpected(fmt::format("'{}': not a whole number", value));
  link.seed = *seed;
  return {};
}

struct Part {
  Text name;
  Parsed<void> (*read)(sim::LinkOptions& link, Text value);
};
using Options = sim::LinkOptions;
constexpr std::array<Text, 3> kBitRates{"bit", "kbit", "Mbit"};

constexpr std::array<Part, 12> kParts{{
    {"delay", [](Options& link, Text value) { return put(link.delay, time(value)); }},
    {"jitter", [](Options& link, Text value) { return put(link.jitter, time(value)); }},
    {"gamma", read_gamma},
    {"delays", read_delays},
    {"loss", [](Options& link, Text value) { return put(link.loss, quantity(value, Dimension::fraction)); }},
    {"burst", read_burst},
    {"duplicates", [](Options& link, Text value) { return put(link.duplicates, quantity(value, Dimension::fraction)); }},
    {"late", read_late},
    {"rate", [](Options& link, Text value) { return put(link.rate, amount(value, kBitRates)); }},
    {"queue", read_queue},
    {"outage", read_outage},
    {"seed", read_seed},
}};

Parsed<void> read_part(sim::LinkOptions& link, Text name, Text value) {
  std::string names;
  for (const Part& part : kParts) {
    if (part.name == name) return part.read(link, value);
    names += (names.empty() ? "" : ", ") + std::string(part.name);
  }
  return tl::unexpected("not one of " + names);
}

}  // namespace

const char* link_help() {
  return "A network is a list of parts, NAME=VALUE, separated by commas:\n"
         "  delay=20ms             of every datagram\n"
         "  jitter=5ms             more, uniform from 0 to this; datagrams are reordered\n"
         "  gamma=20ms/10ms/1s     more, gamma-distributed: mean/deviation/how long a value stays\n"
         "  delays=FILE            more, recorded: CSV with the columns time_s,delay_s; repeated\n"
         "  loss=1%  burst=5       fraction of datagrams lost; mean length of a row of losses\n"
         "  duplicates=1%          fraction that arrives twice\n"
         "  late=1%/30ms           fraction that comes so much later\n"
         "  rate=1Mbit  queue=64kB bottleneck and the queue before it, headers included\n"
         "  outage=10s+500ms       nothing passes, from when for how long; may be repeated\n"
         "  seed=1                 the same seed gives the same network";
}

Parsed<sim::LinkOptions> parse_link(Text text) {
  sim::LinkOptions link;
  for (Text rest = text; !rest.empty();) {
    const auto [part, after] = split<2>(rest, ',');
    if (after.empty() && rest.size() > part.size()) return tl::unexpected(fmt::format("'{}': ends with a comma", text));
    rest = after;
    const auto [name, value] = split<2>(part, '=');
    if (const auto read = read_part(link, name, value); !read) return tl::unexpected(fmt::format("'{}': {}", part, read.error()));
  }
  if (!sim::Link::create(link))
    return tl::unexpected(
        fmt::format("'{}': the parts contradict each other: a deviation needs a mean, pieces at least 1 ms, bursts a loss that "
                    "leaves room for good "
                    "datagrams, outages and recorded times their order, recorded times begin at 0",
                    text));
  return link;
}

namespace {

template <class Value>
Option* add(Command& app, const std::string& name, Value& value, const std::string& help) {
  const auto read = [&value, name](const std::string& text) {
    auto parsed = parse_link(text);
    if (!parsed) refuse_option(name, parsed.error());
    value = std::move(*parsed);
  };
  return app.add_option(name, read, help)->type_name("NETWORK");
}

}  // namespace

Option* add_bit_rate(Command& app, const std::string& name, double& value, const std::string& help) {
  const auto read = [&value, name](const std::string& text) {
    const auto rate = amount(text, kBitRates);
    if (!rate) refuse_option(name, rate.error());
    value = *rate;
  };
  return app.add_option(name, read, help)->type_name("RATE");
}

Option* add_link(Command& app, const std::string& name, sim::LinkOptions& value, const std::string& help) {
  return add(app, name, value, help);
}
Option* add_link(Command& app, const std::string& name, std::optional<sim::LinkOptions>& value, const std::string& help) {
  return add(app, name, value, help);
}

// ==== options session ====

Option* add_playout(Command& app, std::string& value) {
  const auto read = [&value](const std::string& text) {
    if (text != "adaptive") {
      const auto time = parse_quantity(text, Dimension::time);
      if (!time) refuse_option("--playout", time.error() + ", or adaptive");
      if (!(time->value >= 0 && time->value <= 2)) refuse_option("--playout", "'" + text + "': from 0 to 2s, or adaptive");
    }
    value = text;
  };
  return app
      .add_option(
          "--playout", read,
          "How long after the fastest packet a client shows a tick: a time, or adaptive, which waits for nearly all: 2 ms "
          "while hardly any was late or lost, 30 ms for observers [adaptive]")
      ->type_name("TIME");
}

std::optional<std::uint32_t> playout_of(const std::string& value) {
  if (value == "adaptive") return std::nullopt;
  return static_cast<std::uint32_t>(std::llround(1e6 * parse_quantity(value, Dimension::time)->value));
}

Option* add_client_model_scale(Command& app, double& value) {
  return app
      .add_option(
          key("client_model_scale"), value,
          "Mass and stiffness in the clients' models of what their devices move, times the true ones, to see what a wrong "
          "model costs; 0: no models are declared [1]")
      ->check(number(0, 1e3))
      ->type_name("FACTOR");
}

Option* add_key(Command& app, std::string& value) {
  return app
      .add_option("--key", value,
                  "Seal the session with the key in this file; at the server also a list of users. See `tactus key` [not sealed]")
      ->type_name("FILE");
}

}  // namespace tactus::cli
