// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/fem/cholesky_cholmod.h>

#include <cholmod.h>

#include <array>
#include <cmath>
#include <new>
#include <vector>

namespace tactus::sim {
namespace {

constexpr std::size_t kTogether = 4;  ///< right sides that CHOLMOD's workspace holds

int* ints(void* data) { return static_cast<int*>(data); }
double* doubles(void* data) { return static_cast<double*>(data); }

/// Throw if CHOLMOD could not allocate.
template <class T>
T* allocated(T* made) {
  if (made == nullptr) throw std::bad_alloc();
  return made;
}

}  // namespace

struct CholmodCholesky::Impl {
  Impl() {
    cholmod_start(&common);
    common.print = 0;
    common.supernodal = CHOLMOD_SIMPLICIAL;
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_AMD;
    common.grow2 = 0;  // columns of L never grow
  }
  ~Impl() {
    cholmod_free_dense(&work, &common);
    cholmod_free_dense(&unused, &common);
    cholmod_free_sparse(&permuted, &common);
    cholmod_free_factor(&factor, &common);
    cholmod_finish(&common);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  cholmod_common common{};
  cholmod_factor* factor = nullptr;
  cholmod_sparse* permuted = nullptr;  // upper triangle of P A P^T
  std::vector<int> from;               // where each of its values is in A
  cholmod_dense* work = nullptr;       // of solve()
  cholmod_dense* unused = nullptr;     // of solve() with a sparse right side
};

CholmodCholesky::CholmodCholesky() = default;
CholmodCholesky::~CholmodCholesky() = default;
CholmodCholesky::CholmodCholesky(CholmodCholesky&&) noexcept = default;
CholmodCholesky& CholmodCholesky::operator=(CholmodCholesky&&) noexcept = default;

void CholmodCholesky::analyse(const SparseMatrix& A) {
  impl_.reset();
  if (A.rows() == 0) return;  // CHOLMOD refuses matrices without columns
  impl_ = std::make_unique<Impl>();
  Impl& s = *impl_;
  // Each value is its own index, so that one permutation of the matrix shows where each value goes. CHOLMOD only reads.
  const auto count = static_cast<std::size_t>(A.nonZeros());
  std::vector<double> index(count);
  for (std::size_t i = 0; i < count; ++i) index[i] = static_cast<double>(i);
  cholmod_sparse lower{};
  lower.nrow = lower.ncol = static_cast<std::size_t>(A.rows());
  lower.nzmax = count;
  lower.p = const_cast<int*>(A.outerIndexPtr());
  lower.i = const_cast<int*>(A.innerIndexPtr());
  lower.x = index.data();
  lower.stype = -1;
  lower.itype = CHOLMOD_INT;
  lower.xtype = CHOLMOD_REAL;
  lower.dtype = CHOLMOD_DOUBLE;
  lower.sorted = lower.packed = 1;

  s.factor = allocated(cholmod_analyze(&lower, &s.common));
  const std::size_t n = s.factor->n;
  if (cholmod_change_factor(CHOLMOD_REAL, 0, 0, 0, 1, s.factor, &s.common) == 0 || cholmod_allocate_work(n, n, n, &s.common) == 0)
    throw std::bad_alloc();
  s.work = allocated(cholmod_allocate_dense(kTogether, n, kTogether, CHOLMOD_REAL, &s.common));
  s.permuted = allocated(cholmod_ptranspose(&lower, 1, ints(s.factor->Perm), nullptr, 0, &s.common));
  s.from.resize(static_cast<std::size_t>(ints(s.permuted->p)[s.permuted->ncol]));
  for (std::size_t i = 0; i < s.from.size(); ++i) s.from[i] = static_cast<int>(doubles(s.permuted->x)[i]);
}

bool CholmodCholesky::factor(const SparseMatrix& A) noexcept {
  if (!impl_) return true;
  Impl& s = *impl_;
  for (std::size_t i = 0; i < s.from.size(); ++i) doubles(s.permuted->x)[i] = A.valuePtr()[s.from[i]];
  std::array<double, 2> shift{};
  if (cholmod_rowfac(s.permuted, nullptr, shift.data(), 0, s.factor->n, s.factor, &s.common) == 0) return false;
  for (std::size_t k = 0; k < s.factor->n; ++k) {
    const double pivot = doubles(s.factor->x)[ints(s.factor->p)[k]];
    if (!(pivot > 0) || !std::isfinite(pivot)) return false;
  }
  return s.factor->minor == s.factor->n;
}

void CholmodCholesky::solve(const Eigen::VectorXd& b, Eigen::VectorXd& x) noexcept {
  if (!impl_) return;
  Impl& s = *impl_;
  const auto column = [](const Eigen::VectorXd& v) {
    cholmod_dense out{};
    out.nrow = out.nzmax = out.d = static_cast<std::size_t>(v.size());
    out.ncol = 1;
    out.x = const_cast<double*>(v.data());
    out.xtype = CHOLMOD_REAL;
    out.dtype = CHOLMOD_DOUBLE;
    return out;
  };
  cholmod_dense right = column(b), left = column(x);
  cholmod_dense* solution = &left;       // large enough: CHOLMOD writes into it
  s.work->nrow = s.work->d = kTogether;  // if the last call left another shape, CHOLMOD would allocate
  s.work->ncol = s.factor->n;
  cholmod_solve2(CHOLMOD_A, s.factor, &right, nullptr, &solution, nullptr, &s.work, &s.unused, &s.common);
}

std::int64_t CholmodCholesky::fill() const noexcept {
  if (!impl_) return 0;
  std::int64_t sum = 0;
  for (std::size_t k = 0; k < impl_->factor->n; ++k) sum += ints(impl_->factor->ColCount)[k];
  return sum;
}

}  // namespace tactus::sim
