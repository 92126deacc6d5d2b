# SPDX-License-Identifier: Apache-2.0
"""Changes each field of surface and tetrahedron files, one at a time: what `tactus mesh` writes or says must change, or it refuses.

  mesh_fields.py PROGRAM [-v]   in an empty folder; -v: a table of formats

IGNORED holds the fields that change nothing. The headers of the readers say so of each (surface_file.h, tet_files.h).
"""
import json
import os
import pathlib
import re
import struct
import subprocess
import sys

from gltf_files import CUBE, CUBE_INDICES, Scene, glb

CORNERS = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
FACES = "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n"
POINTS, SIDES = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]
MSH_TAIL = "$Elements\n3\n1 15 2 0 1 1\n2 4 2 7 1 1 2 3 4\n3 4 2 7 1 2 3 4 5\n$EndElements\n"
NODES = "1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n"

TEXTS = {
    "obj": "mtllib a.mtl\no thing\ng part\nv 0 0 0\nv 1 0 0\nv 0 1 0 1\nv 0 0 1\nvt 0 0\nvn 0 0 1\nusemtl red\ns 1\n"
           "f 1/1/1 3/1/1 2/1/1\nf 1//1 2//1 4//1\nf -3 -2 -1\nf 1 4 3\n",
    "off": "NOFF\n4 4 6\n" + "".join(f"{x} {y} {z} 0 0 1\n" for x, y, z in POINTS) + FACES.replace("\n", " 255 0 0\n"),
    "ply": "ply\nformat ascii 1.0\ncomment made by hand\nobj_info none\nelement vertex 4\nproperty float nx\nproperty float x\nproperty float y\n"
           "property double z\nelement face 4\nproperty uchar red\nproperty list uchar int vertex_indices\nelement edge 1\nproperty int a\n"
           "end_header\n" + "".join(f"9 {x} {y} {z}\n" for x, y, z in POINTS) + re.sub("(?m)^", "8 ", FACES[:-1]) + "\n5\n",
    "stl": "solid name\n" + "".join("facet normal 0 0 1\nouter loop\n" + "".join("vertex {} {} {}\n".format(*POINTS[v]) for v in side) +
                                    "endloop\nendfacet\n" for side in SIDES) + "endsolid name\n",
    "node": "4 3 1 1\n0 0 0 0 7.5 1\n1 1 0 0 7.5 1\n2 0 1 0 7.5 1\n3 0 0 1 7.5 1\n",
    "ele": "1 4 1\n0 0 1 2 3 7.5\n",
    "msh 2.2": "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"box\"\n$EndPhysicalNames\n$Nodes\n5\n" + NODES + "$EndNodes\n" + MSH_TAIL,
    "msh 4.0": "$MeshFormat\n4 0 8\n$EndMeshFormat\n$Nodes\n1 5\n1 3 0 5\n" + NODES + "$EndNodes\n$Elements\n2 3\n1 0 15 1\n1 1\n1 3 4 2\n2 1 2 3 4\n3 2 3 4 5\n$EndElements\n",
    "msh 4.1": "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 0 1\n1 0 0 0 1 1 1 0 0\n$EndEntities\n$Nodes\n1 5 1 5\n3 1 0 5\n1\n2\n3\n4\n5\n" +
               re.sub(r"(?m)^\d+ ", "", NODES) + "$EndNodes\n$Elements\n2 3 1 3\n0 1 15 1\n1 1\n3 1 4 2\n2 1 2 3 4\n3 2 3 4 5\n$EndElements\n",
}

IGNORED = {  # format: lines (from 1) and words (from 0) that change nothing
    "obj": {(1, 1), (2, 1), (3, 1), (8, 1), (8, 2), (9, 1), (9, 2), (9, 3), (10, 1), (11, 1),  # names, textures, normals, materials, smoothing
            *((12, word) for word in (2, 3, 5, 6, 8, 9)), *((13, word) for word in (2, 4, 6))},  # of a face
    "off": {(2, 2), *((line, word) for line in range(3, 7) for word in (3, 4, 5)), *((line, word) for line in range(7, 11) for word in (4, 5, 6))},
    "ply": {*((3, word) for word in (1, 2, 3)), (4, 1), (6, 2), (11, 2), (13, 1), (14, 2), *((line, 0) for line in range(16, 24)), (24, 0)},
    "stl": {(1, 1), (30, 1), *((2 + 7 * f, word) for f in range(4) for word in (2, 3, 4))},  # names and normals
    "node": {(line, word) for line in range(2, 6) for word in (4, 5)},                       # attributes, markers
    "ele": {(2, 5)},                                                                         # attributes
    "msh 2.2": {(5, 0), *((6, word) for word in (0, 1, 2)), *((line, word) for line in (18, 19, 20) for word in (0, 3, 4)),
                *((18, word) for word in (1, 2, 5))},  # names; numbers and tags of elements; an element of another kind, which is counted
    "msh 4.0": {*((6, word) for word in (0, 1)), *((15, word) for word in (0, 1, 2)), *((16, word) for word in (0, 1)), *((17, word) for word in (0, 1)),
                (18, 0), (19, 0)},  # entities of blocks; that element; numbers
    "msh 4.1": {*((5, word) for word in range(4)), *((6, word) for word in range(9)), *((line, word) for line in (9, 23) for word in (2, 3)),
                *((10, word) for word in (0, 1)), *((24, word) for word in (0, 1, 2)), *((line, word) for line in (25, 26) for word in (0, 1)),
                (27, 0), (28, 0)},  # $Entities; lowest and highest number; as above
}


