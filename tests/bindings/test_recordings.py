# SPDX-License-Identifier: Apache-2.0
"""Recordings of one's own in Python: arrays and tables to traces, streams and figures."""
import json
import math
import pathlib
import pickle
import re
import sys

import numpy as np
import pytest

import tactus

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "tools"))


def test_the_page_of_recordings(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"^```python\n(.*?)^```$", (ROOT / "docs/recordings.md").read_text(), re.M | re.S)
    for block in blocks:
        exec(block, {})
    trace = tactus.read_trace("sine.mcap")
    assert len(blocks) == 1 and len(trace.ticks) == 2000
    assert abs(float(trace.position[1000, 0, 0]) - 0.05 * math.sin(1)) < 1e-12


def swinging(time):
    """(T, 3) positions, (T, 4) rotations w x y z and (T, 3) forces of a cup."""
    position = np.stack([0.1 * np.sin(2 * time), 0.05 * np.cos(3 * time), 0 * time + 0.2], axis=1)
    angle = 0.5 * np.sin(time)
    rotation = np.stack([np.cos(angle / 2), 0 * time, 0 * time, np.sin(angle / 2)], axis=1)
    force = np.stack([0 * time, 0 * time, 2 + np.sin(5 * time)], axis=1)
    return position, rotation, force


def test_a_trace_from_arrays_keeps_their_values(tmp_path):
    time = np.arange(1000) / 500
    position, rotation, force = swinging(time)
    of = {"cup": (position, rotation), "table": np.tile([1.0, 2, 3], (1000, 1))}
    trace = tactus.Trace.from_arrays(time, of, {"left": force, "right": -force}, {"left": position})
    assert trace.tick_rate == 500 and trace.object_names == ["cup", "table"] and trace.user_names == ["left", "right"] and not trace.notes
    assert (trace.ticks == np.arange(1000)).all() and (trace.position[:, 0] == position).all() and (trace.position[:, 1] == [1, 2, 3]).all()
    assert np.abs(trace.rotation[:, 0] - rotation).max() < 1e-15
    assert (trace.force[:, 0] == force).all() and (trace.force[:, 1] == -force).all() and (trace.device[:, 0] == position).all()
    assert np.abs(trace.velocity[1:, 0] - np.diff(position, axis=0) * 500).max() < 1e-9
    trace.save(tmp_path / "own.mcap")
    again = tactus.read_trace(tmp_path / "own.mcap")
    assert (again.objects == trace.objects).all() and (again.users == trace.users).all() and again.dofs == [63, 7]
    stream = trace.encode(tactus.RigidBounds(visual_position=1e-3))
    assert stream == tactus.encode(tmp_path / "own.mcap", tactus.RigidBounds(visual_position=1e-3))
    shown = stream.to_arrays(trace.ticks)
    assert list(shown) == ["time", "cup", "table"]
    assert np.linalg.norm(shown["cup"][:, :3] - position, axis=1).max() <= 1e-3
    assert len(repr(stream)) < 80 and len(repr(stream.decode())) < 120 and len(repr(trace)) < 200
    assert tactus.compare(trace.to_bytes(), stream).holds


def test_times_of_every_kind_are_the_same():
    time = np.arange(200) / 250
    position, _, _ = swinging(time)
    whole = np.round(time * 1e9).astype(np.int64)
    epoch = 1_700_000_000_000_000_000
    plain = tactus.Trace.from_arrays(time, position)
    for other in (tactus.Trace.from_arrays(whole + epoch, position), tactus.Trace.from_arrays((whole + epoch).astype("M8[ns]"), position),
                  tactus.Trace.from_arrays(whole.astype("m8[ns]"), position), tactus.Trace.from_arrays(1e3 * time, position, time_unit="ms"),
                  tactus.Trace.from_arrays(None, position, tick_rate=250), tactus.Trace.from_arrays(list(time), position.tolist()),
                  tactus.Trace.from_arrays(time + 100, position)):
        assert other.tick_rate == 250 and (other.ticks == plain.ticks).all() and (other.objects == plain.objects).all()


