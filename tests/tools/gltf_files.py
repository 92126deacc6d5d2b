# SPDX-License-Identifier: Apache-2.0
"""Writes glTF 2.0 scenes: buffers as bytes behind the JSON (.glb), in base64 or in a file of their own (.gltf). For tests."""
import base64
import json
import pathlib
import struct

CODES = {5120: "b", 5121: "B", 5122: "h", 5123: "H", 5125: "I", 5126: "f"}
TYPES = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}

# A cube of one metre: four corners of its own for each side, as programs write it that give sides normals.
CORNERS = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
CUBE = [CORNERS[v] for side in SIDES for v in side]
CUBE_INDICES = [4 * s + k for s in range(6) for k in (0, 1, 2, 0, 2, 3)]
SQUARE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
SQUARE_INDICES = [0, 1, 2, 0, 2, 3]


class Scene:
    def __init__(self):
        self.data = b""
        self.json = {"asset": {"version": "2.0", "generator": "gltf_files.py"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [], "meshes": [],
                     "accessors": [], "bufferViews": []}

    def add(self, kind, item):
        self.json.setdefault(kind, []).append(item)
        return len(self.json[kind]) - 1

    def view(self, data, **more):
        self.data += bytes(-len(self.data) % 4)
        self.data += data
        return self.add("bufferViews", {"buffer": 0, "byteOffset": len(self.data) - len(data), "byteLength": len(data), **more})

    def accessor(self, values, kind, component=5126, sparse=None, **more):
        """in   values  flat, or tuples; None: none, all are 0, `count` says how many   sparse  {index: values}"""
        item = {"componentType": component, "type": kind, **more}
        if values is not None:
            flat = [c for v in values for c in (v if isinstance(v, (tuple, list)) else (v,))]
            item["count"] = len(flat) // TYPES[kind]
            item["bufferView"] = self.view(struct.pack(f"<{len(flat)}{CODES[component]}", *flat))
        if sparse:
            indices, changed = sorted(sparse), [c for i in sorted(sparse) for c in sparse[i]]
            item["sparse"] = {"count": len(indices), "indices": {"bufferView": self.view(struct.pack(f"<{len(indices)}H", *indices)), "componentType": 5123},
                              "values": {"bufferView": self.view(struct.pack(f"<{len(changed)}{CODES[component]}", *changed))}}
        return self.add("accessors", item)

    def mesh(self, positions, indices, targets=(), component=5123, attributes=None, **more):
        primitive = {"attributes": {"POSITION": self.accessor(positions, "VEC3"), **(attributes or {})}, **more}
        if indices is not None:
            primitive["indices"] = self.accessor(indices, "SCALAR", component)
        if targets:
            primitive["targets"] = [{"POSITION": t} for t in targets]
        return self.add("meshes", {"primitives": [primitive]})

    def node(self, **item):
        return self.add("nodes", item)

    def animate(self, *channels, name="move"):
        """in   channels  (node, path, times, values, kind of values, interpolation)"""
        item = {"name": name, "channels": [], "samplers": []}
        for node, path, times, values, kind, how in channels:
            item["channels"].append({"sampler": len(item["samplers"]), "target": {"node": node, "path": path}})
            item["samplers"].append({"input": self.accessor(times, "SCALAR"), "output": self.accessor(values, kind), "interpolation": how})
        return self.add("animations", item)

    def write(self, path, uri=None):
        """.glb; or .gltf with its buffer in base64, or in the file `uri` beside it."""
        path, scene = pathlib.Path(path), dict(self.json)
        buffer = {"byteLength": len(self.data)}
        if path.suffix == ".gltf" and uri is None:
            buffer["uri"] = "data:application/octet-stream;base64," + base64.b64encode(self.data).decode()
        elif path.suffix == ".gltf":
            buffer["uri"] = uri
            (path.parent / uri).write_bytes(self.data)
        scene["buffers"] = [buffer]
        path.write_bytes(glb(scene, self.data) if path.suffix == ".glb" else json.dumps(scene).encode())
        return path


def glb(scene, data):
    text = json.dumps(scene).encode()
    text += b" " * (-len(text) % 4)
    data += bytes(-len(data) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks
