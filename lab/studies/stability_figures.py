# SPDX-License-Identifier: Apache-2.0
"""Figures of `tactus bench stability`, each from the series of one study."""
from common import figure


def of(studies):
    """(name, caption, function that draws) of every figure whose series the studies have."""
    out = []
    for name, caption, needed, draw in FIGURES:
        for study in studies:
            if name.startswith(study["study"] + "-") and all(series in study["series"] for series in needed):
                series = {key: study["series"][key]["rows"] for key in needed}
                out.append((name, caption, lambda draw=draw, series=series: draw(series)))
    return out


def columns(rows, x, y, scale=1.0):
    """Two columns without the rows that have no value."""
    points = [(scale * row[x], row[y]) for row in rows if row[y] is not None]
    return [a for a, _ in points], [b for _, b in points]


def theory_and_points(axes, rows, number, label, theory=1, measured=2):
    """The formula as a line, what was measured as marks."""
    style = figure.style_of(number)
    axes.plot(*columns(rows, 0, theory), color=style["color"], linestyle=style["linestyle"], label=label)
    axes.plot(*columns(rows, 0, measured), color=style["color"], linestyle="none", marker=style["marker"])


def jury_limit(series):
    fig, (axes,) = figure.panels()
    for number, (name, label) in enumerate([
            ("over-n-heavy", "k_o 1000 N/m, b_o 10 N s/m, m_o 100 g"), ("over-n-figure", "k_o 100 N/m, b_o 1 N s/m, m_o 10 g "
                                                                                         "(figure 4.16)"),
            ("over-n-linear", "the same, surface approached linearly"), ("over-n-vertex", "vertex of the slab alone, 4.5 g")]):
        theory_and_points(axes, series[name], number, label)
    axes.axvline(1000 / 60, color="#888888", linestyle="--", linewidth=0.8)
    axes.annotate("60 Hz", (1000 / 60, 0.03), xycoords=("data", "axes fraction"), ha="right", fontsize=8, color="#666666")
    figure.logarithmic(axes)
    ticks = [1, 2, 3, 5, 10, 20, 50]
    axes.set_xticks(ticks, [str(tick) for tick in ticks], minor=False)
    axes.minorticks_off()
    axes.set_xlabel("N = T_n / T_s (deformation every N ms)")
    axes.set_ylabel("largest sum of k_s [N/m]")
    axes.legend(loc="lower left", title="lines: Jury's criterion; marks: step responses", alignment="left", bbox_to_anchor=(0, 1))
    return fig


def jury_steps(series):
    fig, panels = figure.panels(2)
    for axes, name, title in zip(panels, ("figure-4.16-a", "figure-4.16-b"), ("(a) sum of k_s = 720 N/m", "(b) sum of k_s = 680 "
                                                                                                          "N/m")):
        x, y = columns(series[name], 0, 1, 1e3)
        axes.step(x, y, where="post", color=figure.COLOURS[0])
        axes.axvline(320, color="#888888", linestyle="--", linewidth=0.8)
        axes.set_title(title, loc="left")
        axes.set_ylabel("surface x_o [mm]")
        axes.set_xlim(0, 800)
    panels[0].set_ylim(-6, 8)
    panels[1].set_ylim(0, 2.2)
    panels[0].annotate("second user", (326, 0.9), xycoords=("data", "axes fraction"), fontsize=8, color="#666666")
    panels[1].set_xlabel("time [ms]")
    return fig


def device_damping(series):
    fig, (axes,) = figure.panels()
    for number, (name, rate) in enumerate([("damping-1khz", "1 kHz"), ("damping-60hz", "60 Hz")]):
        style = figure.style_of(number)
        theory_and_points(axes, series[name], number, f"b_d = k_o T / 2 at {rate}; marks: passivity observer")
        axes.plot(*columns(series[name], 0, 3), color=style["color"], linestyle="none", marker="x", label=f"device alone "
                                                                                                          f"stable, {rate}")
    figure.logarithmic(axes)
    axes.set_xlim(0.04, 12)
    axes.set_ylim(3, 50000)
    axes.set_xlabel("damping of the device b_d [N s/m]")
    axes.set_ylabel("largest wall stiffness k_o [N/m]")
    axes.legend(loc="upper left")
    return fig


