// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <numeric>
#include <vector>

#include <tactus/trace/byte_source.h>
#include <tactus/trace/compression.h>

namespace tactus {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// "hello, hello, hello" as the program lz4 writes it, without a content size.
const Bytes kLz4{0x04, 0x22, 0x4d, 0x18, 0x64, 0x40, 0xa7, 0x10, 0x00, 0x00, 0x00, 0x73, 0x68, 0x65, 0x6c, 0x6c, 0x6f, 0x2c,
                 0x20, 0x07, 0x00, 0x50, 0x68, 0x65, 0x6c, 0x6c, 0x6f, 0x00, 0x00, 0x00, 0x00, 0x30, 0x66, 0x93, 0x58};

Bytes packed(const Bytes& bytes) {
  Compressor compressor;
  const auto out = compressor.compress(bytes).value();
  return {out.begin(), out.end()};
}

TEST(TraceCompression, IsKnownByNameAndByData) {
  EXPECT_EQ(compression_of_name("lz4"), Compression::lz4);
  EXPECT_EQ(compression_of_name(""), Compression::none);
  EXPECT_FALSE(compression_of_name("brotli"));
  Bytes out(19);
  EXPECT_TRUE(decompress_exactly(Compression::lz4, kLz4, out));
  EXPECT_EQ(std::string(out.begin(), out.end()), "hello, hello, hello");
  for (std::size_t size = 0; size < kLz4.size(); ++size)
    EXPECT_FALSE(decompress_exactly(Compression::lz4, std::span(kLz4).first(size), out));
  EXPECT_EQ(compression_of_data(packed({1, 2, 3})), Compression::zstd);
  EXPECT_EQ(compression_of_data(kLz4), Compression::lz4);
  EXPECT_EQ(compression_of_data(Bytes{0x28, 0xb5, 0x2f}), Compression::none);
}

TEST(TraceCompression, ASizeThatIsNotExactIsRefused) {
  Bytes bytes(1000);
  std::iota(bytes.begin(), bytes.end(), std::uint8_t{0});
  const Bytes frame = packed(bytes);
  for (const std::size_t size : {std::size_t{999}, std::size_t{1000}, std::size_t{1001}}) {
    Bytes out(size);
    EXPECT_EQ(decompress_exactly(Compression::zstd, frame, out), size == 1000) << size;
  }
  EXPECT_EQ(announced_size(Compression::zstd, frame), 1000U);
}

TEST(TraceCompression, APackedFileIsUnpackedWhateverItsPieces) {
  Bytes bytes(300'000);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(i * i >> 7);
  const Bytes frame = packed(bytes);
  auto source = ByteSource::over_memory(frame);
  ASSERT_EQ(source.unpack().value(), Compression::zstd);
  Bytes read;
  for (Bytes piece(777);;) {
    const std::size_t got = source.read(piece).value();
    read.insert(read.end(), piece.begin(), piece.begin() + static_cast<std::ptrdiff_t>(got));
    if (got < piece.size()) break;
  }
  EXPECT_EQ(read, bytes);
  EXPECT_EQ(source.stored_bytes_read(), frame.size());
  EXPECT_FALSE(source.ends_within_frame());
  EXPECT_FALSE(source.size());

  auto cut = ByteSource::over_memory(std::span(frame).first(frame.size() / 2));
  ASSERT_TRUE(cut.unpack());
  Bytes out(bytes.size());
  EXPECT_LT(cut.read(out).value(), bytes.size());
  EXPECT_TRUE(cut.ends_within_frame());
}

TEST(TraceCompression, PeekingMovesNothing) {
  const Bytes bytes{1, 2, 3, 4, 5};
  auto source = ByteSource::over_memory(bytes);
  EXPECT_EQ(source.unpack().value(), Compression::none);
  EXPECT_EQ(source.peek(9).value().size(), 5U);
  Bytes out(9);
  EXPECT_EQ(source.read(out).value(), 5U);
  EXPECT_EQ(out, (Bytes{1, 2, 3, 4, 5, 0, 0, 0, 0}));
  EXPECT_EQ(source.stored_bytes_read(), 5U);
}

}  // namespace
}  // namespace tactus
