# SPDX-License-Identifier: Apache-2.0
"""Numbers of reports/: each agrees with the cells that its row names, each table and figure has its command; small figures stay what they are."""
import pathlib
import re
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "lab"))
import report  # noqa: E402
from common import figure  # noqa: E402
from common.arguments import Refusal  # noqa: E402
from reports import cells  # noqa: E402
from thesis import numbers  # noqa: E402

TABLE = "scene,seed,v,n\na,1,2.5%,3\na,2,,5\nb,1,10%,x\n"


class Cells(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        (pathlib.Path(self.folder.name) / "t.csv").write_text(TABLE)
        (pathlib.Path(self.folder.name) / "code.h").write_text("constexpr int kMost =\n   20'000; // and kLeast = 3\n")
        self.tables = cells.Tables(self.folder.name)

    def value(self, source):
        return cells.value(self.tables, source)

    def test_cells_and_formulas(self):
        for source, value in (("{t.csv | scene=a | seed=1 | n}", 3), ("{t.csv | scene=b | v} / 100", 0.1), ("mean{t.csv | scene=a | n * 2} + 1", 9),
                              ("sum{t.csv | seed=1..2 | n}", 8), ("rows{t.csv | scene!=b | n}", 2), ("largest{t.csv | seed=2 or 7 | -n}", -5),
                              ("amount{t.csv | scene=a | 1 - n}", 4), ("farthest{t.csv | scene=a | 1 - n}", -4), ("defined: 3 * 4", 12),
                              ("{code.h ~ kMost =} / 2", 10_000), ("{code.h ~ kLeast =}", 3),
                              ("largest over seed: {t.csv | scene=a | n} - {t.csv | scene=a | seed=1 | n}", 2)):
            self.assertAlmostEqual(self.value(source), value, 12, source)

    def test_what_names_no_cell_is_refused(self):
        for source in ("{t.csv | scene=a | n}", "{t.csv | scene=c | n}", "{t.csv | place=a | n}", "{t.csv | scene=b | n}", "{code.h ~ kNone =}",
                       "3 + 4", "some{t.csv | scene=a | n}", "{code.h ~ k}"):
            with self.assertRaises(Refusal, msg=source):
                self.value(source)

    def test_a_number_agrees_within_half_of_its_last_digit(self):
        for number, text, agrees in ((17.34, "17.3", True), (17.36, "17.3", False), (8.49e-6, "8.5e-6", True), (8.44e-6, "8.5e-6", False),
                                     (1234, "1 234", True), (0.04, "0", True), (0.6, "0", False), (-594.2, "-594", True)):
            self.assertEqual(cells.agrees(number, text), agrees, (number, text))
        self.assertEqual([cells.written(*pair) for pair in ((17.36, "17.3"), (8.44e-6, "8.5e-6"), (-0.01, "0.2"))], ["17.4", "8.4e-6", "0.0"])


class Reports(unittest.TestCase):
    def test_every_number_agrees_with_its_cells(self):
        tables = cells.Tables(ROOT / "reports")
        counts = [cells.check(tables, name) for name in report.sourced()]
        self.assertEqual([wrong for _, _, wrong in counts if wrong], [])
        self.assertGreater(sum(agree for agree, _, _ in counts), 350)

    def test_the_list_has_numbers_of_results(self):
        listed = {row["value"] for row in cells.Tables(ROOT / "reports").rows("results.csv")}
        rows = [line.split("|") for line in (ROOT / "reports/README.md").read_text(encoding="utf8").splitlines() if line.startswith("|")]
        numbers_of = [row[2].split()[0] for row in rows if re.match(r" [\d.]", row[2])]
        self.assertGreater(len(numbers_of), 50)
        self.assertEqual([number for number in numbers_of if number not in listed], [])

    def test_every_table_and_figure_has_its_command(self):
        files = {target for one in report.made().values() for target in one["files"]}
        there = {str(path.relative_to(ROOT / "reports")) for ending in ("csv", "svg") for path in (ROOT / "reports").rglob("*." + ending)}
        self.assertEqual(there - files - set(report.sourced()), {"precision/other-programs.csv"})
        self.assertEqual({target for target in files - there if target.endswith((".csv", ".svg"))}, set())

    def test_figures_are_drawn_by_these_scripts(self):
        drawn = list((ROOT / "reports").rglob("*.svg"))
        self.assertGreater(len(drawn), 60)
        for path in drawn:
            text = path.read_text(encoding="utf8")
            self.assertEqual(figure.compact(text), text, path)

    def test_differences(self):
        with tempfile.TemporaryDirectory() as folder:
            one, two = pathlib.Path(folder) / "1.csv", pathlib.Path(folder) / "2.csv"
            one.write_text("a,t,n\nx,1,2\ny,2,0.1\n")
            two.write_text("a,t,n\nx,9,2.0000001\ny,7,0.2\n")
            self.assertEqual(report.differences(one, two, ["t"]), [(3, "n", "0.1", "0.2")])
            two.write_text("a,t,n\nx,9,2\n")
            self.assertEqual(len(report.differences(one, two, [])), 1)

    def test_numbers_of_a_report_have_names_of_their_own(self):
        rows = numbers.rows("fig1", {"figure": "fig1", "ok": True, "rows": [{"name": "a", "p": 1, "of": {"x": 2}}, {"name": "a", "p": 2, "of": {"x": 3}}],
                                     "list": [5, 6]})
        self.assertEqual(rows, [["1", "", "ok", "1"], ["1", "a, p=1", "p", "1"], ["1", "a, p=1", "of.x", "2"], ["1", "a, p=2", "p", "2"],
                                ["1", "a, p=2", "of.x", "3"], ["1", "", "list.0", "5"], ["1", "", "list.1", "6"]])


class CompactFigures(unittest.TestCase):
    def points(self, path):
        """Absolute points of a compact path."""
        out, x, y = [], 0.0, 0.0
        for letter, numbers_of in re.findall(r"([A-Za-z])([^A-Za-z]*)", path):
            values = [float(n) for n in re.findall(r"-?(?:\d+\.?\d*|\.\d+)", numbers_of)]
            for a, b in zip(values[::2], values[1::2]):
                x, y = (a, b) if letter == "M" else (x + a, y + b)
                out.append((round(x, 2), round(y, 2)))
        return out

    def test_a_path_keeps_its_points(self):
        self.assertEqual(self.points(figure.compact_path("M 10.004 0.5 \nL 9.25 -0.256 \nL 9.2512 100 \nz\n")), [(10, 0.5), (9.25, -0.26), (9.25, 100)])
        self.assertEqual(self.points(figure.compact_path("M 1,2 L 3,4 5,6.5 Z")), [(1, 2), (3, 4), (5, 6.5)])
        self.assertEqual(figure.compact_path("M 0 0 A 1 1 0 0 1 2 2"), "M 0 0 A 1 1 0 0 1 2 2")

    def test_names_and_styles_are_stated_once(self):
        style = 'style="fill: #0072b2"'
        made = figure.compact('<style>*{}</style><path id="mark" d="M 0 0 \nL 1 1 \n"/>\n  <g id="axes_1">\n' + f'   <use xlink:href="#mark" x="1.23456" {style}/>\n' * 3)
        self.assertEqual(made.count("fill: #0072b2"), 1)
        self.assertEqual(made.count('href="#n0" x="1.23" class="s0"'), 3)
        self.assertNotIn("axes_1", made)


if __name__ == "__main__":
    unittest.main()
