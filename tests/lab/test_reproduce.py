#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""lab/reproduce.py: arithmetic, text and arguments; with the program at TACTUS, and tactus-study beside it, also figures."""
import contextlib
import io
import json
import math
import os
import pathlib
import statistics
import sys
import tempfile
import unittest
import xml.etree.ElementTree

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "lab"))
sys.dont_write_bytecode = True

import reproduce  # noqa: E402
from common import arguments  # noqa: E402
from thesis import delay, interpolations, limits, made, rates, signals, touch  # noqa: E402

TACTUS = os.environ.get("TACTUS", "")
STUDY = os.path.join(os.path.dirname(TACTUS), "tactus-study")
if TACTUS and os.path.exists(STUDY):
    os.environ.setdefault("TACTUS_STUDY", STUDY)


def parsed(*words):
    return reproduce.set_up().parse_args(words)


def row(rate, deviation):
    return {"packets_per_s": rate, "standard_deviation": deviation}


class Arithmetic(unittest.TestCase):
    def test_mean_and_deviation(self):
        values = [3.0, 5.0, 10.0]
        self.assertAlmostEqual(made.mean(values), 6)
        self.assertAlmostEqual(made.deviation(values), statistics.stdev(values))
        self.assertEqual(made.deviation([3.0]), 0)
        self.assertEqual(made.plus_minus([1.0, 2.0]), "1.5 +- 0.7")

    def test_three_digits(self):
        for value, text in ((None, "-"), (0.004, "0"), (-0.004, "0"), (0.125, "0.13"), (9.999, "10"), (12.34, "12.3"), (-12.36, "-12.4")):
            self.assertEqual(made._rounded(value), text)

    def test_quantiles_take_the_nearest(self):
        self.assertEqual([interpolations.quantile([1, 2, 3, 4], fraction) for fraction in (0, 0.5, 0.99, 1)], [1, 3, 4, 4])
        self.assertEqual(interpolations.quantile([], 0.5), 0)

    def test_gamma_density_is_a_density(self):
        shape, scale, start = 4.5, 5.3, 50
        step = 0.01
        at = [start + step * (i + 0.5) for i in range(30000)]
        weights = [step * limits.gamma_density(x, shape, scale, start) for x in at]
        self.assertAlmostEqual(sum(weights), 1, 5)
        self.assertAlmostEqual(sum(w * x for w, x in zip(weights, at)), start + shape * scale, 3)
        self.assertEqual(limits.gamma_density(start, shape, scale, start), 0)

    def test_jumps_of_a_force(self):
        ticks = {"force_rendered_N": [0, 1, 1, -2, -2], "update": [None, "haptic", None, "visual", "haptic"]}
        self.assertEqual(signals.jumps(ticks), {"updates": 3, "median_jump_N": 1, "largest_jump_N": 3})

    def test_fraction_outside_counts_contact_only(self):
        self.assertEqual(delay.fraction_outside([0, 1.0, 1.2, 0.5], [0, 1.0, 1.0, 0]), 100 * 2 / 3)
        self.assertEqual(delay.fraction_outside([0], [0]), 0)

    def test_after_a_jump(self):
        run = lambda of: {"ticks": [{"force_N": [9.0] * 2800 + of}]}
        most, long = touch.after_jump(run([1.05, 0.8, 1.0]), run([1.0, 1.0, 1.0]))
        self.assertAlmostEqual(most, -20)
        self.assertEqual(long, 1)

    def test_effects_leave_out_seeds_that_miss(self):
        met = {"mean_N": 2, "reference_mean_N": 1, "peak_N": 3, "reference_peak_N": 2, "outside": 0.5, "lowest_energy_J": -1e-3}
        missed = met | {"reference_mean_N": 0, "lowest_energy_J": 0}
        self.assertEqual(touch.effects([met, missed]), ([100], [50], [50], [-1, 0]))

    def test_order_of_settings(self):
        names = ("a", "b", "c")
        rows = lambda *of: dict(zip(names, (row(*one) for one in of)))
        self.assertEqual(rates.order_of(rows((3, 0), (2, 0), (1, 0)), names), "holds")
        self.assertEqual(rates.order_of(rows((3, 1), (3.5, 1), (1, 1)), names), "holds within the spread of the runs")
        self.assertEqual(rates.order_of(rows((3, 0.1), (3.5, 0.1), (1, 0.1)), names), "does not hold")

    def test_violations_are_added_and_worst_kept(self):
        run = {"packets_per_s": 2.0, "payload_bit_per_s": 8, "bytes_per_update": 4, "visual_violations": 1, "fraction_over_jnd": 0.5,
               "fraction_in_contact": 0.5, "haptic_violations": 2, "fraction_shown_over": 0.2, "worst_shown_ratio": 1.5}
        found = rates.summarise(rates.SETTINGS["S4_NI"], [run, run | {"packets_per_s": 4.0, "worst_shown_ratio": 1.2}])
        self.assertEqual((found["packets_per_s"], found["visual_violations"], found["haptic_violations"], found["worst_shown_ratio"]),
                         (3, 2, 4, 1.5))
        self.assertNotIn("haptic_violations", rates.summarise(rates.SETTINGS["S_R1"], [run]))


