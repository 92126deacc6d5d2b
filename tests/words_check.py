#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Check that words of our own, for which the field has a term, do not come back. words.csv lists them with the term and where they are looked for.

  words_check.py [ROOT]       check a source tree
  words_check.py --self-test  check that each kind of place is looked at, and that plain English is left alone

`all`: in code, comments, help, specification and documents alike. `names`: words that are also plain English, so only names count: of types, functions,
variables and macros in code; keys of JSON schemas, of TOML and of options; terms of the glossary; names in `backticks` of the specification.
"""
import csv
import pathlib
import re
import subprocess
import sys
import tempfile

CODE = {".h", ".cpp", ".c", ".py", ".mjs", ".js", ".ts", ".lua"}
PROSE = {".md", ".csv", ".toml", ".cmake", ".html"}
FOLDERS = ("bindings", "cli", "codec", "conformance", "device", "docs", "examples", "io", "lab", "metrics", "session", "sim", "spec", "tests", "tools",
           "README.md", "CONTRIBUTING.md")
LEFT_OUT = ("tests/words.csv", "tests/words_check.py",
            "spec/99-changes.md",  # old names stand beside new ones
            "lab/studies/world_model.py")  # columns of its stored table
OF_OTHERS = {"Promise", "awaitPromise", "one_way"}  # JavaScript's, networks'
OLD_OPTIONS = {"--jnd-share", "--visual-share", "--haptic-share", "--told", "--pace"}  # whose error names the key of today
NOT_CODE = {
    "c": re.compile(r"//[^\n]*|/\*.*?\*/|R\"(\w*)\(.*?\)\1\"|\"(?:\\.|[^\"\\\n])*\"|(?<!\d)'(?:\\.|[^'\\\n])+'", re.S),
    "py": re.compile(r"#[^\n]*|\"\"\".*?\"\"\"|'''.*?'''|\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])*'", re.S),
    "lua": re.compile(r"--[^\n]*|\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])*'", re.S),
}
NAME = re.compile(r"[A-Za-z_]\w*")
PART = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+")
TEST = re.compile(r"\b(?:TYPED_)?TEST(?:_[FP])?\(\w+,\s*\w+\)|\bdef test_\w+")  # a sentence
KEY = re.compile(r"""^\s*"(\w+)"\s*:|["'](\w+)["']\s*:|\[["'](\w+)["']\]|["'](--[a-z-]+)""", re.M)


def words(root):
    with open(root / "tests/words.csv", encoding="utf-8") as table:
        return {row["word"]: (row["term"], row["where"]) for row in csv.DictReader(table)}


def files(root):
    """Files that git knows, or all in a tree that is none of git's."""
    run = subprocess.run(["git", "-C", root, "ls-files", "--", *FOLDERS], capture_output=True, text=True, check=False)
    names = run.stdout.split("\n") if run.returncode == 0 else [p.relative_to(root).as_posix() for p in root.rglob("*")]
    for name in sorted(set(names)):
        path = root / name
        if name not in LEFT_OUT and path.suffix in CODE | PROSE and path.is_file():
            yield name, path


def blank(match):
    return re.sub(r"[^\n]", " ", match.group())


def names_in(name, text):
    """(offset, name) of what has a name in a file."""
    suffix = pathlib.PurePath(name).suffix
    if suffix in CODE:
        text = TEST.sub(blank, text)
        kind = {".py": "py", ".lua": "lua"}.get(suffix, "c")
        for match in NAME.finditer(NOT_CODE[kind].sub(blank, text)):
            yield match.start(), match.group()
        for match in KEY.finditer(text):
            yield match.start(), match.group(match.lastindex)
    elif suffix == ".toml":
        for match in re.finditer(r"^\s*(?:\[\[?)?([\w.]+)\]?\]?\s*(?:=|$)", text, re.M):
            yield match.start(1), match.group(1)
    elif name.startswith("spec/") and suffix == ".md":
        for match in re.finditer(r"`([A-Za-z_]\w*)`", text):
            yield match.start(), match.group(1)
        glossary = re.search(r"^## \d+ Terms\n.*?(?=^## )", text, re.M | re.S)
        for match in re.finditer(r"^\| ([^|]+) \|", glossary.group() if glossary else "", re.M):
            yield glossary.start() + match.start(1), match.group(1)


def findings(root):
    table = words(root)
    everywhere = re.compile(r"\b(" + "|".join(word for word, (_, where) in table.items() if where == "all") + r")\b", re.I)
    for name, path in files(root):
        text = path.read_text(encoding="utf-8", errors="replace")
        found = {}
        for match in everywhere.finditer(text):
            found.setdefault((text.count("\n", 0, match.start()) + 1, match.group().lower()), match.group())
        for offset, whole in names_in(name, text):
            for part in PART.findall(whole):
                if part.lower() in table and whole not in OF_OTHERS | OLD_OPTIONS:
                    found.setdefault((text.count("\n", 0, offset) + 1, part.lower()), whole)
        for (line, word), whole in sorted(found.items()):
            yield f"{name}:{line}: {whole}: for '{word}' the field says: {table[word][0]}"


def self_test():
    good = {"tests/words.csv": "word,term,where\neased,smoothed,all\nplace,position,names\n",
            "codec/a.h": "// in the first place\nint position;  // \"place\"\n", "docs/a.md": "A place for `place` in prose.\n",
            "spec/00-overview.md": "## 7 Terms\n\n| term | meaning |\n| position | a place |\n\n## 8 More\n| place | |\n"}
    bad = [("codec/a.h", "int place_of(int);\n"), ("codec/a.h", "struct RestPlace;\n"), ("codec/a.h", "// an eased path\n"), ("cli/a.cpp", 'json["place"];\n'),
           ("cli/a.cpp", 'add("--place");\n'), ("lab/a.py", "def place(): pass\n"), ("lab/a.py", 'x = {"place": 1}\n'), ("sim/scenes/a.toml", "place = 1\n"),
           ("docs/a.md", "An Eased path.\n"), ("spec/40-rigid.md", "The element `place` is there.\n"), ("spec/rules.csv", "eased\n"),
           ("spec/00-overview.md", "## 7 Terms\n| place | |\n## 8\n"), ("tools/a.lua", "local place = 1\n")]
    good["tests/a.cpp"] = "TEST_F(Box, StaysInPlace) {}\n"
    failed = 0
    for change in [None, *bad]:
        with tempfile.TemporaryDirectory() as scratch:
            root = pathlib.Path(scratch)
            for name, text in {**good, **dict([change] if change else [])}.items():
                (root / name).parent.mkdir(parents=True, exist_ok=True)
                (root / name).write_text(text, encoding="utf-8")
            found = list(findings(root))
            if len(found) != (1 if change else 0):
                print(f"self-test: {change or 'the good tree'}: found {found}")
                failed += 1
    print(f"self-test: {len(bad) + 1} trees, {failed} wrong")
    return failed


def main(args):
    if args == ["--self-test"]:
        return 1 if self_test() else 0
    root = pathlib.Path(args[0] if args else pathlib.Path(__file__).resolve().parent.parent)
    found = list(findings(root))
    for line in found:
        print(line)
    print(f"{len(found)} words of our own")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
