# SPDX-License-Identifier: Apache-2.0
"""Figures as in a paper: one style, readable without colour, as SVG, PNG or PDF by the ending of the file.

    fig, axes = figure.panels(2)                      # one below the other, one axis of x
    figure.line(axes[0], x, y, 0, label="no haptic bound", low=least, high=largest)
    figure.save(fig, "rate.svg")                      # or save_all(fig, "folder/rate"): .svg, .png and .pdf

matplotlib is imported where the first figure is drawn: scripts that draw nothing do without it.
"""
import collections
import io
import math
import os
import re
import sys
import textwrap

from .arguments import USAGE, Refusal, how_to_install
from .table import write_whole

ENDINGS = (".svg", ".png", ".pdf")
# Distinguishable by everybody (Okabe and Ito); in grey by dashes and markers.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
DASHES = ("-", "--", "-.", ":", (0, (5, 1, 1, 1, 1, 1)), (0, (8, 2)), (0, (1, 1)))
MARKERS = ("o", "s", "^", "D", "v", "P", "X")
STYLE = {
    "font.family": "DejaVu Sans", "font.size": 9, "axes.titlesize": 10, "axes.labelsize": 9, "legend.fontsize": 8,
    "xtick.labelsize": 8, "ytick.labelsize": 8, "lines.linewidth": 1.4, "lines.markersize": 4.5,
    "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True, "grid.color": "#dddddd", "grid.linewidth": 0.6,
    "axes.axisbelow": True, "legend.frameon": False, "legend.handlelength": 3.2, "figure.dpi": 100, "savefig.dpi": 200,
    "svg.hashsalt": "tactus", "svg.fonttype": "path", "pdf.fonttype": 42, "text.usetex": False, "text.parse_math": False,
    "axes.formatter.useoffset": False, "figure.constrained_layout.use": True,
}
SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
WIDTH, PANEL_HEIGHT = 6.3, 2.0  # [inch]: the text of a page of A4


def pyplot():
    """matplotlib.pyplot in this style, without a display."""
    try:
        import matplotlib
        import matplotlib.pyplot
    except ImportError as refused:
        name = (refused.name or "matplotlib").partition(".")[0]
        raise Refusal(f"figures need {name}, which {sys.executable} does not find",
                      how_to_install(*(("matplotlib",) if name == "matplotlib" else ("numpy", "matplotlib"))), missing="matplotlib") from None
    matplotlib.use("agg")
    matplotlib.pyplot.rcParams.update(STYLE)
    return matplotlib.pyplot


def check_name(path):
    """Before the work: the ending is one that can be drawn, and what draws is installed."""
    if os.path.splitext(path)[1] not in ENDINGS:
        raise Refusal(f"{path}: give a file that ends in .svg, .png or .pdf", status=USAGE)
    pyplot()


def panels(count=1, height=None, width=WIDTH, shared=True):
    """A figure with `count` panels below each other that share the axis of x.   out  figure, [axes]"""
    size = (width, height or (3.4 if count == 1 else 0.8 + PANEL_HEIGHT * count))
    fig, axes = pyplot().subplots(count, 1, sharex=shared, squeeze=False, figsize=size)
    return fig, list(axes[:, 0])


def style_of(number, marked=True):
    """The n-th of lines of equal standing."""
    return {"color": COLOURS[number % len(COLOURS)], "linestyle": DASHES[number % len(DASHES)],
            "marker": MARKERS[number % len(MARKERS)] if marked else None}


def line(axes, x, y, number, label=None, low=None, high=None, marked=True):
    """A line with its spread: bars from the least to the largest where it is marked, else a band."""
    style = style_of(number, marked)
    if low is not None and marked:
        below, above = [max(b - a, 0) for a, b in zip(low, y)], [max(b - a, 0) for a, b in zip(y, high)]  # 0: a mean of equals, rounded
        return axes.errorbar(x, y, yerr=[below, above], label=label, capsize=2.5, elinewidth=0.8, **style)
    if low is not None:
        axes.fill_between(x, low, high, color=style["color"], alpha=0.2, linewidth=0)
    return axes.plot(x, y, label=label, **style)[0]


def logarithmic(axes, which="xy"):
    """Logarithmic scales whose powers of ten need no mathematical text, which the style leaves off so that names stay as they are."""
    import matplotlib.ticker

    def power(value, _):
        exponent = round(math.log10(value))
        if abs(value / 10 ** exponent - 1) > 1e-6:
            return ""
        return f"{value:g}" if -3 <= exponent <= 3 else "10" + str(exponent).translate(SUPERSCRIPTS)

    for letter in which:
        getattr(axes, f"set_{letter}scale")("log")
        axis = getattr(axes, letter + "axis")
        axis.set_major_formatter(matplotlib.ticker.FuncFormatter(power))
        axis.set_minor_formatter(matplotlib.ticker.NullFormatter())


def legend(fig, axes, title=None, beside=True):
    """One legend for all panels: to the right of them, or above."""
    handles, labels = [], []
    for one in axes:
        for handle, label in zip(*one.get_legend_handles_labels()):
            if label not in labels:
                handles.append(handle)
                labels.append(label)
    if not labels:
        return
    if beside:
        axes[0].legend(handles, labels, title=title, loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0, alignment="left")
    else:
        axes[0].legend(handles, labels, title=title, loc="lower right", bbox_to_anchor=(1.0, 1.01), borderaxespad=0, ncol=min(len(labels), 4))


