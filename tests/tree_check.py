#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Check that the tree keeps its own rules. Prints one line per finding; exit 1 when there is any.

  tree_check.py [ROOT]        check a source tree
  tree_check.py --self-test   check that every rule can fail, on a made-up tree
"""
import pathlib
import re
import sys
import tempfile

SOURCE_DIRS = (".ci", "spec", "codec", "io", "metrics", "sim", "device", "cli", "conformance", "tests", "cmake")
CODE = {".h", ".cpp"}
SOURCES = CODE | {".py", ".sh", ".cmake", ".gp", ".mjs", ".js"}
MAX_LINES = 500
SHARED = {"base"}  # folders of codec/ that are not subjects of the specification


def source_files(root):
    named = [root / "go", root / "CMakeLists.txt", root / ".ci" / "run"]
    found = [p for d in SOURCE_DIRS for p in (root / d).rglob("*") if "node_modules" not in p.parts]
    return sorted({p for p in named + found if p.is_file() and (p in named or p.suffix in SOURCES or p.name == "CMakeLists.txt")})


def includes(path):
    """Files of ours that a file includes: <tactus/...> is below codec/, but for the folders beside it."""
    for ours, own in re.findall(r'^\s*#\s*include\s+(?:<tactus/([^>]+)>|"([^"]+)")', path.read_text(encoding="utf-8"), re.M):
        top = ours.split("/")[0]
        yield own or {"trace": "io/", "metrics": "", "sim": ""}.get(top, "codec/") + ours


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
        if len(lines) > MAX_LINES:
            yield f"{path.relative_to(root)}: {len(lines)} lines, at most {MAX_LINES}: split it by subject"


def check_sides(root):
    """The encoder never includes the decoder nor the reverse."""
    for path in sorted((root / "codec").rglob("*")):
        if path.suffix not in CODE:
            continue
        for side, other in (("encoder", "decoder"), ("decoder", "encoder")):
            if side in path.stem:
                for name in sorted(n for n in reachable(root, path) if other in pathlib.Path(n).stem):
                    yield f"{path.relative_to(root)}: the {side} includes {name}"


def check_stems(root):
    """One stem, six places: specification, code, unit test, fuzz target, bench (vectors are the conformance runner's affair)."""
    for folder in sorted(p for p in (root / "codec").iterdir() if p.is_dir()):
        stem = folder.name
        names = {stem} | {p.stem for p in folder.iterdir() if p.suffix in CODE}
        tests = [root / "tests/unit" / f"{prefix}{n}_test.cpp" for n in names for prefix in ("", f"{stem}_")]
        if not any(t.is_file() for t in tests):
            yield f"codec/{stem}: no tests/unit/[{stem}_]<name>_test.cpp for any of {', '.join(sorted(names))}"
        if stem in SHARED:
            continue
        if not any((root / "spec").glob(f"*{stem}*.md")):
            yield f"codec/{stem}: no spec/NN-{stem}.md"
        for kind in ("fuzz", "bench") if stem != "packet" else ("fuzz",):  # packets are timed with what they carry
            programs = (root / "tests" / kind).glob(f"*_{kind}.cpp")
            if not any(stem in p.stem or any(i.startswith(f"codec/{stem}/") for i in includes(p)) for p in programs):
                yield f"codec/{stem}: no tests/{kind}/*_{kind}.cpp has its name or includes a header of it"


def check_readme(root):
    """Each line of the README's tree starts with a path, indented two spaces per level; the text after it is free."""
    readme = root / "README.md"
    text = readme.read_text(encoding="utf-8") if readme.is_file() else ""
    block = re.search(r"^## Tree\s*\n+```[^\n]*\n(.*?)^```", text, re.M | re.S)
    if not block:
        yield "README.md: no fenced block under a heading '## Tree'"
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
            yield f"README.md: the tree names {path.relative_to(root)}, which is not there"


CHECKS = (check_sources, check_sides, check_stems, check_readme)


def findings(root):
    return [line for check in CHECKS for line in check(root)]


def self_test():
    spdx = "// SPDX-License-Identifier: Apache-2.0\n"
    good = {
        "README.md": "## Tree\n\n```\ncodec/          the library\n  rigid/        bodies\n                  that are stiff\nspec/           text\n```\n",
        "spec/40-rigid.md": "",
        "codec/rigid/rigid.h": spdx,
        "codec/rigid/rigid_encoder.h": spdx + '#include <tactus/rigid/rigid.h>\n',
        "codec/rigid/rigid_decoder.h": spdx + '#include <tactus/rigid/rigid.h>\n',
        "tests/unit/rigid_test.cpp": spdx,
        "tests/fuzz/packet_fuzz.cpp": spdx + '#include <tactus/rigid/rigid_decoder.h>\n',
        "tests/bench/rigid_bench.cpp": spdx + '#include <tactus/rigid/rigid_decoder.h>\n',
    }
    bad = {  # what is changed (None: left out) and a word of the finding that must follow
        "codec/rigid/rigid.h": [("int x;\n", "licence"), (spdx + "\n" * MAX_LINES, "501 lines"),
                                (spdx + '#include <tactus/rigid/rigid_decoder.h>\n', "the encoder includes codec/rigid/rigid_decoder.h")],
        "codec/rigid/rigid_decoder.h": [(spdx + '#include <tactus/rigid/rigid_encoder.h>\n', "the decoder includes")],
        "spec/40-rigid.md": [(None, "no spec/NN-rigid.md")],
        "tests/unit/rigid_test.cpp": [(None, "no tests/unit")],
        "tests/fuzz/packet_fuzz.cpp": [(None, "no tests/fuzz"), (spdx, "no tests/fuzz")],
        "tests/bench/rigid_bench.cpp": [(None, "no tests/bench")],
        "README.md": [(None, "no fenced block"), ("## Tree\n```\ncodec/\n  mesh/   gone\n```\n", "names codec/mesh")],
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
