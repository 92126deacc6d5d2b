#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""`tactus plot FILE...`: recordings over time, each quantity in a panel, several recordings over each other.

The program reads traces and streams (`tactus export figure`) and gives numbers: the documents of cli/schemas/figure.json, which --plot of
its commands hands over, too. What is drawn of them, and how, is here.
"""
import contextlib
import json
import math
import os
import shutil
import subprocess
import sys
import typing

from common import arguments, figure, program, surface
from common.arguments import Refusal, printable

SCHEMA = "tactus.figure/1"
MOST_PANELS, MOST_RUNS, LONGEST_NAME, LABEL_WIDTH, LEGEND_WIDTH = 40, 6, 40, 22, 92  # the last three in characters
LEGEND_LINE, LEGEND_EDGE = 12.5, 8  # [points]
MARKS = 12  # along a line
GREY, BOUND = "#444444", "bound"
BOUND_STYLE = {"color": GREY, "linestyle": (0, (1, 1.5)), "linewidth": 1.3}
NOTES = """\
Positions, speeds, forces, deformation, and of a stream its packets, each in a panel; what --plot FILE.json of sim, encode, decode,
compare or tolerable wrote. Of a long recording a line shows the extremes.
examples:
  tactus plot push.mcap -o push.svg
  tactus plot plain.mcap helped.mcap --label "no compensation" --label "with compensation" -o both.pdf
  tactus plot plain.mcap helped.mcap --panel "force on" --line rendered -o forces.svg
  tactus encode push.mcap -o a.tct -p 4% --plot a.json && tactus encode push.mcap -o b.tct -p 8% --plot b.json
  tactus plot a.json b.json -o errors.png"""


class Panel(typing.NamedTuple):
    lines: dict  # name: (x, y)
    bound: float | None


class Run(typing.NamedTuple):
    """What one file shows."""
    name: str
    heading: str
    x_label: str = ""
    is_log: bool = False
    panels: dict = {}  # label: Panel
    surface: dict | None = None


def command_line():
    made = arguments.parser("plot", "Draw recordings over time, one or several in a figure", NOTES)
    made.add_argument("files", metavar="FILE", nargs="*",
                      help="Trace (MCAP), stream, which is decoded, or numbers of a figure (JSON); - is standard input")
    arguments.add_report_options(made, output_help="Figure to draw: .svg, .png or .pdf", metavar="FILE", force=True)
    made.add_argument("--label", action="append", default=[], metavar="TEXT",
                      help="Of the first FILE in the legend, then of the next one [the file's name]")
    made.add_argument("--title", metavar="TEXT", help="Above the figure [of one FILE its name]; '' for none")
    made.add_argument("--panel", action="append", default=[], metavar="TEXT", help="Draw only panels with this in their label; may be repeated [all]")
    made.add_argument("--line", action="append", default=[], metavar="NAME", help="Of panels with several lines draw only these; may be repeated [all]")
    made.add_argument("--check", action="store_true", help="Only look whether figures can be drawn here")
    made.parse_args = made.parse_intermixed_args  # files on both sides of an option
    return made


def short(name):
    name = printable(name)
    return name if len(name) <= LONGEST_NAME else name[:LONGEST_NAME - 1] + "…"


def points_of(pairs):
    """out   x and y, not a number where there is none"""
    points = [(float(x), math.nan if y is None else float(y)) for x, y in pairs]
    if not all(math.isfinite(x) for x, _ in points):
        raise ValueError("a point has no position on the axis of x")
    return tuple(zip(*points)) or ((), ())


def understood(text, name):
    """A run of a document.   raises Refusal"""
    try:
        document = json.loads(text)
        if document["schema"] != SCHEMA:
            raise ValueError(f"its schema is not {SCHEMA}")
        if "surface" in document:
            return Run(name, str(document["heading"]), surface=surface.checked(document["surface"]))
        panels = {}
        for panel in document["panels"]:
            lines = {str(line["name"]): points_of(line["points"]) for line in panel["lines"]}
            panels[str(panel["label"])] = Panel(lines, float(panel["bound"]) if "bound" in panel else None)
        if not panels:
            raise ValueError("it has no panels")
        return Run(name, str(document["heading"]), str(document["x"]["label"]), bool(document["x"].get("logarithmic")), panels)
    except (KeyError, TypeError, ValueError, RecursionError) as wrong:
        why = f"{wrong} is missing" if isinstance(wrong, KeyError) else str(wrong)
        raise Refusal(f"{name}: this JSON is no figure: {why}", "Give what --plot FILE.json or `tactus export figure` wrote.") from None


def exported(path, begin, options):
    """What the program makes of a recording; its own words where it refuses it.   in   begin   what was read of standard input"""
    words = [program.tactus(), "export", "figure", *(["--quiet"] if options.quiet else []), *(["--no-progress"] if options.no_progress else []),
             *(["--json"] if options.json else []), "--", path]
    is_piped = path == "-"
    with subprocess.Popen(words, stdin=subprocess.PIPE if is_piped else subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE if options.json else None) as child:
        if is_piped:
            with contextlib.suppress(BrokenPipeError), child.stdin as to:  # of what it refuses it reads the beginning alone
                to.write(begin)
                shutil.copyfileobj(sys.stdin.buffer, to)
            child.stdin = None
        text, errors = child.communicate()
    if child.returncode:
        sys.stderr.buffer.write(errors or b"")
        sys.exit(child.returncode)
    return text


def read(path, options):
    """A JSON document, or a recording that the program reads."""
    if path == "-":
        begin = sys.stdin.buffer.read(1)
        return understood(begin + sys.stdin.buffer.read() if begin == b"{" else exported(path, begin, options), "standard input")
    if os.path.isfile(path):
        with open(path, "rb") as file:
            if file.read(1) == b"{":
                return understood(b"{" + file.read(), path)
    return understood(exported(path, b"", options), path)


def labels_of(options):
    """In words: those that were given, else the names of the files, whole where they would be equal."""
    stems = [os.path.splitext(os.path.basename(path))[0].replace("_", " ").replace("-", " ").strip() or path for path in options.files]
    names = [path if stems.count(stem) > 1 else stem for path, stem in zip(options.files, stems)]
    return [short(label) for label in [*options.label, *names[len(options.label):]]]


def axis_label(text):
    """In lines that a panel is high enough for; the unit stays whole."""
    quantity, bracket, unit = printable(text).rpartition(" [")
    lines = figure.wrapped(quantity if bracket else unit, LABEL_WIDTH, 2)
    return "\n".join(lines) + (bracket + unit if bracket else "")


def set_limits(axes, values):
    """All that is finite with room around it; from 0 where nothing is negative, whose line stays whole."""
    finite = [value for value in values if math.isfinite(value)]
    low, high = min(finite, default=0), max(finite, default=0)
    high = high if high != low or low else 1
    room = high - min(low, 0) or -low
    axes.set_ylim(low - 0.06 * room if low < 0 else -0.02 * room, high + 0.06 * room)


def columns(handles):
    return max(1, min(len(handles), LEGEND_WIDTH // (max(len(handle.get_label()) for handle in handles) + 8)))


def legend(axes, handles, side, above=()):
    """Above the axes, in as many lines as it takes.   in   above   handles of the legend on the other side, above which it goes if both are long"""
    from matplotlib.legend import Legend
    from matplotlib.transforms import offset_copy
    if not handles:
        return
    width = sum(len(handle.get_label()) + 8 for handle in [*handles, *above])
    lines = math.ceil(len(above) / columns(above)) if above and width > LEGEND_WIDTH else 0
    raised = offset_copy(axes.transAxes, axes.figure, y=lines and LEGEND_LINE * lines + LEGEND_EDGE, units="points")
    made = Legend(axes, handles, [handle.get_label() for handle in handles], loc=f"lower {side}", bbox_to_anchor=(side == "right", 1),
                  bbox_transform=raised, borderaxespad=0.2, columnspacing=1.5, ncol=columns(handles))
    axes.add_artist(made)
    made.set_clip_on(False)  # it is outside of the axes, which make room for it


def style_of(name, names, run, overlaid, count):
    """Of a line with `count` points. Alone, a panel's lines differ by colour and dashes; overlaid, the runs do, and those of one run by markers."""
    number = names.index(name)
    style = figure.style_of(run if overlaid else number, marked=False) | {"linewidth": 1.2}
    if name == BOUND:
        return style | BOUND_STYLE | ({"color": style["color"]} if overlaid else {})
    if not overlaid or len(set(names) - {BOUND}) < 2:
        return style
    every = max(1, count // MARKS)
    return style | {"marker": figure.MARKERS[number % len(figure.MARKERS)], "markevery": (run * every // MOST_RUNS, every)}


def draw_lines(axes, of_runs, names, overlaid):
    """The lines of a panel, and levels of bounds: one for all where they agree, else each in the colour of its run."""
    for run, panel in of_runs:
        for name, (x, y) in panel.lines.items():
            axes.plot(x, y, label=short(name), **style_of(name, names, run, overlaid, len(x)))
    levels = {panel.bound: run for run, panel in reversed(of_runs) if panel.bound is not None}
    for level, run in levels.items():
        axes.axhline(level, label=BOUND, **BOUND_STYLE | ({"color": figure.COLOURS[run]} if len(levels) > 1 else {}))


def key_of(axes, names, overlaid):
    """What the legend of a panel explains: nothing where there is one line."""
    from matplotlib.lines import Line2D
    by_label = {line.get_label(): line for line in reversed(axes.get_lines())}
    has_bound = BOUND in by_label
    if not overlaid:
        return list(reversed(by_label.values())) if len(by_label) > 1 else []
    marked = [name for name in names if name != BOUND]
    handles = [Line2D([], [], color=GREY, linestyle="none", marker=figure.MARKERS[names.index(name) % len(figure.MARKERS)], label=short(name))
               for name in marked if len(marked) > 1]
    return handles + [Line2D([], [], label=BOUND, **BOUND_STYLE)] * has_bound


def draw_panel(axes, label, of_runs, overlaid):
    """out   the handles of its legend"""
    names = list(dict.fromkeys(name for _, panel in of_runs for name in panel.lines))
    draw_lines(axes, of_runs, names, overlaid)
    values = [y for _, panel in of_runs for line in panel.lines.values() for y in line[1]]
    set_limits(axes, values + [panel.bound for _, panel in of_runs if panel.bound is not None])
    axes.set_ylabel(axis_label(label))
    key = key_of(axes, names, overlaid)
    legend(axes, key, "right")
    return key


def panels_of(runs):
    """Labels of those that are drawn."""
    return list(dict.fromkeys(label for run in runs for label in run.panels))[:MOST_PANELS]


def draw(runs, title):
    """Panels of the same quantity lie over each other."""
    from matplotlib.lines import Line2D
    overlaid = len(runs) > 1
    labels = panels_of(runs)
    fig, panels = figure.panels(len(labels))
    keys = [draw_panel(axes, label, [(i, run.panels[label]) for i, run in enumerate(runs) if label in run.panels], overlaid)
            for axes, label in zip(panels, labels)]
    if overlaid:
        handles = [Line2D([], [], label=run.name, **figure.style_of(i, marked=False)) for i, run in enumerate(runs)]
        legend(panels[0], handles, "left", above=keys[0])
    set_x(panels[-1], runs)
    figure.title(fig, title)
    return fig


def set_x(axes, runs):
    """The axis of x that all panels share."""
    axes.set_xlabel(printable(runs[0].x_label))
    known = [v for run in runs for panel in run.panels.values() for x, _ in panel.lines.values() for v in x]
    if runs[0].is_log:
        figure.scale(axes, log_x=True)
        if not any(v > 0 for v in known):
            axes.set_xlim(1, 1000)
    else:
        axes.set_xlim(0, max(known, default=0) or 1)


def selected(runs, options):
    """Those panels and lines that --panel and --line ask for.   raises Refusal"""
    for text in options.panel:
        if not any(text in label for run in runs for label in run.panels):
            raise Refusal(f"--panel {printable(text)}: there is no such panel", "There are: " + ", ".join(printable(label) for label in panels_of(runs)),
                          arguments.USAGE)

    def of(panel):
        lines = {name: line for name, line in panel.lines.items() if name in options.line or len(panel.lines) < 2 or not options.line}
        return panel._replace(lines=dict(zip(options.line, lines.values())) if options.line and len(lines) == 1 else lines)  # nothing to tell apart
    chosen = [{label: of(panel) for label, panel in run.panels.items() if not options.panel or any(text in label for text in options.panel)}
              for run in runs]
    return [run._replace(panels={label: panel for label, panel in panels.items() if panel.lines}) for run, panels in zip(runs, chosen)]


def check_together(runs):
    if len(runs) > 1 and any(run.surface or run.x_label != runs[0].x_label for run in runs):
        raise Refusal("these files do not share an axis", "Draw each in a figure of its own.")


def check_arguments(options):
    if not options.files:
        raise Refusal("FILE is missing", "Give a trace or a stream: tactus plot push.mcap -o push.svg", arguments.USAGE)
    if not options.output:
        raise Refusal("-o is missing", "Name the figure: -o push.svg", arguments.USAGE)
    for too_many, limit, what in ((options.files, MOST_RUNS, "FILEs"), (options.label, len(options.files), "labels")):
        if len(too_many) > limit:
            raise Refusal(f"{len(too_many)} {what} are too many", f"Give at most {limit}.", arguments.USAGE)
    figure.check_name(options.output)
    if os.path.lexists(options.output) and not options.force:
        raise Refusal(f"{options.output}: the file already exists", "Give -f to replace it, or another name.")


def work(options):
    if options.check:
        figure.pyplot()
        return
    check_arguments(options)
    runs = [read(path, options)._replace(name=label) for path, label in zip(options.files, labels_of(options))]
    check_together(runs)
    runs = runs if runs[0].surface else selected(runs, options)
    if not runs[0].surface and not panels_of(runs):
        raise Refusal("no line is left to draw", "Give --line a name that the legend of the whole figure has.", arguments.USAGE)
    title = options.title if options.title is not None else "" if len(runs) > 1 else printable(runs[0].heading)
    drawn = surface.draw(runs[0].surface, title) if runs[0].surface else draw(runs, title)
    figure.save(drawn, options.output, options.force)
    panels = panels_of(runs)
    left_out = len({label for run in runs for label in run.panels}) - len(panels)
    if left_out:
        print(f"note: {left_out} panels are left out after the first {MOST_PANELS}", file=sys.stderr)
    if options.json:
        print(json.dumps({"schema": "tactus.plot/1", "figure": options.output, "panels": panels,
                          "files": [{"file": path, "label": run.name} for path, run in zip(options.files, runs)]}, indent=2, ensure_ascii=False))
    elif not options.quiet:
        print(printable(f"{options.output}: {len(panels)} panels of {', '.join(options.files)}"))


if __name__ == "__main__":
    arguments.run(command_line(), work)
