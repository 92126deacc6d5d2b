// SPDX-License-Identifier: Apache-2.0
/// Mutations of MCAP files whose check values are then right again, or 0 ("not computed") where that takes unpacking.
#include <algorithm>

#include <tactus/base/bytes.h>
#include <tactus/trace/mcap.h>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace {

using namespace tactus;
using mcap::Opcode;
using Bytes = std::span<std::uint8_t>;

void put(Bytes field, std::uint32_t value) {
  if (std::ranges::all_of(field, [](std::uint8_t byte) { return byte == 0; })) return;  // not computed is right, too
  for (std::size_t i = 0; i < field.size(); ++i) field[i] = static_cast<std::uint8_t>(value >> (8 * i));
}

void repair_chunk(Bytes content) {
  ByteReader in(content);
  in.bytes(3 * sizeof(std::uint64_t));  // times, size
  const std::size_t crc = in.position();
  in.u32();
  const bool packed = !in.bytes(in.u32()).empty();
  const auto records = in.bytes(in.u64());
  if (in.ok()) put(content.subspan(crc, 4), packed ? 0 : crc32(records));
}

void repair_attachment(Bytes content) {
  if (content.size() >= 4) put(content.last(4), crc32(content.first(content.size() - 4)));
}

void repair_file(Bytes file) {
  std::size_t at = mcap::kMagic.size(), section = 0;  // where the bytes begin that the next CRC of a whole section covers
  while (at < file.size()) {
    ByteReader in(file.subspan(at));
    const auto opcode = static_cast<Opcode>(in.u8());
    const auto size = static_cast<std::size_t>(in.bytes(in.u64()).size());
    if (!in.ok()) return;
    const Bytes content = file.subspan(at + mcap::kRecordPrefix, size);
    if (opcode == Opcode::chunk) repair_chunk(content);
    if (opcode == Opcode::attachment) repair_attachment(content);
    if (opcode == Opcode::data_end && size == 4) put(content, crc32(file.subspan(section, at - section)));
    at += in.position();
    if (opcode == Opcode::data_end) section = at;
    if (opcode == Opcode::footer && size == mcap::kFooterContent)
      put(content.last(4), crc32(file.subspan(section, at - 4 - section)));
  }
}

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size, unsigned) {
  size = LLVMFuzzerMutate(data, size, max_size);
  repair_file({data, size});
  return size;
}
