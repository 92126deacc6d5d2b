// SPDX-License-Identifier: Apache-2.0
/// Adaptive binary range coder. spec/30-range-coder.md. 32-bit range, carry resolved by the encoder, shortest tail: bytes past the
/// end of a payload read as zero. Encoder and decoder share one interface, so that a packet's syntax is written once, as a template.
/// Cost: about 5 ns per adaptive bit, 3 ns per call of raw bits; no allocation.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include <tactus/base/rule.h>

namespace tactus {

/// Probability that the next bit is 0, x 2^-15, always in 1..32767, and the shift of its next adaptation.
struct BitModel {
  static constexpr std::uint16_t kSlowest = 6;
  std::uint16_t zero = 1 << 14;
  std::uint16_t rate = 1;

  /// Count-based adaptation: the first bits move the probability a lot, later ones by 2^-6.
  constexpr void adapt(bool bit) noexcept {
    if (bit) zero = static_cast<std::uint16_t>(zero - (zero >> rate));
    else zero = static_cast<std::uint16_t>(zero + (((1 << 15) - zero) >> rate));
    if (rate < kSlowest) ++rate;
  }
};

/// Start models in two bytes each: bit 15 says whether a model begins with rate `Rate` or 1.
template <std::uint16_t Rate>
class StartModel {
 public:
  consteval StartModel(unsigned zero, unsigned rate) : packed_(static_cast<std::uint16_t>(zero | (rate == 1 ? 0u : 0x8000u))) {
    if (zero > 0x7fff || (rate != 1 && rate != Rate)) throw "not a start model";  // does not compile
  }
  constexpr BitModel model() const noexcept {
    return {static_cast<std::uint16_t>(packed_ & 0x7fffu), static_cast<std::uint16_t>(packed_ >> 15 != 0 ? Rate : 1)};
  }

 private:
  std::uint16_t packed_;
};

/// `Models` is a struct of nothing but BitModel.
template <class Models, std::uint16_t Rate, std::size_t N>
Models unpack(const StartModel<Rate> (&rows)[N]) noexcept {
  static_assert(N * sizeof(BitModel) == sizeof(Models), "spec/tables/*-start-models.csv has one row per model");
  std::array<BitModel, N> out;
  for (std::size_t i = 0; i < N; ++i) out[i] = rows[i].model();
  return std::bit_cast<Models>(out);
}

/// A symbol of `Bits` bits, most significant first, one model per node of the binary tree; node n has the children 2n and 2n + 1.
template <unsigned Bits>
using TreeModel = std::array<BitModel, (1u << Bits) - 1>;

/// Class of a magnitude: 0 for 0, else the number of bits, capped at 15.
using MagnitudeModel = TreeModel<4>;

constexpr std::uint32_t magnitude_of(std::int32_t value) noexcept {
  return static_cast<std::uint32_t>(value < 0 ? -static_cast<std::int64_t>(value) : value);
}

namespace detail {
/// Syntax elements above the single bit; `Coder` supplies bit(model, value) and raw(count, value), each of which returns the value
/// that was coded or decoded.
template <class Coder>
class SymbolCoder {
 public:
  template <unsigned Bits, std::size_t Nodes>
  std::uint32_t tree(std::array<BitModel, Nodes>& model, std::uint32_t value) noexcept {
    static_assert(Nodes == (1u << Bits) - 1);
    std::uint32_t node = 1;
    for (unsigned i = Bits; i-- > 0;) node = 2 * node + (self().bit(model[node - 1], (value >> i) & 1u) ? 1u : 0u);
    return node - (1u << Bits);
  }

