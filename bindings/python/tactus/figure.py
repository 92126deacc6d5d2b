# SPDX-License-Identifier: Apache-2.0
"""A figure for a paper; matplotlib is needed here alone."""
from __future__ import annotations

import os
from typing import Any

import numpy as np

from .codec import Player
from .run import decode
from .trace import Trace, read_trace


def _errors(trace: Trace, poses: Any) -> tuple[Any, Any]:
    """(T, N) distances [m] and angles [rad] of what is shown from the truth."""
    distance = np.linalg.norm(poses[..., :3] - trace.position, axis=2)
    cosine = np.abs(np.sum(poses[..., 3:7] * trace.rotation, axis=2))
    sine = np.sqrt(np.maximum(0, np.sum((poses[..., 3:7] - np.sign(np.sum(poses[..., 3:7] * trace.rotation, axis=2, keepdims=True))
                                         * trace.rotation) ** 2, axis=2))) / 2
    return distance, np.where(cosine > 0.9, 4 * np.arcsin(np.minimum(sine, 1)), 2 * np.arccos(np.minimum(cosine, 1)))


def plot(trace: Trace | str | os.PathLike[str], stream: str | os.PathLike[str] | bytes, file: str | os.PathLike[str] | None = None,
         **options: Any) -> Any:
    """Draw packets, errors beside their bounds, and forces over time.

    file     .pdf, .svg, .png, .eps: written; None: only the figure is returned
    options  of the receiver: see ReceiverOptions
    raises   ImportError without matplotlib; Error
    """
    try:
        from matplotlib.figure import Figure
    except ImportError as why:
        raise ImportError("tactus.plot needs matplotlib: apt-get install python3-matplotlib, or pip install matplotlib") from why
    truth = trace if isinstance(trace, Trace) else read_trace(trace)
    shown = decode(stream, truth.ticks, **options)
    with Player(stream) as player:
        bounds = player.scene.rigid_bounds
    distance, angle = _errors(truth, shown.poses)
    panels = 3 + (1 if truth.user_names else 0)
    figure = Figure(figsize=(7, 1.6 * panels), layout="constrained")
    axes = figure.subplots(panels, 1, sharex=True)
    reasons = ("haptic", "visual", "heartbeat", "request")
    for i, reason in enumerate(reasons):
        axes[0].plot([p.tick / truth.tick_rate for p in shown.packets if p.kind == "rigid" and p.reason == reason],
                     [i for p in shown.packets if p.kind == "rigid" and p.reason == reason], "|", color=f"C{i}")
    axes[0].set_yticks(range(len(reasons)), reasons)
    for i, name in enumerate(truth.object_names):
        axes[1].plot(truth.time, 1e3 * distance[:, i], lw=0.8, label=name)
        axes[2].plot(truth.time, np.degrees(angle[:, i]), lw=0.8, label=name)
    if bounds is not None:
        axes[1].axhline(1e3 * bounds.visual_position, color="k", ls="--", lw=0.8)
        axes[2].axhline(np.degrees(bounds.visual_rotation), color="k", ls="--", lw=0.8)
    axes[1].set_ylabel("position\nerror [mm]")
    axes[2].set_ylabel("rotation\nerror [deg]")
    if truth.object_names:
        axes[1].legend(loc="upper right", fontsize="small")
    for i, name in enumerate(truth.user_names):
        axes[3].plot(truth.time, np.linalg.norm(truth.force[:, i], axis=1), lw=0.8, label=name)
        axes[3].set_ylabel("force [N]")
        axes[3].legend(loc="upper right", fontsize="small")
    axes[-1].set_xlabel("time [s]")
    if file is not None:
        figure.savefig(os.fsdecode(file))
    return figure
