#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Check that the tree keeps its own rules. Prints one line per finding; exit 1 when there is any.

  tree_check.py [ROOT]        check a source tree
  tree_check.py --self-test   check that every rule can fail, on a made-up tree
"""
import pathlib
import re
import subprocess
import sys
import tempfile

SOURCE_DIRS = (".ci", "spec", "codec", "session", "io", "metrics", "sim", "device", "bindings", "cli", "conformance", "lab", "tests", "tools", "cmake")
CODE = {".h", ".cpp"}
SOURCES = CODE | {".py", ".sh", ".cmake", ".mjs", ".js", ".lua"}
ROOT = {".ci", ".clang-format", ".clang-tidy", ".github", ".gitignore", "CHANGELOG.md", "CITATION.cff", "CMakeLists.txt", "CMakePresets.json",
        "CODE_OF_CONDUCT.md", "CONTRIBUTING.md", "LICENSE", "README.md", "SECURITY.md", "bindings", "cli", "cmake", "codec", "conformance", "device", "docs",
        "examples", "go", "io", "lab", "metrics", "reports", "session", "sim", "spec", "tests", "tools"}
LAYERS = ("codec", "session", "io", "metrics", "sim", "device", "cli")  # each includes nothing of those behind it; what stands beside them is included by nobody
MAX_LINES = 600
SLOW_HEADERS = {"algorithm", "chrono", "cmath", "functional", "iostream", "istream", "map", "ostream", "random", "ranges", "regex", "set", "sstream",
                "unordered_map", "unordered_set", "variant"}  # in no header that tactus.h or session.h includes
ONE_FILE = {".lua"}  # what users copy to install it: may be longer
SHARED = {"base", "mesh"}  # folders of codec/ that are not subjects of the specification
# Everything else in codec/ and session/ is integers: what both ends compute is the same on every machine. These files are interfaces: SI units come in
# or go out, a sender decides what to send, options are read once, a quotient of integers is estimated and then corrected, and the
# basis and the elastic bodies that both ends compute are binary64 in a written order.
FLOATS = {"base/elementary", "base/geometry", "base/quantise", "base/tri_mesh", "client/replica", "client/stiffness_reduction",
          "deformable/deformable_encoder", "deformable/displacement", "deformable/encoder_fit",
          "deformable/motion_clusters", "deformable/vertex_coder", "elastic/driven_shape",
          "elastic/elastic_solver", "elastic/elastic_touch", "load/load_encoder", "load/load_state", "mesh/basis", "mesh/cluster_basis",
          "mesh/deformable_object", "mesh/elastic_elements", "mesh/kriging", "mesh/spring_basis", "packet/sender_policy",
          "packet/substream_encoder", "player", "receiver", "rigid/encoder_choices", "rigid/level_of_detail", "rigid/rigid_bounds", "rigid/rigid_encoder", "rigid/rigid_state",
          "rigid/rigid_truth", "rigid/rigid_update", "rigid/rigid_work", "rigid/trigger",
          "scene/elastic_syntax", "scene/scene_builder", "scene/scene_objects", "sender", "session/congestion", "session/device_signal", "session/exchange",
          "session/server_connection", "session/session_client", "session/session_options", "session/session_server",
          "thesis/force_signal", "thesis/interpolation", "thesis/thesis_encoder", "thesis/thesis_mesh"}
# Everything that is the operating system's stands in these files, one per need; the others are C++ alone. The codec, the traces and
# the metrics are not among them; of the simulation only what runs the program that fills meshes.
SYSTEM = {
    "cli/commands/cmd_lab.cpp": "scripts in the place of the program, or fed by it",
    "cli/commands/sim_check.cpp": "a finer run beside the first", "cli/commands/sim_check.h": "its process",
    "cli/commands/cmd_link.cpp": "to wait for datagrams of many sockets",
    "cli/live/background_work.cpp": "a thread that gives loop to others",
    "cli/live/device_loop.cpp": "single keys",
    "cli/live/device_loop.h": "single keys",
    "cli/live/notify.cpp": "the manager of services",
    "cli/live/token_file.cpp": "a file that one program holds",
    "cli/live/ticker.cpp": "to wait for a time or a datagram",
    "cli/output.cpp": "files that appear whole or not at all, and go when a signal comes",
    "cli/progress.cpp": "terminals",
    "conformance/binary_streams.h": "standard streams without changed line ends",
    "device/falcon/falcon_usb.cpp": "the rights to a device",
    "device/guardian.cpp": "a process that outlives ours",
    "device/guardian.h": "a process that outlives ours",
    "device/hid/hid_raw.cpp": "reports of HID devices",
    "device/real_time.cpp": "priorities, memory that stays",
    "device/shared_library.cpp": "libraries that are looked for when they are needed",
    "io/net/udp.cpp": "sockets",
    "io/seal/secret_file.cpp": "a file that its owner alone reads",
    "sim/surface/program.cpp": "a program that fills meshes", "cli/commands/cmd_mesh.cpp": "its CPU time",
}
# Those that return a subrange: clang 14 cannot compile them with the headers of g++ 12. The functions without ranges do.
NOT_IN_CLANG_14 = re.compile(r"std::ranges::(unique|rotate|remove|remove_if|partition|stable_partition|equal_range|search|search_n|find_end|subrange)\b")
SYSTEM_HEADER = re.compile(r"^\s*#\s*include\s+<((?:sys|net|netinet|arpa|linux)/[^>]+|unistd\.h|fcntl\.h|poll\.h|termios\.h|spawn\.h|dlfcn\.h|"
                           r"pthread\.h|sched\.h|netdb\.h|ifaddrs\.h|pwd\.h|dirent\.h|signal\.h|windows\.h)>", re.M)
OURS = ("codec", "session", "io", "metrics", "sim", "device", "cli", "bindings", "conformance")  # not the tests, which also test what only one system does
UNITS = ("codec", "codec/*", "session", "io/*", "device/*", "metrics")  # each .cpp in them has a unit test of its name
TESTED_BY = {  # those that have none: the parts of one subject, held against each other; files and whole folders
    "codec/base": "base",
    "codec/deformable/displacement": "mesh_graph",
    "codec/deformable/main_state": "deformable_layers",
    "codec/deformable/main_syntax": "deformable_encoder",
    "codec/deformable/motion_clusters": "mesh_basis",
    "codec/elastic": "elastic",
    "codec/mesh_support": "deformable_decoder",
    "codec/load/load_decoder": "load",
    "codec/load/load_encoder": "load",
    "codec/load/load_state": "load",
    "codec/mesh/cluster_basis": "mesh_basis",
    "codec/mesh/deformable_object": "scene_syntax",
    "codec/mesh/elastic_elements": "elastic",
    "codec/mesh/kriging": "mesh_graph",
    "codec/mesh/spring_basis": "mesh_basis",
    "codec/rigid/rigid_bounds": "rigid",
    "codec/rigid/rigid_decoder": "rigid",
    "codec/rigid/rigid_encoder": "rigid",
    "codec/rigid/rigid_state": "rigid",
    "codec/rigid/rigid_syntax": "rigid",
    "codec/rigid/rigid_update": "rigid",
    "codec/scene/deformable_syntax": "scene_syntax",
    "codec/scene/elastic_syntax": "scene_elastic",
    "codec/scene/scene": "scene_syntax",
    "codec/scene/scene_objects": "scene_syntax",
    "codec/thesis/thesis": "thesis_mesh",
    "codec/thesis/thesis_decoder": "thesis_mesh",
    "codec/thesis/thesis_encoder": "thesis_mesh",
    "codec/thesis/thesis_syntax": "thesis_mesh",
    "device/falcon/falcon_frame": "falcon_kinematics",
    "device/falcon/falcon_usb": "falcon_device",
    "device/falcon/libusb_library": "device",
    "device/hid": "hid",
    "device/inverse3": "inverse3",
    "device/openhaptics": "openhaptics",
    "io/net": "net",
    "io/seal/key": "seal_association",
    "io/seal/secret_file": "seal_key_list",
    "io/trace/byte_source": "trace",
    "io/trace/csv_export": "csv",
    "io/trace/csv_fields": "csv",
    "io/trace/csv_header": "csv",
    "io/trace/csv_import": "csv",
    "io/trace/csv_named": "csv",
    "io/trace/csv_plan": "csv",
    "io/trace/csv_reader": "csv",
    "io/trace/csv_rows": "csv",
    "io/trace/csv_tactus": "csv",
    "io/trace/csv_time": "csv",
    "io/trace/csv_timeline": "csv",
    "io/trace/csv_units": "csv",
    "io/trace/mcap_reader": "trace",
    "io/trace/mcap_writer": "trace",
    "io/trace/cdr": "trace",
    "io/trace/message_schemas": "trace",
    "io/trace/messages": "trace",
    "io/trace/ros_assembler": "trace_ros",
    "io/trace/ros_clock": "trace_ros",
    "io/trace/ros_frames": "trace_ros",
    "io/trace/ros_messages": "trace_ros",
    "io/trace/ros_samples": "trace_ros",
    "io/trace/ros_survey": "trace_ros",
    "io/trace/tactus_assembler": "trace",
    "io/trace/trace_reader": "trace",
    "io/trace/trace_writer": "trace",
    "metrics": "metrics",
    "session/session_options": "session_state",
}


def source_files(root):
    named = [root / "go", root / "CMakeLists.txt", root / ".ci" / "run"]
    found = [p for d in SOURCE_DIRS for p in (root / d).rglob("*") if "node_modules" not in p.parts]
    return sorted({p for p in named + found if p.is_file() and (p in named or p.suffix in SOURCES or p.name == "CMakeLists.txt")})


def includes(path):
    """Files of ours that a file includes: <tactus/...> is below codec/, but for the folders beside it."""
    for ours, own in re.findall(r'^\s*#\s*include\s+(?:<tactus/([^>]+)>|"([^"]+)")', path.read_text(encoding="utf-8"), re.M):
        top = ours.split("/")[0]
        yield own or {"session": "", "trace": "io/", "net": "io/", "seal": "io/", "metrics": "", "sim": "", "device": ""}.get(top, "codec/") + ours


def reachable(root, path):
    """Every file of ours that `path` includes, directly or not."""
    seen, todo = set(), list(includes(path))
    while todo:
        name = todo.pop()
        if name not in seen and (root / name).is_file():
            seen.add(name)
            todo += includes(root / name)
    return seen


def check_sources(root):
    for path in source_files(root):
        lines = path.read_text(encoding="utf-8").splitlines()
        if not any("SPDX-License-Identifier: Apache-2.0" in line for line in lines[:2]):
            yield f"{path.relative_to(root)}: the first line does not name the licence (SPDX-License-Identifier: Apache-2.0)"
        if len(lines) > MAX_LINES and path.suffix not in ONE_FILE:
            yield f"{path.relative_to(root)}: {len(lines)} lines, at most {MAX_LINES}: split it by subject"
        for number, line in enumerate(lines, 1):
            if found := path.suffix in CODE and NOT_IN_CLANG_14.search(line):
                yield f"{path.relative_to(root)}:{number}: clang 14 does not compile {found[0]}"


def check_root(root):
    """Nothing is kept beside the folders and files that belong there. What git does not know may lie there."""
    listed = subprocess.run(["git", "-C", root, "ls-files"], capture_output=True, text=True) if (root / ".git").exists() else None
    names = {line.split("/")[0] for line in listed.stdout.splitlines()} if listed else {path.name for path in root.iterdir()}
    for name in sorted(names - ROOT):
        yield f"{name}: does not belong into the root of the tree"


def check_layers(root):
    for at, layer in enumerate(LAYERS):
        above = LAYERS[at + 1:] + ("bindings", "conformance", "lab", "examples")
        for path in sorted(p for p in (root / layer).rglob("*") if p.suffix in CODE):
            for name in sorted(n for n in includes(path) if n.split("/")[0] in above and (root / n).is_file()):
                yield f"{path.relative_to(root)}: includes {name}, of a layer above it"


def cycles(edges):
    """Each group of nodes that lead to one another, as one loop through it that ends where it began."""
    def loop(start):
        came, todo = {}, [start]
        while todo:
            node = todo.pop(0)
            for other in sorted(edges.get(node, ())):
                if other == start:
                    back = [node]
                    while back[-1] != start:
                        back.append(came[back[-1]])
                    return back[::-1] + [start]
                if other not in came:
                    came[other] = node
                    todo.append(other)
        return None

    seen = set()
    for node in sorted(edges):
        found = None if node in seen else loop(node)
        if found:
            seen.update(found)
            yield found


def check_cycles(root):
    """No folder includes another that includes it, directly or not: neither the folders of codec/ nor those at the top. What lies right
    in codec/ may include all of its folders and is included by none."""
    for tops, depth in ((("codec",), 2), (OURS, 1)):
        edges = {}  # by folder and folder: an example
        for path in sorted(p for top in tops for p in (root / top).rglob("*") if p.suffix in CODE):
            name = path.relative_to(root)
            here = "/".join(name.parts[:-1][:depth])
            for other in sorted(n for n in includes(path) if (root / n).is_file()):
                there = "/".join(pathlib.PurePath(other).parts[:-1][:depth])
                if there == "codec" != here and depth == 2:
                    yield f"{name}: includes {other}, which is above the folders of codec/"
                elif there != here:
                    edges.setdefault(here, {}).setdefault(there, f"{name} includes {other}")
        for loop in cycles(edges):
            examples = "; ".join(edges[a][b] for a, b in zip(loop, loop[1:]))
            yield f"{' -> '.join(loop)}: a cycle of folders: {examples}"


def check_sides(root):
    """The encoder never includes the decoder nor the reverse."""
    for path in sorted((root / "codec").rglob("*")):
        if path.suffix not in CODE:
            continue
        for side, other in (("encoder", "decoder"), ("decoder", "encoder")):
            if side in path.stem:
                for name in sorted(n for n in reachable(root, path) if other in pathlib.Path(n).stem):
                    yield f"{path.relative_to(root)}: the {side} includes {name}"


def check_integers(root):
    for path in sorted(p for top in ("codec", "session") for p in (root / top).rglob("*") if p.suffix in CODE):
        code = re.sub(r"//[^\n]*", "", path.read_text(encoding="utf-8"))
        if path.relative_to(root).with_suffix("").as_posix().removeprefix("codec/") not in FLOATS and re.search(r"\b(float|double)\b|<cmath>", code):
            yield f"{path.relative_to(root)}: floating point, and the file is not in FLOATS"


def check_umbrella_headers(root):
    """What a program includes to use the library stays quick to compile: none of its headers includes what is slow and not needed there."""
    for umbrella in ("codec/tactus.h", "session/session.h"):
        if not (root / umbrella).is_file():
            continue
        for name in sorted(reachable(root, root / umbrella) | {umbrella}):
            for header in re.findall(r"^\s*#\s*include\s+<(\w+)>", (root / name).read_text(encoding="utf-8"), re.M):
                if header in SLOW_HEADERS:
                    yield f"{name}: <{header}> is slow to compile, and {umbrella} includes this file"


def check_system(root):
    """Headers of the operating system are included where SYSTEM says, and each file there still needs it."""
    for path in sorted(p for folder in OURS for p in (root / folder).rglob("*") if p.suffix in CODE):
        name, used = path.relative_to(root).as_posix(), SYSTEM_HEADER.findall(path.read_text(encoding="utf-8"))
        if used and name not in SYSTEM:
            yield f"{name}: <{used[0]}> is the operating system's, and the file is not in SYSTEM"
        elif name in SYSTEM and not used:
            yield f"{name}: stands in SYSTEM and includes nothing of the operating system's"


def check_units(root):
    """Each source file has the unit test that bears its name, with that of its folder before it, or the one in TESTED_BY for it or its folder."""
    for path in sorted(p for pattern in UNITS for p in root.glob(f"{pattern}/*.cpp")):
        unit = path.relative_to(root).with_suffix("").as_posix()
        names = (path.stem, f"{path.parent.name}_{path.stem}")
        own = any((root / "tests/unit" / f"{name}_test.cpp").is_file() for name in names)
        other = TESTED_BY.get(unit) or (not own and TESTED_BY.get(path.parent.relative_to(root).as_posix()))
        if own and other:
            yield f"{unit}.cpp: has a test of its own and stands in TESTED_BY all the same"
        elif not own and not other:
            yield f"{unit}.cpp: no tests/unit/{names[0]}_test.cpp nor {names[1]}_test.cpp"
        elif other and not (root / "tests/unit" / f"{other}_test.cpp").is_file():
            yield f"{unit}.cpp: TESTED_BY names tests/unit/{other}_test.cpp, which is not there"


def check_stems(root):
    """One stem: specification, code, fuzz target, bench (vectors are the conformance runner's affair)."""
    for folder in sorted(p for p in (*(root / "codec").iterdir(), root / "session") if p.is_dir()):
        stem, name = folder.name, folder.relative_to(root).as_posix()
        if stem in SHARED:
            continue
        if not any((root / "spec").glob(f"*{stem}*.md")):
            yield f"{name}: no spec/NN-{stem}.md"
        for kind in ("fuzz", "bench"):
            programs = (root / "tests" / kind).glob(f"*_{kind}.cpp")
            if not any(stem in p.stem or any(i.startswith(f"{name}/") for i in includes(p)) for p in programs):
                yield f"{name}: no tests/{kind}/*_{kind}.cpp has its name or includes a header of it"


def check_tree(root):
    """Each line of the tree in CONTRIBUTING.md starts with a path, indented two spaces per level; the text after it is free."""
    page = root / "CONTRIBUTING.md"
    text = page.read_text(encoding="utf-8") if page.is_file() else ""
    block = re.search(r"^## Tree\s*\n+```[^\n]*\n(.*?)^```", text, re.M | re.S)
    if not block:
        yield "CONTRIBUTING.md: no fenced block under a heading '## Tree'"
        return
    parents = []
    for line in block.group(1).splitlines():
        entry = re.match(r"( *)(\S+)", line)
        if not entry:
            continue
        level = len(entry.group(1)) // 2
        if level > len(parents):
            continue  # a sentence that goes on below its path
        parents[level:] = [entry.group(2)]
        path = root.joinpath(*parents)
        if not path.exists():
            yield f"CONTRIBUTING.md: the tree names {path.relative_to(root)}, which is not there"


CHECKS = (check_root, check_sources, check_layers, check_cycles, check_integers, check_umbrella_headers, check_system, check_sides, check_units, check_stems, check_tree)


def findings(root):
    return [line for check in CHECKS for line in check(root)]


def self_test():
    spdx = "// SPDX-License-Identifier: Apache-2.0\n"
    good = {
        "CONTRIBUTING.md": "## Tree\n\n```\ncodec/          the library\n  rigid/        bodies\n                  that are stiff\nspec/           text\n```\n",
        "spec/40-rigid.md": "",
        "codec/base/bytes.h": spdx,
        "codec/sender.h": spdx + '#include <tactus/rigid/rigid_encoder.h>\n',
        "codec/rigid/rigid.h": spdx + '#include <tactus/base/bytes.h>\n',
        "codec/rigid/rigid_encoder.h": spdx + '#include <tactus/rigid/rigid.h>\n',
        "codec/rigid/rigid.cpp": spdx,
        "codec/rigid/trigger.cpp": spdx,
        "codec/rigid/rigid_state.cpp": spdx,
        "codec/rigid/rigid_decoder.h": spdx + '#include <tactus/rigid/rigid.h>\n',
        "tests/unit/rigid_test.cpp": spdx,
        "tests/unit/rigid_trigger_test.cpp": spdx,
        "tests/fuzz/packet_fuzz.cpp": spdx + '#include <tactus/rigid/rigid_decoder.h>\n',
        "tests/bench/rigid_bench.cpp": spdx + '#include <tactus/rigid/rigid_decoder.h>\n',
        "bindings/c/errors.h": spdx + '#include <tactus/base/bytes.h>\n',
        "cli/output.h": spdx,
        "conformance/report.h": spdx + '#include "bindings/c/errors.h"\n',
    }
    bad = {  # what is changed (None: left out) and a word of the finding that must follow
        "codec/rigid/rigid.h": [("int x;\n", "licence"), (spdx + "\n" * MAX_LINES, "601 lines"),
                                (spdx + '#include <tactus/rigid/rigid_decoder.h>\n', "the encoder includes codec/rigid/rigid_decoder.h")],
        "codec/tactus.h": [(spdx + "#include <cmath>\n", "<cmath> is slow")],
        "codec/rigid/rigid_decoder.cpp": [(spdx + "#include <unistd.h>\n", "not in SYSTEM"), (spdx + "double x;\n", "floating point"),
                                            (spdx + "#include <cmath>\n", "floating point")],
        "cli/table.cpp": [(spdx + "std::ranges::rotate(row, begin);\n", "clang 14 does not compile std::ranges::rotate")],
        "cli/progress.cpp": [(spdx, "includes nothing of the operating system's")],
        "codec/rigid/rigid_decoder.h": [(spdx + '#include <tactus/rigid/rigid_encoder.h>\n', "the decoder includes")],
        "token": [("secret", "does not belong")],
        "codec/rigid/curve.h": [(spdx + '#include "cli/output.h"\n', "of a layer above"),
                                (spdx + '#include <tactus/sender.h>\n', "includes codec/sender.h, which is above the folders")],
        "codec/base/bytes.h": [(spdx + '#include <tactus/rigid/rigid.h>\n', "codec/base -> codec/rigid -> codec/base: a cycle"),
                               (spdx + '#include "conformance/report.h"\n', "bindings -> codec -> conformance -> bindings: a cycle")],
        "session/timing.h": [(spdx, "session: no spec/NN-session.md"), (spdx + "double x;\n", "floating point")],
        "spec/40-rigid.md": [(None, "no spec/NN-rigid.md")],
        "tests/unit/rigid_test.cpp": [(None, "rigid.cpp: no tests/unit"), (None, "TESTED_BY names tests/unit/rigid_test.cpp")],
        "tests/unit/rigid_trigger_test.cpp": [(None, "trigger.cpp: no tests/unit")],
        "tests/unit/rigid_state_test.cpp": [(spdx, "stands in TESTED_BY all the same")],
        "tests/fuzz/packet_fuzz.cpp": [(None, "no tests/fuzz"), (spdx, "no tests/fuzz")],
        "tests/bench/rigid_bench.cpp": [(None, "no tests/bench")],
        "CONTRIBUTING.md": [(None, "no fenced block"), ("## Tree\n```\ncodec/\n  mesh/   gone\n```\n", "names codec/mesh")],
    }
    cases = [({}, None)] + [({name: text}, word) for name, changes in bad.items() for text, word in changes]
    failed = 0
    for change, word in cases:
        with tempfile.TemporaryDirectory() as scratch:
            root = pathlib.Path(scratch)
            for name, text in {**good, **change}.items():
                if text is not None:
                    (root / name).parent.mkdir(parents=True, exist_ok=True)
                    (root / name).write_text(text, encoding="utf-8")
            for folder in ("tests/fuzz", "tests/bench", "spec"):
                (root / folder).mkdir(parents=True, exist_ok=True)
            found = findings(root)
            if (word is None and found) or (word is not None and not any(word in line for line in found)):
                print(f"self-test: {change or 'the good tree'}: expected {word or 'no finding'}, found {found}")
                failed += 1
    print(f"self-test: {len(cases)} trees, {failed} wrong")
    return failed


def main(args):
    if args == ["--self-test"]:
        return 1 if self_test() else 0
    root = pathlib.Path(args[0] if args else pathlib.Path(__file__).resolve().parent.parent)
    found = findings(root)
    for line in found:
        print(line)
    print(f"{len(found)} findings in {len(source_files(root))} source files")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
