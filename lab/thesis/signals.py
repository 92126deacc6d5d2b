# SPDX-License-Identifier: Apache-2.0
"""Figures 3.3 and 3.11: a push along x, tick by tick."""
import statistics

from common import figure, table
from common.program import point

from .made import DEGREE, Made, lines

TICK = 1e-3  # [s]


def push(options, deadband, interpolation):
    """Of the scene push-1dof, and 1.5 s of standing still for the heartbeat."""
    return point("push", scene="push-1dof", deadband=deadband, interpolation=interpolation, visual_position_m=0.01 * options.length_unit,
                 visual_rotation_rad=4 * DEGREE, grip=options.grip, seed=1, ticks_more=1500)  # bounds: 3.2.4.1


def as_table(ticks):
    head = ["time_s", "force_rendered_N", "force_server_N", "position_m", "position_shown_m", "update"]
    rows = zip(ticks["force_rendered_N"], ticks["force_server_N"], ticks["position_m"], ticks["position_shown_m"], ticks["update"])
    return head, [[f"{TICK * i:.3f}", f"{rendered:.6g}", f"{server:.6g}", f"{at:.8g}", f"{shown:.8g}", update or ""]
                  for i, (rendered, server, at, shown, update) in enumerate(rows)]


def times(ticks):
    return [TICK * i for i in range(len(ticks["update"]))]


def traffic(options):
    """Figure 3.3: why updates are sent while a cube is pushed."""
    ticks = push(options, 0.08, "none")
    rows = []
    for name, is_pushed in (("pushed", True), ("not touched", False)):
        updates = [u for u, force in zip(ticks["update"], ticks["force_server_N"]) if (force != 0) == is_pushed]
        seconds = 0.0
        for _ in updates:
            seconds += TICK
        rows.append({"name": name, "seconds": seconds} | {why: updates.count(why) for why in ("haptic", "visual", "heartbeat")})
        rows[-1]["updates"] = sum(u is not None for u in updates)
    still = TICK * ticks["update"].index("heartbeat") if "heartbeat" in ticks["update"] else 0
    cells = [[r["name"], f"{r['seconds']:.2f}", r["haptic"], r["visual"], r["heartbeat"],
              f"{r['updates'] / r['seconds']:.1f}" if r["seconds"] else "-"] for r in rows]
    text = lines("Thesis figure 3.3: why updates are sent while a cube is pushed, push-1dof, p = 8 %, seed 1", "",
                 table.aligned(["", "time [s]", "haptic", "visual", "heartbeat", "updates/s"], cells), "",
                 f"The first heartbeat comes at {still:.2f} s, a second after the last update.")
    report = {"schema": "tactus.reproduce_signals/1", "figure": "fig3.3", "first_heartbeat_s": still,
              "rows": [{k: v for k, v in r.items() if k != "updates"} for r in rows]}
    return Made(report, text, lambda: draw_traffic(ticks), {"fig3.3": as_table(ticks)})


def draw_traffic(ticks):
    fig, (above, below) = figure.panels(2)
    t = times(ticks)
    above.plot(t, ticks["force_rendered_N"], color=figure.COLOURS[0], label="force on the hand")
    above.set_ylabel("force along x [N]")
    below.plot(t, [1e3 * p for p in ticks["position_m"]], color="black", label="position of the cube")
    for number, why in enumerate(("haptic", "visual", "heartbeat")):
        sent = [i for i, u in enumerate(ticks["update"]) if u == why]
        below.plot([t[i] for i in sent], [1e3 * ticks["position_m"][i] for i in sent], linestyle="none", color=figure.COLOURS[number],
                   marker=figure.MARKERS[number], markerfacecolor="none", label=f"update: {why}")
    below.set(xlabel="time [s]", ylabel="position along x [mm]")
    for axes in (above, below):
        axes.legend(loc="best")
    return fig


def interpolation(options):
    """Figure 3.11: the rendered force with and without interpolation, at the deadbands that the subjects chose."""
    runs = [("without", "7.4 %", push(options, 0.074, "none")), ("with", "18.7 %", push(options, 0.187, "linear"))]
    rows = [{"name": name} | jumps(ticks) for name, _, ticks in runs]
    cells = [[r["name"], p, r["updates"], f"{r['median_jump_N']:.3f}", f"{r['largest_jump_N']:.3f}"] for r, (_, p, _) in zip(rows, runs)]
    text = lines("Thesis figure 3.11: the rendered force with and without interpolation, push-1dof, seed 1", "", table.aligned(
        ["interpolation", "p", "updates", "jump of the force at an update, median [N]", "largest within 1 ms [N]"], cells))
    report = {"schema": "tactus.reproduce_signals/1", "figure": "fig3.11", "rows": rows}
    return Made(report, text, lambda: draw_interpolation(runs), {f"fig3.11-{name}": as_table(ticks) for name, _, ticks in runs})


def jumps(ticks):
    """Changes of the rendered force from tick to tick: the largest, and the median where an update came."""
    rendered, updates = ticks["force_rendered_N"], ticks["update"]
    steps = [abs(after - before) for before, after in zip(rendered, rendered[1:])]
    at_updates = [step for step, update in zip(steps, updates[1:]) if update]
    return {"updates": sum(u is not None for u in updates), "median_jump_N": statistics.median_high(at_updates) if at_updates else 0,
            "largest_jump_N": max(steps, default=0)}


def draw_interpolation(runs):
    fig, panels = figure.panels(2)
    for axes, (name, p, ticks) in zip(panels, runs):
        axes.plot(times(ticks), ticks["force_server_N"], color="0.6", linewidth=2.4, label="at the server")
        axes.plot(times(ticks), ticks["force_rendered_N"], color=figure.COLOURS[1], linewidth=0.9, label="rendered at the client")
        axes.set(title=f"{name} interpolation, p = {p}", ylabel="force along x [N]")
        axes.legend(loc="best")
    panels[-1].set_xlabel("time [s]")
    return fig