def test_quaternions_by_order_and_columns_by_name():
    time = np.arange(100) / 100
    position, rotation, force = swinging(time)
    plain = tactus.Trace.from_arrays(time, {"cup": (position, rotation)}, {"hand": force})
    swapped = np.concatenate([position, rotation[:, [1, 2, 3, 0]]], axis=1)
    assert (tactus.Trace.from_arrays(time, {"cup": swapped}, order="xyzw").objects == plain.objects).all()

    class Columns(dict):  # as a data frame answers
        columns = property(lambda self: list(self))

    frame = Columns({"qz": rotation[:, 3], "x": position[:, 0], "y": position[:, 1], "z": position[:, 2], "qw": rotation[:, 0],
                     "qx": rotation[:, 1], "qy": rotation[:, 2]})
    forces = Columns({"fz": force[:, 2], "fx": force[:, 0], "fy": force[:, 1]})
    framed = tactus.Trace.from_arrays(time, {"cup": frame}, {"hand": forces})
    assert (framed.objects == plain.objects).all() and (framed.users == plain.users).all()
    del frame["y"]
    with pytest.raises(tactus.Error) as refused:
        tactus.Trace.from_arrays(time, {"cup": frame})
    assert refused.value.rule == "R-CSV-2" and "poses['cup']" in str(refused.value)


def test_missing_samples_are_interpolated_and_counted():
    time = np.arange(1000) / 500
    position, rotation, force = swinging(time)
    held, holes = position.copy(), position.copy()
    holes[100:110] = np.nan  # 22 ms from sample to sample
    holes[500:600, 1] = np.inf  # 202 ms: the last one is held
    turned = rotation.copy()
    turned[700] = 0
    trace = tactus.Trace.from_arrays(time, {"cup": (holes, turned)}, {"hand": force})
    line = position[99] + (np.arange(1, 11) / 11)[:, None] * (position[110] - position[99])
    off = np.abs(trace.position[100:110, 0] - position[100:110]).max()  # a parabola, as the rows beside the gap bend alike
    assert off < 0.2 * np.abs(line - position[100:110]).max()
    assert (trace.position[500:600, 0] == held[499]).all() and (trace.position[600, 0] == held[600]).all()
    assert np.abs(trace.rotation[700, 0] - rotation[700]).max() < 1e-5 and len(trace.ticks) == 1000
    assert trace.notes == ["cup.position: missing samples, interpolated (10; first row 100, at 0.2 s)",
                           "cup.position: missing samples, the one before the gap held (100; first row 500, at 1 s)",
                           "cup.rotation: missing samples, interpolated (row 700, at 1.4 s)"]


def test_times_of_a_clock_with_jitter_are_resampled():
    random = np.random.default_rng(5)
    even = np.arange(2400) / 240
    time = even + random.uniform(-0.2, 0.2, 2400) / 240
    time[0] = 0
    position, rotation, _ = swinging(time)
    trace = tactus.Trace.from_arrays(time, {"cup": (position, rotation)})
    assert trace.tick_rate == 240 and (np.diff(trace.ticks) == 1).all()
    wanted = swinging(trace.ticks / 240)
    assert np.abs(trace.position[:, 0] - wanted[0]).max() < 2e-6  # of a line between samples: h^2 a / 8
    assert len(trace.notes) == 1 and "interpolated onto it" in trace.notes[0] and "240 Hz" in trace.notes[0]
    with_pause = np.concatenate([even[:100], even[100:200] + 5])
    paused = tactus.Trace.from_arrays(with_pause, swinging(with_pause)[0])
    assert len(paused.ticks) == 200 and paused.ticks[100] == 1300


def test_arrays_are_refused_with_rule_and_location():
    time = np.arange(10) / 100
    good = np.zeros((10, 3))
    cases = [(dict(time=time, poses={"cup": good[:5]}), "R-CSV-8", "poses['cup'] has shape (5, 3)"),
             (dict(time=time, poses={"cup": good}, wrenches={"hand": np.zeros((10, 2))}), "R-CSV-8", "wrenches['hand']"),
             (dict(time=time, poses={"cup": good * np.nan}), "R-CSV-4", "cup.position: every sample is missing"),
             (dict(time=time[::-1], poses={"cup": good}), "R-CSV-5", "time: falls"),
             (dict(time=time), "R-CSV-8", ""),
             (dict(poses=good), "R-CSV-7", "tick_rate"),
             (dict(time=np.arange(10), poses=good), "R-CSV-7", ""),  # whole numbers are nanoseconds
             (dict(time=time, poses={"a/b": good}), "R-TRC-17", ""),
             (dict(time=["a"] * 10, poses=good), "R-CSV-8", "time has")]
    for arguments, rule, location in cases:
        with pytest.raises(tactus.Error) as refused:
            tactus.Trace.from_arrays(**arguments)
        assert refused.value.rule == rule and location in str(refused.value), arguments
        assert "--" not in str(refused.value), refused.value  # options of the program help nobody here
    one_back = time.copy()
    one_back[5] = 0.01
    trace = tactus.Trace.from_arrays(one_back, {"cup": good})
    assert trace.notes[0] == "time: falls; the row is left out (row 5)"


