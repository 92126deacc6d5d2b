# SPDX-License-Identifier: Apache-2.0
"""lab/plot: what it makes of documents, and how figures look: nothing overlaps, nothing is cut, and grey tells everything apart."""
import json
import math
import os
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "lab"))
import plot  # noqa: E402
from common import figure, surface  # noqa: E402
from common.arguments import Refusal  # noqa: E402

try:
    figure.pyplot()
    HIDDEN = None
except Refusal as refused:
    HIDDEN = refused.text


def document(panels, **more):
    return json.dumps({"schema": plot.SCHEMA, "heading": "h", "x": {"label": "time [s]", "logarithmic": False}, "panels": panels} | more)


def panel(label, names, points=((0, 0), (1, 2)), **more):
    return {"label": label, "lines": [{"name": name, "points": points} for name in names]} | more


def run(*panels, name="run"):
    return plot.understood(document(panels), name)


def options(*words):
    return plot.command_line().parse_args(words)


class Documents(unittest.TestCase):
    def test_numbers_arrive(self):
        got = run(panel("force [N]", ["a", "b"], [[0, 1.5], [0.25, -2]], bound=3), panel("empty [m]", ["none"], []))
        self.assertEqual(got.x_label, "time [s]")
        self.assertEqual(got.panels["force [N]"], ({"a": ((0.0, 0.25), (1.5, -2.0)), "b": ((0.0, 0.25), (1.5, -2.0))}, 3.0))
        self.assertEqual(got.panels["empty [m]"], ({"none": ((), ())}, None))
        missing = run(panel("y [m]", ["a"], [[0, None], [1, 2]])).panels["y [m]"].lines["a"][1]
        self.assertTrue(math.isnan(missing[0]) and missing[1] == 2.0)

    def test_what_is_no_figure_is_refused_with_the_reason(self):
        for text, why in (("[", "Expecting value"), ("{}", "'schema' is missing"), (document([]), "it has no panels"),
                          (json.dumps({"schema": "tactus.report/3"}), "its schema is not tactus.figure/1"),
                          (document([panel("y", ["a"], [[1]])]), "unpack"), (document([panel("y", ["a"], [["x", 1]])]), "could not convert"),
                          (document([panel("y", ["a"], 7)]), "int"), (document([{"label": "y"}]), "'lines' is missing"),
                          (document([panel("y", ["a"], [[float("inf"), 1]])]), "no position"),
                          (document([], surface={"vertices_m": []}), "'triangles' is missing"),
                          (document([], surface={"vertices_m": [[0, 0, 0]], "triangles": [[0, 0, 1]], "stiffness_N_per_m": [1]}), "not there"),
                          (document([], surface={"vertices_m": [[0, 0, 0]], "triangles": [[0, 0, 0]], "stiffness_N_per_m": [0]}), "not above 0"),
                          (document([], surface={"vertices_m": [[0, 0]], "triangles": [[0, 0, 0]], "stiffness_N_per_m": [1]}), "three")):
            with self.assertRaises(Refusal) as refused:
                plot.understood(text, "x.json")
            self.assertIn(why, refused.exception.text)
            self.assertTrue(refused.exception.text.startswith("x.json: this JSON is no figure: "))

    def test_runs_must_share_an_axis(self):
        first = run(panel("y", ["a"]))
        plot.check_together([first, first])
        for other in (first._replace(x_label="round trip [ms]"), first._replace(surface={"triangles": []})):
            with self.assertRaises(Refusal):
                plot.check_together([first, other])


class Words(unittest.TestCase):
    def test_labels_come_from_names_or_are_given(self):
        self.assertEqual(plot.labels_of(options("a/with_help.mcap", "no-help.tct")), ["with help", "no help"])
        self.assertEqual(plot.labels_of(options("a/run.mcap", "b/run.mcap")), ["a/run.mcap", "b/run.mcap"])
        self.assertEqual(plot.labels_of(options("a.mcap", "b.mcap", "--label", "ours")), ["ours", "b"])

    def test_labels_of_axes_keep_their_unit(self):
        self.assertEqual(plot.axis_label("speed [mm/s]"), "speed [mm/s]")
        self.assertEqual(plot.axis_label("fraction of the time in contact [%]"), "fraction of the time\nin contact [%]")
        long = plot.axis_label("position of " + 9 * "another " + "cube [mm]")
        self.assertEqual(long.count("\n"), 1)
        self.assertTrue(long.endswith("… [mm]"), long)
        self.assertEqual(plot.axis_label("packets per second"), "packets per second")
        self.assertEqual(plot.axis_label("a\x1b\ufffe [N]"), "a\\x1b\\ufffe [N]")

    def test_wrong_arguments(self):
        with tempfile.TemporaryDirectory() as folder:
            there = os.path.join(folder, "there.svg")
            pathlib.Path(there).touch()
            for words, status in ((["a.mcap"], 2), (["-o", "x.svg"], 2), (["a", "-o", "x.gif"], 2), ([*"abcdefg", "-o", "x.svg"], 2),
                                  (["a", "--label", "1", "--label", "2", "-o", "x.svg"], 2), (["a", "-o", there], 1)):
                if HIDDEN and words == ["a", "-o", there]:
                    continue
                with self.assertRaises(Refusal, msg=words) as refused:
                    plot.check_arguments(options(*words))
                self.assertEqual(refused.exception.status, status, words)


