# SPDX-License-Identifier: Apache-2.0
"""Figures 4.7, 4.18, 4.20, 4.21, 4.22 and 4.24: what delay does to the force at a client, and compensation."""
import math

from common import figure
from common.program import point

from .made import WEBER, Numbers, percent_over, six

PI = math.pi
FREQUENCY = 0.5  # [Hz] of the hand
DELAYS = (0.0, 0.037, 0.075, 0.150)  # [s] round trips of figures 4.20 and 4.22
FREQUENCIES = [10.0 ** (-1 + 0.01 * i) for i in range(201)]  # 0.1 to 10 Hz
OBJECT = {"stiffness_N_per_m": 100, "damping_Ns_per_m": 2, "mass_kg": 0.1}  # of figures 4.18 to 4.24
MASS, STIFFNESS, FRICTION = 0.25, 700, 126  # the cube of 4.2.4.2; equation 4.31 gives the 18 ms of figure 4.6 with this friction
TICK = 1e-3


def decibels(value):
    return 20 * math.log10(value)


def omega(frequency):
    return 2 * PI * frequency


def rigid(round_trip, omegas):
    return point("impedance", object="rigid", omega_rad_per_s=omegas, round_trip_s=round_trip, mass_kg=MASS,
                 damping_Ns_per_m=FRICTION, stiffness_N_per_m=STIFFNESS)


def rigid_impedance(options):
    """Figure 4.7: client impedance of a pushed object over frequency."""
    out = Numbers("fig4.7", f"impedance at a client that pushes a rigid object of {MASS} kg against viscous friction ({FRICTION} N s/m)")
    curves, rows = [], []
    for r in (0.0, 0.018, 0.050, 0.100):
        found = rigid(r, [omega(f) for f in FREQUENCIES] + [1e-6])
        without, with_ = ([decibels(z) for z in found[which]] for which in ("without_Ns_per_m", "with_Ns_per_m"))
        curves.append((r, without[:-1], with_[:-1]))
        rows += [[f"{1e3 * r:g}", six(f), six(a), six(b)] for f, a, b in zip(FREQUENCIES, without, with_)]
        if r == 0:
            continue
        slow_without, slow_with = found["without_Ns_per_m"][-1], found["with_Ns_per_m"][-1]
        out.add(f"{1e3 * r:g} ms, slow motion, over zero delay", "%", percent_over(slow_without, FRICTION), 10.0 if r == 0.018 else None)
        out.add(f"{1e3 * r:g} ms with compensation, {found['reduced_stiffness_N_per_m']:.0f} N/m", "%",
                percent_over(slow_with, FRICTION), 0.0)
    return out.made(lambda: draw_rigid(curves), {"fig4.7": (["round_trip_ms", "frequency_Hz", "without_dB", "with_dB"], rows)})


def draw_rigid(curves):
    fig, panels = figure.panels(2)
    for number, (r, without, with_) in enumerate(curves):
        for axes, values in zip(panels, (without, with_)):
            axes.plot(FREQUENCIES, values, label=f"{1e3 * r:g} ms", **figure.style_of(number, marked=False))
    return finish_impedance(fig, panels, ("without compensation", "client stiffness reduced"))


def finish_impedance(fig, panels, titles):
    for axes, title in zip(panels, titles):
        axes.set(title=title, xscale="log", ylabel="impedance\n[dB of 1 N s/m]")
    panels[-1].set_xlabel("frequency of the motion [Hz]")
    ticks = (0.1, 0.2, 0.5, 1, 2, 5, 10)
    panels[-1].set_xticks(ticks, [f"{t:g}" for t in ticks])
    figure.legend(fig, panels, title="round trip")
    return fig


def deformable(round_trip, client_stiffness, omegas, client_damping=5):
    return point("impedance", object="deformable", msd=OBJECT, stiffness_N_per_m=340, client_stiffness_N_per_m=client_stiffness,
                 client_damping_Ns_per_m=client_damping, omega_rad_per_s=omegas, round_trip_s=round_trip, weber=WEBER)


def undamped_stiffness(round_trip):
    """Equation 4.47 for the hand's frequency."""
    return 340 if round_trip == 0 else deformable(round_trip, 340, [omega(FREQUENCY)])["reduced_stiffness_undamped_N_per_m"][0]


def error_at(round_trip, client_stiffness):
    """[%] of the client's impedance at the hand's frequency, over the server's."""
    found = deformable(round_trip, client_stiffness, [omega(FREQUENCY)])
    return percent_over(found["client_Ns_per_m"][0], found["server_Ns_per_m"][0])


def over_frequency(stiffness_of):
    """Impedances with the client stiffness that belongs to each round trip: curves, and the rows of a table."""
    curves, rows = [], []
    for r in DELAYS:
        found = deformable(r, stiffness_of(r), [omega(f) for f in FREQUENCIES])
        exact, slow, server = ([decibels(z) for z in found[of]] for of in ("client_Ns_per_m", "slow_client_Ns_per_m", "server_Ns_per_m"))
        curves.append((r, exact, slow, server))
        rows += [[f"{1e3 * r:g}", *map(six, row)] for row in zip(FREQUENCIES, exact, slow, server)]
    return curves, (["round_trip_ms", "frequency_Hz", "client_dB", "approximated_dB", "server_dB"], rows)


