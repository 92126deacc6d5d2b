# SPDX-License-Identifier: Apache-2.0
"""The Python package against the program, the conformance vectors and itself."""
import copy
import csv
import ctypes
import dataclasses
import importlib.util
import json
import math
import multiprocessing
import os
import pathlib
import pickle
import re
import subprocess
import sys

import numpy as np
import pytest

import tactus

ROOT = pathlib.Path(__file__).resolve().parents[2]
CONFORMANCE = ROOT / "conformance"
sys.path.insert(0, str(CONFORMANCE))
from run import answer_lines, load_cases, read_input  # noqa: E402
PROGRAM = os.environ.get("TACTUS_PROGRAM")
needs_program = pytest.mark.skipif(PROGRAM is None, reason="needs the program tactus with its simulation")
BOUNDS = {"weber_fraction": 0.04, "visual_position": 3e-4, "visual_rotation": math.radians(2)}


def program(*arguments):
    return subprocess.run([PROGRAM, *map(str, arguments)], check=True, capture_output=True, text=True).stdout


@pytest.fixture(scope="session")
def traces(tmp_path_factory):
    """A rigid and a deformable trace of the simulation."""
    folder = tmp_path_factory.mktemp("traces")
    program("sim", "rotate-push-lift", "--duration", "3s", "-o", folder / "rigid.mcap", "-q")
    program("sim", "membrane", "--duration", "2s", "-o", folder / "mesh.mcap", "-q")
    return folder


def swing(tick):
    """(1, 13): a cube on a spring."""
    w, t = 6.28, tick * 1e-3
    return [[0.1 * math.sin(w * t), 0, 0, 1, 0, 0, 0, 0.1 * w * math.cos(w * t), 0, 0, 0, 0, 0]]


def test_sender_and_receiver_agree():
    with tactus.build_scene([tactus.RigidObject("cube")]) as scene:
        sender, receiver = tactus.Sender(scene), tactus.Receiver(scene)
        sent = 0
        for tick in range(1000):
            for packet in sender.encode(tick, swing(tick)):
                assert packet.kind == "rigid" and packet.size == len(packet.data) and packet.tick == tick
                assert receiver.push(packet.data).updates == 1
                sent += 1
            assert np.abs(receiver.poses(tick)[0, :3] - swing(tick)[0][:3]).max() <= 0.006
        assert 5 < sent < 200
        assert sender.state_hash() == receiver.state_hash()
        assert receiver.scene.objects[0].name == "cube"


def test_a_mesh_keeps_its_bound():
    vertices = np.array([[0, 0, 0], [0.1, 0, 0], [0.1, 0.1, 0], [0, 0.1, 0]])
    triangles = np.array([[0, 1, 2], [0, 2, 3]], np.uint32)
    scene = tactus.build_scene(meshes=[tactus.Mesh("sheet", vertices, triangles)])
    sender, receiver = tactus.Sender(scene), tactus.Receiver(scene)
    for tick in range(200):
        shape = np.zeros((4, 3), np.float32)
        shape[:, 2] = 0.01 * math.sin(0.02 * tick)
        for packet in sender.encode(tick, shapes=[tactus.Shape(shape, triangle=0, force=1, stiffness=500)]):
            assert packet.kind == "deformable"
            receiver.push(packet.data)
        assert np.linalg.norm(receiver.displacements(0, tick) - shape, axis=1).max() <= 2.6e-4
    assert np.allclose(scene.meshes[0].vertices, vertices, atol=1e-6) and (scene.meshes[0].triangles == triangles).all()


