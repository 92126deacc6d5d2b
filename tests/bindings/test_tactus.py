# SPDX-License-Identifier: Apache-2.0
"""The Python package against the conformance vectors and itself."""
import copy
import ctypes
import dataclasses
import json
import math
import multiprocessing
import os
import pathlib
import pickle
import shutil
import subprocess
import sys
import warnings

import numpy as np
import pytest

import tactus

ROOT = pathlib.Path(__file__).resolve().parents[2]
CONFORMANCE = ROOT / "conformance"
sys.path.insert(0, str(CONFORMANCE))
from run import answer_lines, load_cases, read_input  # noqa: E402


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
                assert receiver.push(packet).updates == 1
                sent += 1
            assert np.abs(receiver.poses(tick)[0, :3] - swing(tick)[0][:3]).max() <= 0.006
        assert 5 < sent < 200
        assert receiver.state_hash() != tactus.Receiver(scene).state_hash()
        assert receiver.scene.objects[0].name == "cube"


def test_what_moved_may_be_named():
    with tactus.build_scene([tactus.RigidObject("cube"), tactus.RigidObject("ball")]) as scene:
        compares, informed, misled = (tactus.Sender(scene) for _ in range(3))
        rows = np.zeros((2, 13))
        rows[:, 3] = 1
        for tick in range(500):
            rows[0] = swing(tick)[0]
            packets = compares.encode(tick, rows)
            assert [p.data for p in informed.encode(tick, rows, moved=[0])] == [p.data for p in packets]
            assert not misled.encode(tick, rows, moved=()) or tick == 0
        with pytest.raises(ValueError):
            informed.encode(500, rows, moved=[[0]])


def test_a_transport_may_give_the_numbers():
    with tactus.build_scene([tactus.RigidObject("cube")], rigid_profile=tactus.PROFILE_THESIS) as scene:
        sender = tactus.Sender(scene)
        informed, uninformed = (tactus.Receiver(scene, interpolation=tactus.INTERPOLATION_PLAYOUT) for _ in range(2))
        rows = np.zeros((1, 13))
        rows[0, 3] = 1
        for tick, number in ((0, 1000), (10, 1003), (20, 1006)):                  # it jumps, then rests
            rows[0, 0] += 0.1
            [packet] = sender.encode(tick, rows, number=number)
            assert packet.number == number
            for receiver in (informed, uninformed):
                receiver.push(packet)
            for none in (1, 2):
                informed.skip_number(number + none)
        assert abs(informed.poses(5)[0, 0] - 0.1) < 1e-3 and abs(uninformed.poses(5)[0, 0] - 0.15) < 1e-3
        for number in (0, -1, (1 << 64) + 2000):
            with pytest.raises(ValueError):
                sender.encode(30, rows, number=number)
        for number in (-1, (1 << 64) + 2000):
            with pytest.raises(ValueError):
                informed.push(number, b"")
            with pytest.raises(ValueError):
                informed.skip_number(number)
        with pytest.raises(tactus.Error, match="R-API-5|numbers"):
            sender.encode(30, rows, number=1000)
        with pytest.raises(tactus.Error):
            informed.skip_number(0)
        with pytest.raises(tactus.Error, match="R-PKT-4"):
            informed.push(2000, b"")                                              # a packet without bytes, which is not none


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
            receiver.push(packet)
        assert np.linalg.norm(receiver.displacements(0, tick) - shape, axis=1).max() <= 2.6e-4
    assert np.allclose(scene.meshes[0].vertices, vertices, atol=1e-6) and (scene.meshes[0].triangles == triangles).all()


def test_packets_come_with_their_numbers():
    """From a network as two things, the number and the bytes; those that come are acknowledged, and the next ones build on them."""
    scene = tactus.build_scene([tactus.RigidObject("cube")], baselines=64)
    sender = tactus.Sender(scene, baseline=tactus.BASELINE_ACKNOWLEDGED, key_interval=0)
    receiver, twin = tactus.Receiver(scene), tactus.Receiver(scene)
    numbers, keys = [], 0
    for tick in range(1000):
        for packet in sender.encode(tick, swing(tick)):
            numbers.append(packet.number)
            if packet.number % 3 == 0:
                continue  # lost
            decoded = receiver.push(packet.number, packet.data, now=tick + 20)
            assert decoded.number == packet.number and twin.push(packet).tick == tick
            keys, newest = keys + decoded.key, packet
            sender.acknowledge(decoded)
    assert numbers == list(range(1, len(numbers) + 1)) and len(numbers) > 5 and keys == 1
    assert receiver.state_hash() == twin.state_hash()
    with pytest.raises(tactus.Error) as refused:
        receiver.push(newest)  # again
    assert refused.value.rule == "R-PKT-5" and refused.value.advice == "drop"