def draw_deformable(curves):
    fig, panels = figure.panels(2)
    for which, axes in enumerate(panels):
        axes.plot(FREQUENCIES, curves[0][3], color="0.7", linewidth=3, label="server")
        for number, curve in enumerate(curves):
            axes.plot(FREQUENCIES, curve[1 + which], label=f"client, {1e3 * curve[0]:g} ms", **figure.style_of(number, marked=False))
    return finish_impedance(fig, panels, ("exact", "approximated for slow motion"))


def without_compensation(options):
    """Figure 4.20: impedance of a deformable object at a client."""
    out = Numbers("fig4.20", "impedance of a deformable object at a client, k_o 100 N/m, k 340 N/m, b_c 5 N s/m")
    curves, table = over_frequency(lambda round_trip: 340)
    for f, thesis in ((0.5, 37.5), (1, 19), (2, None)):  # that at 1 Hz stands in 4.3.4.2
        delay = deformable(0, 340, [omega(f)])["tolerable_delay_s"][0]
        out.add(f"tolerable round trip at {f:g} Hz, c = 10 % (eq. 4.45)", "ms", 1e3 * (delay or 0), thesis)
    slow = lambda round_trip, damping: decibels(deformable(round_trip, 340, [omega(FREQUENCY)], damping)["slow_client_Ns_per_m"][0])
    out.add("37 ms at 0.5 Hz, over the server, with K_i for K_i(s) (fig. 4.20b)", "dB", slow(0.037, 5) - slow(0, 0), 0.82)
    out.add("37 ms at 0.5 Hz, over the server", "%", error_at(0.037, 340))
    out.add("75 ms at 0.5 Hz, over the server", "%", error_at(0.075, 340), 39.6)
    return out.made(lambda: draw_deformable(curves), {"fig4.20": table})


def with_compensation(options):
    """Figure 4.22: the same with the client stiffness reduced for 0.5 Hz."""
    out = Numbers("fig4.22", "the same with the client stiffness reduced for 0.5 Hz")
    curves, table = over_frequency(undamped_stiffness)
    error = lambda round_trip: error_at(round_trip, undamped_stiffness(round_trip))
    out.add("stiffness for 75 ms (eq. 4.47)", "N/m", undamped_stiffness(0.075))
    out.add("75 ms at 0.5 Hz, over the server (eq. 4.47)", "%", error(0.075), 3.2)
    reduced = deformable(0.075, 340, [omega(FREQUENCY)])["reduced_stiffness_N_per_m"][0]
    out.add("75 ms at 0.5 Hz, over the server (eq. 4.46)", "%", error_at(0.075, reduced), 3.0)
    out.add("37 ms at 0.5 Hz, over the server (eq. 4.47)", "%", error(0.037))
    out.add("150 ms at 0.5 Hz, over the server (eq. 4.47)", "%", error(0.150))
    return out.made(lambda: draw_deformable(curves), {"fig4.22": table})


def press(duration, users, compensation=None):
    """`users`: (presses, round trip [ms]) of each; a press is begin, hold, end [s] and depth [m]."""
    more = {} if compensation is None else {"compensation": compensation}
    return point("press", msd=OBJECT, stiffness_N_per_m=340, client_damping_Ns_per_m=5, frequency_Hz=FREQUENCY, duration_s=duration,
                 users=[{"presses": presses, "round_trip_ms": round_trip} for presses, round_trip in users], **more)["users"]


def one_press(options):
    """Figure 4.21: a user presses, holds and lets go, at several round trips."""
    out = Numbers("fig4.21", "a user presses at 0.5 Hz, holds still and lets go")
    round_trips = (0, 37, 75, 150)  # [ms]
    runs = [press(2.8, [([[0.2, 0.7, 2, 0.03]], r)])[0] for r in round_trips]
    server, clients = runs[0]["server_N"], [run["client_N"] for run in runs]
    for r, client in zip(round_trips[1:], clients[1:]):
        out.add(f"{r} ms: peak of the force over that of the server", "%", percent_over(max(client), max(server)),
                10.0 if r == 37 else None)
    rows = [[f"{TICK * i:.3f}", *map(six, values)] for i, values in enumerate(zip(server, *clients))]
    head = ["time_s", "server_N", *[f"client_{r}ms_N" for r in round_trips]]
    return out.made(lambda: draw_press(round_trips, server, clients), {"fig4.21": (head, rows)})


def draw_press(round_trips, server, clients):
    fig, (axes,) = figure.panels()
    t = [TICK * i for i in range(len(server))]
    axes.plot(t, server, color="0.7", linewidth=3.4, label="server")
    for number, (r, client) in enumerate(zip(round_trips, clients)):
        axes.plot(t, client, label=f"client, round trip {r} ms", **figure.style_of(number, marked=False))
    axes.set(xlabel="time [s]", ylabel="force [N]")
    axes.legend()
    return fig