def test_errors_have_class_and_rule(tmp_path):
    with pytest.raises(tactus.Error) as refused:
        tactus.build_scene([tactus.RigidObject("twin"), tactus.RigidObject("twin")])
    assert refused.value.rule == "R-STR-11" and refused.value.name == "invalid" and refused.value.subject == "twin"
    with pytest.raises(tactus.Error) as refused:
        tactus.Player(b"no stream")
    assert refused.value.rule == "R-STR-1" and refused.value.remedy
    with pytest.raises(tactus.Error) as refused:
        tactus.read_trace(tmp_path / "nowhere.mcap")
    assert refused.value.rule == "R-TRC-1" and "nowhere.mcap" in str(refused.value)
    scene = tactus.build_scene([tactus.RigidObject("cube")])
    with pytest.raises(tactus.Error) as refused:
        tactus.Sender(scene).encode(0, [[math.nan] * 13])
    assert refused.value.rule == "R-API-1"
    with pytest.raises(ValueError):
        tactus.Sender(scene).encode(0, [[0, 0, 0]])
    with pytest.raises(TypeError):
        tactus.RigidBounds(colour=1)
    with pytest.raises(IndexError):
        tactus.Receiver(scene).displacements(0, 0)
    stream = next(read_input(case) for case in load_cases(CONFORMANCE)[0] if case.id.startswith("client/"))
    player = tactus.Player(stream)
    player.close()
    with pytest.raises(ValueError, match="closed"):
        player.play(0)


def test_what_c_would_misread_is_refused():
    """Handles of another class, copies, numbers that would wrap, texts that would end early, and packets without bytes."""
    scene = tactus.build_scene([tactus.RigidObject("cube")])
    sender, receiver = tactus.Sender(scene), tactus.Receiver(scene)
    for make in (tactus.Sender, tactus.Receiver, tactus.StreamWriter):
        for wrong in (sender, receiver, 5, None):
            with pytest.raises(TypeError, match="Scene is wanted"):
                make(wrong)
    for again in (copy.copy, copy.deepcopy, pickle.dumps):
        with pytest.raises(TypeError, match="cannot be copied"):
            again(receiver)
    with pytest.raises(ctypes.ArgumentError, match="out of range"):
        sender.encode(1 << 64, swing(0))
    with pytest.raises(ctypes.ArgumentError, match="out of range"):
        receiver.state_hash(1 << 32)
    with pytest.raises(OverflowError):
        tactus.SenderOptions(baseline=1 << 32)
    assert (receiver.poses(np.int64(3)) == receiver.poses(3)).all()
    with pytest.raises(ValueError, match="null byte"):
        tactus.build_scene([tactus.RigidObject("a\0b")])
    with pytest.raises(ValueError, match="null byte"):
        tactus.TraceReader("a\0b")
    for corner in (-1, 0.5, (1 << 32) + 1):
        with pytest.raises(ValueError, match="whole numbers"):
            tactus.build_scene(meshes=[tactus.Mesh("m", np.eye(3), np.array([[0, 1, corner]]))])
    with pytest.raises(ValueError, match="contacts"):
        sender.encode(0, swing(0), np.zeros((1, 1), tactus.CONTACT))
    writer, packets = tactus.StreamWriter(scene), [p for tick in range(200) for p in sender.encode(tick, swing(tick))]
    decoded = receiver.push(bytearray(packets[0].data))
    with pytest.raises(TypeError):
        receiver.push("packet")
    with pytest.raises(ValueError, match="no bytes"):
        writer.add(decoded)


def test_a_few_bytes_do_not_ask_for_all_memory():
    scene = tactus.build_scene([tactus.RigidObject("cube")])
    sender, writer = tactus.Sender(scene), tactus.StreamWriter(scene)
    for tick in (0, 100, (1 << 32) - 100):
        for packet in sender.encode(tick, swing(tick)):
            writer.add(packet)
    stream = writer.finish()
    with pytest.raises(ValueError, match="implausibly far"):
        tactus.decode(stream)
    assert len(tactus.decode(stream, ticks=[0, 100, (1 << 32) - 100]).poses) == 3


