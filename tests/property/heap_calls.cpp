// SPDX-License-Identifier: Apache-2.0
#include "tests/property/heap_calls.h"

#include <atomic>
#include <cstddef>

namespace {

std::atomic<std::uint64_t> calls{0};

}  // namespace

// Names that the linker gives.
extern "C" void* __real_malloc(std::size_t size);  // NOLINT(bugprone-reserved-identifier)
extern "C" void* __wrap_malloc(std::size_t size);  // NOLINT(bugprone-reserved-identifier)

extern "C" void* __wrap_malloc(std::size_t size) {  // NOLINT(bugprone-reserved-identifier)
  ++calls;
  return __real_malloc(size);
}

std::uint64_t tactus::testing::heap_calls() noexcept { return calls; }