PRESSES = ([[0.5, 1, 4, 0.03], [5.5, 6, 7.5, 0.03]], [[2, 2.5, 6.8, 0.03]])  # of the two users of figures 4.18 and 4.24
ROUND_TRIPS = (80, 60)  # [ms]
WHILES = (("user 1 presses alone", 0, 500, 1900), ("user 2 presses beside user 1", 1, 2000, 3900),
          ("user 1 presses beside user 2", 0, 5500, 6700), ("user 1 only holds", 0, 2000, 3900))  # user, begin, end [ms]


def press_both(delays, compensation=None):
    return press(8.5, [(presses, r if delays else 0) for presses, r in zip(PRESSES, ROUND_TRIPS)], compensation)


def fraction_outside(force, reference):
    """[%] of the ticks in contact in which the force is further than c from the reference of the same tick."""
    contact = [(f, r) for f, r in zip(force, reference) if f != 0 or r != 0]
    return 100 * sum(abs(f - r) > WEBER * r for f, r in contact) / len(contact) if contact else 0


def two_users(options):
    """Figure 4.24: two users press the same object, with compensation and without."""
    out = Numbers("fig4.24", "two users press the same object, round trips 80 ms and 60 ms", ("without", "lambda 0.01", "lambda 0.1"))
    reference, runs = press_both(False), [press_both(True, compensation) for compensation in (None, 0.01, 0.1)]
    for name, user, begin, end in WHILES:
        server = reference[user]["server_N"][begin:end]
        clients = [run[user]["client_N"][begin:end] for run in runs]
        out.add(f"{name}: peak over that of the server", "%", *[percent_over(max(client), max(server)) for client in clients])
        out.add(f"{name}: time outside +-10 %", "%", *[fraction_outside(client, server) for client in clients])
    columns = [reference[user]["server_N"] if run is None else run[user]["client_N"] for user in (0, 1) for run in (None, *runs)]
    head = ["time_s"] + [f"{of}_{user}_N" for user in (1, 2) for of in ("server", "without", "lambda_0.01", "lambda_0.1")]
    rows = [[six(TICK * i), *map(six, row)] for i, row in enumerate(zip(*columns))]
    return out.made(lambda: draw_two(columns), {"fig4.24": (head, rows)})


def draw_two(columns):
    fig, panels = figure.panels(2)
    t = [TICK * i for i in range(len(columns[0]))]
    for user, axes in enumerate(panels):
        server, without, *compensated = columns[4 * user:4 * user + 4]
        axes.fill_between(t, [(1 - WEBER) * f for f in server], [(1 + WEBER) * f for f in server], color="0.85", linewidth=0,
                          label="server, ±10 %")
        for number, (label, force) in enumerate(zip(("client, no compensation", "client, λ = 0.01", "client, λ = 0.1"),
                                                    (without, *compensated))):
            axes.plot(t, force, label=label, **figure.style_of(number, marked=False))
        axes.set(title=f"user {user + 1}, round trip {ROUND_TRIPS[user]} ms", ylabel="force [N]")
    panels[-1].set_xlabel("time [s]")
    figure.legend(fig, panels)
    return fig


def two_users_delayed(options):
    """Figure 4.18: what delay alone does to them."""
    out = Numbers("fig4.18", "two users press the same object, round trips 80 ms and 60 ms, without compensation", ("delayed",))
    reference, delayed = press_both(False), press_both(True)
    for name, user, begin, end in WHILES:
        now, then = (max(run[user]["client_N"][begin:end]) for run in (delayed, reference))
        out.add(f"{name}: peak over that without delay", "%", percent_over(now, then))
    devices = [[1e3 * max(0.0, depth) for depth in user["depth_m"]] for user in reference]
    columns = devices + [run[user]["client_N"] for user in (0, 1) for run in (reference, delayed)]
    head = ["time_s", "device_1_mm", "device_2_mm"] + [f"{of}_{user}_N" for user in (1, 2) for of in ("no_delay", "delayed")]
    rows = [[six(TICK * i), *map(six, row)] for i, row in enumerate(zip(*columns))]
    return out.made(lambda: draw_delayed(columns), {"fig4.18": (head, rows)})


def draw_delayed(columns):
    fig, panels = figure.panels(3)
    t = [TICK * i for i in range(len(columns[0]))]
    for number, depth in enumerate(columns[:2]):
        panels[0].plot(t, depth, label=f"device of user {number + 1}", **figure.style_of(number, marked=False))
    panels[0].set(ylabel="depth [mm]")
    panels[0].legend(loc="upper right")
    for user, axes in enumerate(panels[1:]):
        for number, (label, force) in enumerate(zip(("without delay", f"round trip {ROUND_TRIPS[user]} ms"),
                                                    columns[2 + 2 * user:4 + 2 * user])):
            axes.plot(t, force, label=label, **figure.style_of(number, marked=False))
        axes.set(title=f"user {user + 1}", ylabel="force [N]")
        axes.legend(loc="upper right")
    panels[-1].set_xlabel("time [s]")
    return fig
