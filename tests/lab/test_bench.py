# SPDX-License-Identifier: Apache-2.0
"""Studies of lab/studies without the programs: what is computed in Python from points, resumption, errors."""
import csv
import os
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "lab"))
from common.arguments import Refusal  # noqa: E402
from studies import delay, precision, precision_report, session, signals, stability, stability_figures, world, world_costs  # noqa: E402


def numbers(force):
    return {key: None for key, *_ in delay.QUANTITIES} | {"force_error": force}


class Delay(unittest.TestCase):
    def row(self, *forces):
        return {"scene": "s", "user": "u", "round_trip_ms": 50.0, "network": "constant", "clients": "none",
                "seeds": [numbers(force) for force in forces]}

    def test_spread_is_mean_and_farthest_from_zero_of_what_was_measured(self):
        self.assertEqual(delay.spread(self.row(0.25, -0.5, None), "force_error", 100), (-12.5, -50))
        self.assertEqual(delay.spread(self.row(None), "force_error", 100), (None, None))

    def test_cells(self):
        self.assertEqual(delay.cell(self.row(0.25, -0.5), "force_error", 100, 1), "-12.5 (-50.0)")
        self.assertEqual(delay.cell(self.row(-1e-5), "force_error", 100, 1), "0.0")
        self.assertEqual(delay.cell(self.row(None), "force_error", 100, 1), "-")
        self.assertEqual(list(delay.as_json(self.row(0.25)))[5:], ["same_motion_force_error_percent"])

    def test_times(self):
        parser = delay.parser("")
        self.assertEqual(parser.parse_args(["--round-trip", "25ms,0.1s"]).round_trip, [25_000, 100_000])
        for wrong in (["--round-trip", "100"], ["--round-trip", "2s"], ["--duration", "10ms"], ["--seeds", "0"]):
            with self.assertRaises(Refusal) as refused:
                parser.parse_args(wrong)
            self.assertEqual(refused.exception.status, 2)

    def test_the_command_is_named_as_typed(self):
        parse = delay.parser("").parse_args
        self.assertEqual(delay.command_of(parse([]), delay.SCENES), "tactus bench delay")
        self.assertEqual(delay.command_of(parse(["msd-1d", "--round-trip", "50ms", "--duration", "3s"]), ["msd-1d"]),
                         "tactus bench delay msd-1d --round-trip 50ms --duration 3s")


class Precision(unittest.TestCase):
    def test_extrapolation_of_order_two_is_exact(self):
        limit, order, uncertainty = precision.extrapolate(*(3 + 0.5 * h * h for h in (1, 1 / 2, 1 / 4)))
        self.assertAlmostEqual(limit, 3, 12)
        self.assertAlmostEqual(order, 2, 12)
        self.assertAlmostEqual(uncertainty, 0, 12)

    def test_space_errors(self):
        points = [{"refinement": r, "quadratic_m_per_n": 3 + 0.5 / r**2, "deflection_m_per_n": 3 * (1 - 0.1 / r),
                   "transient_m": t}
                  for r, t in ((1, [3.0, 8.0]), (2, []), (4, [3.0, 4.0]))]
        errors = precision.space_errors(points)
        for error, wanted in zip(errors["static_error"], (0.1, 0.05, 0.025)):
            self.assertAlmostEqual(error, wanted, 12)
        self.assertEqual(errors["transient_error"], [0.8, None, None])

    def test_a_row_that_was_cut_off_is_dropped_and_whole_ones_stay(self):
        row = dict.fromkeys(precision.TIME_COLUMNS, 0.1) | {"scene": "s", "method": "a, b", "steps_per_sample": 5, "runs": 1,
                                                          "unconverged_steps": 0, "taken": "", "remark": "", "force_error": None}
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "time.csv")
            table = precision.Growing(path, precision.TIME_COLUMNS)
            kept = table.add(row | {"step_s": 1 / 3})
            self.assertEqual((kept["step_s"], kept["force_error"]), (0.3333333, None))
            table.add(row)
            text = pathlib.Path(path).read_text(encoding="utf8")
            pathlib.Path(path).write_text(text[:-4], encoding="utf8")
            again = precision.Growing(path, precision.TIME_COLUMNS)
            self.assertEqual(again.rows, [kept])
            self.assertEqual(again.find(method="a, b", steps_per_sample=5), kept)
            with open(path, encoding="utf8", newline="") as file:
                self.assertEqual(len(list(csv.reader(file))), 2)
            with self.assertRaises(Refusal):
                precision.Growing(path, precision.SPACE_COLUMNS)

    def test_results_of_another_context_are_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            precision.take_up(folder, {"machine": "one"}, False)
            precision.take_up(folder, {"machine": "one"}, False)
            with self.assertRaises(Refusal):
                precision.take_up(folder, {"machine": "another"}, False)
            precision.take_up(folder, {"machine": "another"}, True)

    def test_usable(self):
        self.assertEqual([precision_report.is_usable(error) for error in (None, 0, 0.5, 1.5)], [False, False, True, False])


