// SPDX-License-Identifier: Apache-2.0
#include "tests/property/heap_calls.h"

#ifdef TACTUS_FEM_CHOLMOD
#include <SuiteSparse_config.h>
#endif

#include <atomic>
#include <cstddef>
#include <cstdlib>

namespace {

std::atomic<std::uint64_t> calls{0};

}  // namespace

// Names that the linker gives.
extern "C" void* __real_malloc(std::size_t size);  // NOLINT(readability-identifier-naming)
extern "C" void* __wrap_malloc(std::size_t size);  // NOLINT(readability-identifier-naming)

extern "C" void* __wrap_malloc(std::size_t size) {  // NOLINT(readability-identifier-naming)
  ++calls;
  return __real_malloc(size);
}

#ifdef TACTUS_FEM_CHOLMOD
namespace {

// The library calls what this table names.
[[maybe_unused]] const bool counted = [] {
  SuiteSparse_config.malloc_func = __wrap_malloc;
  SuiteSparse_config.calloc_func = [](std::size_t count, std::size_t size) {
    ++calls;
    return std::calloc(count, size);
  };
  SuiteSparse_config.realloc_func = [](void* block, std::size_t size) {
    ++calls;
    return std::realloc(block, size);
  };
  return true;
}();

}  // namespace
#endif

std::uint64_t tactus::testing::heap_calls() noexcept { return calls; }
