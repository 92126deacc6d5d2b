// SPDX-License-Identifier: Apache-2.0
#include "conformance/report.h"

#include <algorithm>
#include <bit>
#include <memory>
#include <ostream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <tactus/base/bytes.h>
#include <tactus/base/rule.h>
#include <tactus/elastic/elastic_solver.h>
#include <tactus/file/stream_file.h>
#include <tactus/packet/substream.h>
#include <tactus/receiver.h>
#include <tactus/rigid/device_path.h>
#include <tactus/scene/elastic_syntax.h>
#include <tactus/scene/scene_syntax.h>

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

void write_deformables(const std::vector<DeformableObject>& deformables, std::ostream& out) {
  out << R"(,"meshes":[)";
  const char* comma = "";
  for (const DeformableObject& mesh : deformables) {
    out << comma << R"({"name":)" << quoted(mesh.name) << R"(,"profile":)" << int{static_cast<std::uint8_t>(mesh.profile)}
        << R"(,"vertices":)" << mesh.rest.size() << R"(,"triangles":)" << mesh.triangles.size() << R"(,"modes":)"
        << mesh.basis.steps.size();
    if (!mesh.stiffness.empty()) {
      Fnv1a levels;
      for (const std::uint8_t level : mesh.stiffness) levels.add_byte(level);
      out << R"(,"stiffness":)" << quoted(hex(levels.value(), 16));
    }
    out << '}';
    comma = ",";
  }
  out << ']';
}

std::string bits(double value) { return '"' + hex(std::bit_cast<std::uint64_t>(value), 16) + '"'; }

void write_bounds(const StreamBounds& bounds, std::ostream& out) {
  out << R"(,"bounds":{)";
  if (bounds.rigid) {
    const RigidTriggers& t = *bounds.rigid;
    out << R"("rigid":[)" << bits(t.heartbeat) << ',' << bits(t.visual_position) << ',' << bits(t.visual_rotation) << ','
        << int{static_cast<std::uint8_t>(t.haptic)};
    const bool weber = t.haptic == HapticRule::isotropic || t.haptic == HapticRule::cone;
    if (weber) out << ',' << bits(t.weber_fraction) << ',' << bits(t.force_floor);
    if (t.haptic == HapticRule::perceptual) out << ',' << bits(t.perceptual_fraction) << ',' << bits(t.force_floor);
    if (t.haptic == HapticRule::cone) out << ',' << bits(t.cone_angle);
    if (t.haptic == HapticRule::fixed) out << ',' << bits(t.fixed_position) << ',' << bits(t.fixed_rotation);
    out << "],";
  }
  out << R"("meshes":[)";
  const char* comma = "";
  for (const auto& [thresholds, kept] : bounds.deformables) {
    out << comma << '[' << (kept ? 1 : 0) + (thresholds.weber_fraction ? 2 : 0) << ',' << bits(thresholds.visual);
    if (thresholds.weber_fraction) out << ',' << bits(*thresholds.weber_fraction) << ',' << bits(thresholds.depth_floor);
    out << ']';
    comma = ",";
  }
  out << ']';
  if (bounds.loads) out << R"(,"loads":[)" << bits(bounds.loads->weber_fraction) << ',' << bits(bounds.loads->force_floor) << ']';
  out << '}';
}

void write_driven(const Scene& scene, std::ostream& out) {
  out << R"(,"driven":[)";
  const char* comma = "";
  for (const std::uint32_t i : scene.moving()) {
    const auto& [coupling, hold, inertia, friction, damping] = scene.driven->bodies[i];
    out << comma << '[' << coupling << ',' << hold << ',' << inertia[0] << ',' << inertia[1] << ',' << inertia[2] << ','
        << friction << ',' << damping << ']';
    comma = ",";
  }
  out << ']';
}

/// Of all bodies.
void write_elastic(const std::vector<DeformableObject>& deformables, std::ostream& out) {
  out << R"(,"elastic":[)";
  const char* comma = "";
  for (std::size_t i = 0; i < deformables.size(); ++i) {
    if (!deformables[i].body) continue;
    const ElasticBody& body = *deformables[i].body;
    const std::size_t vertices = deformables[i].rest.size() + body.inner.size();
    out << comma << '[' << i << ',' << vertices << ',' << body.tets.size() << ',' << body.materials.size() << ','
        << body.fixed.size() << ',' << elastic_work(body, vertices) << ']';
    comma = ",";
  }
  out << ']';
}

