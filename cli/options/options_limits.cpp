// SPDX-License-Identifier: Apache-2.0
#include "cli/options/options_limits.h"

#include <fmt/format.h>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <tactus/base/result.h>
#include <tactus/base/text.h>
#include <tactus/scene/scene_syntax.h>

namespace tactus::cli {
namespace {

using Text = std::string_view;
enum class Unit : std::uint8_t { count, bytes };

struct Part {
  Text name;
  Unit unit;
  double most;  // that the library holds
  void (*put)(DecodeLimits& limits, double value);
};

constexpr double kMost32 = std::numeric_limits<std::uint32_t>::max(), kMost64 = 1e15;

constexpr std::array<Part, 7> kParts{{
    {"objects", Unit::count, kMost32, [](DecodeLimits& l, double v) { l.objects = static_cast<std::uint32_t>(v); }},
    {"vertices", Unit::count, kMost32, [](DecodeLimits& l, double v) { l.vertices = static_cast<std::uint32_t>(v); }},
    {"triangles", Unit::count, kMost32, [](DecodeLimits& l, double v) { l.triangles = static_cast<std::uint32_t>(v); }},
    {"declaration", Unit::bytes, kMost32, [](DecodeLimits& l, double v) { l.header_bytes = static_cast<std::uint32_t>(v); }},
    {"memory", Unit::bytes, kMost64, [](DecodeLimits& l, double v) { l.state_bytes = static_cast<std::uint64_t>(v); }},
    {"bases", Unit::count, kMost64, [](DecodeLimits& l, double v) { l.basis_work = static_cast<std::uint64_t>(v); }},
    {"bodies", Unit::count, kMost64, [](DecodeLimits& l, double v) { l.elastic_work = static_cast<std::uint64_t>(v); }},
}};

/// A whole number above 0, or a number of bytes with its unit.
tl::expected<double, std::string> amount(Text text, const Part& part) {
  const auto wrong = [&] {
    return tl::unexpected(part.unit == Unit::bytes ? fmt::format("'{}': not a number of bytes with its unit: kB, MB or GB", text)
                                                   : fmt::format("'{}': not a whole number above 0", text));
  };
  double scale = 1;
  if (part.unit == Unit::bytes) {
    scale = 0;
    for (const auto& [unit, bytes] : {std::pair<Text, double>{"kB", 1e3}, {"MB", 1e6}, {"GB", 1e9}}) {
      if (!text.ends_with(unit)) continue;
      text.remove_suffix(unit.size());
      scale = bytes;
      break;
    }
    if (scale == 0) return wrong();
  }
  const auto number = parse_number<double>(text);
  if (!number || !(*number > 0) || (scale == 1 && *number != std::floor(*number))) return wrong();
  if (*number * scale > part.most) return tl::unexpected(fmt::format("'{}': too large", text));
  return std::floor(*number * scale);
}

tl::expected<void, std::string> read_part(DecodeLimits& limits, Text text) {
  const std::size_t sign = text.find('=');
  const Text name = text.substr(0, sign), value = sign == Text::npos ? Text() : text.substr(sign + 1);
  std::string names;
  for (const Part& part : kParts) {
    if (part.name == name) {
      TACTUS_TRY(const double number, amount(value, part));
      part.put(limits, number);
      return {};
    }
    names += (names.empty() ? "" : ", ") + std::string(part.name);
  }
  return tl::unexpected(fmt::format("'{}': not one of {}", name, names));
}

}  // namespace

tl::expected<DecodeLimits, std::string> parse_limits(Text text, const DecodeLimits& usual) {
  DecodeLimits out = usual;
  for (bool more = true; more;) {
    const std::size_t comma = text.find(',');
    more = comma != Text::npos;
    TACTUS_CHECK(read_part(out, text.substr(0, comma)));
    text = more ? text.substr(comma + 1) : Text();
  }
  return out;
}

Option* add_limits(Command& app, DecodeLimits& value, const std::string& help) {
  const auto read = [&value](const std::string& text) {
    const auto parsed = parse_limits(text, value);
    if (!parsed) refuse_option("--limit", parsed.error());
    value = *parsed;
  };
  return app.add_option("--limit", read, help)->type_name("LIMITS");
}

const char* limits_help() {
  return "Limits are a list of parts, NAME=VALUE, separated by commas; a server and its clients need the same or more:\n"
         "  objects=4096           rigid and deformable objects\n"
         "  vertices=1048576  triangles=2097152   of all deformable objects\n"
         "  declaration=67.1MB     bytes of the scene's description\n"
         "  memory=268MB           of the states that each end keeps of a session\n"
         "  bases=4194304          work of computing bases: 57000 vertices with 48 modes\n"
         "  bodies=1073741824      work of factoring elastic bodies: thin ones of 10000 vertices, or a cube of 1300";
}

tl::expected<void, Error> check_declaration(const Scene& scene, const DecodeLimits& limits) {
  TACTUS_TRY(const auto bytes, write_scene(scene));
  if (bytes.size() > limits.header_bytes)
    return tl::unexpected(Error{.code = Errc::limit_exceeded, .rule = "R-STR-14", .bit_offset = 0});
  return {};
}

std::string limits_of(const Error& error) {
  if (error.code != Errc::limit_exceeded) return {};
  const Text rule = error.rule;
  if (rule == "R-STR-14") return "objects, vertices, triangles or declaration";
  if (rule == "R-STR-18") return "memory";
  if (rule == "R-STR-21") return "bases";
  if (rule == "R-STR-24") return "bodies";
  return {};
}

Failure allow_more(Failure failure, const Error& error) {
  const std::string names = limits_of(error);
  if (names.empty()) return failure;
  failure.remedy = fmt::format("Allow more with --limit ({}), here and at each client, or make the scene smaller.", names);
  return failure;
}

}  // namespace tactus::cli
