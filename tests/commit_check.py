#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""tests/commit_check.py CMAKE COMMIT_CMAKE: two builds of one commit whose sources differ have different names. 77: no git."""
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

CLEAN, DIRTY = re.compile(r"[0-9a-f]{12}"), re.compile(r"[0-9a-f]{12}-dirty-[0-9a-f]{8}")


class Checkout:
    """A folder with a commit, which may be changed."""

    def __init__(self, root: Path, cmake: str, script: str) -> None:
        self.root, self.header, self.ask = root, root.parent / "commit.h", [cmake, f"-DSOURCE={root}", "-P", script]
        for path in ("codec/a.cpp", "sim/b.cpp", "README.md", ".gitignore"):
            self.write(path, "*.o\n" if path == ".gitignore" else "first\n")
        self.git("init", "-q")
        self.git("add", "-A")
        self.git("commit", "-q", "-m", "first")

    def git(self, *words: str) -> None:
        quiet = {"GIT_CONFIG_GLOBAL": os.devnull, "GIT_CONFIG_NOSYSTEM": "1"}
        author = {f"GIT_{who}_{what}": "a@b" for who in ("AUTHOR", "COMMITTER") for what in ("NAME", "EMAIL")}
        subprocess.run(["git", "-C", str(self.root), *words], check=True, env={**os.environ, **quiet, **author})

    def write(self, path: str, text: str) -> None:
        (self.root / path).parent.mkdir(parents=True, exist_ok=True)
        (self.root / path).write_text(text)

    def name(self) -> str:
        subprocess.run([*self.ask[:1], f"-DOUTPUT={self.header}", *self.ask[1:]], check=True)
        return re.search(r'TACTUS_COMMIT "(.*)"', self.header.read_text())[1]

    def clean(self) -> str:
        self.git("reset", "-q", "--hard")
        self.git("clean", "-q", "-f", "-d")
        return self.name()


def check(of: Checkout) -> None:
    clean = of.name()
    assert CLEAN.fullmatch(clean), clean
    names = [clean]

    def expect_new(what: str) -> None:
        name = of.name()
        assert DIRTY.fullmatch(name) and name.startswith(clean) and name not in names, (what, name, names)
        assert of.name() == name, f"{what}: the same again"
        names.append(name)

    of.write("codec/a.cpp", "second\n")
    expect_new("a change")
    of.git("add", "-A")
    assert of.name() == names[-1], "staged or not, it is the same change"
    of.write("codec/a.cpp", "third\n")
    expect_new("another change of that file")
    of.write("sim/b.cpp", "third\n")
    expect_new("a change of one more file")
    of.write("codec/new;\u00e4 file.h", "first\n")
    expect_new("an untracked file")
    of.write("codec/new;\u00e4 file.h", "second\n")
    expect_new("another content of it")
    assert of.clean() == clean
    (of.root / "codec/a.cpp").unlink()
    expect_new("a removed file")
    assert of.clean() == clean
    for path in ("README.md", "truth.mcap", "codec/a.o"):
        of.write(path, "second\n")
        assert of.name() == clean, f"{path}: nothing is built from it"


def main() -> int:
    if not shutil.which("git"):
        print("skipped: git not found")
        return 77
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder) / "checkout"
        root.mkdir()
        of = Checkout(root, *sys.argv[1:])
        check(of)
        shutil.rmtree(root / ".git")
        assert of.name() == "", "no checkout"
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