void write_header_line(const Scene& h, std::ostream& out) {
  out << R"({"header":{"version":)" << int{kFormatVersion} << R"(,"profile":0,"tick_rate":)" << h.tick_rate << R"(,"grid":[)"
      << int{h.grid.position} << ',' << int{h.grid.velocity} << ',' << int{h.grid.rotation} << ',' << int{h.grid.angular_velocity}
      << R"(],"max_extrapolation":)" << h.max_extrapolation << R"(,"baseline_span":)" << int{h.baseline_span}
      << R"(,"objects":[)";
  const char* comma = "";
  for (const RigidObject& object : h.objects) {
    out << comma << R"({"name":)" << quoted(object.name) << R"(,"dof":)" << int{object.dof} << '}';
    comma = ",";
  }
  out << ']';
  if (!h.deformables.empty()) write_deformables(h.deformables, out);
  if (h.loads) out << R"(,"loads":[)" << int{h.loads->force_exp} << ',' << int{h.loads->users} << ']';
  if (h.motion) {
    const auto& [gravity, slide] = *h.motion;
    out << R"(,"motion":[)" << gravity[0] << ',' << gravity[1] << ',' << gravity[2] << ',' << slide << ']';
  }
  if (h.driven) write_driven(h, out);
  if (has_elastic_body(h.deformables)) write_elastic(h.deformables, out);
  if (h.interest) out << R"(,"interest":[)" << h.interest->full << ',' << h.interest->reach << ']';
  if (h.bounds) write_bounds(*h.bounds, out);
  out << "}}\n";
}

void write_packet(const DecodedPacket& packet, std::uint64_t state, std::ostream& out) {
  out << R"("number":)" << packet.number << R"(,"key":)" << (packet.key ? "true" : "false") << R"(,"tick":)" << packet.tick;
  if (packet.substream == 0) {
    out << R"(,"updates":[)";
    const char* comma = "";
    for (const RigidUpdate& update : packet.updates) {
      out << comma << '[' << update.object << ',' << int{static_cast<std::uint8_t>(update.reason)} << ',' << int{update.level}
          << ']';
      comma = ",";
    }
    out << ']';
  } else if (packet.loads > 0) {
    out << R"(,"loads":)" << packet.loads;
  } else {
    out << R"(,"vertices":)" << packet.vertices;
  }
  out << R"(,"range":")" << hex(packet.final_range, 8) << R"(","code":")" << hex(packet.final_code, 8) << R"(","state":")"
      << hex(state, 16) << '"';
}

void write_shown(std::uint64_t hash, std::ostream& out) { out << R"(,"shown":")" << hex(hash, 16) << '"'; }

/// Those of every testee, README.md.
DecodeLimits limits_of(const TesteeOptions& options) {
  return {.header_bytes = 1u << 20, .packet_bytes = 1u << 20, .thesis = options.thesis};
}

/// A receiver that gets every packet at its tick and looks at every tick; in playout, at the tick that lies so far back.
class Client {
 public:
  /// In a smoothed scene no client smooths by itself.
  static Interpolation interpolation_in(const Scene& scene, std::optional<Interpolation> wanted) {
    const Interpolation interpolation = wanted.value_or(Interpolation::none);
    return scene.is_smoothed && interpolation != Interpolation::playout ? Interpolation::none : interpolation;
  }
  /// A device is in the server's own ticks.
  static Result<Client> create(const SharedScene& scene, const TesteeOptions& options) {
    const std::optional<Interpolation> interpolation = options.replica;
    std::shared_ptr<DevicePath> path;
    if (options.device) {
      path = std::make_shared<DevicePath>(scene);
      path->shift(0, 0);
    }
    TACTUS_TRY(
        Receiver receiver,
        Receiver::create(
            scene, {.replica = {.interpolation = interpolation_in(*scene, interpolation)}, .limits = limits_of(options)}, path));
    const std::int64_t delay = interpolation == Interpolation::playout ? kPlayoutDelay : 0;
    return Client(scene, std::move(receiver), interpolation.has_value(), delay, std::move(path));
  }

