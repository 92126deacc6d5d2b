# SPDX-License-Identifier: Apache-2.0
"""The Python package against the program: what both code, decode and compare is the same."""
import csv
import dataclasses
import importlib.util
import json
import math
import os
import pathlib
import subprocess
import sys

import numpy as np
import pytest

import tactus

ROOT = pathlib.Path(__file__).resolve().parents[2]
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


@needs_program
def test_encoding_equals_that_of_the_program(traces, tmp_path):
    def encoded(name, *options):
        program("encode", traces / name, "-o", tmp_path / "s.tct", "-q", "-f", *options)
        return (tmp_path / "s.tct").read_bytes()
    rigid, mesh = traces / "rigid.mcap", traces / "mesh.mcap"
    assert tactus.encode(rigid) == encoded("rigid.mcap")
    assert tactus.encode(rigid, tactus.RigidBounds(**BOUNDS)) == encoded("rigid.mcap", "-p", "4%", "--visual", "0.3mm,2deg")
    assert tactus.encode(rigid, profile="thesis") == encoded("rigid.mcap", "--profile", "thesis") != encoded("rigid.mcap")
    assert tactus.encode(rigid, reduction=tactus.REDUCTION_NONE) == encoded("rigid.mcap", "--tune", "reduction=none")
    assert tactus.encode(mesh) == encoded("mesh.mcap")
    assert tactus.encode(mesh, profile="thesis") == encoded("mesh.mcap", "--profile", "thesis")
    assert tactus.encode(mesh, modes=12) == encoded("mesh.mcap", "--basis", "12")
    fine = tactus.DeformableBounds(visual=1e-5)  # at which what is not asked for differs
    assert tactus.encode(mesh, None, fine, modes=12) == encoded("mesh.mcap", "--basis", "12", "--deformable-visual", "0.01mm")
    assert tactus.encode(mesh, clusters=8) == encoded("mesh.mcap", "--tune", "clusters=8") != encoded("mesh.mcap")
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


@needs_program
def test_clusters_of_a_mesh(traces):
    trace = tactus.read_trace(traces / "mesh.mcap")
    mesh = tactus.find_clusters(trace.meshes[0], trace.shapes[0][1][:40], 8)
    assert mesh.clusters.shape == (714,) and 1 < mesh.clusters.max() + 1 <= 8 and mesh.blend > 0
    declared = tactus.build_scene(meshes=[mesh]).meshes[0]
    assert (declared.clusters == mesh.clusters).all() and declared.blend == mesh.blend and declared.modes == 0
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
        reader.scene(smoothed=1)


@needs_program
def test_comparison_equals_that_of_the_program(traces, tmp_path):
    stream, replica = tmp_path / "s.tct", tmp_path / "r.mcap"
    stream.write_bytes(tactus.encode(traces / "rigid.mcap", tactus.RigidBounds(**BOUNDS)))
    program("decode", stream, "-o", replica, "--like", traces / "rigid.mcap", "-q")
    printed = json.loads(program("compare", traces / "rigid.mcap", replica, "--json"))
    found = tactus.compare(traces / "rigid.mcap", stream)
    assert found.holds and found.position.ticks == 3000
    assert f"{found.position.max:.9g}" in {f"{number:.9g}" for number in numbers_of(printed)}
    assert f"{found.force.rms:.9g}" in {f"{number:.9g}" for number in numbers_of(printed)}
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
    assert np.linalg.norm(shown.displacements[0] - shapes, axis=2).max() <= 3.1e-4


@needs_program
def test_which_forces_a_trace_knows(traces, tmp_path):
    both = tactus.read_trace(traces / "rigid.mcap")
    assert both.recorded_forces == [{"rendered", "server"}]
    rows = list(csv.reader(program("export", "csv", traces / "rigid.mcap").splitlines()))
    for unknown, known, seen in (("force", "server", both.users["server_force"]), ("server_force", "rendered", both.force)):
        kept = [i for i, name in enumerate(rows[0]) if f"/{unknown}_" not in name]
        assert len(kept) == len(rows[0]) - 3
        (tmp_path / "t.csv").write_text("".join(",".join(row[i] for i in kept) + "\n" for row in rows))
        program("import", "csv", tmp_path / "t.csv", "-o", tmp_path / "t.mcap", "-q", "-f")
        trace = tactus.read_trace(tmp_path / "t.mcap")
        assert trace.recorded_forces == [{known}]
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
    printed = subprocess.run([*command, "figure.svg", traces / "rigid.mcap"], check=True, capture_output=True, text=True, cwd=tmp_path).stdout
    rate = {line.split()[0]: float(line.split()[1]) for line in printed.splitlines()[1:-1]}
    assert len(rate) == 11 and rate["S4_NI"] > rate["S8_NI"] > rate["S30_NI"] and rate["S4_WI"] > rate["S30_WI"] > 0
    drawn = (tmp_path / "figure.svg").read_text()
    assert "<svg" in drawn and all(name in drawn for name in rate)
    refused = subprocess.run([*command, "figure.gif", traces / "rigid.mcap"], capture_output=True, text=True, cwd=tmp_path)
    assert refused.returncode == 1 and "figures are .svg, .png or .pdf" in refused.stderr


@needs_program
def test_a_mesh_survives_saving(traces, tmp_path):
    trace = tactus.read_trace(traces / "mesh.mcap")
    trace.save(tmp_path / "again.mcap")
    again = tactus.read_trace(tmp_path / "again.mcap")
    assert (again.users == trace.users).all() and (again.shapes[0][1] == trace.shapes[0][1]).all()
    assert (again.shapes[0][0] == trace.shapes[0][0]).all() and (again.meshes[0].triangles == trace.meshes[0].triangles).all()