class Others(unittest.TestCase):
    def test_options_of_the_encoder_are_handed_on(self):
        options = session.parser("").parse_args(["a.mcap", "-p", "4%", "--tune", "reduction=none", "--visual", "1mm,2deg", "--short"])
        self.assertEqual(options.encoder, ["-p", "4%", "--tune", "reduction=none", "--visual", "1mm,2deg"])
        self.assertEqual((options.traces, options.short), (["a.mcap"], True))
        self.assertEqual(session.parser("").parse_args([]).encoder, [])

    def test_remarks_of_a_session(self):
        case = {"recovery_s": 0.2, "seconds": 10, "bound_scale": {"largest": 2.04, "for_s": 5}}
        self.assertEqual(session.remarks(case), "; recovered 200 ms after it; bounds up to 2.0 times as wide for 50 % of the time")

    def test_tables_of_signals_begin_with_each_user_and_signal(self):
        base = {"within": "1 mm", "packets": 1, "bytes": 2, "largest_error": 0, "rms_error": 0, "fraction_of_permitted": 0,
                "samples_over": 0, "time_per_sample_s": 1e-6}
        kinds = [("a", "device"), ("a", "device"), ("a", "force"), ("b", "force")]
        recording = {"seconds": 2, "signals": [base | {"user": user, "signal": signal} for user, signal in kinds]}
        self.assertEqual([len(rows) for _, rows in signals.tables(recording)], [2, 1, 1])

    def test_stability(self):
        row = {"deviation": -1e-6, "parameters": [{"name": "k", "value": 100.0, "unit": "N/m"}, {"name": "N", "value": 2.0,
            "unit": ""}]}
        self.assertEqual(stability.deviation(row), "0.00 %")
        self.assertEqual(stability.parameters(row, "; "), "k 100 N/m; N 2")
        found = stability_figures.of([{"study": "jury", "series": {"figure-4.16-a": {"rows": []},
                                                                   "figure-4.16-b": {"rows": []}}}])
        self.assertEqual([name for name, _, _ in found], ["jury-figure-4.16"])


