# SPDX-License-Identifier: Apache-2.0
"""Reads glTF scenes whose shapes are known: frames of `tactus import mesh`, volumes of `tactus mesh`, and what is refused.

  gltf_check.py PROGRAM   in an empty folder
"""
import json
import math
import os
import pathlib
import re
import shutil
import subprocess
import sys

from gltf_files import CUBE, CUBE_INDICES, SQUARE, SQUARE_INDICES, Scene

HALF = math.sqrt(0.5)
IDENTITY = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]
failed = checked = 0


def tactus(*words):
    done = subprocess.run([sys.argv[1], *map(str, words)], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


def judge(name, found, wanted, within=1e-6):
    global failed, checked
    checked += 1
    same = len(found) == len(wanted) and all(abs(a - b) <= within for a, b in zip(found, wanted))
    if not same:
        failed += 1
        print(f"{name}: {found} instead of {wanted}")


def frames(path, *options, rate=4):
    """Vertices of each frame, in the axes of the trace."""
    status, _, err = tactus("import", "mesh", path, "--rate", rate, *options, "-o", "o.mcap", "-q", "-f")
    if status != 0:
        return [[(status,)]], err
    shutil.rmtree("o", ignore_errors=True)
    tactus("export", "mesh", "o.mcap", "-o", "o", "-q")
    files = sorted(pathlib.Path("o").iterdir())
    return [[tuple(map(float, v)) for v in re.findall(r"^v (\S+) (\S+) (\S+)", f.read_text(), re.M)] for f in files], err


def refuses(name, path, *wanted, command=("import", "mesh"), options=()):
    global failed, checked
    checked += 1
    status, _, err = tactus(*command, path, *options, "-o", "r.mcap" if command[0] == "import" else "r.node", "-q", "-f")
    if status != 1 or any(part not in err for part in wanted):
        failed += 1
        print(f"{name}: status {status}, {err}")


def moving(path, times, values, kind, how, positions=SQUARE, **node):
    scene = Scene()
    scene.node(mesh=scene.mesh(positions, SQUARE_INDICES), **node)
    scene.animate((0, path, times, values, kind, how))
    return scene


def xs(found, vertex=0, axis=0):
    return [f[vertex][axis] for f in found[0]]


# ==== nodes that move ====

def check_nodes():
    shift = [(0, 0, 0), (1, 0, 0)]
    judge("linear", xs(frames(moving("translation", [0, 1], shift, "VEC3", "LINEAR").write("a.glb"))), [0, 0.25, 0.5, 0.75, 1])
    judge("step", xs(frames(moving("translation", [0, 1], shift, "VEC3", "STEP").write("a.glb"))), [0, 0, 0, 0, 1])
    flat = [(0, 0, 0), (0, 0, 0), (0, 0, 0), (0, 0, 0), (1, 0, 0), (0, 0, 0)]  # tangent, value, tangent of two keys
    judge("cubic", xs(frames(moving("translation", [0, 1], flat, "VEC3", "CUBICSPLINE").write("a.glb"))), [0, 0.15625, 0.5, 0.84375, 1])
    steep = [(0, 0, 0), (0, 0, 0), (2, 0, 0), (0, 0, 0), (0, 0, 0), (0, 0, 0)]  # leaves with 2 m/s: over 2 s that is 4 t (1 - t/2)^2 / 2
    judge("cubic over 2 s", xs(frames(moving("translation", [0, 2], steep, "VEC3", "CUBICSPLINE").write("a.glb"), rate=1)), [0, 0.5, 0])
    judge("before and behind the keys", xs(frames(moving("translation", [0.5, 1], shift, "VEC3", "LINEAR").write("a.glb"))), [0, 0, 0, 0.5, 1])
    turn = [(0, 0, 0, 1), (0, -HALF, 0, -HALF)]  # a quarter about y, with the other sign: the shorter arc is taken
    found = frames(moving("rotation", [0, 1], turn, "VEC4", "LINEAR").write("a.glb"), rate=2)
    judge("rotation", [c for f in found[0] for c in f[1]], [1, 0, 0, HALF, HALF, 0, 0, 1, 0])  # (1, 0, 0) goes to -z, which is y in a trace
    found = frames(moving("scale", [0, 1], [(1, 1, 1), (3, 1, 1)], "VEC3", "LINEAR").write("a.glb"), rate=2)
    judge("scale", xs(found, 1), [1, 2, 3])
    kept = frames(moving("translation", [0, 1], [(0, 0, 0), (0, 1, 0)], "VEC3", "LINEAR").write("a.glb"), "--axes", "z-up", rate=1)
    judge("axes kept", xs(kept, 0, 1), [0, 1])
    judge("axes turned", xs(frames("a.glb", rate=1), 0, 2), [0, 1])


def check_trees():
    scene = Scene()
    scene.node(children=[1], scale=[2, 2, 2], translation=[0, 0, 5])
    scene.node(children=[2], matrix=[0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 10, 0, 0, 1])  # a quarter about z, then 10 along x
    scene.node(mesh=scene.mesh(SQUARE, SQUARE_INDICES), name="leaf")
    scene.animate((2, "translation", [0, 1], [(0, 0, 0), (1, 0, 0)], "VEC3", "LINEAR"))
    found = frames(scene.write("a.glb"), rate=1)
    # the corner (1, 0, 0) + t (1, 0, 0) is turned to (0, 1 + t, 0), shifted to (10, 1 + t, 0), doubled and shifted to (20, 2 + 2 t, 5)
    judge("trees", [c for f in found[0] for c in f[1]], [20, -5, 2, 20, -5, 4])
    for form in ("b.gltf", "c.gltf"):
        scene.write(form, uri=None if form == "b.gltf" else "c%20d.bin".replace("%20", "_"))
        judge(form, [c for f in frames(form, rate=1)[0] for c in f[1]], [20, -5, 2, 20, -5, 4])


# ==== what bends ====

def check_morphs():
    scene = Scene()
    up = scene.accessor(None, "VEC3", count=4, sparse={2: (0, 0, 1)})
    side = scene.accessor([(1, 0, 0)] * 4, "VEC3")
    scene.node(mesh=scene.mesh(SQUARE, SQUARE_INDICES, targets=[up, side]))
    scene.json["meshes"][0]["weights"] = [0, 0.5]
    scene.animate((0, "weights", [0, 1], [0, 0.5, 1, 0], "SCALAR", "LINEAR"))
    found = frames(scene.write("a.glb"), "--axes", "z-up", rate=2)
    judge("morph", [c for f in found[0] for c in f[2]], [1.5, 1, 0, 1.25, 1, 0.5, 1, 1, 1])
    del scene.json["animations"]
    judge("weights of the mesh", frames(scene.write("a.glb"), "--axes", "z-up")[0][0][2], [1.5, 1, 0])
    scene.json["nodes"][0]["weights"] = [1, 0]
    judge("weights of the node", frames(scene.write("a.glb"), "--axes", "z-up")[0][0][2], [1, 1, 1])


def check_skins():
    scene = Scene()
    joints = scene.accessor([(0, 1, 0, 0)] * 4, "VEC4", 5121)
    weights = scene.accessor([(255, 0, 0, 0), (0, 255, 0, 0), (0, 255, 0, 0), (51, 204, 0, 0)], "VEC4", 5121, normalized=True)
    mesh = scene.mesh(SQUARE, SQUARE_INDICES, attributes={"JOINTS_0": joints, "WEIGHTS_0": weights})
    scene.node(mesh=mesh, skin=0, translation=[7, 7, 7])  # where the node stands does not matter
    scene.node(children=[2], name="root")
    scene.node(translation=[0.5, 0, 0], name="elbow")
    scene.json["scenes"][0]["nodes"] = [0, 1]
    back = IDENTITY[:12] + [-0.5, 0, 0, 1]
    scene.add("skins", {"joints": [1, 2], "inverseBindMatrices": scene.accessor(IDENTITY + back, "MAT4")})
    scene.animate((2, "rotation", [0, 1], [(0, 0, 0, 1), (0, 0, HALF, HALF)], "VEC4", "LINEAR"))
    found = frames(scene.write("a.glb"), "--axes", "z-up", rate=1)
    judge("skin at rest", [c for v in found[0][0] for c in v], [c for v in SQUARE for c in v])
    # turned by a quarter about (0.5, 0, 0): (1, 0) to (0.5, 0.5), (1, 1) to (-0.5, 0.5), (0, 1) to (-0.5, -0.5), of which 4/5
    wanted = [(0, 0, 0), (0.5, 0.5, 0), (-0.5, 0.5, 0), (-0.4, 0.2 - 0.4, 0)]
    judge("skin", [c for v in found[0][1] for c in v], [c for v in wanted for c in v])


# ==== shapes ====

def filled(path, *options):
    status, out, err = tactus("mesh", path, *options, "-o", "o.node", "-f", "--json")
    return [json.loads(out)["vertices"], json.loads(out)["volume_m3"]] if status == 0 else [err]


def check_shapes():
    def cube(**node):
        scene = Scene()
        scene.node(mesh=scene.mesh(CUBE, CUBE_INDICES, component=node.pop("component", 5123), **node.pop("primitive", {})), **node)
        return scene
    judge("corners of sides are one", filled(cube().write("a.glb")), [8, 1])
    judge("a mirror", filled(cube(scale=[-1, 2, 1]).write("a.glb")), [8, 2])
    judge("bytes as indices", filled(cube(component=5121).write("a.glb")), [8, 1])
    plain = Scene()
    plain.node(mesh=plain.mesh([CUBE[i] for i in CUBE_INDICES], None))
    judge("no indices", filled(plain.write("a.glb")), [8, 1])
    whole = Scene()
    for quarter in ("VEC3",):
        positions = whole.accessor([tuple(65535 * c for c in v) for v in CUBE], quarter, 5123, normalized=True)
        whole.add("meshes", {"primitives": [{"attributes": {"POSITION": positions}, "indices": whole.accessor(CUBE_INDICES, "SCALAR", 5123)}]})
    whole.json["extensionsRequired"] = whole.json["extensionsUsed"] = ["KHR_mesh_quantization"]
    whole.node(mesh=0, scale=[3, 1, 1])
    judge("whole numbers", filled(whole.write("a.glb")), [8, 3])
    for mode, order in ((5, [0, 1, 3, 2]), (6, [0, 1, 2, 3])):
        strip = Scene()
        strip.node(mesh=strip.mesh(SQUARE, order, mode=mode))
        faces = len(frames(strip.write("a.glb"))[0][0])
        judge(f"mode {mode}", [faces], [4])
    two = Scene()
    two.node(name="both", children=[1, 2])
    two.node(name="left", mesh=two.mesh(CUBE, CUBE_INDICES))
    two.node(name="right", mesh=0, translation=[3, 0, 0], scale=[1, 2, 1])
    two.write("a.glb")
    judge("joined", filled("a.glb"), [16, 3])
    judge("one node", filled("a.glb", "--node", "right"), [8, 2])
    judge("one branch", filled("a.glb", "--node", "both"), [16, 3])
    refuses("no such node", "a.glb", "R-SEQ-6", "'left', 'right'", command=("mesh",), options=("--node", "middle"))


# ==== what is refused ====

def check_refusals():
    scene = moving("translation", [0, 1], [(0, 0, 0), (1, 0, 0)], "VEC3", "LINEAR")
    scene.animate((0, "translation", [0, 2], [(0, 0, 0), (0, 1, 0)], "VEC3", "LINEAR"), name="other")
    scene.write("a.glb")
    refuses("two animations", "a.glb", "R-SEQ-6", "--animation 'move'", "'move', 'other'")
    judge("the one that is chosen", xs(frames("a.glb", "--animation", "move", rate=1)), [0, 1])
    refuses("no such animation", "a.glb", "R-SEQ-6", "no animation 'walk'", options=("--animation", "walk"))
    os.makedirs("in/deep", exist_ok=True)
    pathlib.Path("secret.bin").write_bytes(scene.data)
    scene.json["animations"].pop()
    scene.write("in/a.gltf", uri="deep/a b.bin")
    text = pathlib.Path("in/a.gltf").read_text()
    for name in ("deep/a b.bin", "deep/a%20b.bin", "deep/../deep/./a%20b.bin"):
        pathlib.Path("in/b.gltf").write_text(text.replace("deep/a b.bin", name))
        judge(name, xs(frames("in/b.gltf", rate=1)), [0, 1])
    os.symlink("../secret.bin", "in/link.bin")
    here = pathlib.Path.cwd()
    for name in ("../secret.bin", f"{here}/secret.bin", f"file://{here}/secret.bin", "http://localhost/a.bin", "deep/%2e%2e/%2e%2e/secret.bin",
                 "link.bin", "missing.bin", "deep", "", "a%0", "..", "."):
        pathlib.Path("in/b.gltf").write_text(text.replace("deep/a b.bin", name))
        refuses(f"buffer {name}", "in/b.gltf", "b.gltf: buffer '")
    scene = moving("translation", [0, 1e8], [(0, 0, 0), (1, 0, 0)], "VEC3", "LINEAR")
    refuses("too long", scene.write("a.glb"), "R-SEQ-7", "--rate")
    scene = moving("translation", [1, 0], [(0, 0, 0), (1, 0, 0)], "VEC3", "LINEAR")
    refuses("times fall", scene.write("a.glb"), "the animation of nodes[0]: time 1")
    scene = moving("translation", [0, 1], [(0, 0, 0), (math.nan, 0, 0)], "VEC3", "LINEAR")
    refuses("NaN", scene.write("a.glb"), "NaN or infinite")
    scene = moving("translation", [0, 1], [(0, 0, 0), (1e7, 0, 0)], "VEC3", "LINEAR")
    refuses("far", scene.write("a.glb"), "R-SRF-8", "in frame 6")
    scene = moving("translation", [0, 1], [(0, 0, 0), (1, 0, 0)], "VEC3", "LINEAR")
    for key in ("extensionsRequired", "extensionsUsed"):
        scene.json[key] = ["KHR_draco_mesh_compression"]
    refuses("compressed", scene.write("a.glb"), "R-SRF-3", "KHR_draco_mesh_compression", "without compression")
    data = pathlib.Path("a.glb").read_bytes()
    pathlib.Path("b.glb").write_bytes(data[:-8])
    refuses("cut", "b.glb", "R-SRF-5", f"announces {len(data)} bytes and has {len(data) - 8}")


if __name__ == "__main__":
    for check in (check_nodes, check_trees, check_morphs, check_skins, check_shapes, check_refusals):
        check()
    print(f"{checked - failed} of {checked} right")