def test_states_are_those_of_the_conformance_vectors():
    """The state hash after each packet, and the rule that a damaged stream breaks."""
    states = rules = 0
    cases, faults = load_cases(CONFORMANCE)
    assert not faults
    for case in cases:
        if "session" in case.traits:
            continue  # no stream
        packets = [line for line in map(json.loads, answer_lines(case)) if "packet" in line]
        seen = []
        try:
            with tactus.Player(read_input(case), limits=tactus.Limits(header_bytes=1 << 20, packet_bytes=1 << 20)) as player:
                while (tick := player.next_tick()) is not None:
                    played = player.play(tick)
                    for i, packet in enumerate(played, len(seen)):
                        if packet.substream not in [later.substream for later in played[i + 1 - len(seen):]]:
                            assert f"{player.state_hash(packet.substream):016x}" == packets[i]["state"], case.id
                            states += 1
                    seen += played
            assert not case.error, case.id
        except tactus.Error as refused:
            assert case.error and refused.rule == case.error["rule"], (case.id, str(refused))
            rules += 1
    assert states > 500 and rules > 50, (states, rules)


@needs_program
def test_encoding_equals_that_of_the_program(traces, tmp_path):
    def encoded(name, *options):
        program("encode", traces / name, "-o", tmp_path / "s.tct", "-q", "-f", *options)
        return (tmp_path / "s.tct").read_bytes()
    rigid, mesh = traces / "rigid.mcap", traces / "mesh.mcap"
    assert tactus.encode(rigid) == encoded("rigid.mcap")
    assert tactus.encode(rigid, tactus.RigidBounds(**BOUNDS)) == encoded("rigid.mcap", "-p", "4%", "--visual", "0.3mm,2deg")
    assert tactus.encode(rigid, profile="thesis") == encoded("rigid.mcap", "--profile", "thesis") != encoded("rigid.mcap")
    assert tactus.encode(rigid, reduction=tactus.REDUCTION_NONE) == encoded("rigid.mcap", "--no-reduction")
    assert tactus.encode(mesh) == encoded("mesh.mcap")
    assert tactus.encode(mesh, profile="thesis") == encoded("mesh.mcap", "--profile", "thesis")
    assert tactus.encode(mesh, modes=12) == encoded("mesh.mcap", "--basis", "12")
    fine = tactus.DeformableBounds(visual=1e-5)  # at which what is not asked for differs
    assert tactus.encode(mesh, None, fine, modes=12) == encoded("mesh.mcap", "--basis", "12", "--deformable-visual", "0.01mm")
    assert tactus.encode(mesh, clusters=8) == encoded("mesh.mcap", "--clusters", "8") != encoded("mesh.mcap")
    with pytest.raises(ValueError, match="one basis"):
        tactus.encode(mesh, modes=12, clusters=8)


@needs_program
def test_what_is_built_by_hand_is_coded_as_by_the_program(traces, tmp_path):
    """Scene builder and sender of the C interface, with what they do when nothing is asked for."""
    for name in ("rigid.mcap", "mesh.mcap"):
        program("encode", traces / name, "-o", tmp_path / "s.tct", "-q", "-f")
        with tactus.Player(tmp_path / "s.tct") as player:
            like = player.scene
        with tactus.TraceReader(traces / name) as reader:
            meshes = reader.meshes
            scene = tactus.build_scene(like.objects, meshes, tactus.RigidBounds(), tactus.DeformableBounds(), tick_rate=reader.tick_rate)
            sender, writer = tactus.Sender(scene), tactus.StreamWriter(scene)
            for frame in reader:
                for packet in sender.encode(frame.tick, frame.objects, frame.contacts, frame.shapes):
                    writer.add(packet)
            assert writer.finish() == (tmp_path / "s.tct").read_bytes(), name