def test_times_that_repeat_are_spread_as_those_of_a_table():
    """A clock of 10 ms, a driver that hands over ten at once, and copies: times of samples are even, copies count once."""
    even = np.arange(2000) / 1000
    position, rotation, force = swinging(even)
    for time in (np.floor(even * 100) / 100, np.repeat(even[9::10], 10)):
        trace = tactus.Trace.from_arrays(time, {"cup": (position, rotation)}, {"hand": force})
        assert trace.tick_rate == 1000 and (np.diff(trace.ticks) == 1).all() and len(trace.ticks) > 1985
        first = np.argmin(np.abs(position[:20] - trace.position[0, 0]).sum(axis=1))
        assert np.abs(trace.position[:1900, 0] - position[first:first + 1900]).max() < 1e-4
        assert any(note.startswith("time: several rows share a time or come in groups, of 10 rows each") for note in trace.notes), trace.notes
    copied = tactus.Trace.from_arrays(np.repeat(even, 2), {"cup": np.repeat(position, 2, axis=0)})
    assert copied.tick_rate == 1000 and np.abs(copied.position[:, 0] - position).max() == 0
    assert copied.notes == ["time: repeats; of equal times the last row counts (2000; first row 0)"]


def test_devices_turn_as_objects_do():
    time = np.arange(100) / 100
    position, rotation, force = swinging(time)
    by_row = tactus.Trace.from_arrays(time, devices={"hand": np.hstack([position, rotation])}, wrenches={"hand": force})
    assert np.abs(by_row.users["device"]["orientation"][:, 0] - rotation).max() < 1e-12
    assert np.abs(by_row.device[:, 0] - position).max() == 0 and by_row.senses == [1]
    by_pair = tactus.Trace.from_arrays(time, devices={"hand": (position, rotation[:, [1, 2, 3, 0]])}, order="xyzw")
    assert np.abs(by_pair.users["device"]["orientation"][:, 0] - rotation).max() < 1e-12
    with pytest.raises(tactus.Error) as refused:
        tactus.Trace.from_arrays(time, devices={"hand": np.zeros((100, 6))})
    assert "devices['hand'] has shape (100, 6), not (100, 3) or (100, 7)" in str(refused.value)


def test_errors_of_recordings_say_file_topic_and_time(tmp_path):
    from ros_bag import Bag, pose
    bag = Bag()
    cup = bag.channel("/cup/pose", "pose")
    for i in range(200):  # 0.9 years apart from the hundredth on
        bag.add(cup, 1e6 + i / 100 + 2.8e7 * max(0, i - 100), pose(1e6, at=(i / 1000, 0, 0)))
    bag.write(tmp_path / "leaps.mcap")
    data = (tmp_path / "leaps.mcap").read_bytes()
    for given, file in ((tmp_path / "leaps.mcap", str(tmp_path / "leaps.mcap")), (data, "")):
        with pytest.raises(tactus.Error) as refused:
            tactus.read_trace(given)
        assert refused.value.rule == "R-TRC-15" and refused.value.words == str(refused.value)
        assert refused.value.words.startswith(file) and "/cup/pose, at 2156000001 s: " in refused.value.words, refused.value.words
        assert "--skip /cup/pose leaves the topic out" in refused.value.words
        assert str(pickle.loads(pickle.dumps(refused.value))) == str(refused.value)
    (tmp_path / "table.xlsx").write_bytes(b"PK\3\4" + bytes(60) + b"xl/workbook.xml")
    with pytest.raises(tactus.Error) as refused:
        tactus.read_trace(tmp_path / "table.xlsx")
    assert "table.xlsx" in str(refused.value) and refused.value.words


def test_a_figure_is_written_as_pdf_svg_and_png(tmp_path):
    pytest.importorskip("matplotlib")
    time = np.arange(500) / 500
    position, rotation, force = swinging(time)
    trace = tactus.Trace.from_arrays(time, {"cup": (position, rotation)}, {"hand": force})
    for ending, head in (("pdf", b"%PDF"), ("svg", b"<?xml"), ("png", b"\x89PNG")):
        tactus.plot(trace, trace.encode(), tmp_path / f"figure.{ending}")
        assert (tmp_path / f"figure.{ending}").read_bytes().startswith(head)


