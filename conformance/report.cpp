// SPDX-License-Identifier: Apache-2.0
#include "conformance/report.h"

#include <ostream>
#include <string>
#include <string_view>

#include "codec/base/hash.h"
#include "codec/rigid/rigid_decoder.h"
#include "codec/stream/file.h"

namespace tactus::conformance {
namespace {

std::string hex(std::uint64_t value, unsigned digits) {
  std::string text(digits, '0');
  for (unsigned i = digits; i-- > 0; value >>= 4) text[i] = "0123456789abcdef"[value & 15];
  return text;
}

/// One code point of valid UTF-8; `at` moves behind it.
std::uint32_t next_code_point(std::string_view text, std::size_t& at) {
  const auto lead = static_cast<std::uint8_t>(text[at++]);
  const unsigned tail = lead >= 0xf0 ? 3 : lead >= 0xe0 ? 2 : lead >= 0x80 ? 1 : 0;
  std::uint32_t point = tail == 0 ? lead : lead & (0x3fu >> tail);
  for (unsigned i = 0; i < tail; ++i) point = point << 6 | (static_cast<std::uint8_t>(text[at++]) & 0x3fu);
  return point;
}

std::string quoted(std::string_view text) {
  std::string out = "\"";
  for (std::size_t at = 0; at < text.size();) {
    const std::uint32_t point = next_code_point(text, at);
    if (point >= 0x10000) {
      out += "\\u" + hex(0xd7c0 + (point >> 10), 4) + "\\u" + hex(0xdc00 + (point & 0x3ff), 4);
    } else if (point >= 0x80) {
      out += "\\u" + hex(point, 4);
    } else {
      if (point == '"' || point == '\\') out += '\\';
      out += static_cast<char>(point);
    }
  }
  return out + '"';
}

void write_header_line(const StreamHeader& h, std::ostream& out) {
  out << R"({"header":{"version":1,"profile":)" << int{static_cast<std::uint8_t>(h.profile)} << R"(,"tick_rate":)" << h.tick_rate
      << R"(,"grid":[)" << int{h.grid.position} << ',' << int{h.grid.velocity} << ',' << int{h.grid.rotation} << ','
      << int{h.grid.spin} << R"(],"max_extrapolation":)" << h.max_extrapolation << R"(,"baseline_span":)" << int{h.baseline_span}
      << R"(,"objects":[)";
  const char* comma = "";
  for (const RigidObject& object : h.objects) {
    out << comma << R"({"name":)" << quoted(object.name) << R"(,"dof":)" << int{object.dof} << '}';
    comma = ",";
  }
  out << "]}}\n";
}

void write_packet_line(std::uint64_t number, const DecodedPacket& packet, std::uint64_t state, std::ostream& out) {
  out << R"({"packet":)" << number << R"(,"sequence":)" << packet.sequence << R"(,"key":)" << (packet.key ? "true" : "false")
      << R"(,"tick":)" << packet.tick << R"(,"updates":[)";
  const char* comma = "";
  for (const RigidUpdate& update : packet.updates) {
    out << comma << '[' << update.object << ',' << int{static_cast<std::uint8_t>(update.reason)} << ',' << int{update.level}
        << ']';
    comma = ",";
  }
  out << R"(],"range":")" << hex(packet.final_range, 8) << R"(","code":")" << hex(packet.final_code, 8) << R"(","state":")"
      << hex(state, 16) << '"';
}

void write_shown(std::uint64_t hash, std::ostream& out) { out << R"(,"shown":")" << hex(hash, 16) << '"'; }

/// A client that applies every packet at the packet's tick and looks at every tick.
class Viewer {
 public:
  explicit Viewer(Replica replica) : replica_(std::move(replica)) {}

  std::uint64_t apply(const DecodedPacket& packet, std::span<const RigidState> objects) {
    for (; tick_ < packet.tick; ++tick_) all_.add64(replica_.pose_hash(tick_));
    replica_.apply(packet, objects, packet.tick);
    return replica_.pose_hash(packet.tick);
  }
  /// Over every tick up to the last packet's.
  std::uint64_t finish() {
    all_.add64(replica_.pose_hash(tick_));
    return all_.value();
  }

 private:
  Replica replica_;
  std::int64_t tick_ = 0;
  Fnv1a all_;
};

}  // namespace

Result<void> report(std::span<const std::uint8_t> file, std::optional<Interpolation> replica, std::ostream& out) {
  TACTUS_TRY(auto reader, StreamFileReader::open(file));
  TACTUS_TRY(auto decoder, RigidDecoder::create(reader.header()));
  std::optional<Viewer> viewer;
  if (replica) {
    TACTUS_TRY(auto shown, Replica::create(reader.header(), {.interpolation = *replica}));
    viewer.emplace(std::move(shown));
  }
  write_header_line(reader.header(), out);
  for (std::uint64_t number = 0;; ++number) {
    TACTUS_TRY(const auto record, reader.next());
    if (!record) {
      out << R"({"end":{"complete":)" << (reader.complete() ? "true" : "false") << R"(,"packets":)" << number << R"(,"state":")"
          << hex(decoder.state_hash(), 16) << '"';
      if (viewer) write_shown(viewer->finish(), out);
      out << "}}\n";
      return {};
    }
    TACTUS_TRY(const auto packet, decoder.decode(record->bytes));
    if (packet.tick != record->tick) return fail(Errc::invalid, "R-FIL-7");
    write_packet_line(number, packet, decoder.state_hash(), out);
    if (viewer) write_shown(viewer->apply(packet, decoder.objects()), out);
    out << "}\n";
  }
}

void report_error(const char* errc, const char* rule, std::ostream& out) {
  out << R"({"error":{"errc":")" << errc << R"(","rule":")" << rule << "\"}}\n";
}

}  // namespace tactus::conformance