def z_width(series):
    rows, period, b_d = series["z-width"], 1e-3, 0.35
    fig, (axes,) = figure.panels()
    walls = [0.01 * i for i in range(801)]
    axes.plot(walls, [2 * (b_d + b) / period for b in walls], color=figure.COLOURS[0], label="b_d + b_o = k_o T / 2 (slow "
                                                                                             "motion, eq. 2.4)")
    slower = [b for b in walls if b < b_d]
    axes.plot(slower, [2 * (b_d - b) / period for b in slower], color=figure.COLOURS[1], linestyle="--",
              label="b_d = k_o T / 2 + b_o (every motion)")
    for column, number, label, joined in [(1, 0, "passive in slow motion, observer", False), (2, 1, "passive at 500 Hz, "
                                                                                                    "observer", False),
                                          (4, 2, "stable in a loose grip", True), (3, 3, "stable, device alone", True)]:
        style = figure.style_of(number)
        points = [(row[0], row[column]) for row in rows if row[column] is not None and row[column] > 0]
        axes.plot([x for x, _ in points], [y for _, y in points], color=style["color"], marker=style["marker"],
                  linestyle=style["linestyle"] if joined else "none", label=label)
    figure.logarithmic(axes, "y")
    axes.set_xlim(0, 8)
    axes.set_ylim(100, 200000)
    axes.set_xlabel("damping of the wall b_o [N s/m]")
    axes.set_ylabel("stiffness of the wall k_o [N/m]")
    axes.legend(loc="lower right", ncol=2, fontsize=7)
    return fig


def client_forces(series):
    titles = ["(a) barely held, no delay", "(b) barely held, 100 ms", "(c) barely held, 100 ms, b_c = 5 N s/m",
              "(d) normal grip, 100 ms",
              "(e) barely held, 100 ms, k_o = 1000 N/m"]
    fig, grid = figure.pyplot().subplots(5, 2, sharex=True, figsize=(figure.WIDTH, 8))
    for (force, energy), name, title in zip(grid, "abcde", titles):
        for axes, column in ((force, 1), (energy, 2)):
            axes.plot(*columns(series[name], 0, column), color=figure.COLOURS[1 if name == "b" else 0], linewidth=1)
            axes.set_xlim(0, 4)
        force.set_title(title, loc="left")
        force.set_ylim(bottom=0)
        force.set_ylabel("force [N]")
        energy.set_ylabel("energy [mJ]")
        energy.axhline(0, color="#888888", linewidth=0.8)
    for axes in grid[-1]:
        axes.set_xlabel("time [s]")
    return fig


METHODS = ["velocity-verlet", "backward-euler", "newmark", "tr-bdf2", "projective"]
VERDICTS = [("stable", 0, "o"), ("stable, tetrahedra inside out", 4, "^"), ("stopped with an error", 1, "x")]


def fem_map(series):
    fig, grid = figure.pyplot().subplots(2, 3, sharex=True, sharey=True, figsize=(figure.WIDTH, 4.4))
    cells = list(grid.flat)
    for axes, method in zip(cells, METHODS):
        for verdict, (label, colour, marker) in enumerate(VERDICTS):
            points = [row for row in series["map-" + method] if row[2] == verdict]
            axes.plot([row[0] for row in points], [row[1] for row in points], linestyle="none", color=figure.COLOURS[colour],
                      marker=marker,
                      markersize=2.8, label=label)
        axes.plot(*columns(series["map-limit"], 0, 1), color="black", label="h ω_max = 2")
        figure.logarithmic(axes)
        axes.set_title(method, loc="left")
        axes.set_xlim(50, 2e10)
        axes.set_ylim(5e-7, 0.2)
    for axes in (cells[0], cells[3]):
        axes.set_ylabel("step h [s]")
    for axes in (cells[2], cells[3], cells[4]):
        axes.set_xlabel("Young's modulus E [Pa]")
    cells[2].tick_params(labelbottom=True)
    cells[5].axis("off")
    cells[5].legend(*cells[0].get_legend_handles_labels(), loc="center left")
    return fig


FIGURES = [
    ("jury-limit", "Largest sum of server stiffnesses over the deformation rate: measured by step responses (points), Jury's "
                   "criterion "
     "(lines).", ["over-n-figure", "over-n-linear", "over-n-heavy", "over-n-vertex"], jury_limit),
    ("jury-figure-4.16", "Step responses of thesis figure 4.16: above and below the critical sum of 700 N/m; the second user "
                         "begins at "
     "320 ms.", ["figure-4.16-a", "figure-4.16-b"], jury_steps),
    ("wall-device-damping", "Largest wall stiffness over the damping of the device, eq. 2.3 (lines), with the passivity "
                            "observer (points); "
     "crosses: the device alone against the wall, stable.", ["damping-1khz", "damping-60hz"], device_damping),
    ("wall-z-width", "Which stiffness and damping a wall may have at 1 kHz with a device of 0.35 N s/m: measured (points), eqs. "
                     "2.3 and 2.4 "
     "(lines).", ["z-width"], z_width),
    ("client-figure-4.17", "Thesis figure 4.17: force on the hand and energy at the client's port. (a) no delay; (b) 100 ms; "
                           "(c) 100 ms, "
     "damped by the client; (d) 100 ms, normal grip; (e) 100 ms, stiffer object.", ["a", "b", "c", "d", "e"], client_forces),
    ("fem-map", "Which step size each method gets through over 1000 steps, as the material stiffens: a slab displaced by 2 mm "
                "and let go.",
     ["map-limit", *("map-" + method for method in METHODS)], fem_map),
]
