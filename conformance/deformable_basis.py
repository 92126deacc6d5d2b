# SPDX-License-Identifier: Apache-2.0
"""Chapter 50 of the specification, section 10: the basis that both ends compute. Floats are binary64; sum() would not add in order."""
from __future__ import annotations

from math import floor, sqrt

from conventions import clamp
from deformable_graph import Hierarchy
from deformable_header import DeformableObject, Mode

MOST_MEMBERS, MOST_ANCHORS, MOST_NEAR = 1024, 64, 24
SPARE_COLUMNS = 8
ISOTROPIC = 2.0 ** -8
AXES = range(3)


def work(item: DeformableObject) -> int:
    """As 50, section 1.5 counts it."""
    if item.fixed is None:
        return 0
    columns = item.mode_count + SPARE_COLUMNS
    return columns * (len(item.rest) + 16 * min(len(item.rest), MOST_MEMBERS)) + columns ** 3 // 4


def dot(a: list, b: list) -> float:
    total = 0.0
    for x, y in zip(a, b):
        total += x * y
    return total


# ---- Networks -------------------------------------------------------------------------------------------------------
class Network:
    def __init__(self, rest: list, members: list[int], tree: Hierarchy, fixed: set):
        index = {v: i for i, v in enumerate(members)}
        self.fixed = [i for i, v in enumerate(members) if v in fixed]
        self.size = len(members)
        pairs = set()
        for v in members:
            others = [w for w in members if rest[w] != rest[v]]
            others.sort(key=lambda w: (tree.distance(v, w), index[w]))
            for w in others[:MOST_NEAR]:
                pairs.add((min(index[v], index[w]), max(index[v], index[w])))
        self.springs = []
        for v, w in sorted(pairs):
            d = [float(rest[members[w]][axis] - rest[members[v]][axis]) for axis in AXES]
            length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])
            self.springs.append((v, w, [c / length for c in d]))
        self.bound = self.largest_eigenvalue()

    def largest_eigenvalue(self) -> float:
        blocks = [[0.0] * 9 for _ in range(self.size)]
        for v, w, n in self.springs:
            for end in (v, w):
                for i in AXES:
                    for k in AXES:
                        blocks[end][3 * i + k] += n[i] * n[k] + (ISOTROPIC if i == k else 0.0)
        return max([1.0] + [2 * sqrt(dot(block, block)) for block in blocks])

    def multiply(self, x: list) -> list:
        columns = len(x[0])
        y = [[0.0] * columns for _ in x]
        for v, w, n in self.springs:
            for c in range(columns):
                d = [x[3 * v + axis][c] - x[3 * w + axis][c] for axis in AXES]
                s = n[0] * d[0] + n[1] * d[1] + n[2] * d[2]
                for axis in AXES:
                    f = n[axis] * s + ISOTROPIC * d[axis]
                    y[3 * v + axis][c] += f
                    y[3 * w + axis][c] -= f
        for i in self.fixed:
            for axis in AXES:
                y[3 * i + axis] = [0.0] * columns
        return y


# ---- Filter and Ritz vectors ----------------------------------------------------------------------------------------
def chebyshev(network: Network, low: float, high: float, x: list) -> list:
    half, middle = (high - low) / 2, (high + low) / 2
    first = sigma = -half / middle
    y = [[(p - middle * c) * (sigma / half) for p, c in zip(*rows)] for rows in zip(network.multiply(x), x)]
    for _ in range(7):
        following = 1 / (2 / first - sigma)
        scale, back = 2 * following / half, sigma * following
        x, y = y, [[scale * (p - middle * b) - back * a for p, a, b in zip(*rows)] for rows in zip(network.multiply(y), x, y)]
        sigma = following
    return y


def inverse_factor(m: list) -> list:
    """Of L in L L^T = m, which is given by its lower triangle."""
    size = len(m)
    for j in range(size):
        p = m[j][j]
        for k in range(j):
            p -= m[j][k] * m[j][k]
        m[j][j] = sqrt(max(p, 2.0 ** -40 * m[j][j], 2.0 ** -200))
        for i in range(j + 1, size):
            for k in range(j):
                m[i][j] -= m[i][k] * m[j][k]
            m[i][j] /= m[j][j]
    out = [[0.0] * size for _ in range(size)]
    for j in range(size):
        out[j][j] = 1 / m[j][j]
        for i in range(j + 1, size):
            for k in range(j, i):
                out[i][j] -= m[i][k] * out[k][j]
            out[i][j] /= m[i][i]
    return out


def rotate_rows(m: list, p: int, q: int, c: float, s: float) -> None:
    m[p], m[q] = [c * x - s * y for x, y in zip(m[p], m[q])], [s * x + c * y for x, y in zip(m[p], m[q])]