  /// Any 32-bit magnitude: class, for class 15 five more bits of length, then the bits below the leading one.
  std::uint32_t magnitude(MagnitudeModel& model, std::uint32_t value) noexcept {
    std::uint32_t width = static_cast<std::uint32_t>(std::bit_width(value));
    const std::uint32_t symbol = tree<4>(model, width < 15 ? width : 15);
    width = symbol < 15 ? symbol : 15 + self().raw(5, width - 15);
    if (width < 2) return width;
    if (width > 32) return refuse();
    std::uint32_t out = 1;
    for (std::uint32_t left = width - 1; left > 0;) {
      const std::uint32_t count = left < 16 ? left : 16;
      left -= count;
      out = (out << count) | self().raw(count, (value >> left) & ((1u << count) - 1));
    }
    return out;
  }

  /// Magnitude, then for non-zero values one raw bit, 1 for negative. |value| < 2^31.
  std::int32_t signed_value(MagnitudeModel& model, std::int32_t value) noexcept {
    const std::uint32_t size = magnitude(model, magnitude_of(value));
    if (size == 0) return 0;
    return with_sign(size, self().raw(1, value < 0 ? 1u : 0u) != 0);
  }

  /// The same with a model of whether the sign is that of `like`, if there is one.
  std::int32_t signed_value(MagnitudeModel& model, BitModel& sign, std::int32_t like, std::int32_t value) noexcept {
    const std::uint32_t size = magnitude(model, magnitude_of(value));
    return size == 0 ? 0 : with_sign(size, is_negative(sign, like, value));
  }

  /// The same of a value that is not 0: its magnitude less 1, then the sign.
  std::int32_t nonzero_value(MagnitudeModel& model, BitModel& sign, std::int32_t like, std::int32_t value) noexcept {
    const std::uint32_t less = magnitude(model, value == 0 ? 0 : magnitude_of(value) - 1);
    return with_sign(less < 0x7fffffffu ? less + 1 : refuse(), is_negative(sign, like, value));
  }

  /// R-RNG-4: a magnitude had more than 32 bits, or a signed one more than 31. Never set while encoding.
  bool too_wide() const noexcept { return too_wide_; }

 private:
  bool is_negative(BitModel& sign, std::int32_t like, std::int32_t value) noexcept {
    if (like == 0) return self().raw(1, value < 0 ? 1u : 0u) != 0;
    const bool differs = self().bit(sign, (value < 0) != (like < 0) ? 1u : 0u) != 0;
    return differs != (like < 0);
  }
  std::int32_t with_sign(std::uint32_t size, bool negative) noexcept {
    const auto bounded = static_cast<std::int32_t>(size <= 0x7fffffffu ? size : refuse());
    return negative ? -bounded : bounded;
  }
  std::uint32_t refuse() noexcept {
    too_wide_ = true;
    return 0;
  }
  Coder& self() noexcept { return static_cast<Coder&>(*this); }

  bool too_wide_ = false;
};
}  // namespace detail

/// Encodes into a caller's buffer.
class RangeEncoder : public detail::SymbolCoder<RangeEncoder> {
 public:
  explicit RangeEncoder(std::span<std::uint8_t> out) noexcept : out_(out) {}

  bool bit(BitModel& model, std::uint32_t value) noexcept {
    const std::uint32_t bound = (range_ >> 15) * model.zero;
    if (value) advance(bound, range_ - bound);
    else advance(0, bound);
    model.adapt(value != 0);
    return value != 0;
  }

  /// `count` equally likely bits, 1 <= count <= 16. The last of the 2^count intervals takes the remainder of the division.
  std::uint32_t raw(unsigned count, std::uint32_t value) noexcept {
    const std::uint32_t step = range_ >> count;
    const std::uint32_t last = (1u << count) - 1;
    advance(value * step, value == last ? range_ - last * step : step);
    return value;
  }

