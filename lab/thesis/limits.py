# SPDX-License-Identifier: Apache-2.0
"""Figures of chapter 4 beside those of forces: the delay that varies (4.13a), limits of stability (4.16, 4.17), the stiffness of a
surface (4.23)."""
import math
import statistics

from common import figure, surface
from common.program import point

from .made import Numbers, added, six
from .touch import VARYING

BIN, FIRST, LAST = 2, 50, 130  # [ms] of the histogram


def gamma_density(x, shape, scale, start):
    """Of a gamma distribution of this shape and scale [ms] that begins at `start`."""
    t = (x - start) / scale
    return math.exp((shape - 1) * math.log(t) - t - math.lgamma(shape)) / scale if t > 0 else 0


def varying_delay(options):
    """Figure 4.13a: round trips of datagrams sent each 10 ms for an hour and answered at once."""
    times = point("round-trips", link=VARYING, count=360_000)["round_trip_ms"]
    fixed, mean = 2e-3 * VARYING["delay_us"], 2e-3 * VARYING["gamma_mean_us"]
    shape = 2 * (VARYING["gamma_mean_us"] / VARYING["gamma_deviation_us"]) ** 2  # of the sum of two
    scale = mean / shape
    middle = added(times) / len(times)
    out = Numbers("fig4.13a", "round trips over the network with varying delay", ("here", "gamma"))
    out.add("mean", "ms", middle, fixed + mean)
    out.add("standard deviation", "ms", math.sqrt(added((t - middle) * (t - middle) for t in times) / len(times)),
            scale * math.sqrt(shape))
    out.add("shortest", "ms", min(times), fixed)
    counts = [0] * ((LAST - FIRST) // BIN)
    for t in times:
        if FIRST <= t < LAST:
            counts[int((t - FIRST) / BIN)] += 1
    rows = [(FIRST + BIN * (i + 0.5), count / BIN / len(times)) for i, count in enumerate(counts)]
    rows = [(at, fraction, gamma_density(at, shape, scale, fixed)) for at, fraction in rows]
    return out.made(lambda: draw_histogram(rows),
                    {"fig4.13a": (["round_trip_ms", "fraction_per_ms", "gamma_per_ms"], [[f"{a:g}", six(b), six(c)] for a, b, c in rows])})


def draw_histogram(rows):
    fig, (axes,) = figure.panels()
    at, fraction, gamma = zip(*rows)
    axes.bar(at, [100 * s for s in fraction], BIN, color="0.8", edgecolor="0.4", linewidth=0.5, label="simulated network")
    axes.plot(at, [100 * g for g in gamma], color="black", label="gamma distribution")
    axes.set(xlabel="round trip [ms]", ylabel="fraction of the round trips [% per ms]")
    axes.legend()
    return fig


def stability(name, title, case, subjects, unit, series, draw):
    """A figure of a study of stability: numbers of the rows whose subject begins so, and series."""
    made = point("stability", case=case, short=True)
    out = Numbers(name, title, ("here",))
    for row in made["rows"]:
        if row["subject"].startswith(subjects) and row["measured"] is not None:
            called = ", ".join([row["subject"], *[f"{p['name']} {p['value']:g} {p['unit']}" for p in row["parameters"]]])
            out.add(f"{called}: {row['verdict']}, {row['quantity']}", unit, row["measured"])
    found = {short: made["series"][long]["rows"] for short, long in series.items()}
    rows = [[short, six(row[0]), six(row[1])] for short, of in found.items() for row in of]
    return out.made(lambda: draw(found), {name: (["series", "x", "y"], rows)})


def jury(options):
    """Figure 4.16: step responses below and above the critical stiffness."""
    return stability("fig4.16", "two users step onto an object near the critical stiffness of eq. 4.38, 700 N/m", "jury", "figure 4.16",
                     "1", {"figure_4_16_a": "figure-4.16-a", "figure_4_16_b": "figure-4.16-b"}, draw_jury)


def draw_jury(found):
    fig, panels = figure.panels(2)
    for number, (axes, title, rows) in enumerate(zip(panels, ("(a) sum of k_s = 720 N/m", "(b) sum of k_s = 680 N/m"), found.values())):
        axes.step([1e3 * row[0] for row in rows], [row[1] for row in rows], where="post", color=figure.COLOURS[number], linewidth=1)
        axes.axvline(320, color="0.4", linestyle=":", linewidth=1, label="the second user begins")
        axes.set(title=title, ylabel="surface x_o [mm]", xlim=(0, 800))
        axes.legend(loc="upper left")
    panels[0].set_ylim(-6, 8)
    panels[1].set_ylim(0, 2.2)
    panels[-1].set_xlabel("time [ms]")
    return fig


def client(options):
    """Figure 4.17: grip, damping and object stiffness at a client."""
    return stability("fig4.17", "grip, damping and object stiffness: force and energy at a client, 100 ms", "client", "(", "mJ",
                     {letter: letter for letter in "abcde"}, draw_client)


CASES = ("(a) barely held, no delay", "(b) barely held, 100 ms", "(c) barely held, 100 ms, b_c = 5 N s/m", "(d) normal grip, 100 ms",
         "(e) barely held, 100 ms, k_o = 1000 N/m")


def draw_client(found):
    fig, panels = figure.panels(5, height=8.6)
    for axes, title, rows in zip(panels, CASES, found.values()):
        t = [row[0] for row in rows]
        axes.plot(t, [row[1] for row in rows], color=figure.COLOURS[0], linewidth=1.1, label="force on the hand")
        axes.plot([], [], color=figure.COLOURS[1], linestyle="--", label="energy that the device has put in (right axis)")
        axes.set(title=title, ylabel="force [N]", xlim=(0, 4))
        other = axes.twinx()
        other.plot(t, [row[2] for row in rows], color=figure.COLOURS[1], linestyle="--", linewidth=1.1)
        other.set_ylabel("energy [mJ]")
        other.grid(False)
        other.spines["right"].set_visible(True)
    panels[-1].set_xlabel("time [s]")
    panels[0].legend(loc="lower right")
    return fig


def stiffness(options):
    """Figure 4.23: the stiffness of the membrane."""
    membrane = point("stiffness-map", scene="membrane")["deformables"][0]
    at, values = membrane["vertices_m"], membrane["stiffness_N_per_m"]
    known = [(v, k) for v, k in zip(at, values) if k is not None]
    left, right = ([k for v, k in known if (v[0] < 0) == is_left] for is_left in (True, False))
    out = Numbers("fig4.23", "stiffness of the membrane at each vertex of its surface", ("here",))
    out.add("median of the half at x < 0", "N/m", statistics.median_high(left))
    out.add("median of the half at x > 0", "N/m", statistics.median_high(right))
    out.add("softest", "N/m", min(left + right))
    rows = [[membrane["name"], i, *map(repr, v), "inf" if k is None else repr(k)] for i, (v, k) in enumerate(zip(at, values))]
    head = ["deformable", "vertex", "x_m", "y_m", "z_m", "stiffness_N_per_m"]
    return out.made(lambda: surface.draw(membrane, ""), {"fig4.23": (head, rows)})
