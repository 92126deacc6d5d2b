// SPDX-License-Identifier: Apache-2.0
#include <tactus/base/bytes.h>

#include <gtest/gtest.h>

#include <limits>
#include <string_view>

namespace tactus {
namespace {

using Bytes = std::vector<std::uint8_t>;

TEST(Bytes, IntegersAreLittleEndian) {
  Bytes out;
  ByteWriter w(out);
  w.u8(1);
  w.u16(0x0302);
  w.u32(0x07060504);
  w.u64(0x0f0e0d0c0b0a0908);
  w.i32(-2);
  for (std::uint8_t i = 0; i < 15; ++i) EXPECT_EQ(out[i], i + 1);
  ByteReader r(out);
  EXPECT_EQ(r.u8(), 1);
  EXPECT_EQ(r.u16(), 0x0302);
  EXPECT_EQ(r.u32(), 0x07060504u);
  EXPECT_EQ(r.u64(), 0x0f0e0d0c0b0a0908u);
  EXPECT_EQ(r.i32(), -2);
  EXPECT_TRUE(r.ok());
  EXPECT_EQ(r.remaining(), 0u);
}

TEST(Bytes, OverrunSticksAndReadsZero) {
  const Bytes in{1, 2, 3};
  ByteReader r(in);
  EXPECT_EQ(r.u32(), 0u);
  EXPECT_TRUE(r.overrun());
  EXPECT_EQ(r.u8(), 0u) << "a reader that overran must not recover";
  EXPECT_TRUE(r.bytes(1).empty());
}

TEST(Bytes, HugeCountOverrunsWithoutArithmeticOverflow) {
  const Bytes in{1, 2, 3};
  ByteReader r(in);
  r.u8();
  EXPECT_TRUE(r.bytes(std::numeric_limits<std::uint64_t>::max()).empty());
  EXPECT_TRUE(r.overrun());
}

TEST(Bytes, VarintsRoundTripAtEveryWidth) {
  for (int bits = 0; bits <= 64; ++bits) {
    const std::uint64_t top = bits == 0 ? 0 : std::uint64_t{1} << (bits - 1);
    for (const std::uint64_t value : {top, top | (top >> 1), top == 0 ? 0 : (top - 1) | top}) {
      Bytes out;
      ByteWriter(out).varint(value);
      ByteReader r(out);
      EXPECT_EQ(r.varint(), value);
      EXPECT_TRUE(r.ok());
      EXPECT_EQ(r.remaining(), 0u);
    }
  }
}

TEST(Bytes, OverlongVarintsAreRefused) {
  const Bytes cases[] = {
      {0x80, 0x00},                                                        // 0 in two bytes
      {0xff, 0x80, 0x00},                                                  // 127 in three
      {0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x02},        // 65 bits
      {0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x01},  // eleven bytes
  };
  for (const Bytes& in : cases) {
    ByteReader r(in);
    r.varint();
    EXPECT_TRUE(r.overlong());
  }
}

TEST(Bytes, SubReaderKeepsItsLimitAndItsPlace) {
  const Bytes in{1, 2, 3, 4, 5};
  ByteReader r(in);
  r.u8();
  ByteReader inner = r.sub(2);
  EXPECT_EQ(inner.bit_offset(), 8u);
  EXPECT_EQ(inner.u16(), 0x0302);
  EXPECT_EQ(inner.u8(), 0);
  EXPECT_TRUE(inner.overrun());
  EXPECT_EQ(r.u8(), 4);
}

TEST(Hash, CheckValues) {
  const std::string_view text = "123456789";
  const std::span bytes(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  EXPECT_EQ(crc32(bytes), 0xcbf43926u);
  EXPECT_EQ(crc32(bytes.subspan(4), crc32(bytes.first(4))), 0xcbf43926u);
  Fnv1a empty;
  EXPECT_EQ(empty.value(), 0xcbf29ce484222325u);
  Fnv1a a;
  a.add_byte('a');
  EXPECT_EQ(a.value(), 0xaf63dc4c8601ec8cu);
}

}  // namespace
}  // namespace tactus
