# SPDX-License-Identifier: Apache-2.0
"""Figure 3.14 of the thesis once more: what the traffic settings of its table 3.3 cost in packets, and what they do to the force.

  for seed in 1 2 3 4 5; do tactus sim rotate-push-lift --tune duration_scale=0.5,tremor=0.4mm --seed $seed -o $seed.mcap; done
  figure_3_14.py fig3.14.svg 1.mcap 2.mcap 3.mcap 4.mcap 5.mcap

It reads like a notebook: each part ends with a table or a figure. The thesis asked people for ratings. Their place is taken by the fraction
of the time in which the error of the force is one that people notice. The hands were recorded without a codec between them and the
object; `tactus reproduce fig3.14` closes that loop.
"""
# %% What is compared: name, packets per second in the text of the thesis, interpolation at the client, reduction, bounds.
import math
import pathlib
import sys

import matplotlib
import matplotlib.pyplot as plt
import numpy as np

import tactus

UNIT = 0.05  # m per length unit of the thesis
NI, WI = tactus.INTERPOLATION_NONE, tactus.INTERPOLATION_LINEAR


def setting(name, rate, interpolation, haptic=tactus.HAPTIC_ISOTROPIC, p=0.08):
    length, angle = (0.010, 4) if interpolation == WI else (0.006, 2)
    bounds = tactus.RigidBounds(haptic=haptic, weber_fraction=p, visual_position=length * UNIT, visual_rotation=math.radians(angle),
                                fixed_position=0.0015 * UNIT)
    return name, rate, interpolation, bounds


SETTINGS = [setting("S_R1", None, NI, tactus.HAPTIC_OFF),
            *(setting(f"S{100 * p:.0f}_NI", rate, NI, p=p) for p, rate in ((0.04, 42.6), (0.08, None), (0.18, None), (0.30, 25))),
            *(setting(f"S{100 * p:.0f}_WI", rate, WI, p=p) for p, rate in ((0.04, 28.6), (0.08, None), (0.18, None), (0.30, 12.3))),
            setting("S_NIso", 18.2, WI, tactus.HAPTIC_CONE, p=0.18),
            setting("S_DR", 33.6, WI, tactus.HAPTIC_FIXED)]

if len(sys.argv) < 3:
    sys.exit(__doc__)
figure, traces = pathlib.Path(sys.argv[1]), sys.argv[2:]
if figure.suffix not in (".svg", ".png", ".pdf"):
    sys.exit(f"{figure}: figures are .svg, .png or .pdf")
matplotlib.use("agg")
matplotlib.rcParams["svg.fonttype"] = "none"  # words stay words


# %% Each recording is encoded with each setting, and what its client shows is held against the truth.
def measure(trace, bounds, interpolation):
    """Packets per second, and fraction of the time with a force error that people notice [%]."""
    stream = tactus.encode(trace, bounds, profile="thesis")
    with tactus.Player(stream) as player:
        packets = len(player.play(1 << 31))
    shown = tactus.compare(trace, stream, interpolation=interpolation)
    ticks = shown.position.ticks
    return 1000 * packets / ticks, 100 * shown.perceived.ticks_over / ticks


results = np.array([[measure(trace, bounds, interpolation) for trace in traces] for _, _, interpolation, bounds in SETTINGS])
mean, spread = results.mean(axis=1), results.std(axis=1, ddof=1 if len(traces) > 1 else 0)

print(f"{'setting':8} {'packets/s':>16} {'thesis':>7} {'error noticed [%]':>18}")
for (name, rate, *_), (packets, noticed), (s_packets, s_noticed) in zip(SETTINGS, mean, spread):
    print(f"{name:8} {packets:9.1f} +- {s_packets:<4.1f} {rate or '-':>6} {noticed:12.2f} +- {s_noticed:.2f}")

# %% The figure: mean and standard deviation over the recordings.
KINDS = {"reference": slice(0, 1), "without interpolation": slice(1, 5), "with interpolation": slice(5, 9), "other rules": slice(9, 11)}
STYLES = (("o", "none", "black"), ("^", "--", "#d55e00"), ("o", "-", "#0072b2"), ("s", "none", "#009e73"))
drawing, axes = plt.subplots(figsize=(7.5, 4.4), constrained_layout=True)
for i, ((kind, part), (marker, line, colour)) in enumerate(zip(KINDS.items(), STYLES)):
    (x, y), (dx, dy) = mean[part].T, spread[part].T
    axes.errorbar(x, y, xerr=dx, yerr=dy, marker=marker, linestyle=line, color=colour, label=kind, capsize=2.5, elinewidth=0.8)
    for (name, *_), point in zip(SETTINGS[part], zip(x, y)):
        side = -1 if i in (0, 2) else 1
        axes.annotate(name, point, xytext=(side * 8, -side * 8), textcoords="offset points", ha="right" if side < 0 else "left", va="center")
axes.set(xlabel="packets per second", ylabel="force error that people notice, % of the time")
axes.margins(0.12)
axes.invert_yaxis()
axes.grid(color="#dddddd")
axes.legend(loc="lower left", bbox_to_anchor=(0, 1), ncol=4, frameon=False)
drawing.savefig(figure)
print(f"{figure} is written")
