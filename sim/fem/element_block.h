// SPDX-License-Identifier: Apache-2.0
/// Elements sixteen at a time, and the kernels that work on them, compiled once per instruction set from element_kernel.h.
/// Nothing here may be an inline function: a linker could keep the copy that was compiled for a machine other than this one.
#pragma once

#include <cstddef>
#include <cstdint>

namespace tactus::sim {

inline constexpr std::size_t kBlockSize = 16;  ///< elements: lanes of two of the widest vectors there are

/// Structure of arrays, lane last. Lanes without an element have no stiffness.
struct alignas(64) ElementBlock {
  double gradient[9][kBlockSize];       ///< row r, column c of the inverse rest edges at 3 r + c: g_(r+1) [1/m]
  double two_mu[kBlockSize];            ///< 2 mu V [J]
  double lambda[kBlockSize];            ///< lambda V [J]
  double rotation[4][kBlockSize];       ///< w x y z, of about unit length: R(q) divides by |q|^2
  std::uint32_t corner[4][kBlockSize];  ///< 4 x vertex: where its vector begins
};

/// Vector of a vertex. The fourth component makes it one load and one store.
struct alignas(32) VertexVector {
  double xyz[3];
  double unused;
};

struct BlockSpan {
  ElementBlock* data;
  std::size_t size;
};

/// Effect of a step on a state of n displacements and velocities, summed in the same order by every instruction set.
struct Motion {
  double work;      ///< sum of f (u1 - u0) [J]
  double farthest;  ///< largest |u1 - u0| [m]
  bool finite;      ///< u1 and v1
};

/// u, k: doubles of VertexVectors. Forces are added to k.
struct ElementKernels {
  void (*forces)(BlockSpan blocks, const double* u, double* k) noexcept;
  void (*linear_forces)(BlockSpan blocks, const double* u, double* k) noexcept;
  double (*energy)(BlockSpan blocks, const double* u) noexcept;
  double (*linear_energy)(BlockSpan blocks, const double* u) noexcept;
  void (*turn)(BlockSpan blocks, const double* u) noexcept;
  /// Also copies u1 and v1 to u and v: loading them is the main cost.
  Motion (*motion)(const double* f, const double* u0, const double* u1, const double* v1, double* u, double* v,
                   std::size_t n) noexcept;
  bool (*finite)(const double* x, std::size_t n) noexcept;
};

/// portable: two lanes, SSE2 on x86-64. All sets yield the same bits.
enum class InstructionSet : std::uint8_t { portable, avx2, avx512 };

bool supported(InstructionSet set) noexcept;          ///< by this machine and this build
InstructionSet widest() noexcept;                     ///< of those supported
ElementKernels kernels(InstructionSet set) noexcept;  ///< pre  supported(set)

ElementKernels portable_kernels() noexcept;
#ifdef TACTUS_FEM_X86
ElementKernels avx2_kernels() noexcept;
ElementKernels avx512_kernels() noexcept;
#endif

}  // namespace tactus::sim
