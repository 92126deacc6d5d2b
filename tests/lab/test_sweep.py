# SPDX-License-Identifier: Apache-2.0
"""lab/sweep: formulas, plans, parts, spread, figures, and a sweep that is killed.   TACTUS: the program, as for the scripts"""
import csv
import math
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import unittest

PROJECT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(PROJECT / "lab"))

from common import table as common_table  # noqa: E402
from common.arguments import Refusal, printable  # noqa: E402
from sweep import plan as plans  # noqa: E402
from sweep import table as tables  # noqa: E402
from sweep.formula import Formula, NotAFormula, leading_number  # noqa: E402
from sweep.points import pointed  # noqa: E402

SMALL = """name = "small"
command = ["encode", "{hand}", "-o", "/dev/null", "-p", "{p}"]
[[input]]
name = "one"
file = "one-{seed}.mcap"
command = ["sim", "push-1dof", "--duration", "1s", "--seed", "{seed}", "-o", "{file}"]
[vary]
hand = ["one"]
p = { from = "1%", to = "16%", count = 5, scale = "log" }
[repeat]
seed = ["1", "2"]
[measure]
packets = "/traffic/packets"
force_rms_N = "/error/contact_force_N/rms"
[derive]
force_mN = "1000 * force_rms_N"
"""


def loaded(text):
    with tempfile.NamedTemporaryFile("w", suffix=".toml") as file:
        file.write(text)
        file.flush()
        return plans.load(file.name)


class Formulas(unittest.TestCase):
    def test_values(self):
        numbers = {"a": 3.0, "b.c_1": 4.0, "zero": 0.0}
        for text, value in (("a+b.c_1*2", 11), ("(a + b.c_1) * 2", 14), ("-a - -2", -1), ("8 / 2 / 2", 2), ("1e3*.5", 500), ("a-1-1", 1)):
            self.assertEqual(Formula(text).value(numbers), value, text)
        self.assertEqual(Formula("a / zero").value(numbers), math.inf)
        self.assertEqual(Formula("1 / (a / zero)").value(numbers), 0)
        self.assertTrue(math.isnan(Formula("zero / zero").value(numbers)))
        self.assertEqual(Formula("a * b.c_1 / a").names, ["a", "b.c_1", "a"])

    def test_what_is_no_formula_is_said_with_its_location(self):
        for text, printed in (("", "a number or the name of a column is wanted at character 1"), ("a b", "an operator is wanted at character 3"),
                           ("(a", "a ) is wanted at character 3"), ("a + * b", "a number or the name of a column is wanted at character 5"),
                           ("(" * 40 + "a", "an end of the parentheses is wanted at character 33"), ("a ** 2", "a number or the name"),
                           ("__import__('os')", "a number or the name of a column is wanted at character 1")):
            with self.assertRaises(NotAFormula) as caught:
                Formula(text)
            self.assertIn(printed, str(caught.exception), text)

    def test_number_of_a_cell(self):
        for cell, number in (("2.5%", 2.5), ("5mm,4deg", 5), ("-1e-3x", -1e-3), (".5", 0.5), ("1e", 1)):
            self.assertEqual(leading_number(cell), number)
        for cell in ("", "one", "+1", " 1"):
            self.assertTrue(math.isnan(leading_number(cell)), cell)