def test_what_a_device_drives_and_deforms():
    box = tactus.RigidObject("box", driven=tactus.Driven(mass=0.2, inertia=(1e-4, 2e-4, 3e-4), stiffness=400, friction=0.3))
    corners = 0.05 * np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    body = tactus.Elastic(tets=[[0, 1, 2, 4], [0, 3, 1, 4], [0, 2, 3, 4], [1, 3, 2, 4]], materials=[[1e4, 0.4, 1000], [2e4, 0.4, 1000]],
                          coupling=300, inner=[[0.0125, 0.0125, 0.0125]], material=[0, 1, 0, 1], fixed=[0, 2], gravity=(0, 0, -9.81))
    soft = tactus.Mesh("soft", corners, faces, frame_period=5, elastic=body)
    plain = [tactus.build_scene([dataclasses.replace(box, driven=d)], [dataclasses.replace(soft, elastic=e)]).to_bytes()
             for d, e in ((None, None), (box.driven, None), (None, body), (box.driven, body))]
    assert len(set(plain)) == 4 and len(plain[0]) < len(plain[1]) < len(plain[2]) < len(plain[3])
    assert tactus.Scene(plain[3]).to_bytes() == plain[3]
    for change, said in (({"material": [0, 1]}, "2 numbers of materials for 4"), ({"tets": [[0, 1, 2, 0.5]]}, "tets are whole"),
                         ({"fixed": [1.5]}, "fixed are whole")):
        with pytest.raises(ValueError, match=said):
            tactus.build_scene(meshes=[dataclasses.replace(soft, elastic=dataclasses.replace(body, **change))])
    for change, rule in (({"coupling": 0}, "R-ELA-2"), ({"fixed": [5]}, "R-ELA-3"), ({"tets": [[0, 2, 1, 4], *body.tets[1:]]}, "R-ELA-4")):
        with pytest.raises(tactus.Error) as refused:
            tactus.build_scene(meshes=[dataclasses.replace(soft, elastic=dataclasses.replace(body, **change))])
        assert refused.value.rule == rule
    with pytest.raises(tactus.Error) as refused:
        tactus.build_scene([dataclasses.replace(box, driven=tactus.Driven(0, (1, 1, 1), 1))])
    assert refused.value.rule == "R-API-4"


@needs_program
def test_clusters_of_a_mesh(traces):
    trace = tactus.read_trace(traces / "mesh.mcap")
    mesh = tactus.find_clusters(trace.meshes[0], trace.shapes[0][1][:40], 8)
    assert mesh.clusters.shape == (714,) and 1 < mesh.clusters.max() + 1 <= 8 and mesh.blend > 0
    told = tactus.build_scene(meshes=[mesh]).meshes[0]
    assert (told.clusters == mesh.clusters).all() and told.blend == mesh.blend and told.modes == 0
    assert tactus.build_scene(meshes=trace.meshes).meshes[0].clusters is None
    with pytest.raises(ValueError, match="not \\(S, 714, 3\\)"):
        tactus.find_clusters(mesh, np.zeros((2, 713, 3)), 8)
    for wrong in (np.zeros(3), np.full(714, 300), np.full(714, 0.5)):
        with pytest.raises(ValueError, match="clusters are"):
            tactus.build_scene(meshes=[dataclasses.replace(mesh, clusters=wrong)])
    with pytest.raises(tactus.Error) as refused:
        tactus.find_clusters(mesh, trace.shapes[0][1][:2], 65)
    assert refused.value.rule == "R-API-4"
    with tactus.TraceReader(traces / "mesh.mcap") as reader, pytest.raises(TypeError, match="no argument"):
        reader.scene(eased=1)


@needs_program
def test_comparison_equals_that_of_the_program(traces, tmp_path):
    stream, replica = tmp_path / "s.tct", tmp_path / "r.mcap"
    stream.write_bytes(tactus.encode(traces / "rigid.mcap", tactus.RigidBounds(**BOUNDS)))
    program("decode", stream, "-o", replica, "--like", traces / "rigid.mcap", "-q")
    told = json.loads(program("compare", traces / "rigid.mcap", replica, "--json"))
    found = tactus.compare(traces / "rigid.mcap", stream)
    assert found.holds and found.position.ticks == 3000
    assert f"{found.position.max:.9g}" in {f"{number:.9g}" for number in numbers_of(told)}
    assert f"{found.force.rms:.9g}" in {f"{number:.9g}" for number in numbers_of(told)}
    mesh = tactus.compare(traces / "mesh.mcap", tactus.encode(traces / "mesh.mcap")).meshes[0]
    assert mesh.violations == 0 and mesh.frames > 40 and 0.9 < mesh.worst_ratio <= 1
    assert not tactus.compare(traces / "rigid.mcap", stream, tactus.RigidBounds(visual_position=1e-5)).holds