def jacobi(a: list, m: list) -> None:
    size = len(a)
    for _ in range(4):
        for p in range(size - 1):
            for q in range(p + 1, size):
                if a[p][q] == 0:
                    continue
                theta = (a[q][q] - a[p][p]) / (2 * a[p][q])
                t = (-1.0 if theta < 0 else 1.0) / (abs(theta) + sqrt(theta * theta + 1))
                c = 1 / sqrt(t * t + 1)
                s = t * c
                rotate_rows(a, p, q, c, s)
                for row in a:
                    row[p], row[q] = c * row[p] - s * row[q], s * row[p] + c * row[q]
                rotate_rows(m, p, q, c, s)


def ritz(network: Network, x: list) -> tuple[list, list]:
    z = network.multiply(x)
    size = len(x[0])
    x_columns, z_columns = list(zip(*x)), list(zip(*z))
    m = inverse_factor([[dot(x_columns[i], x_columns[k]) if k <= i else 0.0 for k in range(size)] for i in range(size)])
    a = [[dot(x_columns[max(i, k)], z_columns[min(i, k)]) for k in range(size)] for i in range(size)]
    h = [[dot(m[i][:i + 1], [a[k][j] for k in range(i + 1)]) for j in range(size)] for i in range(size)]
    for i in range(size):
        for j in range(i + 1):
            a[i][j] = a[j][i] = dot(h[i][:j + 1], m[j][:j + 1])
    jacobi(a, m)
    columns = sorted(range(size), key=lambda i: (a[i][i], i))
    return [[dot(row, m[i]) for i in columns] for row in x], [a[i][i] for i in columns]


# ---- Modes ----------------------------------------------------------------------------------------------------------
def stages_of(item: DeformableObject, tree: Hierarchy, free: list[int]) -> list[int]:
    """`free[m]` are those among the first m of the order."""
    order, stages = tree.order, []
    most = min(len(order), MOST_MEMBERS)
    for m in range(most, 0, -1):
        whole = m == len(order) or tree.depth[order[m]] < tree.depth[order[m - 1]]
        if whole and 3 * free[m] >= 2 * (item.mode_count + SPARE_COLUMNS) and (not stages or 2 * m <= stages[0]):
            stages.insert(0, m)
    return stages or [most]


def start_block(order: list[int], fixed: set, columns: int) -> list:
    state, x = 1, []
    for v in order:
        for _ in AXES:
            x.append([0.0] * columns)
            for c in range(columns if v not in fixed else 0):
                state = (state * 6364136223846793005 + 1442695040888963407) % (1 << 64)
                x[-1][c] = (state >> 40) * 2.0 ** -23 - 1
    return x


def from_parents(tree: Hierarchy, order_index: dict, v: int, x: list, fixed: set) -> list:
    """The three rows of a vertex."""
    rows = [[0.0] * len(x[0]) for _ in AXES]
    for parent, weight in zip(tree.parents[0][v], tree.weights[0][v]) if v not in fixed else ():
        for axis in AXES:
            from_row = x[3 * order_index[parent] + axis]
            rows[axis] = [a + (weight * 2.0 ** -15) * b for a, b in zip(rows[axis], from_row)]
    return rows


def rounded(u: list) -> Mode:
    largest = max(abs(c) for c in u) or 1.0
    square = 0.0
    for c in u:
        square += (c / largest) * (c / largest)
    step = floor(1.5 / sqrt(max(1.0, square)) * 4096 * 2048 / 2047 + 0.5)
    return Mode(step, [floor(c / largest * 2047 + 0.5) for c in u])


def computed_modes(item: DeformableObject) -> list[Mode]:
    tree = Hierarchy(item, sets=1)                          # set 0
    order, fixed = tree.order, set(item.fixed)
    order_index = {v: i for i, v in enumerate(order)}
    free = [0]
    for v in order:
        free.append(free[-1] + (v not in fixed))
    anchors = [v for v in order if v in fixed][:MOST_ANCHORS]
    stages = stages_of(item, tree, free)
    x = start_block(order[:stages[0]], fixed, min(item.mode_count + SPARE_COLUMNS, 3 * free[stages[0]]))
    for m in stages:
        for v in order[len(x) // 3:m]:
            x += from_parents(tree, order_index, v, x, fixed)
        members = order[:m] + [v for v in anchors if order_index[v] >= m]
        network = Network(item.rest, members, tree, fixed)
        if x[0]:
            x = relaxed(network, x, 8 if m == stages[0] else 3)[:3 * m]
    modes = []
    for k in range(item.mode_count):
        u = [[row[k] if k < len(row) else 0.0] for row in x]
        for v in order[stages[-1]:]:
            u += from_parents(tree, order_index, v, u, fixed)
        modes.append(rounded([u[3 * order_index[v] + axis][0] for v in range(len(order)) for axis in AXES]))
    return modes


def relaxed(network: Network, x: list, rounds: int) -> list:
    x = x + [[0.0] * len(x[0]) for _ in range(3 * network.size - len(x))]
    for _ in range(rounds):
        x, values = ritz(network, x)
        x = chebyshev(network, clamp(values[-1], network.bound / 256, network.bound / 4), network.bound, x)
    return ritz(network, x)[0]