def test_one_bad_object_does_not_stop_the_others():
    scene = tactus.build_scene([tactus.RigidObject("cube"), tactus.RigidObject("ball")])
    sender, receiver = tactus.Sender(scene), tactus.Receiver(scene)
    rest = [0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0]
    for tick in range(40):
        rows = np.array([rest, rest], float)
        rows[:, 0] = 0.01 * tick
        if 10 <= tick < 30:
            rows[1, 0] = math.nan if tick < 20 else -600
        for packet in sender.encode(tick, rows):
            receiver.push(packet)
        shown = receiver.poses(tick)[:, 0]
        assert abs(shown[0] - 0.01 * tick) <= 0.006
        if 10 <= tick < 30:
            held, = sender.held
            assert (held.part, held.index, held.name, held.since) == ("object", 1, "ball", 10)
            assert held.rule == ("R-API-1" if tick < 20 else "R-API-2") and held.text and held.remedy
            assert tick < 20 or "world_size" in held.remedy
            assert abs(shown[1] - 0.09) <= 0.006
        else:
            assert sender.held == [] and abs(shown[1] - 0.01 * tick) <= 0.006


def test_poses_alone_are_refused_with_what_they_lack():
    with pytest.raises(ValueError, match=r"\(1, 7\), not \(objects, 13\).*velocity.*tick_rate"):
        tactus.Sender(tactus.build_scene([tactus.RigidObject("cube")])).encode(0, [[0, 0, 0, 1, 0, 0, 0]])


def test_an_installation_in_any_folder_finds_its_libraries(tmp_path):
    package = pathlib.Path(tactus.__file__).parent
    if not (package / "libtactus.so.0").exists():
        pytest.skip("the libraries are not beside the package")
    folder = tmp_path / "lib/python3/dist-packages"
    shutil.copytree(package, folder / "tactus", ignore=shutil.ignore_patterns("*.so.0", "__pycache__"))
    for library in ("libtactus.so.0", "libtactus-trace.so.0"):
        shutil.copy(package / library, tmp_path / "lib" / library)
    words = [sys.executable, "-c", "import tactus; tactus._library.core(), tactus._library.traces(); print(tactus.__file__)"]
    alone = {name: value for name, value in os.environ.items() if name != "LD_LIBRARY_PATH"} | {"PYTHONPATH": str(folder)}
    assert subprocess.run(words, env=alone, check=True, capture_output=True, text=True).stdout.startswith(str(folder))
    (tmp_path / "lib/libtactus.so.0").unlink()
    refused = subprocess.run(words, env=alone, check=False, capture_output=True, text=True)
    assert "LD_LIBRARY_PATH" in refused.stderr and refused.returncode == 1


def test_a_recording_that_leaves_the_world_is_coded_with_a_warning():
    positions = np.zeros((200, 3))
    positions[:, 0] = np.interp(np.arange(200), (20, 100, 180), (0, 600, 0))
    still = np.tile([1.0, 0, 0, 0], (200, 1))
    own = tactus.Trace.from_arrays(np.arange(200) / 100, poses={"cup": (positions, still), "saucer": (np.zeros((200, 3)), still)})
    with pytest.warns(RuntimeWarning, match="cup, tick .*R-API-2.*world_size"):
        stream = own.encode()
    shown = stream.to_arrays()["cup"]
    assert 500 < shown[:, 0].max() < 512 and abs(shown[-1, 0]) < 0.01
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        far = own.encode(world_size=1000)
    assert abs(far.to_arrays()["cup"][100, 0] - 600) < 0.01