@unittest.skipIf(HIDDEN, HIDDEN)
class Looks(unittest.TestCase):
    WAVES = [[i / 100, (i * 7) % 13 - 3.0] for i in range(500)]

    def drawn(self, *runs, title="A title"):
        fig = plot.draw(list(runs), title)
        self.addCleanup(figure.pyplot().close, fig)
        fig.canvas.draw()
        return fig

    def legends(self, axes):
        from matplotlib.legend import Legend
        return [child for child in axes.get_children() if isinstance(child, Legend)]

    def words(self, axes):
        return [[text.get_text() for text in legend.get_texts()] for legend in self.legends(axes)]

    def check_layout(self, fig):
        """No legend, title or label lies over data or over another, and none leaves the page."""
        renderer, page = fig.canvas.get_renderer(), fig.bbox
        boxes = [legend.get_window_extent(renderer) for axes in fig.axes for legend in self.legends(axes)]
        boxes += [axes.yaxis.label.get_window_extent(renderer) for axes in fig.axes] + [fig.axes[-1].xaxis.label.get_window_extent(renderer)]
        boxes += [fig._suptitle.get_window_extent(renderer)] if fig._suptitle else []
        for i, box in enumerate(boxes):
            inside = page.x0 - 1 <= box.x0 and box.x1 <= page.x1 + 1 and page.y0 - 1 <= box.y0 and box.y1 <= page.y1 + 1
            self.assertTrue(inside, f"{box} leaves the page")
            for other in boxes[:i] + [axes.bbox for axes in fig.axes]:
                self.assertFalse(box.padded(-1).overlaps(other), f"{box} over {other}")

    def example(self, name):
        return run(panel("position of cube [mm]", ["x", "y", "z"], self.WAVES), panel("speed [mm/s]", ["cube"], self.WAVES),
                   panel("position error [mm]", ["error"], bound=0.3), panel("force error [N]", ["error", "bound"]), name=name)

    def test_one_run(self):
        fig = self.drawn(self.example("a"))
        self.assertEqual([self.words(axes) for axes in fig.axes], [[["x", "y", "z"]], [], [["error", "bound"]], [["error", "bound"]]])
        self.assertEqual([axes.get_ylabel() for axes in fig.axes], ["position of cube [mm]", "speed [mm/s]", "position error [mm]", "force error [N]"])
        self.assertEqual(fig.axes[-1].get_xlabel(), "time [s]")
        self.assertEqual(len({line.get_linestyle() for line in fig.axes[0].get_lines()}), 3, "grey tells them apart")
        self.check_layout(fig)

    def test_two_runs(self):
        fig = self.drawn(self.example("without compensation"), self.example("with compensation"))
        self.assertEqual(sorted(self.words(fig.axes[0])), [["without compensation", "with compensation"], ["x", "y", "z"]])
        self.assertEqual([self.words(axes) for axes in fig.axes[1:]], [[], [["bound"]], [["bound"]]])
        lines = fig.axes[0].get_lines()
        styles = {(line.get_linestyle(), line.get_color(), line.get_marker()) for line in lines}
        self.assertEqual((len(lines), len(styles)), (6, 6))
        self.assertEqual(len({(line.get_linestyle(), line.get_marker()) for line in lines}), 6, "grey tells them apart")
        self.assertEqual({(line.get_linestyle(), line.get_color()) for line in lines[:3]}, {("-", figure.COLOURS[0])})
        self.check_layout(fig)

    def test_names_that_are_long_or_many(self):
        long = [run(panel(f"speed of {'body ' * 30}[mm/s]", [f"an object of number {i}" for i in range(6)], self.WAVES),
                    panel("y [m]", ["only one"]), name=f"a run whose name goes on and on: {i}"[:plot.LONGEST_NAME]) for i in range(3)]
        self.check_layout(self.drawn(*long, title=""))
        self.check_layout(self.drawn(long[0], title="word " * 80))

    def test_panels_of_one_run_alone_are_kept(self):
        fig = self.drawn(run(panel("a [m]", ["x"])), run(panel("b [m]", ["x"]), panel("a [m]", ["x"])))
        self.assertEqual([(axes.get_ylabel(), len(axes.get_lines())) for axes in fig.axes], [("a [m]", 2), ("b [m]", 1)])

    def test_bounds_that_differ_have_the_colour_of_their_run(self):
        for second, colours in ((0.3, {plot.GREY}), (0.5, set(figure.COLOURS[:2]))):
            fig = self.drawn(run(panel("e [mm]", ["error"], bound=0.3)), run(panel("e [mm]", ["error"], bound=second)))
            self.assertEqual({line.get_color() for line in fig.axes[0].get_lines() if line.get_label() == "bound"}, colours)

    def test_scales(self):
        limits = lambda points, **more: self.drawn(run(panel("y [m]", ["a"], points, **more))).axes[0].get_ylim()
        for (low, high), got in (((-0.08, 4.24), limits([[0, 2], [1, 4]])), ((-0.2, 10.6), limits([[0, 2], [1, 4]], bound=10)),
                                 ((-4.48, 4.48), limits([[0, -4], [1, 4]])), ((-0.02, 1.06), limits([[0, 0], [1, 0]])),
                                 ((-0.02, 1.06), limits([]))):
            self.assertAlmostEqual(got[0], low)
            self.assertAlmostEqual(got[1], high)
        low, high = limits([[0, -4], [1, -4]])
        self.assertTrue(low < -4 < high)
        self.assertEqual(self.drawn(run(panel("y [m]", ["a"], [[0, 1], [2.5, 1]]))).axes[0].get_xlim(), (0, 2.5))

    def test_files_by_their_ending(self):
        with tempfile.TemporaryDirectory() as folder:
            source = os.path.join(folder, "a.json")
            pathlib.Path(source).write_text(document([panel("y [m]", ["a"])]))
            for ending, begin in ((".svg", b"<?xml"), (".png", b"\x89PNG"), (".pdf", b"%PDF-")):
                paths = [os.path.join(folder, name + ending) for name in ("one", "again")]
                for path in paths:
                    plot.work(options(source, "-o", path, "-q"))
                first, second = (pathlib.Path(path).read_bytes() for path in paths)
                self.assertTrue(first.startswith(begin))
                self.assertEqual(first, second, "equal figures, equal bytes")

    def test_no_more_panels_than_can_be_drawn(self):
        many = run(*[panel(f"y{i} [m]", ["a"]) for i in range(4)])
        most, plot.MOST_PANELS = plot.MOST_PANELS, 3
        self.addCleanup(setattr, plot, "MOST_PANELS", most)
        self.assertEqual([axes.get_ylabel() for axes in self.drawn(many).axes], ["y0 [m]", "y1 [m]", "y2 [m]"])

    def test_a_logarithmic_axis_without_a_line(self):
        for points in ([], [[0.5, 1], [80, 2]]):
            fig = self.drawn(run(panel("fraction [%]", ["a, b"], points))._replace(x_label="round trip [ms]", is_log=True))
            self.assertEqual((fig.axes[0].get_xscale(), fig.axes[0].get_xlabel()), ("log", "round trip [ms]"))


