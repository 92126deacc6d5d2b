# SPDX-License-Identifier: Apache-2.0
"""The surface of a deformable object in the colours of its local stiffness."""
import math

from . import figure

TICKS = [digit * 10 ** power for power in range(-3, 9) for digit in (1, 1.5, 2, 3, 5, 7)]
FLAT = 0.2  # height to length: what is flatter is seen from above


def checked(of):
    """A surface of a document.   raises ValueError, TypeError, KeyError"""
    vertices, triangles = ([list(map(kind, part)) for part in of[name]] for kind, name in ((float, "vertices_m"), (int, "triangles")))
    stiffness = [None if value is None else float(value) for value in of["stiffness_N_per_m"]]
    if not triangles or any(len(part) != 3 for part in vertices + triangles) or len(stiffness) != len(vertices):
        raise ValueError("a surface has triangles, three coordinates and one stiffness for each vertex")
    if not all(0 <= v < len(vertices) for face in triangles for v in face):
        raise ValueError("a triangle has a vertex that is not there")
    if not all(math.isfinite(value) for part in vertices for value in part) or any(not 0 < v < math.inf for v in stiffness if v is not None):
        raise ValueError("a number of the surface is not finite, or a stiffness not above 0")
    return {"vertices_m": vertices, "triangles": triangles, "stiffness_N_per_m": stiffness}


def draw(of, title):
    """Vertices that are held, whose stiffness is None, are crosses. A few beside one are far stiffer than all the rest: the colours span
    98 of 100 vertices.   in   of   vertices_m, triangles, stiffness_N_per_m"""
    at = [[1e3 * c for c in v] for v in of["vertices_m"]]
    values = of["stiffness_N_per_m"]
    known = sorted(v for v in values if v is not None) or [1.0]
    low, top = known[0], max(known[len(known) * 98 // 100], 1.1 * known[0])
    shown = [top if v is None else min(v, top) for v in values]
    sizes = [max(axis) - min(axis) for axis in zip(*at)]
    import matplotlib.cm
    import matplotlib.colors
    colours = matplotlib.cm.ScalarMappable(matplotlib.colors.LogNorm(low, top), "cividis")
    held = {v for v, k in enumerate(values) if k is None}
    draw_it = from_above if sizes[2] < FLAT * max(sizes) else in_space
    fig, axes = draw_it(at, of["triangles"], shown, held, colours)
    bar = fig.colorbar(colours, ax=axes, label=f"stiffness [N/m], {low:.3g} to {known[-1]:.3g}", extend="max", shrink=0.8,
                       pad=0.05 if draw_it == from_above else 0.15)
    ticks = [t for t in TICKS if low <= t <= top]
    bar.set_ticks(ticks, labels=[f"{t:g}" for t in ticks])
    bar.ax.minorticks_off()
    figure.title(fig, title)
    return fig


def from_above(at, triangles, shown, held, colours):
    """Faces that look up."""
    area = lambda a, b, c: (at[b][0] - at[a][0]) * (at[c][1] - at[a][1]) - (at[b][1] - at[a][1]) * (at[c][0] - at[a][0])
    faces = [face for face in triangles if area(*face) > 0]
    tall = max(p[1] for p in at) - min(p[1] for p in at)
    fig, (axes,) = figure.panels(height=4.6, width=min(figure.WIDTH, 1.9 + 4.2 * (max(p[0] for p in at) - min(p[0] for p in at)) / tall))
    axes.tripcolor([p[0] for p in at], [p[1] for p in at], shown, triangles=faces, shading="gouraud", cmap=colours.cmap, norm=colours.norm)
    crosses = [at[v] for v in {v for face in faces for v in face} & held]
    if crosses:
        axes.plot([p[0] for p in crosses], [p[1] for p in crosses], "kx", markersize=4, label="held")
        axes.legend(loc="lower left", bbox_to_anchor=(0, 1))
    axes.set(xlabel="x [mm]", ylabel="y [mm]", aspect="equal")
    axes.grid(False)
    return fig, axes


def in_space(at, triangles, shown, held, colours):
    """Faces in the mean colour of their corners."""
    from matplotlib.ticker import MaxNLocator
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection
    fig = figure.pyplot().figure(figsize=(figure.WIDTH, 4.6))
    axes = fig.add_subplot(projection="3d", computed_zorder=False)
    mean = [sum(shown[v] for v in face) / 3 for face in triangles]
    axes.add_collection3d(Poly3DCollection([[at[v] for v in face] for face in triangles], facecolors=colours.to_rgba(mean), edgecolors="#00000030",
                                           linewidths=0.3))
    crosses = [at[v] for v in {v for face in triangles if faces_viewer(axes, [at[v] for v in face]) for v in face} & held]
    if crosses:
        axes.plot(*zip(*crosses), "kx", markersize=4, label="held", linestyle="none")
        axes.legend(loc="upper left")
    ends = [(min(part), max(part)) for part in zip(*at)]
    for axis, (low, high) in zip("xyz", ends):
        axes.set(**{f"{axis}lim": (low, high), f"{axis}label": f"{axis} [mm]"})
        getattr(axes, f"{axis}axis").set_major_locator(MaxNLocator(3 if axis == "z" else 5))
    axes.set_box_aspect([max(high - low, 1e-9) for low, high in ends])
    return fig, axes


def faces_viewer(axes, corners):
    """Whether the outside of a face is seen, its corners counter-clockwise from there."""
    (ax, ay, az), (bx, by, bz) = ([q - p for p, q in zip(corners[0], other)] for other in corners[1:])
    elevation, azimuth = math.radians(axes.elev), math.radians(axes.azim)
    return ((ay * bz - az * by) * math.cos(azimuth) * math.cos(elevation) + (az * bx - ax * bz) * math.sin(azimuth) * math.cos(elevation)
            + (ax * by - ay * bx) * math.sin(elevation)) > 0