def run(program, name):
    """The mesh, the report but for its times, what is said, and the status."""
    done = subprocess.run([program, "mesh", name, "-o", "o.msh", "-f", "--json"], capture_output=True, text=True, check=False)
    out = pathlib.Path("o.msh")
    text = out.read_text() if out.exists() else ""
    out.unlink(missing_ok=True)
    report = json.loads(done.stdout) if done.returncode == 0 else {}
    report.pop("time", None)
    return done.returncode, text, done.stderr, report


def other(word):
    if re.fullmatch(r"-?\d+", word):
        return str(int(word) + 1)
    try:
        return str(float(word) + 0.25)
    except ValueError:
        return word + "x"


def text_fields(text):
    """(line, word), and the text with that word changed."""
    for number, line in enumerate(text.split("\n"), 1):
        for at, word in enumerate(re.finditer(r"[^\s/]+", line)):
            lines = text.split("\n")
            lines[number - 1] = line[:word.start()] + other(word[0]) + line[word.end():]
            yield (number, at), "\n".join(lines)


# ==== bytes: fields as (name, form, values...) ====

def stl_bytes():
    yield "header", "80s", b"solid-like name"
    yield "facets", "<I", 4
    for f, side in enumerate(SIDES):
        yield f"normal {f}", "<3f", 0, 0, 1
        for v in side:
            yield f"corner {f}", "<3f", *POINTS[v]
        yield f"attribute {f}", "<H", 0


def ply_bytes(order):
    yield "text", "*", (f"ply\nformat binary_{order}_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty double z\nproperty uchar red\n"
                        "element face 4\nproperty list ushort uint vertex_index\nproperty short flags\nend_header\n").encode()
    end = "<" if order == "little" else ">"
    for v, p in enumerate(POINTS):
        yield f"x {v}", end + "f", p[0]
        yield f"y {v}", end + "f", p[1]
        yield f"z {v}", end + "d", p[2]
        yield f"red {v}", "B", 9
    for f, side in enumerate(SIDES):
        yield f"length {f}", end + "H", 3
        for v in side:
            yield f"corner {f}", end + "I", v
        yield f"flags {f}", end + "h", 1


def msh_bytes(version):
    size = "<q" if version == "4.1" else "<i"
    yield "text", "*", f"$MeshFormat\n{version} 1 8\n".encode()
    yield "order", "<i", 1
    yield "text", "*", b"\n$EndMeshFormat\n$Nodes\n" + (b"" if version == "4.1" else b"5\n")
    points = [tuple(map(float, line.split()[1:])) for line in NODES.splitlines()]
    if version == "4.1":
        for name, form, value in (("blocks", "<q", 1), ("nodes", "<q", 5), ("lowest", "<q", 1), ("highest", "<q", 5), ("dimension", "<i", 3),
                                  ("entity", "<i", 1), ("parametric", "<i", 0), ("nodes in block", "<q", 5)):
            yield "nodes: " + name, form, value
        for v in range(5):
            yield "tag", "<q", v + 1
    for v, p in enumerate(points):
        if version != "4.1":
            yield "tag", size, v + 1
        for c in p:
            yield f"position {v}", "<d", c
    yield "text", "*", b"\n$EndNodes\n$Elements\n" + (b"" if version == "4.1" else b"2\n")
    if version == "4.1":
        for name, form, value in (("blocks", "<q", 1), ("elements", "<q", 2), ("lowest", "<q", 1), ("highest", "<q", 2), ("dimension", "<i", 3),
                                  ("entity", "<i", 1), ("type", "<i", 4), ("elements in block", "<q", 2)):
            yield "elements: " + name, form, value
    else:
        for name, value in (("type", 4), ("elements in block", 2), ("tags", 2)):
            yield "elements: " + name, "<i", value
    for e, tet in enumerate(((1, 2, 3, 4), (2, 3, 4, 5))):
        yield f"number {e}", size, e + 1
        if version != "4.1":
            yield f"tags {e}", "<2i", 7, 1
        for v in tet:
            yield f"corner {e}", size, v
    yield "text", "*", b"\n$EndElements\n"


BYTES = {"stl, binary": stl_bytes(), "ply, little": ply_bytes("little"), "ply, big": ply_bytes("big"), "msh 2.2, binary": msh_bytes("2.2"),
         "msh 4.1, binary": msh_bytes("4.1")}
IGNORED_BYTES = r"header|normal|attribute|red|flags|lowest|highest|nodes: (dimension|entity)|number|tags \d|elements: (dimension|entity)"


def pack(form, values):
    return values[0] if form == "*" else struct.pack(form, *values)


