#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The blocks of README.md and of the pages in docs/: run, compared, listed.

    page_commands.py PAGE          print the commands of a page: lines that begin with `tactus`, and each block of Python as one command
    page_commands.py run PAGE...   run the blocks of each page, in their order, in the current folder; `tactus` is on PATH
    page_commands.py check         without running: every block of every page is run or says why not; links lead somewhere; words per page
    page_commands.py list          every block that is not run, with its reason
    page_commands.py self-test     check that each kind of finding is found

What a block is, its first line says: nothing or `sh`: commands, run as one script; `python`: a program; `js`: the same for Node; `text`:
what the block before it prints. There `...` stands for any text, alone on a line for any lines; other lines follow each other as shown.
A comment above a block, which no reader sees, says more:
    <!-- not run: REASON -->   nobody runs it, or another test does
    <!-- needs NAME -->        not run where this program, module of Python or, as in `tactus view`, command is not there
    <!-- file NAME -->         the block is the content of this file in the folder
    <!-- example NAME -->      lines of examples/NAME, as they stand there; a block `text` after it is what that example prints
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import typing

ROOT = pathlib.Path(__file__).resolve().parents[2]
FENCE = re.compile(r"(?:^<!-- (not run|needs|file|example):? (.*?) -->\n)?^```(\S*)\n(.*?)^```$", re.M | re.S)
SHELL, FILES = {"", "sh"}, {"toml", "json", "yaml", "csv"}
MOST_WORDS = {"README.md": 1300}
BY_CASES = {  # pages with a case of their own, which makes what they need; it uses blocks() or the commands that are printed
    "docs/large-worlds.md": "266-bench-world", "docs/operator.md": "258-operator-page", "docs/recordings.md": "244-recordings-page",
}
PROJECT = ("conformance", "examples", "reports", "sim", "spec", "tools")  # the pages' commands are those of the project's folder
SECONDS = 240  # for one block


class Block(typing.NamedTuple):
    line: int
    mark: str  # what stands above it
    printed: str
    kind: str
    text: str


def blocks(page):
    text = page.read_text(encoding="utf8")
    found = [Block(text.count("\n", 0, m.start()) + 1, m[1] or "", m[2] or "", m[3], m[4]) for m in FENCE.finditer(text)]
    fences = len(re.findall(r"^```", text, re.M))
    if fences != 2 * len(found):
        raise SystemExit(f"{page}: {fences} lines of ``` are not the ends of {len(found)} blocks")
    return found


def pages():
    return [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]


def commands(page):
    for block in blocks(page):
        if block.kind == "python" and not block.mark:
            yield "python3 -c " + "'" + block.text.replace("'", "'\\''") + "'"
        elif block.kind in SHELL:
            yield from (line for line in block.text.splitlines() if line.startswith("tactus "))


def shown_in(shown, printed):
    """Whether the lines `shown` are consecutive lines of `printed`, but for what `...` stands for."""
    lines = [line.rstrip() for line in shown.strip("\n").splitlines()]
    pattern = "".join(r"(?:.*\n)*?" if line.strip() == "..." else r"[^\n]*".join(map(re.escape, line.split("..."))) + r"[ ]*\n" for line in lines)
    return re.search("^" + pattern, printed.rstrip("\n") + "\n", re.M) is not None


def build():
    """Folder of the build that the program is from."""
    program = shutil.which("tactus")
    if program is None:
        raise SystemExit("tactus is not on PATH")
    return pathlib.Path(program).resolve().parents[1]


def python():
    """The Python that has NumPy here."""
    return next((found for found in ("/usr/bin/python3", sys.executable) if os.path.exists(found)), "python3")


def is_there(name):
    if name.startswith("tactus "):
        commands_here = subprocess.run(["tactus", "--help"], capture_output=True, text=True, check=False).stdout
        return re.search(rf"^  {re.escape(name[7:])} ", commands_here, re.M) is not None
    return shutil.which(name) is not None or subprocess.run([python(), "-c", f"import {name}"], capture_output=True, check=False).returncode == 0


def print_of(words, **how):
    done = subprocess.run(words, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=SECONDS,
                          check=False, **how)
    return done.stdout, "" if done.returncode == 0 else f"status {done.returncode}\n{done.stdout}"


