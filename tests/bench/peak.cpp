// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/peak.h"

#include <algorithm>
#include <cstddef>
#include <ctime>

namespace tactus::testing {
namespace {

constexpr int kRounds = 200'000;
constexpr std::size_t kChains = 8;  // of each kind: more than an addition takes cycles

// A function per instruction set: the vectors of one that a function is not compiled for would be taken apart.
#define TACTUS_ROUNDS(target, name, bytes)                                        \
  target double name() {                                                          \
    using V [[gnu::vector_size(bytes)]] = double;                                 \
    V sum[kChains] = {}, product[kChains];                                        \
    for (V & p : product) p = V{} + 1.0;                                          \
    V step = V{} + 1e-9, factor = V{} + (1 + 1e-12);                              \
    for (int i = 0; i < kRounds; ++i) {                                           \
      for (std::size_t k = 0; k < kChains; ++k) {                                 \
        sum[k] += step;                                                           \
        product[k] *= factor;                                                     \
      }                                                                           \
      asm volatile("" : "+x"(step), "+x"(factor)); /* or all rounds become one */ \
    }                                                                             \
    V all{};                                                                      \
    for (std::size_t k = 0; k < kChains; ++k) all += sum[k] + product[k];         \
    return all[0];                                                                \
  }

TACTUS_ROUNDS(, portable_rounds, 16)
#ifdef TACTUS_FEM_X86
TACTUS_ROUNDS([[gnu::target("avx2")]], avx2_rounds, 32)
TACTUS_ROUNDS([[gnu::target("avx512f")]], avx512_rounds, 64)
#endif
#undef TACTUS_ROUNDS

double now() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace

double peak(sim::InstructionSet set) {
  double (*rounds)() = portable_rounds;
  double lanes = 2;
#ifdef TACTUS_FEM_X86
  if (set == sim::InstructionSet::avx2) rounds = avx2_rounds, lanes = 4;
  if (set == sim::InstructionSet::avx512) rounds = avx512_rounds, lanes = 8;
#endif
  double shortest = 1;
  volatile double keep = 0;
  for (int run = 0; run < 100; ++run) {
    const double begin = now();
    keep = rounds();
    shortest = std::min(shortest, now() - begin);
  }
  static_cast<void>(keep);
  return 2 * kChains * lanes * kRounds / shortest;
}

}  // namespace tactus::testing