def drawn(fig, ending):
    """The figure's bytes; the same figure gives the same bytes."""
    out = io.BytesIO()
    fig.align_ylabels()
    metadata = {".svg": {"Date": None, "Creator": None}, ".pdf": {"CreationDate": None, "Creator": None, "Producer": None},
                ".png": {"Software": None}}[ending]
    if fig._suptitle is not None:
        metadata["Title"] = fig._suptitle.get_text()  # what readers of screens tell
    fig.savefig(out, format=ending[1:], metadata=metadata)
    return compact(out.getvalue().decode()).encode() if ending == ".svg" else out.getvalue()


def compact(svg):
    """An SVG of a third of the size that looks the same: coordinates to 1/100 of a point, from each point to the next; short names, of what is
    used alone; styles stated once; no indentation."""
    svg = re.sub(r'(?<= d=")[^"]*(?=")', lambda found: compact_path(found[0]), svg)
    svg = re.sub(r'(?<= [xy]=")-?\d+\.\d+(?=")|(?<= [xy][12]=")-?\d+\.\d+(?=")|(?<=translate\()[-\d. ]+(?=\))',
                 lambda found: " ".join(hundredths(round(100 * float(number))) for number in found[0].split()), svg)
    used = {name: f"n{i}" for i, name in enumerate(dict.fromkeys(re.findall(r'(?<=href="#)[^"]+|(?<=url\(#)[^)]+', svg)))}
    svg = re.sub(r' id="([^"]*)"', lambda found: f' id="{used[found[1]]}"' if found[1] in used else "", svg)
    svg = re.sub(r'(?<=href="#)[^"]+|(?<=url\(#)[^)]+', lambda found: used[found[0]], svg)
    styles = collections.Counter(re.findall(r' style="([^"]*)"', svg))
    classes = {style: f"s{i}" for i, (style, count) in enumerate(styles.items()) if count > 2 and "url(" not in style}
    svg = re.sub(r' style="([^"]*)"', lambda found: f' class="{classes[found[1]]}"' if found[1] in classes else found[0], svg)
    rules = "".join(f".{name}{{{style}}}" for style, name in classes.items())
    return re.sub(r"\n\s+", "\n", svg.replace("</style>", rules + "</style>", 1))


def hundredths(number):
    """The shortest text of so many hundredths."""
    text = f"{abs(number) // 100}.{abs(number) % 100:02}".rstrip("0").rstrip(".")
    return ("-" if number < 0 else "") + (text.removeprefix("0") if len(text) > 1 else text)


def compact_path(path):
    """Of M, L, Q, C and z with absolute coordinates; others, such as those that are compact already, stay as they are."""
    pieces = re.findall(r"([A-Za-z])([^A-Za-z]*)", path.replace("Z", "z"))
    if any(letter not in "MLQCz" for letter, _ in pieces):
        return path
    out, x, y = [], 0, 0
    for letter, numbers in pieces:
        values = [round(100 * float(number)) for number in numbers.replace(",", " ").split()]
        count = {"M": len(values), "L": 2, "Q": 4, "C": 6, "z": 1}[letter]  # numbers of a step
        if letter == "M":
            out.append("M" + joined(values))
            x, y = values[-2:]
            continue
        steps = []
        for first in range(0, len(values), count):
            steps += [value - (x, y)[i % 2] for i, value in enumerate(values[first:first + count])]
            x, y = values[first + count - 2:first + count]
        out.append("z" if letter == "z" else letter.lower() + joined(steps))
    return "".join(out)


def joined(values):
    """A minus parts two numbers, too."""
    return "".join(text if i == 0 or text.startswith("-") else " " + text for i, text in enumerate(map(hundredths, values)))


def save(fig, path, replace=True):
    """Write it by the ending of its name."""
    ending = os.path.splitext(path)[1]
    if ending not in ENDINGS:
        raise Refusal(f"{path}: give a file that ends in .svg, .png or .pdf", status=USAGE)
    write_whole(path, drawn(fig, ending), replace)
    pyplot().close(fig)


def save_all(fig, stem, replace=True):
    """Write STEM.svg, STEM.png and STEM.pdf.   out  their names"""
    paths = [stem + ending for ending in ENDINGS]
    for path in paths:
        write_whole(path, drawn(fig, os.path.splitext(path)[1]), replace)
    pyplot().close(fig)
    return paths


def scale(axes, log_x=False, log_y=False):
    """Axes that begin at 0 where what they show is not negative, or logarithmic ones with numbers in plain digits."""
    from matplotlib import ticker
    for is_log, axis, limits in ((log_x, axes.xaxis, axes.set_xlim), (log_y, axes.yaxis, axes.set_ylim)):
        low, high = axis.get_view_interval() if axes.has_data() else (0, 1)
        if not is_log:
            seen = axis.get_data_interval()
            if 0 <= seen[0] < seen[1] / 2 and (axis is axes.yaxis or seen[0] > 0):  # a marker at x = 0 stays whole
                limits(0, high)
            continue
        (axes.set_xscale if axis is axes.xaxis else axes.set_yscale)("log")
        low, high = axis.get_data_interval()
        few = axes.has_data() and 0 < low and high < 200 * low
        axis.set_major_locator(ticker.LogLocator(subs=(1, 2, 5) if few else (1,)))
        axis.set_major_formatter(ticker.FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_formatter(ticker.NullFormatter())


def wrapped(text, width, most):
    """At most `most` lines of some `width` characters."""
    return textwrap.wrap(text, width, max_lines=most, placeholder=" …") or [""]


def title(fig, text):
    if text:
        fig.suptitle("\n".join(wrapped(text, 78, 2)), fontsize=10, x=0.02, ha="left")