class Plans(unittest.TestCase):
    def test_points_and_words(self):
        plan = loaded(SMALL)
        points = list(plan.points())
        self.assertEqual((plan.count(), len(points)), (10, 10))
        self.assertEqual([point["p"] for point in points[::2]], ["1%", "2%", "4%", "8%", "16%"])
        self.assertEqual(points[1], {"hand": "one", "p": "1%", "seed": "2"})
        self.assertEqual(plan.words(points[1], "dir/{}".format), ["encode", "dir/one-2.mcap", "-o", "/dev/null", "-p", "1%"])
        self.assertEqual(plan.columns(), ["hand", "p", "seed", "force_rms_N", "packets", "host", "seconds", "force_mN"])

    def test_groups_change_together(self):
        plan = loaded(SMALL.replace("[repeat]", '[[zip]]\na = ["1", "2"]\nb = ["x", "y"]\n[repeat]').replace('"{p}"', '"{p}", "{a}{b}"'))
        self.assertEqual({(point["a"], point["b"]) for point in plan.points()}, {("1", "x"), ("2", "y")})

    def test_every_shipped_plan_is_one(self):
        for path in (PROJECT / "reports/plans").glob("*.toml"):
            self.assertGreater(plans.load(path).count(), 0)

    def test_each_mistake_is_found(self):
        for old, new, printed in (
                ('name = "small"', "", "name: is missing"), ('"small"', '"../x"', "is no name"), ('"small"', "3", "is no text"),
                ('["one"]', '"one"', "vary.hand: is no array of texts"), ('["one"]', "[]", "vary.hand: is no array of texts"),
                ('["one"]', "[1]", "holds what is no text"), ("count = 5", "count = 1", "count: is 1"),
                ('"16%"', '"16mm"', "goes from % to mm"), ('"1%"', '"0%"', "above 0"), ('"log"', '"cubic"', "is 'cubic'"),
                ('["1", "2"]', '["1", "2"]\nother = ["1"]', "repeat: has 2 parameters"), ('"/traffic/packets"', '"packets"', "no JSON pointer"),
                ("1000 * force", "1000 * farce", "farce_rms_N is no column"), ("force_mN =", "packets =", "is the name of two columns"),
                ('"{p}"]', '"4%"]', "vary.p: is used nowhere"), ("{hand}", "{hands}", "nothing here has the name {hands}"),
                ('"{p}"]', '"{p"]', "is not closed"), ("one-{seed}.mcap", "one.mcap", "does not name {seed}"),
                ("one-{seed}.mcap", "{seed}/x", "is no name of a file"), ("[vary]", "[varied]", "is no key of a plan")):
            with self.subTest(printed), self.assertRaises(Refusal) as caught:
                loaded(SMALL.replace(old, new))
            self.assertIn(printed, "\n".join(text for text, _ in caught.exception.findings))

    def test_lines(self):
        with self.assertRaises(Refusal) as caught:
            loaded(SMALL.replace('"/traffic/packets"', '"packets"'))
        self.assertRegex(caught.exception.text, r"\.toml:13: measure\.packets: ")

    def test_shards_are_whole(self):
        import importlib.util
        spec = importlib.util.spec_from_file_location("sweep_script", PROJECT / "lab/sweep.py")
        script = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(script)
        for count in (1, 2, 3, 7):
            owners = [[i for i in range(1, count + 1) if script.is_of(number, (i, count))] for number in range(50)]
            self.assertTrue(all(len(of) == 1 for of in owners))
        every = {number % 4: {i for n in range(number % 4, 64, 4) for i in range(1, 5) if script.is_of(n, (i, 4))} for number in range(4)}
        self.assertTrue(all(owners == {1, 2, 3, 4} for owners in every.values()))  # each part gets all repetitions


class Reports(unittest.TestCase):
    def test_pointers(self):
        report = {"a": [{"b/c": 1, "d~e": "text"}], "f": None, "g": {}}
        self.assertEqual([pointed(report, pointer) for pointer in ("/a/0/b~1c", "/a/0/d~0e", "/f")], ["1", "text", "null"])
        for pointer in ("/a", "/a/1", "/a/x", "/g", "/h", "/a/0/b~1c/0"):
            self.assertIsNone(pointed(report, pointer))

    def test_terminals_get_no_control_characters(self):
        self.assertEqual(printable("a\x1b[31m\nü"), "a\\x1b[31m\nü")

    def test_tables(self):
        self.assertEqual(common_table.csv_text([["a", 'b"c'], ["d,e", "f\ng"]]), 'a,"b""c"\n"d,e","f\ng"\n')


