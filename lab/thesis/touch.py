# SPDX-License-Identifier: Apache-2.0
"""Figures of chapter 4 that show what users of a scene feel behind a network: 4.1, 4.2, 4.6, 4.8, 4.10 to 4.12, 4.25 and 4.27.

Hands are virtual and feel what is rendered, so that a motion is not the same with delay and without, as with people.
"""
from common import figure

from .made import WEBER, Numbers, added, percent_over, points, six

TICK = 1e-3


def constant(round_trip):
    """There and back alike.   in  [us]"""
    return {"delay_us": round_trip // 2}


# The network of 4.2.4.3 and 4.2.4.4, one way: 25 ms and a gamma-distributed delay that keeps its value for a while.
VARYING = {"delay_us": 25_000, "gamma_mean_us": 12_000, "gamma_deviation_us": 8_000, "gamma_piece_us": 500_000}
CIRCLES = {"scene": "membrane", "link": constant(100_000), "duration_s": 12}
SCENES = {
    "fig4.1": ("two users push a block side by side, round trip 100 ms, without compensation",
               {"scene": "jenga-together", "link": constant(100_000)}),
    "fig4.2": ("a user presses a membrane and circles over it, round trip 100 ms, without compensation", CIRCLES),
    "fig4.8": ("the task of the subjects: a cube is pushed forth and back, round trip 100 ms",
               {"scene": "push-cube", "link": constant(100_000)}),
    "fig4.10": ("two users push a block side by side, round trip 100 ms", {"scene": "jenga-together", "link": constant(100_000)}),
    "fig4.11": ("one user pushes a block, another presses on it; varying round trip", {"scene": "jenga-press", "link": VARYING}),
    "fig4.12": ("one user pushes a block, another stops it; varying round trip", {"scene": "jenga-against", "link": VARYING}),
    "fig4.25": ("two users press a one-dimensional object, round trip 50 ms",
                {"scene": "msd-1d", "link": constant(50_000), "msd": {"stiffness_N_per_m": 100, "damping_Ns_per_m": 2, "mass_kg": 0.1}}),
    "fig4.27": ("a user presses a membrane and circles over it, round trip 100 ms", CIRCLES),
}
WITHOUT_COMPENSATION = ("fig4.1", "fig4.2")
WHAT = (("mean force over that without delay", "%"), ("peak of the force over that without delay", "%"),
        ("time outside +-10 % of the force without delay", "%"), ("least energy that the device has put in", "mJ"))


def touch(name):
    """The function that makes one of SCENES."""
    def make(options):
        title, request = SCENES[name]
        clients = ["none"] if name in WITHOUT_COMPENSATION else ["none", "stiffness"]
        runs = points(options, "reproduce", "touch",
                      [request | {"clients": clients, "seed": seed, "ticks": seed == 1} for seed in range(1, options.seeds + 1)])
        columns = ["without", "worst seed", "with", "worst seed with"][:2 * len(clients)]
        out = Numbers(name, title, columns)
        for user, called in enumerate(runs[0]["users"]):
            by_client = [effects([run["runs"][c]["users"][user] for run in runs]) for c in range(len(clients))]
            for i, (what, unit) in enumerate(WHAT):
                out.add(f"{called}: {what}", unit, *[f(effect[i]) for effect in by_client for f in (average, farthest)])
        trips = [1e3 * trip for run in runs for user in run["runs"][0]["users"] for trip in user["round_trip_s_each_100_ticks"][10:]]
        out.add("round trip as the client sees it", "ms", average(trips), farthest(trips))
        first = runs[0]
        return out.made(lambda: draw(first), {name: as_table(first)})
    return make


def effects(runs):
    """Of a user, one value per seed: mean, peak, time outside [%], least energy [mJ]. In some seeds the hand misses the object."""
    met = [run for run in runs if run["reference_mean_N"] != 0]
    return ([percent_over(run["mean_N"], run["reference_mean_N"]) for run in met],
            [percent_over(run["peak_N"], run["reference_peak_N"]) for run in met],
            [100 * run["outside"] for run in met], [1e3 * run["lowest_energy_J"] for run in runs])


def average(values):
    return added(values) / len(values) if values else 0


def farthest(values):
    return max(values, key=abs, default=0)


def ticks_of(first, user):
    """Of seed 1: force without delay, delayed, compensated, stiffness with compensation, round trip [ms]."""
    reference, delayed = first["reference"]["ticks"][user], first["runs"][0]["ticks"][user]
    compensated = first["runs"][1]["ticks"][user] if len(first["runs"]) > 1 else None
    zeros = [0.0] * len(reference["force_N"])
    return (reference["force_N"], delayed["force_N"], compensated["force_N"] if compensated else zeros,
            compensated["stiffness_N_per_m"] if compensated else zeros, [1e3 * trip for trip in delayed["round_trip_s"]])


def as_table(first):
    names = ("without_delay_N", "delayed_N", "compensated_N", "stiffness_N_per_m", "round_trip_ms")
    columns = [column for user in range(len(first["users"])) for column in ticks_of(first, user)]
    return (["time_s"] + [f"{user}_{name}" for user in first["users"] for name in names],
            [[six(TICK * i), *map(six, row)] for i, row in enumerate(zip(*columns))])


def draw(first):
    fig, panels = figure.panels(2 * len(first["users"]) if len(first["runs"]) > 1 else len(first["users"]))
    forces = panels[::2] if len(first["runs"]) > 1 else panels
    for user, (name, axes) in enumerate(zip(first["users"], forces)):
        reference, delayed, compensated, stiffness, trips = ticks_of(first, user)
        t = [TICK * i for i in range(len(reference))]
        axes.fill_between(t, [(1 - WEBER) * f for f in reference], [(1 + WEBER) * f for f in reference], color="0.8", linewidth=0,
                          label="without delay, ±10 %")
        axes.plot(t, delayed, label="delayed", color=figure.COLOURS[1], linestyle="--", linewidth=1.1)
        axes.set(title=f"user “{name}”", ylabel="force [N]")
        if len(first["runs"]) > 1:
            axes.plot(t, compensated, label="delayed, compensated", color=figure.COLOURS[0], linewidth=1.1)
            draw_stiffness(panels[2 * user + 1], t, stiffness, trips)
    panels[-1].set_xlabel("time [s]")
    figure.legend(fig, panels)
    return fig


def draw_stiffness(axes, t, stiffness, trips):
    axes.plot(t, [k or float("nan") for k in stiffness], label="stiffness that the client renders", color=figure.COLOURS[2], linestyle="-.")
    axes.set_ylabel("stiffness [N/m]")
    axes.set_ylim(bottom=0)
    other = axes.twinx()
    other.plot(t, trips, color="black", linestyle=":")
    axes.plot([], [], color="black", linestyle=":", label="round trip (right axis)")
    other.set_ylabel("round trip [ms]")
    other.set_ylim(bottom=0)
    other.grid(False)
    other.spines["right"].set_visible(True)


BOUND = 0.018  # [s] of the thesis's figure 4.6, at which the speed makes the force 10 % larger (eq. 4.31)
ROUND_TRIPS = (18_000, 25_000, 50_000, 100_000)  # [us]
JUMP = 2_800_000  # [us] when the delay jumps in the thesis's figure
PUSH = {"scene": "jenga-together", "unnoticed_round_trip_s": BOUND, "clients": ["none", "stiffness"], "ticks": True}


def constant_push(options):
    """Figure 4.6: forces at constant speed: the steady state, which the models describe; and after jumps of the delay."""
    jumps = (20_000, 50_000, 100_000)
    # What a session takes for its delay is the least of 10 s: a longer one acts after so long.
    requests = [PUSH | {"duration_s": 5, "link": constant(r)} for r in ROUND_TRIPS]
    requests += [PUSH | {"duration_s": 20, "link": constant(50_000) | {
        "recorded_us": [[0, 0], [JUMP, by // 2], [3_600_000_000, 0]]}} for by in jumps]
    found = points(options, "reproduce", "touch", requests)
    steady_runs, jump_runs = found[:len(ROUND_TRIPS)], found[len(ROUND_TRIPS):]
    speed = steady_runs[0]["speed_m_per_s"]
    out = Numbers("fig4.6", f"two users push a block side by side at constant {1e3 * speed:.2f} mm/s", ("without", "with", "thesis without"))
    for r, run in zip(ROUND_TRIPS, steady_runs):
        reference = steady(run["reference"])
        out.add(f"{r // 1000} ms: steady force over that without delay", "%",
                *[percent_over(steady(of), reference) for of in run["runs"]], 10.0 if r == 18_000 else None)
    for by, run in zip(jumps, jump_runs):
        after = [after_jump(of, run["reference"]) for of in run["runs"]]
        out.add(f"50 ms, then {(50_000 + by) // 1000} ms: farthest from the force without delay", "%", *[most for most, _ in after])
        out.add(f"50 ms, then {(50_000 + by) // 1000} ms: time more than 10 % from it", "ms", *[long for _, long in after])
    columns = [force(steady_runs[0]["reference"])] + [force(of) for run in steady_runs for of in run["runs"]]
    head = ["time_s", "0ms_N"] + [f"{r // 1000}ms{which}_N" for r in ROUND_TRIPS for which in ("", "_with")]
    rows = [[six(TICK * i), *map(six, row)] for i, row in enumerate(zip(*columns))]
    return out.made(lambda: draw_push(columns), {"fig4.6": (head, rows)})


def force(of):
    """[N] of the first user."""
    return of["ticks"][0]["force_N"]


def steady(of):
    """[N] mean of the last second."""
    return added(force(of)[-1000:]) / 1000


def after_jump(of, reference):
    """How far the force is off at most [%], and for how long more than c [ms]."""
    off = [a / b - 1 for a, b in zip(force(of)[JUMP // 1000:], force(reference)[JUMP // 1000:])]
    return 100 * max(off, key=abs), float(sum(abs(o) > WEBER for o in off))


def draw_push(columns):
    fig, panels = figure.panels(2)
    t = [TICK * i for i in range(len(columns[0]))]
    for which, (axes, title) in enumerate(zip(panels, ("without compensation", "with compensation"))):
        axes.plot(t, columns[0], color="0.7", linewidth=3, label="without delay")
        for number, r in enumerate(ROUND_TRIPS):
            axes.plot(t, columns[1 + 2 * number + which], label=f"round trip {r // 1000} ms", **figure.style_of(number, marked=False))
        axes.set(title=title, ylabel="force of the first user [N]")
    panels[-1].set_xlabel("time [s]")
    figure.legend(fig, panels)
    return fig
