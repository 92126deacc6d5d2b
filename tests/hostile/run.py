#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Give a `tactus` program damaged and malicious files and look how it ends.

  run.py PROGRAM                 a seeded selection, 5 s of CPU time
  run.py PROGRAM --full          20 times as many damaged files and all bombs: about a minute of CPU time
  run.py PROGRAM --runs N --seed S --only KIND    N damaged files of one kind: streams, traces, tables, scenes, plans, meshes, "scenes of others",
                                 folders
  run.py PROGRAM --keep DIR      put what failed into DIR
  run.py --self-test             each kind of bad ending is found
  --sanitized                    the program has AddressSanitizer: no limit of memory, more time

Right is: an end within 10 s of CPU time and 1 GiB of memory, by no signal, with status 0 to 3; after status 1 an error that begins with
"error:"; no control character or broken UTF-8 in what is printed, and no line without end; no temporary file; an output after status 0 only
(but for what `sim` says it leaves), and then one that is there.
"""
import argparse
import functools
import os
import pathlib
import random
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import zlib

import bombs
import mutate

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "tools"))
import gltf_files  # noqa: E402

CPU_S, MEMORY, LONGEST_LINE, LONGEST_MESSAGE = 10, 1 << 30, 2100, 8000
POWER = re.compile("[\x00-\x09\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069]")
POWER_IN_JSON = re.compile("[\x00-\x09\x0b-\x1f]")  # it is for programs, which undo its escapes


class Runner:
    def __init__(self, program, sanitized, cpu_s=CPU_S):
        self.program, self.sanitized = program, sanitized
        self.cpu_s = cpu_s * (8 if sanitized else 1)
        self.environment = {"PATH": os.environ["PATH"], "HOME": "/nonexistent", "LC_ALL": "C.UTF-8", "ASAN_OPTIONS": "detect_leaks=0:allocator_may_return_null=1",
                            "UBSAN_OPTIONS": "print_stacktrace=1:halt_on_error=1"}

    def limit(self):
        resource.setrlimit(resource.RLIMIT_CPU, (self.cpu_s, self.cpu_s + 5))
        resource.setrlimit(resource.RLIMIT_FSIZE, (MEMORY, MEMORY))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        if not self.sanitized:
            resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))

    def findings(self, folder, words, statuses):
        """What is wrong with how `tactus words` ends in `folder`; a sentence each."""
        before = {p.name for p in folder.iterdir()}
        try:
            done = subprocess.run([self.program, *words], cwd=folder, env=self.environment, capture_output=True, stdin=subprocess.DEVNULL,
                                  preexec_fn=self.limit, timeout=300, check=False)
        except subprocess.TimeoutExpired:
            yield "does not end"
            return
        if done.returncode < 0:
            yield f"ended by signal {-done.returncode}"
            return
        if done.returncode not in statuses:
            yield f"status {done.returncode}, not one of {sorted(statuses)}"
        if b"Sanitizer" in done.stderr or b"runtime error" in done.stderr:
            yield "a sanitizer has found something"
        if b"the program has a defect" in done.stderr or b"there is not enough memory" in done.stderr:
            yield "only the last net has caught it"
        power = POWER_IN_JSON if "--json" in words else POWER
        yield from bad_text("standard output", done.stdout, power, None)
        yield from bad_text("standard error", done.stderr, power, LONGEST_MESSAGE)
        lines = [line for line in done.stderr.splitlines() if not line.startswith((b"note:", b"warning:"))]
        if done.returncode == 1 and not (lines and lines[0].startswith((b"error:", b"{") if "--json" in words else b"error:")):
            yield "no error: on standard error"
        left = {str(p.relative_to(folder)) for p in folder.rglob("*") if p.name not in before}
        wanted = {words[i + 1] for i, word in enumerate(words[:-1]) if word == "-o" and words[i + 1] != "/dev/null"}
        locks = {".lock"} if words[0] == "sweep" else set()  # of its folder of results
        hidden = [name for name in left
                  if pathlib.Path(name).name.startswith(".") and pathlib.Path(name).name not in locks or name.endswith(".part")]
        if hidden:
            yield f"left behind: {sorted(hidden)}"
        if done.returncode == 0 and any(not (folder / name).exists() for name in wanted):
            yield "status 0, but no output"
        if done.returncode == 1 and words[0] not in ("sim", "sweep") and wanted & left:
            yield "an output in spite of the error"


def bad_text(where, data, power, most):
    text = data.decode("utf-8", "surrogateescape")
    found = power.search(text.replace("\ufffd", "")) or re.search("[\udc80-\udcff]", text)
    if found:
        yield f"{where} has {found.group()!r}"
    if most and (len(text) > most or any(len(line) > LONGEST_LINE for line in text.splitlines())):
        yield f"{where} is too long: {len(text)} characters"


# ---- Files to damage ---------------------------------------------------------------------------------------------------

def make_seeds(program, folder):
    """Whole files of every kind, made by the program itself, by name."""
    def tactus(*words):
        subprocess.run([program, *words], cwd=folder, check=True, stdout=subprocess.DEVNULL, stdin=subprocess.DEVNULL)

    def read(name):
        return (folder / name).read_bytes()

    tactus("sim", "push-1dof", "--duration", "120ms", "-o", "rigid.mcap", "-q")
    tactus("encode", "rigid.mcap", "-o", "rigid.tct", "-q")
    tactus("export", "csv", "rigid.mcap", "-o", "rigid.csv")
    tactus("mesh", "--slab", "3x3x1", "--cell", "20mm", "-o", "slab.msh", "-q")
    tactus("mesh", "--slab", "2x2x1", "-o", "slab.node", "-q")
    frames = folder / "frames"
    frames.mkdir()
    for k in range(3):
        (frames / f"f{k}.obj").write_text("".join(f"v {x} {y} {0.01 * k * x * y}\n" for x in range(3) for y in range(3)) +
                                          "".join(f"f {i} {i + 3} {i + 4}\nf {i} {i + 4} {i + 1}\n" for i in (1, 2, 4, 5)))
    tactus("import", "mesh", "frames", "-o", "mesh.mcap", "-q")
    tactus("encode", "mesh.mcap", "-o", "mesh.tct", "-q", "--haptic", "off")
    tactus("encode", "mesh.mcap", "-o", "thesis.tct", "-q", "--haptic", "off", "--profile", "thesis")
    tactus("encode", "mesh.mcap", "-o", "clusters.tct", "-q", "--haptic", "off", "--tune", "clusters=2")
    tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
    off = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n"
    ply = ("ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 4\n"
           "property list uchar int vertex_indices\nend_header\n" + off.split("\n", 2)[2])
    bombs.plan(folder, bombs.PLOT)
    scenes = pathlib.Path(__file__).parents[2] / "sim" / "scenes"
    return {"streams": [("tct", read(f"{n}.tct")) for n in ("rigid", "mesh", "thesis", "clusters")],
            "traces": [("mcap", read("rigid.mcap")), ("mcap", read("mesh.mcap"))],
            "tables": [("csv", read("rigid.csv")[:20000]), ("csv", b"t,x,y,z,s\n" + b"".join(b"%g,%d,2,3,a\n" % (i / 10, i) for i in range(20)))],
            "scenes": [("toml", (scenes / f"{n}.toml").read_bytes()) for n in ("push-1dof", "rotate-push-lift", "membrane-small", "msd-1d")],
            "plans": [("toml", read("p.toml"))],
            "meshes": [("msh", read("slab.msh")), ("node", read("slab.node")), ("ele", read("slab.ele")), ("obj", tetrahedron.encode()),
                       ("off", off.encode()), ("ply", ply.encode())],
            "scenes of others": [("glb", gltf(folder / "a.glb")), ("gltf", gltf(folder / "a.gltf"))],
            "folders": [("obj", (frames / "f1.obj").read_bytes())]}


def gltf(path):
    """A square that is bent, and that a joint moves."""
    scene = gltf_files.Scene()
    joints = scene.accessor([(0, 1, 0, 0)] * 4, "VEC4", 5121)
    weights = scene.accessor([(0.5, 0.5, 0, 0)] * 4, "VEC4")
    shift = scene.accessor(None, "VEC3", count=4, sparse={2: (0, 0, 1)})
    scene.node(mesh=scene.mesh(gltf_files.SQUARE, gltf_files.SQUARE_INDICES, [shift], attributes={"JOINTS_0": joints, "WEIGHTS_0": weights}), skin=0)
    scene.node(children=[2], name="root")
    scene.node(translation=[1, 0, 0], rotation=[0, 0, 0, 1])
    scene.json["scenes"][0]["nodes"] = [0, 1]
    scene.add("skins", {"joints": [1, 2]})
    scene.animate((0, "weights", [0, 0.2], [0, 1], "SCALAR", "STEP"), (2, "rotation", [0, 0.2], [(0, 0, 0, 1), (0, 0, 1, 0)], "VEC4", "LINEAR"),
                  (1, "scale", [0, 0.2], [(0, 0, 0), (1, 1, 1), (0, 0, 0)] * 2, "VEC3", "CUBICSPLINE"))
    return scene.write(path).read_bytes()


def damaged(kind, form, data, rng):
    if form == "tct":
        return mutate.mutated_stream(data, rng) if rng.randrange(3) else mutate.mutated(data, rng, mutate.BINARY)
    if form == "mcap":
        return mutate.mutated_mcap(mutate.unpacked_mcap(data), rng) if rng.randrange(3) else mutate.mutated(data, rng, mutate.BINARY)
    data = mutate.mutated(data, rng, mutate.BINARY if form == "glb" else mutate.TEXT)
    return mutate.zstd(["-1"], data) if kind == "tables" and rng.randrange(3) == 0 else data


@functools.cache
def can(program, command):
    """Whether a program has a command that it may have been built without."""
    return subprocess.run([program, command, "--help"], capture_output=True, check=False).returncode == 0


def drawn(program, name, truth=None):
    """As figures, and as pages where they can be made."""
    plot = [["export", "figure", name, "-o", "o.json"]] if truth is None else []
    view = [["view", name, "-o", "o.html", *(["--truth", truth] if truth else [])]] if can(program, "view") else []
    return plot + view


def commands(kind, name, rng, program):
    """What the table of kinds and commands asks for; one of it."""
    table = {
        "streams": [["info", name], ["info", name, "--packets", "--json"], ["decode", name, "-o", "o.mcap", "--interpolate", "--ticks", "200"],
                    ["decode", name, "-o", "o.mcap"], ["export", "foxglove", name, "-o", "o.mcap"], *drawn(program, name)],
        "traces": [["info", name], ["encode", name, "-o", "o.tct"], ["encode", name, "-o", "o.tct", "--profile", "thesis"],
                   ["encode", name, "-o", "o.tct", "--basis", "4"], ["encode", name, "-o", "o.tct", "--tune", "layered=on"],
                   ["encode", name, "-o", "o.tct", "--tune", "clusters=3"], *drawn(program, name), *drawn(program, "seed.tct", name),
                   ["export", "csv", name, "-o", "o.csv"], ["export", "mesh", name, "-o", "o"], ["compare", name, name],
                   ["export", "foxglove", name, "-o", "o.mcap", "--layout", "o.json"],
                   ["decode", "seed.tct", "-o", "o.mcap", "--like", name], ["sim", "push-1dof", "-o", "o.mcap", "--replay", name],
                   ["cut", name, "-o", "o.mcap", "--from", "10ms", "--rebase"], ["resample", name, "-o", "o.mcap", "--rate", "333"],
                   ["merge", name, name, "-o", "o.mcap"], ["recover", name, "-o", "o.mcap"]],
        "tables": [["import", "csv", name, "-o", "o.mcap", "--preset", "tactus"],
                   ["import", "csv", name, "-o", "o.mcap", "--map", "position=x,y,z", "--time", "t", "--segment", "s"]],
        "scenes": [["info", name], ["sim", name, "-o", "o.mcap", "--duration", "5ms"]],
        "plans": [["sweep", name, "--list"]] * 3 + [["sweep", name, "-o", "o", "-j", "1"]],
        "meshes": [["mesh", name, "-o", "o.msh"]],
        "scenes of others": [["import", "mesh", name, "-o", "o.mcap"], ["import", "mesh", name, "-o", "o.mcap"], ["mesh", name, "-o", "o.msh"]],
        "folders": [["import", "mesh", "frames", "-o", "o.mcap"]],
    }
    return rng.choice(table[kind])


class Folders:
    """A folder for every run; those of failures are kept."""

    def __init__(self, keep):
        self.keep, self.failed, self.runs = keep, 0, 0

    def judge(self, label, folder, words, findings):
        self.runs += 1
        for finding in findings:
            self.failed += 1
            print(f"FAILED {label}: tactus {' '.join(words)[:200]!r}: {finding}", flush=True)
            if self.keep:
                shutil.copytree(folder, pathlib.Path(self.keep, re.sub(r"\W", "-", label)), symlinks=True, dirs_exist_ok=True)


def run_damaged(runner, seeds, kinds, runs, seed, folders):
    for kind in kinds:
        for i in range(runs):
            rng = random.Random(f"{seed} {kind} {i}")
            form, data = seeds[kind][i % len(seeds[kind])]
            with tempfile.TemporaryDirectory() as scratch:
                folder = pathlib.Path(scratch)
                name = "in." + form
                content = damaged(kind, form, data, rng)
                if kind == "folders":
                    shutil.copytree(seeds["home"] / "frames", folder / "frames")
                    (folder / "frames" / "f1.obj").write_bytes(content)
                else:
                    (folder / name).write_bytes(content)
                for form_2, other in (("node", "ele"), ("ele", "node")):
                    if form == form_2:
                        shutil.copy(seeds["home"] / f"slab.{other}", folder / f"in.{other}")
                (folder / "seed.tct").write_bytes(seeds["streams"][0][1])
                words = commands(kind, name, rng, runner.program)
                folders.judge(f"{kind} {seed} {i}", folder, words, runner.findings(folder, words, {0, 1, 3}))


def run_bombs(runner, chosen, seeds, folders):
    for bomb in chosen:
        with tempfile.TemporaryDirectory() as scratch:
            folder = pathlib.Path(scratch)
            made = bomb(folder, seeds["traces"][0][1]) if bomb in bombs.OF_TRACES else bomb(folder)
            for words, statuses in made:
                folders.judge(getattr(bomb, "__name__", "bomb"), folder, words, runner.findings(folder, words, statuses))


def self_test():
    """Programs that end badly, one way each."""
    cases = [("echo 'error: no' >&2; exit 1", {1}, True), ("kill -SEGV $$", {1}, False), ("exit 7", {1}, False), ("exit 1", {1}, False),
             ("printf 'error: \\033[2J' >&2; exit 1", {1}, False), ("printf 'a\\377'", {0}, False), ("printf 'a\\302\\233'", {0}, False),
             ("while :; do :; done", {1}, False), ("touch .o.abc; echo 'error: no' >&2; exit 1", {1}, False), ("exit 0", {0}, False),
             ("touch o.x", {0}, True), ("touch o.x; echo 'error: no' >&2; exit 1", {1}, False),
             ("echo 'error: the program has a defect' >&2; exit 1", {1}, False), ("head -c 100000 /dev/zero | tr '\\0' e >&2; exit 0; ", {0}, False), ("echo ==1==ERROR: AddressSanitizer >&2; touch o.x", {0}, False)]
    wrong = 0
    with tempfile.TemporaryDirectory() as scratch:
        script = pathlib.Path(scratch, "program")
        for body, statuses, good in cases:
            script.write_text("#!/bin/sh\n" + body)
            script.chmod(0o755)
            work = pathlib.Path(scratch, f"work{zlib.crc32(body.encode())}")
            work.mkdir()
            if (not list(Runner(script, False, 1).findings(work, ["info", "-o", "o.x"], statuses))) != good:
                wrong += 1
                print(f"taken for {'bad' if good else 'good'}: {body}")
    print(f"{len(cases)} endings, {wrong} judged wrongly")
    return wrong == 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", nargs="?", type=pathlib.Path)
    parser.add_argument("--full", action="store_true")
    parser.add_argument("--runs", type=int)
    parser.add_argument("--seed", default="1")
    parser.add_argument("--only")
    parser.add_argument("--keep")
    parser.add_argument("--sanitized", action="store_true")
    parser.add_argument("--self-test", action="store_true")
    options = parser.parse_args()
    if options.self_test:
        return 0 if self_test() else 1
    if not options.program:
        parser.error("PROGRAM is missing")
    if shutil.which("zstd") is None:
        parser.error("the program zstd is missing, which packs what is to be unpacked")
    runner, folders = Runner(options.program.resolve(), options.sanitized), Folders(options.keep)
    kinds = [options.only] if options.only else ["streams", "traces", "tables", "scenes", "plans", "meshes", "scenes of others", "folders"]
    with tempfile.TemporaryDirectory() as scratch:
        seeds = make_seeds(runner.program, pathlib.Path(scratch))
        seeds["home"] = pathlib.Path(scratch)
        run_damaged(runner, seeds, kinds, options.runs or (1000 if options.full else 50), options.seed, folders)
        if not options.only:
            run_bombs(runner, bombs.SMALL + bombs.OF_TRACES + (bombs.LARGE if options.full else ()), seeds, folders)
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    print(f"{folders.runs} runs, {folders.failed} findings, {used.ru_utime + used.ru_stime:.0f} s of CPU time")
    return 1 if folders.failed else 0


if __name__ == "__main__":
    sys.exit(main())