class Spread(unittest.TestCase):
    def test_least_middle_largest(self):
        plan = loaded(SMALL)
        rows = [point | {"packets": str(n), "force_rms_N": "0.5" if n else "none", "host": "h", "seconds": "1.000"}
                for n, point in enumerate(plan.points())]
        head, cells = tables.spread_table(plan, tables.groups_of(plan, rows))
        self.assertEqual(head[:6], ["hand", "p", "repetitions", "force_rms_N_min", "force_rms_N_median", "force_rms_N_max"])
        self.assertEqual(cells[0], ["one", "1%", "2", "0.5", "0.5", "0.5", "0", "0.5", "1", "500", "500", "500"])
        self.assertEqual(cells[4][6:9], ["8", "8.5", "9"])

    def test_columns_of_times_stay_out(self):
        plan = loaded(SMALL + 'slow = "seconds * 2"\n')
        self.assertEqual(plan.timed(), {"seconds", "slow"})
        head, _ = tables.spread_table(plan, [])
        self.assertNotIn("slow_min", head)


class Killed(unittest.TestCase):
    def sweep(self, folder, *more, **how):
        words = [sys.executable, "-B", str(PROJECT / "lab/sweep.py"), f"{folder}/plan.toml", "-q", *more]
        return subprocess.Popen(words, start_new_session=True, stderr=subprocess.DEVNULL, **how)

    def test_a_killed_sweep_resumes_to_equal_tables(self):
        with tempfile.TemporaryDirectory() as folder:
            pathlib.Path(folder, "plan.toml").write_text(SMALL)
            self.assertEqual(self.sweep(folder, "-o", f"{folder}/whole").wait(120), 0)
            running = self.sweep(folder, "-o", f"{folder}/killed", "-j", "1")
            end = time.monotonic() + 60
            while len(list(pathlib.Path(folder, "killed/points").glob("*.json"))) < 3 and time.monotonic() < end:
                time.sleep(0.01)
            os.killpg(running.pid, signal.SIGKILL)
            running.wait()
            kept = len(list(pathlib.Path(folder, "killed/points").glob("*.json")))
            self.assertTrue(3 <= kept < 10, kept)
            self.assertEqual(self.sweep(folder, "-o", f"{folder}/killed").wait(120), 0)
            for name in ("points.csv", "table.csv", "context.json"):
                self.assertEqual(pathlib.Path(folder, "whole", name).read_bytes(), pathlib.Path(folder, "killed", name).read_bytes())
            with open(f"{folder}/killed/points.csv", newline="") as file:
                self.assertEqual(len(list(csv.DictReader(file))), 10)


class Figures(unittest.TestCase):
    def test_texts_are_texts_and_bytes_repeat(self):
        try:
            import matplotlib  # noqa: F401
        except ImportError:
            self.skipTest("no matplotlib")
        evil = r"$\frac{a}{b}$ `touch x` <b> {/Symbol a} %s"
        text = SMALL + f"[[plot]]\nname = 'f'\ntitle = '{evil}'\nx = 'p'\ny = ['packets', 'force_mN']\nseries = 'hand'\nlog = 'x'\n"
        text += "names = { one = '_hidden' }\n"
        plan = loaded(text)
        rows = [point | {"packets": str(n), "force_rms_N": "0.5", "host": "h", "seconds": "1.000"} for n, point in enumerate(plan.points())]
        with tempfile.TemporaryDirectory() as folder:
            drawn = []
            for _ in range(2):
                files, notes = tables.draw(plan, plan.plots[0], tables.groups_of(plan, rows), folder)
                self.assertEqual((len(files), notes), (3, []))
                drawn.append([pathlib.Path(file).read_bytes() for file in files])
            self.assertEqual(drawn[0], drawn[1])
            self.assertIn(b"&lt;b&gt;", drawn[0][0])


if __name__ == "__main__":
    unittest.main()
