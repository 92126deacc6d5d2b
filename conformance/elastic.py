# SPDX-License-Identifier: Apache-2.0
"""Chapter 55 of the specification, sections 5.3 and 6: the shapes of an elastic body, and what a client shows that knows its device."""
from __future__ import annotations

from math import floor
from typing import NamedTuple, Optional

from deformable_graph import triangles_of_vertices
from deformable_header import DeformableObject
from deformable_main import FADING, MainState
from deformable_motion import lim
from device_path import DevicePath
from elastic_step import Stepper
from elastic_touch import Proxy, Push, Surface
from scene import Declaration

STILL = 2.0 ** -30                                          # m/s


class Shape(NamedTuple):
    """What is there when a frame begins."""
    u: list[float]
    w: list[float]
    k: list[float]
    moves: bool
    proxy: Proxy


class Shapes:
    """Those of one body, computed as far as they are asked for. `path` is that of the device."""

    def __init__(self, scene: Declaration, item: DeformableObject, path: DevicePath):
        self.item, self.body, self.path = item, item.body, path
        self.ticks = item.frame_period // 256
        self.grid_step = 2.0 ** -scene.position_exp
        self.scale = 2.0 ** scene.position_exp
        self.farthest = 2.0 ** (27 - scene.position_exp)
        self.stepper = Stepper(self.body, self.ticks, scene.tick_rate)
        self.triangles_of = triangles_of_vertices(item)
        still = self.stepper.still
        self.shapes = [Shape(still, still, still, any(self.body.gravity), Proxy())]  # from the frame on in which the body begins
        self.ended = False

    def shape(self, n: int) -> Optional[Shape]:
        """Shape n; none without a tick mapping or after the end, and the first one for frames before."""
        if not self.path.offsets:
            return None
        begin = min(self.path.offsets) // self.ticks
        while not self.ended and len(self.shapes) <= n - begin:
            self.advance(begin + len(self.shapes) - 1)
        i = max(0, n - begin)
        return self.shapes[i] if i < len(self.shapes) else None

    def reach(self, t: int) -> None:
        self.shape(t // self.ticks)

    def advance(self, n: int) -> None:
        """Computes shape n + 1, the next one."""
        shape = self.shapes[-1]
        pushes, proxy = self.pushes(shape, n)
        if not pushes and not shape.moves:
            self.shapes.append(shape._replace(proxy=proxy))
            return
        u, w, k = self.stepper.step(shape.u, shape.w, shape.k, self.stepper.load(pushes))
        if all(abs(c) <= self.farthest for c in u):
            self.shapes.append(Shape(u, w, k, bool(pushes) or any(abs(c) >= STILL for c in w), proxy))
        else:
            self.ended = True

    def pushes(self, shape: Shape, n: int) -> tuple[list[Push], Proxy]:
        """Of the ticks of frame n."""
        u, rest = shape.u, self.body.rest
        s = [(x + u[3 * v], y + u[3 * v + 1], z + u[3 * v + 2]) for v, (x, y, z) in enumerate(rest[:len(self.item.rest)])]
        surface = Surface(self.item.triangles, self.triangles_of, s)
        pushes, proxy = [], shape.proxy
        for i in range(self.ticks):
            position = self.path.position(n * self.ticks + i)
            if position is None:
                proxy = Proxy()
                continue
            p = tuple(c * self.grid_step for c in position)
            proxy, push = surface.touch(p, proxy, i == 0, self.body.coupling, self.body.friction)
            if push:
                pushes.append(push)
        return pushes, proxy

    def grid(self, n: int) -> Optional[list[int]]:
        """Displacements of the object's vertices, on the position grid."""
        shape = self.shape(n)
        if shape is None:
            return None
        return [floor(c * self.scale + 0.5) for c in shape.u[:3 * len(self.item.rest)]]

    def shown(self, state: MainState, t: int) -> Optional[list[int]]:
        """What a client shows at tick t of a state that follows its device; none: what it would show without."""
        n, m = t // self.ticks, state.tick // self.ticks
        now, then = self.grid(n), self.grid(m)
        if now is None or then is None:
            return None
        left = 1 << 16
        if state.following == FADING:
            for _ in range(n - m):
                left = (left * 7) >> 3
                if left == 0:
                    break
        return [lim(a + faded(u - b, left)) for u, a, b in zip(state.u, now, then)]


def faded(off: int, left: int) -> int:
    shrunk = (abs(off) * left) >> 16
    return -shrunk if off < 0 else shrunk