def test_declared_contacts_give_recorded_forces_a_bound():
    time = np.arange(1000) / 500
    position, rotation, force = swinging(time)
    force[:, 1] = force[:, 2]  # a plane's force changes with what moves along it
    arrays = time, {"cup": (position, rotation)}, {"hand": force}
    bounds = tactus.RigidBounds(weber_fraction=0.04, visual_position=0.02, visual_rotation=0.5)

    def packets(trace):
        return sum(packet.reason == "haptic" for packet in trace.encode(bounds).decode(trace.ticks).packets)

    assert packets(tactus.Trace.from_arrays(*arrays)) == 0
    touched = tactus.Trace.from_arrays(*arrays, contacts={"hand": ("cup", 500)})
    contact = touched.users["contact"][100, 0]
    assert contact["kind"] == 1 and contact["stiffness"] == 500 and (contact["device"] == position[100]).all()
    assert abs(contact["point"][2] - force[100, 2] / 500) < 1e-12  # of the object: the force stretches the spring by so much
    assert packets(touched) > 0
    held = tactus.Trace.from_arrays(*arrays, {"hand": position + [0, 0, 0.01]}, contacts={"hand": ("cup", 500, "spring")})
    assert held.users["contact"]["kind"][100, 0] == 2 and (held.users["contact"]["device"][100, 0] == (position + [0, 0, 0.01])[100]).all()
    for contacts, rule, location in [({"foot": ("cup", 500)}, "R-API-5", "no user 'foot', but 'hand'"),
                                  ({"hand": ("saucer", 500)}, "R-API-5", "no object 'saucer', but 'cup'"), ({"hand": ("cup", -1)}, "R-API-4", ""),
                                  ({"hand": 500}, "R-CSV-8", "contacts['hand'] is 500"),
                                  ({"hand": ("cup", 500, "cube")}, "R-CSV-8", "neither 'plane' nor 'spring'")]:
        with pytest.raises(tactus.Error) as refused:
            tactus.Trace.from_arrays(*arrays, contacts=contacts)
        assert refused.value.rule == rule and location in str(refused.value), contacts


def test_frames_of_pandas():
    pandas = pytest.importorskip("pandas")
    time = np.arange(200) / 250
    position, rotation, force = swinging(time)
    plain = tactus.Trace.from_arrays(time, {"cup": (position, rotation)}, {"hand": force})
    frame = pandas.DataFrame({name: column for names, columns in (("xyz", position), (("qw", "qx", "qy", "qz"), rotation), (("fx", "fy", "fz"), force))
                              for name, column in zip(names, columns.T)})
    epoch = pandas.to_datetime(1_700_000_000_000_000_000 + np.round(time * 1e9).astype(np.int64))
    for when in (pandas.Series(time), epoch, pandas.Series(epoch), epoch.tz_localize("UTC"), pandas.Series(epoch.tz_localize("Europe/Berlin"))):
        framed = tactus.Trace.from_arrays(when, {"cup": frame}, {"hand": frame})
        assert (framed.objects == plain.objects).all() and (framed.users == plain.users).all()


def test_times_with_a_zone_are_those_of_utc():
    stamps = np.datetime64("2024-05-01T12:00:00", "ns") + np.arange(100) * np.timedelta64(4, "ms")

    class Zoned:  # as an index of pandas answers
        tz = "Europe/Berlin"

        def tz_convert(self, zone):
            assert zone is None
            return stamps

    column = type("Column", (), {"dt": Zoned()})
    for when in (stamps, Zoned(), column()):
        assert tactus.Trace.from_arrays(when, np.zeros((100, 3))).tick_rate == 250


def test_the_notebook_runs_and_draws(tmp_path, monkeypatch, capsys):
    pytest.importorskip("matplotlib")
    monkeypatch.chdir(tmp_path)
    names = {}
    for number, cell in enumerate(json.loads((ROOT / "examples" / "recording.ipynb").read_text())["cells"]):
        assert cell.get("outputs", []) == []
        if cell["cell_type"] == "code":
            exec(compile("".join(cell["source"]), f"recording.ipynb, cell {number}", "exec"), names)
    assert (tmp_path / "own.pdf").read_bytes().startswith(b"%PDF") and len(tactus.read_trace("own.mcap").ticks) == 2000
    assert "cup.position: missing samples, interpolated (10; first row 300, at 0.6 s)" in capsys.readouterr().out
    assert names["result"].holds and list(names["rates"].values()) == sorted(names["rates"].values(), reverse=True)
    assert names["result"].force.max > 0
