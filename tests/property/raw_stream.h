// SPDX-License-Identifier: Apache-2.0
/// Streams made field by field, so that a vector can break one rule and keep all others. Nothing here asks an encoder what it would do.
#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <vector>

#include <tactus/base/bytes.h>
#include <tactus/rigid/rigid_syntax.h>
#include <tactus/scene/scene_syntax.h>

namespace tactus::conformance {

using Bytes = std::vector<std::uint8_t>;

// Vectors are to stay what they are: no default of the library enters them.
inline constexpr std::uint8_t kRotationExp = 20;
inline constexpr std::int32_t kHalfCircle = 1 << kRotationExp;  ///< the longest rotation residual

/// Extends `bytes` by the little-endian CRC-32 of all of it.
Bytes with_crc(Bytes bytes);
Bytes varint(std::uint64_t value);
Bytes operator+(Bytes a, const Bytes& b);
Bytes first(const Bytes& bytes, std::size_t count);

struct RawObject {
  std::string name = "cube";
  std::uint8_t dof = Dof::all;
  Vec3i position{};
  Quat30 rotation{kOne30, 0, 0, 0};
  std::uint8_t kind = 1;
};

/// A header with any values, valid or not.
struct RawHeader {
  std::vector<RawObject> objects{RawObject{}};
  std::uint32_t tick_rate = 1000;
  GridExponents grid{22, 17, kRotationExp, 12};
  std::uint16_t max_extrapolation = 2000;
  std::uint8_t baseline_span = 1;
  Bytes deformables{};  ///< all about deformable objects, if flags say so
  Bytes loads{};        ///< force_exp and load_users, if flags say so
  Bytes motion{};       ///< gravity and slide_deceleration, if flags say so
  Bytes driven{};       ///< constants of driven objects, if flags say so
  Bytes elastic{};      ///< elastic bodies, if flags say so
  Bytes extensions{};
  std::array<std::uint8_t, 4> magic{0x89, 0x54, 0x43, 0x54};
  std::uint8_t version = 1;
  std::uint8_t profile = 0;
  std::uint16_t flags = 0;
  std::optional<Bytes> object_count{};  ///< in place of the true number

  Bytes body() const;
  /// Magic to crc around any body.
  Bytes around(const Bytes& body) const;
  Bytes bytes() const { return around(body()); }
  /// pre  the header is valid
  SharedScene parsed() const;
};

/// One record of a file: type, size, payload, crc.
Bytes record(std::uint8_t type, const Bytes& payload);

struct RawUpdate {
  std::uint32_t gap = 0;
  CodedUpdate coded;
};

/// A packet with any values in its head and its gaps.
Bytes raw_packet(const Scene& header, std::uint16_t sequence, RigidHead head, std::span<const RawUpdate> updates);

/// The bytes that `code(coder)` writes symbol by symbol.
template <class Code>
Bytes payload(Code code) {
  Bytes bytes(std::size_t{1} << 16);
  RangeEncoder coder(bytes);
  code(coder);
  bytes.resize(coder.finish());
  return bytes;
}

/// A packet of a sequence number and the payload that `code(coder)` writes.
template <class Code>
Bytes with_payload(std::uint16_t sequence, Code code) {
  return Bytes{static_cast<std::uint8_t>(sequence), static_cast<std::uint8_t>(sequence >> 8)} + payload(code);
}

/// A packet of rigid objects whose payload `code(coder, models)` writes.
template <class Code>
Bytes coded_packet(std::uint16_t sequence, Code code) {
  return with_payload(sequence, [&](RangeEncoder& coder) {
    RigidModels models = start_models();
    code(coder, models);
  });
}

/// One object of a packet, by its index in the header.
struct Update {
  std::uint32_t object = 0;
  Reason reason = Reason::visual;
  std::uint8_t level = 0;
  std::array<Vec3i, kQuantities> residual{};  ///< position, velocity, rotation, angular velocity
  std::uint8_t predictor = 0;                 ///< coded if the header has motion constants
  std::uint8_t ease = 0, keep = 0;            ///< of an eased scene
  bool is_held = false;                       ///< of a driven scene, as the differences of the contact
  std::array<std::int32_t, 7> contact{};
};

struct Step {
  std::int64_t tick = 0;
  std::vector<Update> updates{Update{}};  ///< in the order of the header
  bool key = false;
  std::uint32_t baseline = 1;               ///< packets back, for packets that are not key
  std::optional<std::uint16_t> sequence{};  ///< in place of the next one
};

/// Builds a file packet by packet; keeps the ticks of baselines, nothing else.
class Stream {
 public:
  explicit Stream(const RawHeader& header);

  /// Encode a packet and append its record.
  Stream& add(const Step& step);
  Bytes packet(const Step& step);
  /// Append a packet record with any bytes inside.
  Stream& add_packet(std::int64_t tick, const Bytes& packet, bool key = false);
  Stream& add_record(std::uint8_t type, const Bytes& payload);
  /// Append the index and the trailer.
  Stream& finish();

  const Scene& header() const { return *scene_; }
  const Bytes& bytes() const { return bytes_; }

 private:
  struct Key {
    std::int64_t tick;
    std::size_t offset;
  };
  SharedScene scene_;
  Bytes bytes_;
  std::map<std::uint16_t, std::int64_t> ticks_;  // of packets, by sequence
  std::uint16_t next_sequence_ = 0;
  std::int64_t record_tick_ = 0;
  std::vector<Key> keys_;
};

/// Random numbers that are the same with every standard library: only the engine is, distributions are not.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  /// 0 .. limit - 1
  std::uint32_t below(std::uint32_t limit) { return static_cast<std::uint32_t>(engine_() % limit); }
  /// Any sign, widths 0 .. max_width equally likely.
  std::int32_t integer(unsigned max_width);
  std::uint8_t byte() { return static_cast<std::uint8_t>(engine_() >> 56); }

 private:
  std::mt19937_64 engine_;
};

/// A random update that keeps every rule: residuals of any size that the object's axes allow, rotations up to half a circle.
Update random_update(Random& random, const Scene& header, std::uint32_t object);

/// One object, updated at these ticks: each moves and turns it and leaves it moving and turning.
Bytes updated_at(const RawHeader& header, std::initializer_list<std::int64_t> ticks);

}  // namespace tactus::conformance
