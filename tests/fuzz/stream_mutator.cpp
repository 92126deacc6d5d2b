// SPDX-License-Identifier: Apache-2.0
/// Mutations of stream files that keep lengths and check values right, so that they reach the code behind: half of them change the
/// whole file, half one section.
#include <algorithm>

#include "tests/fuzz/sections.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace {

using namespace tactus::testing;

/// Nothing if the result would not fit.
std::vector<std::uint8_t> mutate_section(std::span<const std::uint8_t> file, const Section& section, std::size_t max_size) {
  constexpr std::size_t kLengthGrows = 9;  // by at most so many bytes
  if (file.size() + kLengthGrows > max_size) return {};
  const std::size_t size = section.end - section.payload;
  std::vector<std::uint8_t> payload(size + max_size - file.size() - kLengthGrows);
  std::ranges::copy(file.subspan(section.payload, size), payload.begin());
  payload.resize(payload.empty() ? 0 : LLVMFuzzerMutate(payload.data(), size, payload.size()));
  return with_payload(file, section, payload);
}

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size, unsigned seed) {
  const auto sections = sections_of({data, size});
  if (seed % 2 == 1 && !sections.empty()) {
    const auto mutated = mutate_section({data, size}, sections[seed / 2 % sections.size()], max_size);
    std::ranges::copy(mutated, data);
    size = mutated.empty() ? size : mutated.size();
  } else {
    size = LLVMFuzzerMutate(data, size, max_size);
  }
  repair({data, size});
  return size;
}