def numbers_of(value):
    """All numbers of a JSON document."""
    if isinstance(value, dict):
        value = list(value.values())
    if isinstance(value, list):
        return [number for item in value for number in numbers_of(item)]
    return [value] if isinstance(value, (int, float)) else []


@needs_program
def test_traces_are_arrays(traces):
    trace = tactus.read_trace(traces / "rigid.mcap")
    assert trace.position.shape == (3000, 1, 3) and trace.force.shape == (3000, 1, 3) and trace.tick_rate == 1000
    assert trace.object_names == ["cube"] and np.allclose(np.linalg.norm(trace.rotation, axis=2), 1)
    replica = tactus.decode(tactus.encode(traces / "rigid.mcap", tactus.RigidBounds(**BOUNDS)), trace.ticks)
    assert np.linalg.norm(replica.position - trace.position, axis=2).max() <= 3e-4
    mesh = tactus.read_trace(traces / "mesh.mcap")
    ticks, shapes = mesh.shapes[0]
    assert shapes.shape == (len(ticks), 714, 3) and np.isfinite(shapes).all()
    shown = tactus.decode(tactus.encode(traces / "mesh.mcap"), ticks, shapes=True)
    assert np.linalg.norm(shown.displacements[0] - shapes, axis=2).max() <= 2.6e-4


@needs_program
def test_which_forces_a_trace_knows(traces, tmp_path):
    both = tactus.read_trace(traces / "rigid.mcap")
    assert both.known_forces == [{"felt", "server"}]
    rows = list(csv.reader(program("export", "csv", traces / "rigid.mcap").splitlines()))
    for unknown, known, seen in (("force", "server", both.users["server_force"]), ("server_force", "felt", both.force)):
        kept = [i for i, name in enumerate(rows[0]) if f"/{unknown}_" not in name]
        assert len(kept) == len(rows[0]) - 3
        (tmp_path / "t.csv").write_text("".join(",".join(row[i] for i in kept) + "\n" for row in rows))
        program("import", "csv", tmp_path / "t.csv", "-o", tmp_path / "t.mcap", "-q", "-f")
        trace = tactus.read_trace(tmp_path / "t.mcap")
        assert trace.known_forces == [{known}]
        assert (trace.force == seen).all() and (trace.users["server_force"] == (seen if known == "server" else 0)).all()


@needs_program
def test_the_same_program_in_c_and_python(traces, tmp_path):
    for name, p in (("a.tct", 0.04), ("b.tct", 0.3)):
        (tmp_path / name).write_bytes(tactus.encode(traces / "rigid.mcap", tactus.RigidBounds(**{**BOUNDS, "weber_fraction": p})))
    script = [sys.executable, str(ROOT / "examples/compare_streams.py")]
    outputs = [subprocess.run([*command, "a.tct", "b.tct"], check=True, capture_output=True, text=True, cwd=tmp_path).stdout
               for command in (script, [os.environ["TACTUS_C_EXAMPLE"]])]
    assert outputs[0] == outputs[1] and "state" in outputs[0] and not outputs[0].endswith(" 0.000 mm apart\n")
    (tmp_path / "bad.tct").write_bytes(b"no stream")
    (tmp_path / "mesh.tct").write_bytes(tactus.encode(traces / "mesh.mcap"))
    for command in (script, [os.environ["TACTUS_C_EXAMPLE"]]):
        for name, why in (("bad.tct", "R-STR-1"), ("mesh.tct", "mesh.tct: no rigid object")):
            refused = subprocess.run([*command, "a.tct", name], capture_output=True, text=True, cwd=tmp_path)
            assert refused.returncode == 1 and why in refused.stderr and "Traceback" not in refused.stderr