  /// Choose the value in [low, low + range) with the most trailing zero bits, write it and drop all zero bytes at the end.
  /// Returns the payload's size.
  std::size_t finish() noexcept {
    const std::uint64_t end = static_cast<std::uint64_t>(low_) + range_ - 1;
    std::uint64_t tail = low_;
    for (unsigned k = 32; k > 0; --k) {
      const std::uint64_t mask = (std::uint64_t{1} << k) - 1;
      tail = (low_ + mask) & ~mask;
      if (tail <= end) break;
      tail = low_;
    }
    if (tail >> 32) carry();
    for (unsigned shift = 32; shift > 0; shift -= 8) emit(static_cast<std::uint8_t>(tail >> (shift - 8)));
    while (size_ > 0 && !overflow_ && out_[size_ - 1] == 0) --size_;
    return size_;
  }

  bool overflow() const noexcept { return overflow_; }  ///< the buffer was too small; the output is not usable

 private:
  void advance(std::uint32_t offset, std::uint32_t range) noexcept {
    const std::uint32_t low = low_ + offset;
    if (low < low_) carry();
    low_ = low;
    range_ = range;
    while (range_ < (1u << 24)) {
      emit(static_cast<std::uint8_t>(low_ >> 24));
      low_ <<= 8;
      range_ <<= 8;
    }
  }
  void emit(std::uint8_t byte) noexcept {
    if (size_ < out_.size()) out_[size_++] = byte;
    else overflow_ = true;
  }
  /// low + range never exceeds 2^32 at the first byte, so a byte below 0xff always stops the carry.
  void carry() noexcept {
    for (std::size_t i = size_; i-- > 0;) {
      if (++out_[i] != 0) return;
    }
  }

  std::span<std::uint8_t> out_;
  std::size_t size_ = 0;
  std::uint32_t low_ = 0;
  std::uint32_t range_ = 0xffffffffu;
  bool overflow_ = false;
};

/// Decodes any byte string: no input makes it fail before the end. The value arguments of the shared interface are ignored.
class RangeDecoder : public detail::SymbolCoder<RangeDecoder> {
 public:
  explicit RangeDecoder(std::span<const std::uint8_t> in) noexcept : in_(in) {
    for (int i = 0; i < 4; ++i) code_ = (code_ << 8) | next();
  }

  bool bit(BitModel& model, std::uint32_t = 0) noexcept {
    const std::uint32_t bound = (range_ >> 15) * model.zero;
    const bool value = code_ >= bound;
    if (value) {
      code_ -= bound;
      range_ -= bound;
    } else {
      range_ = bound;
    }
    model.adapt(value);
    normalise();
    return value;
  }

  std::uint32_t raw(unsigned count, std::uint32_t = 0) noexcept {
    const std::uint32_t step = range_ >> count;
    const std::uint32_t last = (1u << count) - 1;
    const std::uint32_t quotient = code_ / step;
    const std::uint32_t value = quotient < last ? quotient : last;
    code_ -= value * step;
    range_ = value == last ? range_ - last * step : step;
    normalise();
    return value;
  }

  std::uint32_t range() const noexcept { return range_; }
  std::uint32_t code() const noexcept { return code_; }
  /// Bytes taken so far, implied zeros included.
  std::size_t position() const noexcept { return position_; }
  /// After the last symbol: the first rule that the payload breaks, or none.
  ///   R-RNG-2 no byte is left over;  R-RNG-3 the last byte is not zero
  RuleName broken_rule() const noexcept {
    if (in_.size() > position_) return "R-RNG-2";
    if (!in_.empty() && in_.back() == 0) return "R-RNG-3";
    return {};
  }

 private:
  void normalise() noexcept {
    while (range_ < (1u << 24)) {
      code_ = (code_ << 8) | next();
      range_ <<= 8;
    }
  }
  std::uint32_t next() noexcept {
    const std::uint32_t byte = position_ < in_.size() ? in_[position_] : 0u;
    ++position_;
    return byte;
  }

  std::span<const std::uint8_t> in_;
  std::size_t position_ = 0;
  std::uint32_t code_ = 0;
  std::uint32_t range_ = 0xffffffffu;
};

}  // namespace tactus