def byte_fields(fields):
    """Name, and the file with one number changed; texts stand in TEXTS."""
    fields = list(fields)
    whole = [pack(form, values) for _, form, *values in fields]
    yield "", b"".join(whole)
    for i, (name, form, *values) in enumerate(fields):
        for k, value in enumerate(values):
            if form == "*":
                continue
            changed = list(values)
            changed[k] = b"another" if isinstance(value, bytes) else value + (0.25 if isinstance(value, float) else 1)
            yield name, b"".join(whole[:i] + [pack(form, changed)] + whole[i + 1:])


# ==== glTF: each value of its JSON ====

def gltf_scene():
    scene = Scene()
    scene.json["asset"]["copyright"] = "nobody"
    scene.json["extensionsUsed"] = ["KHR_materials_unlit"]
    scene.json["materials"] = [{"name": "red"}]
    mesh = scene.mesh(CUBE, CUBE_INDICES, targets=[scene.accessor(None, "VEC3", count=24, sparse={2: (0, 0, 1), 5: (0, 0, 1)})], material=0, mode=4)
    scene.json["meshes"][0]["weights"] = [0.5]
    scene.json["accessors"][1].update(min=[0, 0, 0], max=[1, 1, 1])
    scene.node(children=[1], translation=[1, 2, 3], rotation=[0, 0, 0.6, 0.8], scale=[1, 2, 3], name="root")
    scene.node(children=[2])
    scene.node(mesh=mesh, name="leaf", matrix=[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1])
    scene.animate((1, "translation", [0.5, 1], [(0, 0, 0), (1, 0, 0)], "VEC3", "LINEAR"))
    scene.json["buffers"] = [{"byteLength": len(scene.data)}]
    return scene


IGNORED_GLTF = r"asset\.(generator|copyright)|extensionsUsed|materials|(nodes|animations)\.\d+\.name|accessors\.\d+\.(min|max)|target$|material"


def json_fields(value, path=()):
    if isinstance(value, dict):
        for key, item in value.items():
            yield from json_fields(item, path + (key,))
    elif isinstance(value, list):
        for i, item in enumerate(value):
            yield from json_fields(item, path + (i,))
    else:
        yield path, value


def gltf_fields():
    scene = gltf_scene()
    yield "", glb(scene.json, scene.data)
    for path, value in json_fields(scene.json):
        changed = json.loads(json.dumps(scene.json))
        at = changed
        for key in path[:-1]:
            at = at[key]
        step = -1 if path[-1] == "byteLength" else 0.25 if isinstance(value, float) else 1
        at[path[-1]] = value + "x" if isinstance(value, str) else value + step
        yield ".".join(map(str, path)), glb(changed, scene.data)


# ==== all of it ====

def run_gltf(program, name):
    """Frames, what is said, and the status."""
    done = subprocess.run([program, "import", "mesh", name, "--rate", "2", "-o", "o.mcap", "-f", "-q"], capture_output=True, text=True, check=False)
    out = pathlib.Path("o.mcap")
    data = out.read_bytes() if out.exists() else b""
    out.unlink(missing_ok=True)
    return done.returncode, data, done.stderr


def main(program, is_verbose):
    table = []  # format, fields, ignored ones, wrong ones
    for form, text in TEXTS.items():
        name = "in." + form.split()[0]
        pathlib.Path("in.node").write_text(TEXTS["node"])
        pathlib.Path("in.ele").write_text(TEXTS["ele"])
        pathlib.Path(name).write_text(text)
        plain = run(program, name)
        wrong = [] if plain[0] == 0 else [plain]
        fields = list(text_fields(text))
        same = []
        for field, changed in fields:
            pathlib.Path(name).write_text(changed)
            if run(program, name) == plain:
                same.append(field)
        wrong += [f"line {line}, word {word}" for line, word in sorted(set(same) ^ IGNORED[form])]
        table.append((form, len(fields), len(same), wrong))
    for form, fields, use, ignored in [(f, byte_fields(b), run, IGNORED_BYTES) for f, b in BYTES.items()] + [("glb", gltf_fields(), run_gltf, IGNORED_GLTF)]:
        name = "in." + re.split(r"[ ,]", form)[0]
        plain, wrong, same, count = None, [], 0, 0
        for field, changed in fields:
            pathlib.Path(name).write_bytes(changed)
            result = use(program, name)
            if plain is None:
                plain, wrong = result, [] if result[0] == 0 else [result]
                continue
            count += 1
            same += result == plain
            if (result == plain) != bool(re.search(ignored, field)):
                wrong.append(field)
        table.append((form, count, same, wrong))
    for form, fields, same, wrong in table:
        if is_verbose or wrong:
            print(f"{form}: {fields} fields, {same} ignored", *(f"wrong: {w}" for w in wrong), sep="\n  ")
    print(f"{sum(row[1] for row in table)} fields of {len(table)} formats, {sum(row[2] for row in table)} are ignored, {sum(len(row[3]) for row in table)} wrong")


if __name__ == "__main__":
    os.environ["LC_ALL"] = "C.UTF-8"
    main(sys.argv[1], "-v" in sys.argv[2:])