@needs_program
@pytest.mark.skipif(importlib.util.find_spec("matplotlib") is None, reason="needs matplotlib: apt-get install python3-matplotlib")
def test_figure_of_the_thesis(traces, tmp_path):
    command = [sys.executable, str(ROOT / "examples/figure_3_14.py")]
    told = subprocess.run([*command, "figure.svg", traces / "rigid.mcap"], check=True, capture_output=True, text=True, cwd=tmp_path).stdout
    rate = {line.split()[0]: float(line.split()[1]) for line in told.splitlines()[1:-1]}
    assert len(rate) == 11 and rate["S4_NI"] > rate["S8_NI"] > rate["S30_NI"] and rate["S4_WI"] > rate["S30_WI"] > 0
    drawn = (tmp_path / "figure.svg").read_text()
    assert "<svg" in drawn and all(name in drawn for name in rate)
    refused = subprocess.run([*command, "figure.gif", traces / "rigid.mcap"], capture_output=True, text=True, cwd=tmp_path)
    assert refused.returncode == 1 and "figures are .svg, .png or .pdf" in refused.stderr


def test_the_page_of_recordings(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"^```python\n(.*?)^```$", (ROOT / "docs/recordings.md").read_text(), re.M | re.S)
    for block in blocks:
        exec(block, {})
    trace = tactus.read_trace("sine.mcap")
    assert len(blocks) == 1 and len(trace.ticks) == 2000
    assert abs(float(trace.position[1000, 0, 0]) - 0.05 * math.sin(1)) < 1e-12


def test_tables(tmp_path):
    table = tactus.read_table(ROOT / "reports/deformable/equal/points.csv")
    assert table["payload_bit_per_s"].dtype == np.float64 and len(table["v"] if "v" in table else table["max_m"]) > 0
    (tmp_path / "t.csv").write_text("p,name,x\n2.5%,a,1\n5%,b,\n")
    table = tactus.read_table(tmp_path / "t.csv")
    assert table["p"].tolist() == [0.025, 0.05] and table["name"].tolist() == ["a", "b"] and math.isnan(table["x"][1])


def test_everything_public_is_documented():
    for name in tactus.__all__:
        thing = getattr(tactus, name)
        if callable(thing):
            assert thing.__doc__, name
    assert (pathlib.Path(tactus.__file__).parent / "py.typed").exists()


def refused_ticks(path):  # in a worker
    return len(tactus.read_trace(path).ticks)


def test_an_error_of_a_worker_arrives_in_its_parent(tmp_path):
    bad = tmp_path / "bad.mcap"
    bad.write_bytes(b"no trace")
    with multiprocessing.Pool(1) as pool:
        waiting = pool.map_async(refused_ticks, [str(bad)])
        with pytest.raises(tactus.Error) as refused:
            waiting.get(timeout=60)
    assert refused.value.rule == "R-TRC-2" and "bad.mcap" in str(refused.value) and refused.value.subject == str(bad)
    again = pickle.loads(pickle.dumps(refused.value))
    assert str(again) == str(refused.value) and vars(again) == vars(refused.value)


def test_bytes_are_read_where_a_path_would_be(tmp_path):
    with pytest.raises(tactus.Error) as refused:
        tactus.read_trace(bytes(100_000))
    assert refused.value.rule == "R-TRC-2" and len(str(refused.value)) < 300


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
    holes[100:110] = np.nan  # 22 ms from sample to sample: a line
    holes[500:600, 1] = np.inf  # 202 ms: the last one is held
    turned = rotation.copy()
    turned[700] = 0
    trace = tactus.Trace.from_arrays(time, {"cup": (holes, turned)}, {"hand": force})
    line = position[99] + (np.arange(1, 11) / 11)[:, None] * (position[110] - position[99])
    assert np.abs(trace.position[100:110, 0] - line).max() < 1e-12
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


