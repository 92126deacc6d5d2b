// SPDX-License-Identifier: Apache-2.0
#include "sim/fem/cholesky.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/fem/ordering.h"
#include "sim/fem/panel_kernels.h"

namespace tactus {
namespace {

constexpr int kMostZeros = 10;  ///< [%] of a panel that merging two may fill with zeros

std::size_t at(int i) { return static_cast<std::size_t>(i); }

Graph vertex_graph(const SparseMatrix& A) {
  const int n = static_cast<int>(A.rows()) / 3;
  Graph graph;
  graph.begin.assign(1, 0);
  std::vector<int> seen(at(n), -1);
  for (int i = 0; i < n; ++i) {
    seen[at(i)] = i;
    for (int row = 3 * i; row < 3 * i + 3; ++row) {
      for (SparseMatrix::InnerIterator it(A, row); it; ++it) {
        const int j = it.index() / 3;
        if (std::exchange(seen[at(j)], i) != i) graph.neighbours.push_back(j);
      }
    }
    graph.begin.push_back(static_cast<int>(graph.neighbours.size()));
  }
  return graph;
}

/// Vertices below the diagonal in each column of L, ascending, when eliminated by their number in `position`.
std::vector<std::vector<int>> symbolic(const Graph& graph, const std::vector<int>& order, const std::vector<int>& position,
                                       std::vector<int>& parent) {
  const int n = graph.size();
  std::vector<std::vector<int>> below(at(n)), children(at(n));
  std::vector<int> seen(at(n), -1);
  parent.assign(at(n), -1);
  for (int j = 0; j < n; ++j) {
    seen[at(j)] = j;
    auto& column = below[at(j)];
    const auto add = [&](int i) {
      if (i > j && std::exchange(seen[at(i)], j) != j) column.push_back(i);
    };
    const int node = order[at(j)];
    for (int k = graph.begin[at(node)]; k < graph.begin[at(node) + 1]; ++k) add(position[at(graph.neighbours[at(k)])]);
    for (const int child : children[at(j)])
      for (const int i : below[at(child)]) add(i);
    std::sort(column.begin(), column.end());
    if (column.empty()) continue;
    parent[at(j)] = column.front();
    children[at(column.front())].push_back(j);
  }
  return below;
}

/// Children before parents and side by side, so that columns of like structure are neighbours.
std::vector<int> postorder(const std::vector<int>& parent) {
  const int n = static_cast<int>(parent.size());
  std::vector<int> child(at(n), -1), sibling(at(n), -1), stack, order;
  for (int j = n - 1; j >= 0; --j)
    if (parent[at(j)] >= 0) sibling[at(j)] = std::exchange(child[at(parent[at(j)])], j);
  for (int root = 0; root < n; ++root) {
    if (parent[at(root)] >= 0) continue;
    for (stack.push_back(root); !stack.empty();) {
      const int node = stack.back();
      if (child[at(node)] >= 0) {
        stack.push_back(std::exchange(child[at(node)], sibling[at(child[at(node)])]));
      } else {
        order.push_back(node);
        stack.pop_back();
      }
    }
  }
  return order;
}

}  // namespace

std::int64_t Cholesky::fill() const noexcept {
  std::int64_t sum = 0;
  for (const Panel& p : panels_) sum += std::int64_t{p.width} * (p.width + 1) / 2 + std::int64_t{p.width} * p.used;
  return sum;
}

void Cholesky::analyse(const SparseMatrix& A) {
  const Graph graph = vertex_graph(A);
  std::vector<int> order = nested_dissection(graph), parent;
  position_.resize(order.size());
  const auto number = [&] {
    for (int k = 0; k < graph.size(); ++k) position_[at(order[at(k)])] = k;
  };
  number();
  symbolic(graph, order, position_, parent);
  std::vector<int> sorted;
  for (const int k : postorder(parent)) sorted.push_back(order[at(k)]);
  order = std::move(sorted);
  number();
  const auto below = symbolic(graph, order, position_, parent);
  structure(below, parent);
  map_entries(A);
}

/// Join columns into panels: where the next column is the parent, and merging leaves few zeros.
void Cholesky::structure(const std::vector<std::vector<int>>& below, const std::vector<int>& parent) {
  const int n = static_cast<int>(below.size());
  panels_.clear();
  panel_of_.resize(at(3 * n));
  rows_.clear();
  std::size_t value = 0, highest = 0;
  for (int first = 0, last = 0; first < n; first = last + 1) {
    std::size_t filled = below[at(first)].size() + 1;
    for (last = first; last + 1 < n && parent[at(last)] == last + 1; ++last) {
      const std::size_t width = at(last + 2 - first), rows = below[at(last + 1)].size();
      const std::size_t more = filled + rows + 1, whole = width * (width + 1) / 2 + width * rows;
      if (100 * (whole - more) > kMostZeros * whole) break;
      filled = more;
    }
    const std::vector<int>& rows = below[at(last)];
    Panel panel{3 * first, 3 * (last + 1 - first), 0, 3 * static_cast<int>(rows.size()), rows_.size(), value};
    for (const int row : rows)
      for (int k = 0; k < 3; ++k) rows_.push_back(3 * row + k);
    panel.rows = (panel.used + 3) / 4 * 4;
    rows_.resize(panel.index + at(panel.rows), 3 * n);
    value += at(panel.width) * at(panel.width + panel.rows);
    highest = std::max(highest, at(panel.rows));
    std::fill_n(panel_of_.begin() + panel.begin, panel.width, static_cast<int>(panels_.size()));
    panels_.push_back(panel);
  }
  values_.assign(value, 0);
  pending_.assign(panels_.size(), {});
  head_.assign(panels_.size(), -1);
  place_.assign(at(3 * n), 0);
  work_.assign(at(3 * n) + 4 + highest, 0);
  update_.assign(highest, 0);
}

void Cholesky::map_entries(const SparseMatrix& A) {
  entries_.clear();
  for (int row = 0; row < A.outerSize(); ++row) {
    for (int k = A.outerIndexPtr()[row]; k < A.outerIndexPtr()[row + 1]; ++k) {
      const int other = A.innerIndexPtr()[k];
      const int i = 3 * position_[at(row / 3)] + row % 3, j = 3 * position_[at(other / 3)] + other % 3;
      if (i < j) continue;
      const Panel& panel = panels_[at(panel_of_[at(j)])];
      const int column = j - panel.begin;
      if (i < panel.begin + panel.width) {
        entries_.push_back({k, panel.value + at(column * panel.width + i - panel.begin)});
      } else {
        const auto rows = rows_.begin() + static_cast<std::ptrdiff_t>(panel.index);
        const auto place = std::lower_bound(rows, rows + panel.used, i) - rows;
        entries_.push_back(
            {k, panel.value + at(panel.width * panel.width + column * panel.rows) + static_cast<std::size_t>(place)});
      }
    }
  }
}

void Cholesky::queue(int panel, int row) noexcept {
  if (row >= panels_[at(panel)].used) return;
  const int target = panel_of_[at(rows_[panels_[at(panel)].index + at(row)])];
  pending_[at(panel)] = {std::exchange(head_[at(target)], panel), row};
}

/// Subtract from panel `target` the product of `source`'s rows in its columns with those and the rows below.
void Cholesky::update(int target, int source) noexcept {
  const Panel& to = panels_[at(target)];
  const Panel& from = panels_[at(source)];
  const int* rows = rows_.data() + from.index;
  const int begin = pending_[at(source)].row;
  int end = begin;
  while (end < from.used && rows[end] < to.begin + to.width) ++end;

  const double* below = values_.data() + from.value + at(from.width * from.width);
  double* left = work_.data();  // one row of the source
  double* product = update_.data();
  double* triangle = values_.data() + to.value;
  double* rectangle = triangle + at(to.width * to.width);
  for (int j = begin; j < end; ++j) {
    const int column = rows[j] - to.begin;
    for (int k = 0; k < from.width; ++k) left[k] = below[at(k * from.rows + j)];
    panel_times(below + j, from.rows, from.used - j, from.width, left, product);
    double* to_triangle = triangle + at(column * to.width);
    double* to_rectangle = rectangle + at(column * to.rows);
    for (int i = j; i < end; ++i) to_triangle[rows[i] - to.begin] -= product[i - j];
    for (int i = end; i < from.used; ++i) to_rectangle[place_[at(rows[i])]] -= product[i - j];
  }
  queue(source, end);
}

/// Dense Cholesky of the triangle, then the rows below times its inverse transposed.
bool Cholesky::factor_panel(const Panel& panel) noexcept {
  const int w = panel.width;
  double* triangle = values_.data() + panel.value;
  double* below = triangle + at(w * w);
  for (int j = 0; j < w; ++j) {
    double* column = triangle + at(j * w);
    double* column_below = below + at(j * panel.rows);
    for (int k = 0; k < j; ++k) {
      const double* left = triangle + at(k * w);
      const double factor = left[j];
      for (int i = j; i < w; ++i) column[i] -= factor * left[i];
      panel_axpy(-factor, below + at(k * panel.rows), column_below, panel.rows);
    }
    if (!(column[j] > 0) || !std::isfinite(column[j])) return false;
    const double inverse = 1 / std::sqrt(column[j]);
    for (int i = j; i < w; ++i) column[i] *= inverse;
    for (int i = 0; i < panel.rows; ++i) column_below[i] *= inverse;
  }
  return true;
}

bool Cholesky::factor(const SparseMatrix& A) noexcept {
  std::fill(values_.begin(), values_.end(), 0.0);
  std::fill(head_.begin(), head_.end(), -1);
  for (const Entry& entry : entries_) values_[entry.to] = A.valuePtr()[entry.from];
  for (int target = 0; target < static_cast<int>(panels_.size()); ++target) {
    const Panel& panel = panels_[at(target)];
    for (int i = 0; i < panel.used; ++i) place_[at(rows_[panel.index + at(i)])] = i;
    for (int source = head_[at(target)], next = -1; source >= 0; source = next) {
      next = pending_[at(source)].next;
      update(target, source);
    }
    if (!factor_panel(panel)) return false;
    queue(target, 0);
  }
  return true;
}

void Cholesky::solve(const Eigen::VectorXd& b, Eigen::VectorXd& x) noexcept {
  const auto n = static_cast<std::size_t>(size());
  double* y = work_.data();
  double* gathered = y + n + 4;
  for (std::size_t i = 0; i < position_.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) y[3 * at(position_[i]) + k] = b[static_cast<Eigen::Index>(3 * i + k)];

  y[n] = 0;
  for (const Panel& panel : panels_) {
    const double* triangle = values_.data() + panel.value;
    double* mine = y + panel.begin;
    lower_solve(triangle, panel.width, mine);
    panel_times(triangle + at(panel.width * panel.width), panel.rows, panel.rows, panel.width, mine, gathered);
    const int* rows = rows_.data() + panel.index;
    for (int i = 0; i < panel.rows; ++i) y[rows[i]] -= gathered[i];
  }
  for (std::size_t p = panels_.size(); p-- > 0;) {
    const Panel& panel = panels_[p];
    const double* triangle = values_.data() + panel.value;
    const int* rows = rows_.data() + panel.index;
    for (int i = 0; i < panel.rows; ++i) gathered[i] = y[rows[i]];
    double* mine = y + panel.begin;
    panel_transposed_times(triangle + at(panel.width * panel.width), panel.rows, panel.width, gathered, mine);
    upper_solve(triangle, panel.width, mine);
  }
  for (std::size_t i = 0; i < position_.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) x[static_cast<Eigen::Index>(3 * i + k)] = y[3 * at(position_[i]) + k];
}

}  // namespace tactus