class Arguments(unittest.TestCase):
    def test_lengths_need_units(self):
        self.assertEqual(parsed("fig3.14", "--tremor", "0.2mm", "--length-unit", "5 cm").tremor, 0.0002)
        for wrong in ("0.05", "0mm", "-1mm", "1km", "x"):
            with self.subTest(wrong), self.assertRaises(arguments.Refusal) as refused:
                parsed("fig3.14", "--length-unit", wrong)
            self.assertEqual(refused.exception.status, arguments.USAGE)

    def test_unknown_figures_and_wrong_numbers(self):
        for words in (["fig9"], [], ["fig3.3", "--seeds", "0"], ["fig3.3", "--duration-scale", "0"], ["fig3.3", "--grip", "tight"]):
            with self.subTest(words), self.assertRaises(arguments.Refusal):
                parsed(*words)

    def test_command_of_a_section(self):
        options = parsed("all", "--seeds", "2", "--tremor", "0.2mm", "-o", "x")
        self.assertEqual(reproduce.typed("fig4.1", options), "tactus reproduce fig4.1 --seeds 2 --tremor 0.0002m")
        again = parsed(*reproduce.typed("fig4.1", options).split()[2:])
        self.assertEqual((again.seeds, again.tremor, again.length_unit), (2, 0.0002, 0.05))

    def test_all_needs_a_folder_and_prints_no_json(self):
        for words in (["all"], ["all", "-o", "x", "--json"]):
            with self.subTest(words), self.assertRaises(arguments.Refusal) as refused:
                reproduce.work(parsed(*words))
            self.assertEqual(refused.exception.status, arguments.USAGE)

    def test_figures_in_order_of_the_thesis(self):
        number = lambda name: [int("".join(filter(str.isdigit, part))) for part in name.split(".")]
        self.assertEqual(list(reproduce.FIGURES), sorted(reproduce.FIGURES, key=number))
        self.assertEqual(len(reproduce.FIGURES), 25)


@unittest.skipUnless(os.path.exists(STUDY) and TACTUS, "needs the program, and tactus-study beside it")
class Figures(unittest.TestCase):
    FAST = ("fig4.7", "fig4.18", "fig4.20", "fig4.21", "fig4.22", "fig4.24")

    def made(self, name, *more):
        out = io.StringIO()
        with contextlib.redirect_stdout(out):
            reproduce.work(parsed(name, "-q", "--json", *more))
        return json.loads(out.getvalue())

    def test_numbers_of_the_thesis(self):
        near = {"%": 2.5, "dB": 0.05, "ms": 1}
        for name in ("fig4.7", "fig4.20", "fig4.21", "fig4.22"):
            compared = 0
            for quantity in self.made(name)["quantities"]:
                values = quantity["values"]
                if "thesis" in values:
                    compared += 1
                    self.assertLessEqual(abs(values["here"] - values["thesis"]), near[quantity["unit"]], quantity["name"])
            self.assertGreater(compared, 0)

    def test_all_numbers_are_finite_and_named(self):
        for name in self.FAST:
            report = self.made(name)
            self.assertEqual((report["schema"], report["figure"]), ("tactus.reproduce_delay/1", name))
            for quantity in report["quantities"]:
                self.assertEqual(set(quantity), {"name", "unit", "values"})
                self.assertTrue(quantity["values"] and all(map(math.isfinite, quantity["values"].values())), quantity)

    def test_drawings_are_the_same_twice(self):
        try:
            import matplotlib  # noqa: F401
        except ImportError:
            self.skipTest("needs matplotlib")
        with tempfile.TemporaryDirectory() as folder:
            for name in ("fig3.3", "fig4.21"):
                self.made(name, "-o", folder)
                drawn = pathlib.Path(folder, name + ".svg").read_bytes()
                self.made(name, "-o", folder, "-f")
                self.assertEqual(pathlib.Path(folder, name + ".svg").read_bytes(), drawn)
                xml.etree.ElementTree.fromstring(drawn)  # well formed
                self.assertGreater(len(drawn), 10_000)
                with self.assertRaises(arguments.Refusal):  # they are not replaced unless that is asked for
                    self.made(name, "-o", folder)
            self.assertEqual(len(list(pathlib.Path(folder).glob("*.pdf"))), 2)


if __name__ == "__main__":
    unittest.main()