@unittest.skipIf(HIDDEN, HIDDEN)
class Surfaces(unittest.TestCase):
    def cube(self, height):
        at = [[x, y, z] for z in (0, height) for y in (0, 0.1) for x in (0, 0.1)]
        triangles = [[0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4], [2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5],
                     [3, 7, 5]]
        return {"vertices_m": at, "triangles": triangles, "stiffness_N_per_m": [None, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]}

    def test_flat_ones_are_seen_from_above_others_in_space(self):
        for height, is_flat in ((0.01, True), (0.1, False)):
            fig = surface.draw(self.cube(height), "title")
            self.addCleanup(figure.pyplot().close, fig)
            self.assertEqual(fig.axes[0].name != "3d", is_flat)
            self.assertEqual(fig.axes[1].get_ylabel(), "stiffness [N/m], 2 to 8")
            self.assertEqual([fig.axes[0].get_xlabel(), fig.axes[0].get_ylabel()], ["x [mm]", "y [mm]"])

    def test_only_faces_towards_the_viewer_are_seen(self):
        class Axes:
            elev, azim = 30, -60  # from the right, in front, above
        of = self.cube(0.1)
        seen = [i for i, face in enumerate(of["triangles"]) if surface.faces_viewer(Axes, [of["vertices_m"][v] for v in face])]
        self.assertEqual(seen, [2, 3, 4, 5, 10, 11])


if __name__ == "__main__":
    unittest.main()