def test_arrays_are_refused_with_rule_and_place():
    time = np.arange(10) / 100
    good = np.zeros((10, 3))
    cases = [(dict(time=time, poses={"cup": good[:5]}), "R-CSV-8", "poses['cup'] has shape (5, 3)"),
             (dict(time=time, poses={"cup": good}, wrenches={"hand": np.zeros((10, 2))}), "R-CSV-8", "wrenches['hand']"),
             (dict(time=time, poses={"cup": good * np.nan}), "R-CSV-4", "cup.position: every sample is missing"),
             (dict(time=time[::-1], poses={"cup": good}), "R-CSV-5", "time: does not increase"),
             (dict(time=time), "R-CSV-8", ""),
             (dict(poses=good), "R-CSV-7", "tick_rate"),
             (dict(time=np.arange(10), poses=good), "R-CSV-7", ""),  # whole numbers are nanoseconds
             (dict(time=time, poses={"a/b": good}), "R-TRC-17", ""),
             (dict(time=["a"] * 10, poses=good), "R-CSV-8", "time has")]
    for arguments, rule, place in cases:
        with pytest.raises(tactus.Error) as refused:
            tactus.Trace.from_arrays(**arguments)
        assert refused.value.rule == rule and place in str(refused.value), arguments
    one_back = time.copy()
    one_back[5] = 0.01
    trace = tactus.Trace.from_arrays(one_back, {"cup": good})
    assert trace.notes[0] == "time: does not increase; the row is left out (row 5)"


def test_a_figure_is_written_as_pdf_svg_and_png(tmp_path):
    pytest.importorskip("matplotlib")
    time = np.arange(500) / 500
    position, rotation, force = swinging(time)
    trace = tactus.Trace.from_arrays(time, {"cup": (position, rotation)}, {"hand": force})
    for ending, head in (("pdf", b"%PDF"), ("svg", b"<?xml"), ("png", b"\x89PNG")):
        tactus.plot(trace, trace.encode(), tmp_path / f"figure.{ending}")
        assert (tmp_path / f"figure.{ending}").read_bytes().startswith(head)


def test_a_mesh_survives_saving(traces, tmp_path):
    trace = tactus.read_trace(traces / "mesh.mcap")
    trace.save(tmp_path / "again.mcap")
    again = tactus.read_trace(tmp_path / "again.mcap")
    assert (again.users == trace.users).all() and (again.shapes[0][1] == trace.shapes[0][1]).all()
    assert (again.shapes[0][0] == trace.shapes[0][0]).all() and (again.meshes[0].triangles == trace.meshes[0].triangles).all()


test_a_mesh_survives_saving = needs_program(test_a_mesh_survives_saving)


def test_a_fraction_of_four_is_not_four_percent():
    with pytest.raises(tactus.Error) as refused:
        tactus.build_scene([tactus.RigidObject("cube")], rigid_bounds=tactus.RigidBounds(weber_fraction=4))
    assert refused.value.rule == "R-API-4" and "100 %" in str(refused.value)
    trace = tactus.Trace.from_arrays(np.arange(100) / 100, np.zeros((100, 3)))
    with pytest.raises(tactus.Error) as refused:
        trace.encode(tactus.RigidBounds(weber_fraction=4))
    assert refused.value.rule == "R-API-4"


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
    for contacts, rule, place in [({"foot": ("cup", 500)}, "R-API-5", "contacts: a user or an object"),
                                  ({"hand": ("saucer", 500)}, "R-API-5", ""), ({"hand": ("cup", -1)}, "R-API-4", ""),
                                  ({"hand": 500}, "R-CSV-8", "contacts['hand'] is 500"),
                                  ({"hand": ("cup", 500, "cube")}, "R-CSV-8", "neither 'plane' nor 'spring'")]:
        with pytest.raises(tactus.Error) as refused:
            tactus.Trace.from_arrays(*arrays, contacts=contacts)
        assert refused.value.rule == rule and place in str(refused.value), contacts


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