def test_a_world_has_a_size_and_a_scene_a_number_of_objects():
    many = [tactus.RigidObject(f"o{i}") for i in range(4097)]
    with pytest.raises(tactus.Error) as refused:
        tactus.build_scene(many)
    assert refused.value.rule == "R-STR-14" and "4097 objects where 4096 are allowed" in str(refused.value)
    limits = tactus.Limits(objects=5000)
    scene = tactus.build_scene(many, limits=limits)
    tactus.Receiver(scene, limits=limits)
    with pytest.raises(tactus.Error) as refused:
        tactus.build_scene([tactus.RigidObject("far", (600, 0, 0))])
    assert refused.value.rule == "R-API-2" and "512 m" in str(refused.value) and refused.value.subject == "far"
    far = tactus.build_scene([tactus.RigidObject("far", (600, 0, 0))], world_size=1000)
    assert far.info.position_exp == 21 and far.objects[0].position == (600, 0, 0)
    with pytest.raises(tactus.Error) as refused:
        tactus.build_scene([tactus.RigidObject("far")], rigid_bounds=tactus.RigidBounds(visual_position=1e-4), world_size=1e6)
    assert refused.value.rule == "R-API-4" and "1e+06 m" in str(refused.value) and "0.1 mm" in str(refused.value)


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
    decoded = receiver.push(1, bytearray(packets[0].data))
    for wrong in ((packets[1].data,), (1,), (1, "packet"), (packets[1].data, 2), (packets[1], packets[1].data)):
        with pytest.raises((TypeError, ctypes.ArgumentError)):
            receiver.push(*wrong)
    for number in (0, 1 << 62):
        with pytest.raises(tactus.Error) as refused:
            receiver.push(number, packets[1].data)
        assert refused.value.rule == "R-API-5"
    for take in (writer.add, receiver.push):
        with pytest.raises(ValueError, match="no bytes"):
            take(decoded)
    writer.add(packets[0])
    with pytest.raises(tactus.Error) as refused:
        writer.add(packets[2])  # a file counts
    assert refused.value.rule == "R-API-5"


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
    for change, printed in (({"material": [0, 1]}, "2 numbers of materials for 4"), ({"tets": [[0, 1, 2, 0.5]]}, "tets are whole"),
                         ({"fixed": [1.5]}, "fixed are whole"), ({"method": "euler"}, "method 'euler' is none of")):
        with pytest.raises(ValueError, match=printed):
            tactus.build_scene(meshes=[dataclasses.replace(soft, elastic=dataclasses.replace(body, **change))])
    explicit = dataclasses.replace(body, method="velocity-verlet", sub_steps=40)
    declared = tactus.build_scene(meshes=[dataclasses.replace(soft, elastic=explicit)]).to_bytes()
    assert len(declared) == len(tactus.build_scene(meshes=[dataclasses.replace(soft, elastic=body)]).to_bytes()) + 1
    assert tactus.Scene(declared).to_bytes() == declared
    for change, rule in (({"method": "velocity-verlet"}, "R-ELA-5"), ({"coupling": 0}, "R-ELA-2"), ({"fixed": [5]}, "R-ELA-3"), ({"tets": [[0, 2, 1, 4], *body.tets[1:]]}, "R-ELA-4")):
        with pytest.raises(tactus.Error) as refused:
            tactus.build_scene(meshes=[dataclasses.replace(soft, elastic=dataclasses.replace(body, **change))])
        assert refused.value.rule == rule
    with pytest.raises(tactus.Error) as refused:
        tactus.build_scene([dataclasses.replace(box, driven=tactus.Driven(0, (1, 1, 1), 1))])
    assert refused.value.rule == "R-API-4"


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


def test_paths_are_text_path_objects_or_bytes(tmp_path):
    recording = tactus.Trace.from_arrays(np.arange(50) / 100, poses={"cup": (np.zeros((50, 3)), np.tile([1.0, 0, 0, 0], (50, 1)))})
    for target in (str(tmp_path / "text.mcap"), tmp_path / "object.mcap", os.fsencode(tmp_path / "\u00e9.mcap")):
        recording.save(target)
        assert len(tactus.read_trace(target).ticks) == 50
        stream = tactus.encode(target)
        saved = os.fsencode(target) + b".tct" if isinstance(target, bytes) else pathlib.Path(str(target) + ".tct")
        stream.save(saved)
        assert tactus.decode(saved).poses.shape == tactus.decode(stream).poses.shape and tactus.compare(target, saved).holds
    with pytest.raises(tactus.Error) as refused:
        tactus.read_trace(b"no trace")
    assert refused.value.rule == "R-TRC-2"


def test_bytes_are_read_where_a_path_would_be(tmp_path):
    with pytest.raises(tactus.Error) as refused:
        tactus.read_trace(bytes(100_000))
    assert refused.value.rule == "R-TRC-2" and len(str(refused.value)) < 300


def test_a_fraction_of_four_is_not_four_percent():
    with pytest.raises(tactus.Error) as refused:
        tactus.build_scene([tactus.RigidObject("cube")], rigid_bounds=tactus.RigidBounds(weber_fraction=4))
    assert refused.value.rule == "R-API-4" and "100 %" in str(refused.value) and "weber_fraction" in refused.value.remedy
    trace = tactus.Trace.from_arrays(np.arange(100) / 100, np.zeros((100, 3)))
    with pytest.raises(tactus.Error) as refused:
        trace.encode(tactus.RigidBounds(weber_fraction=4))
    assert refused.value.rule == "R-API-4"