class World(unittest.TestCase):
    REPORT = pathlib.Path(__file__).resolve().parents[2] / "reports/world"

    def setUp(self):
        if world_costs.numpy is None:
            self.skipTest("needs NumPy")
        from studies import world_model
        self.numpy, self.model = world_costs.numpy, world_model

    def test_unit_costs_are_those_that_were_measured(self):
        with open(self.REPORT / "measured.csv", encoding="utf8", newline="") as file:
            self.assertEqual(world_costs.fit(list(csv.DictReader(file))), world_costs.COSTS)
        self.assertEqual(world_costs.read(self.REPORT / "costs.csv"), world_costs.COSTS)

    def test_unit_costs_meet_what_was_measured(self):
        costs, ratios = world_costs.COSTS, []
        with open(self.REPORT / "measured.csv", encoding="utf8", newline="") as file:
            for row in csv.DictReader(file):
                if row["what"] == "physics" or row["reach_m"] == "0":  # without interest clients share nearly all
                    continue
                at = {key: float(cell) for key, cell in row.items() if key != "what"}
                thousands = at["objects"] / 1000
                packets = at["down_datagrams_per_tick"] - costs["idle_datagrams_per_s"] / 1000
                of_client = costs["session_us"] + costs["look_us"] * at["moving"] + packets * (
                    costs["packet_us"] + costs["packet_of_1000_us"] * thousands) + costs["tell_us"] * sum(
                        at[f"moving_in_lod{level}"] for level in range(7))
                of_truth = costs["truth_us"] + costs["truth_of_1000_us"] * thousands
                ratios.append((at["clients"] * of_client + at["moving"] * of_truth) / (1e6 * at["tick_s"]))
        self.assertEqual(len(ratios), len(world_costs.POINTS) - 1)
        self.assertTrue(all(0.75 < ratio < 1.3 for ratio in ratios), ratios)

    def test_levels_of_detail_and_their_hysteresis(self):
        limits = world_costs.level_limits(2, 16)
        self.assertEqual(list(limits), [2, 4, 8, 16, 16, 16, 16])
        levels = lambda before, *distances: list(world_costs.levels_at(limits, self.numpy.array(distances), before))
        self.assertEqual(levels(7, 1, 2, 2.1, 5, 16, 16.1), [0, 0, 1, 2, 3, 7])
        self.assertEqual(levels(0, 2.29, 2.31, 4.59, 4.61), [0, 1, 1, 2])
        self.assertEqual(levels(3, 18.3, 18.5, 7), [3, 7, 2])

    def test_regions_share_the_cost_and_fill_the_world(self):
        setting = self.model.Setting(servers=3, side=12)
        sites = self.numpy.array([[x + 0.5, x + 0.5] for x in range(12)])
        weights = self.numpy.array([4.0, 4, 4] + [1] * 3 + [3] * 3 + [0] * 3)  # of 24
        regions = self.model.Regions(setting, sites, weights)
        owner = regions.of(sites)
        self.assertEqual([weights[owner == server].sum() for server in range(3)], [8, 7, 9])
        points = self.numpy.random.default_rng(1).uniform(0, 12, (1000, 2))
        inside = [regions.distance(points, self.numpy.full(1000, server)) == 0 for server in range(3)]
        self.assertTrue((self.numpy.sum(inside, axis=0) == 1).all())
        self.assertTrue((self.numpy.argmax(inside, axis=0) == regions.of(points)).all())

    def test_an_owner_changes_behind_the_margin(self):
        regions = self.model.Regions(self.model.Setting(servers=2, side=10), self.numpy.array([[4.0, 1], [5, 1]]), self.numpy.ones(2))
        self.assertEqual(list(regions.high[0]), [5, 10])
        before = self.numpy.array([0, 0, 1, 1], self.numpy.int16)
        sites = self.numpy.array([[5.9, 3], [6.1, 3], [4.1, 3], [3.9, 3]])
        self.assertEqual(list(regions.owners(sites, before, 1)), [0, 1, 1, 0])

    def test_what_a_user_holds_belongs_to_its_server(self):
        made = self.model.World(self.model.Setting(objects=2, users=1, servers=2, side=10, seed=1), dict(world_costs.COSTS))
        made.regions = self.model.Regions(made.setting, self.numpy.array([[4.0, 1], [5, 1]]), self.numpy.ones(2))
        made.users, made.server = self.numpy.array([[4.5, 3.0]]), self.numpy.array([0], self.numpy.int16)
        made.objects, made.owner = self.numpy.array([[6.5, 3.0], [8, 3]]), self.numpy.array([1, 1], self.numpy.int16)
        made.holder[0] = 0
        gone, objects = made._own(self.numpy.array([0]))
        self.assertEqual((list(made.owner), gone.any(), objects), ([0, 1], False, 1))
        made._own(self.numpy.array([], int))  # it rests: to the region again
        self.assertEqual((list(made.owner), list(made.holder)), ([1, 1], [-1, -1]))

    def test_updates_of_a_tick_share_a_datagram(self):
        self.assertAlmostEqual(self.model.datagrams(1.0), 1, 2)
        self.assertAlmostEqual(self.model.datagrams(1000.0), 632.1, 1)

    def test_cells_have_means_and_spread(self):
        self.assertEqual(world.spread([1.0, 1.0]), "1")
        self.assertEqual(world.spread([1.0, 2.0, 3.0]), "2 (1 to 3)")
        self.assertEqual([world_costs.digits(n) for n in (12345.6, 0.00012345, 0)], ["12300", "0.000123", "0"])


if __name__ == "__main__":
    unittest.main()