  /// Decodes the packet of a record and writes its line.
  Result<void> decode(std::uint64_t number, const FilePacket& record, std::ostream& out) {
    if (looks_) look_until(record.tick);
    TACTUS_TRY(const DecodedPacket packet, receiver_.push(record.number, record.bytes));
    if (packet.tick != record.tick) return fail(Errc::invalid, "R-FIL-7");
    const std::uint32_t first = scene_->moving().empty() ? 0 : scene_->moving()[0];
    for (const RigidUpdate& update : packet.updates)
      if (path_ && update.object == first) path_->add(packet.number, receiver_.object_after(packet, first));
    out << R"({"packet":)" << number << ',';
    if (has_substream_number(*scene_)) out << R"("part":)" << packet.substream << ',';
    write_packet(packet, receiver_.state_hash(packet.substream), out);
    if (looks_) write_shown(shown_at(record.tick), out);
    out << "}\n";
    return {};
  }

  /// State of the only substream, or of all.
  void write_states(std::ostream& out) const {
    const bool several = has_substream_number(*scene_);
    if (several) out << '[';
    const char* comma = "";
    const bool has_rigid = !scene_->moving().empty() || scene_->deformables.empty();
    for (std::size_t i = has_rigid ? 0 : 1; i <= scene_->deformables.size() + (scene_->loads ? 1 : 0); ++i) {
      out << comma << '"' << hex(receiver_.state_hash(i), 16) << '"';
      comma = ",";
    }
    if (several) out << ']';
  }

  /// What was shown at every tick up to the last packet's.
  void write_all_shown(std::ostream& out) {
    if (!looks_) return;
    look_until(tick_ + 1 + delay_);
    write_shown(all_.value(), out);
  }

 private:
  static constexpr std::int64_t kPlayoutDelay = 100;  // ticks

  Client(SharedScene scene, Receiver receiver, bool looks, std::int64_t delay, std::shared_ptr<DevicePath> path)
      : scene_(std::move(scene)), receiver_(std::move(receiver)), looks_(looks), delay_(delay), path_(std::move(path)) {}

  void look_until(std::int64_t tick) {
    for (; tick_ < tick; ++tick_) all_.add64(shown_at(tick_));
  }

  std::uint64_t shown_at(std::int64_t tick) {
    tick -= delay_;
    Replica& replica = receiver_.replica();
    if (scene_->deformables.empty()) return replica.pose_hash(tick);
    Fnv1a hash;
    hash.add64(replica.pose_hash(tick));
    for (std::size_t i = 0; i < scene_->deformables.size(); ++i)
      for (const auto& displacement : replica.displacements(i, tick))
        for (const std::int32_t component : displacement) hash.add32(component);
    return hash.value();
  }

  SharedScene scene_;
  Receiver receiver_;
  bool looks_;
  std::int64_t delay_;
  std::shared_ptr<DevicePath> path_;  // null: no device is known
  std::int64_t tick_ = 0;
  Fnv1a all_;
};

}  // namespace

Result<void> report(std::span<const std::uint8_t> file, const TesteeOptions& options, std::ostream& out) {
  TACTUS_TRY(auto reader, StreamFileReader::open(file, limits_of(options)));
  TACTUS_TRY(auto client, Client::create(reader.scene(), options));
  write_header_line(*reader.scene(), out);
  for (std::uint64_t number = 0;; ++number) {
    TACTUS_TRY(const auto record, reader.next());
    if (record) {
      TACTUS_CHECK(client.decode(number, *record, out));
      continue;
    }
    out << R"({"end":{"complete":)" << (reader.complete() ? "true" : "false") << R"(,"packets":)" << number << R"(,"state":)";
    client.write_states(out);
    client.write_all_shown(out);
    out << "}}\n";
    return {};
  }
}

void report_error(const char* errc, const char* rule, std::ostream& out) {
  out << R"({"error":{"errc":")" << errc << R"(","rule":")" << rule << "\"}}\n";
}

}  // namespace tactus::conformance