def do(block):
    """Run a block.   out  what it prints, and what is wrong"""
    if block.mark == "file":
        pathlib.Path(block.printed).write_text(block.text, encoding="utf8")
        return "", ""
    if block.mark == "example":
        return do_example(block)
    if block.kind == "python":
        environment = os.environ | {"PYTHONPATH": str(build() / "bindings/python"), "PYTHONDONTWRITEBYTECODE": "1"}
        return print_of([python(), "-c", block.text], env=environment)
    if block.kind == "js":
        return do_js(block)
    return print_of(["sh", "-euc", block.text])


def do_js(block):
    package = pathlib.Path("node_modules/@tactus-codec/decoder")
    if not package.exists():
        package.parent.mkdir(parents=True)
        package.symlink_to(build() / "bindings/wasm/package")
    pathlib.Path("block.mjs").write_text(block.text, encoding="utf8")
    return print_of(["node", "block.mjs"])


def do_example(block):
    source = ROOT / "examples" / block.printed
    if not source.is_file() or not is_part_of(block.text, source.read_text(encoding="utf8")):
        return "", f"these are not lines of examples/{block.printed}"
    return lambda: print_of([str(build() / "examples" / ("example_" + source.stem))]), ""


def is_part_of(text, whole):
    """Whether lines stand in a file one after the other, however far they are indented; `...` alone on a line leaves lines out."""
    at, lines = 0, [line.strip() for line in whole.splitlines()]
    for part in re.split(r"^\s*(?://|#)? ?\.\.\.\s*$", text, flags=re.M):
        sought = [line.strip() for line in part.strip("\n").splitlines()]
        at = next((i + len(sought) for i in range(at, len(lines) - len(sought) + 1) if lines[i:i + len(sought)] == sought), -1)
        if at < 0:
            return False
    return True


def run(page):
    """out   numbers of blocks that ran, of those that were compared with what they print, and findings"""
    ran = compared = 0
    wrong, printed = [], None
    for name in PROJECT:
        if not os.path.lexists(name):
            os.symlink(ROOT / name, name)
    for block in blocks(page):
        where = f"{page.name}:{block.line}"
        if block.mark == "not run" or block.mark == "needs" and not is_there(block.printed):
            printed = None
        elif block.kind == "text":
            if callable(printed):  # an example: some want arguments, and are run by tests of their own
                printed, finding = printed()
                wrong += [f"{where}: {finding}"] if finding else []
            if printed is not None:
                compared += 1
                if not shown_in(block.text, printed):
                    wrong.append(f"{where}: the page shows\n{block.text}but printed is\n{printed}")
        else:
            try:
                printed, finding = do(block)
            except subprocess.TimeoutExpired:
                printed, finding = None, f"still running after {SECONDS} s"
            ran += 1
            wrong += [f"{where}: {finding}"] if finding else []
    return ran, compared, wrong


def findings(page, name):
    """What can be printed without running."""
    before = None
    for block in blocks(page):
        where = f"{name}:{block.line}"
        if block.kind == "text":
            if before is None and block.mark != "not run":
                yield f"{where}: a block `text` shows what the block before it prints, and there is none that runs"
            if not block.text.strip():
                yield f"{where}: a block `text` shows nothing"
        elif block.mark != "not run" and not (
                block.kind in SHELL | {"python", "js"} or block.mark == "example" or block.mark == "file" and block.kind in FILES):
            yield f"{where}: nobody runs a block `{block.kind}`; say why: <!-- not run: REASON -->"
        if block.mark == "not run" and len(block.printed) < 8:
            yield f"{where}: not run without a reason"
        if block.kind != "text":
            before = None if block.mark == "not run" else block
    yield from dead_links(page, name)
    if words(page) > MOST_WORDS.get(name, 10**6):
        yield f"{name}: {words(page)} words, at most {MOST_WORDS[name]}"


def dead_links(page, name):
    text = re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf8"), flags=re.M | re.S)
    for url in re.findall(r"\]\(([^)\s]+)\)", text):
        path, _, anchor = url.partition("#")
        if re.match(r"[a-z]+:", url):
            continue
        target = page.parent / path if path else page
        if not target.exists():
            yield f"{name}: {url} leads nowhere"
        elif anchor and target.suffix == ".md" and anchor not in anchors(target):
            yield f"{name}: {url}: the page has no such heading"


