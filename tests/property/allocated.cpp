// SPDX-License-Identifier: Apache-2.0
#include "tests/property/allocated.h"

#include <atomic>
#include <cstdlib>
#include <new>

namespace {

std::atomic<std::uint64_t> total{0}, blocks{0}, until_failure{0};

void* counted(std::size_t size, const std::nothrow_t&) noexcept {
  if (until_failure > 0 && --until_failure == 0) return nullptr;
  total += size;
  void* p = std::malloc(size);
  if (p != nullptr) ++blocks;
  return p;
}

void* counted(std::size_t size) {
  void* p = counted(size, std::nothrow);
  if (p == nullptr) throw std::bad_alloc();
  return p;
}

void release(void* p) noexcept {
  if (p != nullptr) --blocks;
  std::free(p);
}

}  // namespace

void* operator new(std::size_t size) { return counted(size); }
void* operator new[](std::size_t size) { return counted(size); }
void* operator new(std::size_t size, const std::nothrow_t& tag) noexcept { return counted(size, tag); }
void* operator new[](std::size_t size, const std::nothrow_t& tag) noexcept { return counted(size, tag); }
void operator delete(void* p) noexcept { release(p); }
void operator delete[](void* p) noexcept { release(p); }
void operator delete(void* p, std::size_t) noexcept { release(p); }
void operator delete[](void* p, std::size_t) noexcept { release(p); }
void operator delete(void* p, const std::nothrow_t&) noexcept { release(p); }
void operator delete[](void* p, const std::nothrow_t&) noexcept { release(p); }

namespace tactus::testing {

std::uint64_t allocated_bytes() noexcept { return total; }
std::uint64_t live_blocks() noexcept { return blocks; }
void fail_allocation(std::uint64_t number) noexcept { until_failure = number; }
bool failure_is_due() noexcept { return until_failure > 0; }

}  // namespace tactus::testing