def anchors(page):
    headings = re.findall(r"^#+ (.*)$", page.read_text(encoding="utf8"), re.M)
    return {re.sub(r"[^\w\- ]", "", re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", heading).lower()).replace(" ", "-") for heading in headings}


def words(page):
    return len(page.read_text(encoding="utf8").split())


def check():
    wrong = []
    for page in pages():
        name = page.relative_to(ROOT).as_posix()
        wrong += findings(page, name)
        if name in BY_CASES and "page_commands" not in (ROOT / "tests/cli" / BY_CASES[name]).read_text(encoding="utf8"):
            wrong.append(f"{name}: tests/cli/{BY_CASES[name]} does not run its blocks")
        elif name not in BY_CASES and not any(name in case.read_text(encoding="utf8") for case in (ROOT / "tests/cli").glob("2[0-9][0-9]-*")):
            wrong.append(f"{name}: no case of tests/cli runs it")
        print(f"{name}: {words(page)} words, {len(blocks(page))} blocks")
    for name in ("CONTRIBUTING.md", "CHANGELOG.md", "CODE_OF_CONDUCT.md", "SECURITY.md"):
        wrong += dead_links(ROOT / name, name)
    return wrong


def self_test():
    failed = 0
    printed = "a 1\nb  2\nc 3\n\nd 4"
    for shown, holds in (("a 1\nb  2\n", True), ("b  2\n", True), ("a 1\n...\nd 4\n", True), ("b ...\nc 3", True), ("a 1\nc 3\n", False), ("a\n", False),
                         ("d 4\n...\na 1\n", False), ("a.1\n", False), ("1\n", False)):
        failed += shown_in(shown, printed) != holds
    for part, holds in (("x\n  y\n", True), ("x\n// ...\nz\n", True), ("x\nz\n", False), ("z\n...\nx\n", False)):
        failed += is_part_of(part, "  x\n    y\n  z\n") != holds
    cases = [("```\ntrue\n```\n", []), ("```\nfalse\n```\n", ["status 1"]), ("```\necho a\n```\nso\n```text\na\n```\n", []),
             ("```\necho a\n```\n```text\nb\n```\n", ["the page shows"]), ("<!-- not run: it is too long -->\n```\nfalse\n```\n", []),
             ("<!-- needs no-such-thing -->\n```\nfalse\n```\n", []), ("<!-- file a.toml -->\n```toml\nx = 1\n```\n```\ncat a.toml\n```\n```text\nx = 1\n```\n", []),
             ("<!-- example nothing.cpp -->\n```cpp\nx\n```\n", ["not lines"])]
    wrong_pages = [("```\ntrue\n```\n```text\n```\n", "shows nothing"), ("```rust\n```\n", "nobody runs"), ("```text\na\n```\n", "none that runs"), ("[a](gone.md)\n", "leads nowhere"),
            ("# A b\n[a](#a-b)\n[c](#c)\n", "no such heading"), ("<!-- not run: so -->\n```\n```\n", "without a reason")]
    with tempfile.TemporaryDirectory() as scratch:
        (pathlib.Path(scratch) / "tactus").symlink_to("/bin/false")
        os.chdir(scratch)
        os.environ["PATH"] = scratch + ":" + os.environ["PATH"]
        page = pathlib.Path("page.md")
        for text, wanted in cases:
            page.write_text(text, encoding="utf8")
            found = run(page)[2]
            failed += len(found) != len(wanted) or any(word not in one for word, one in zip(wanted, found))
        for text, wanted in wrong_pages:
            page.write_text(text, encoding="utf8")
            failed += not any(wanted in one for one in findings(page, "page.md"))
    print(f"self-test: {len(cases) + len(wrong_pages) + 13} cases, {failed} wrong")
    return failed


def main(args):
    if args == ["self-test"]:
        return 1 if self_test() else 0
    if args == ["check"]:
        wrong = check()
        print("\n".join(wrong), end="\n" if wrong else "")
        return 1 if wrong else 0
    if args == ["list"]:
        for page in pages():
            for block in blocks(page):
                if block.mark in ("not run", "needs"):
                    print(f"{page.relative_to(ROOT)}:{block.line}: {block.mark}: {block.printed}")
        return 0
    if args[:1] == ["run"] and len(args) > 1:
        wrong = []
        for name in args[1:]:
            ran, compared, found = run(pathlib.Path(name))
            print(f"{pathlib.Path(name).name}: {ran} blocks ran, {compared} printed what the page shows")
            wrong += found
        print("\n".join(wrong), end="\n" if wrong else "")
        return 1 if wrong else 0
    if len(args) != 1 or args[0].startswith("-"):
        print(__doc__, file=sys.stderr)
        return 2
    print("\n".join(commands(pathlib.Path(args[0]))))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
