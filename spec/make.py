#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Check the specification and make what is made from it. Python 3 and its standard library are enough.

  make.py check              links, references to sections and rules (here and in the whole tree), examples, page; exit 1 when anything is wrong
  make.py examples           write the tables of 91-worked-examples.md by the commands beside them, and the SHA-256 of tables into 90
  make.py html OUT           all chapters as one HTML page
  make.py markdown OUT       all chapters as one Markdown file, e.g. for pandoc OUT -o OUT.pdf
"""
import argparse
import hashlib
import re
import shlex
import subprocess
import sys
from pathlib import Path

sys.dont_write_bytecode = True
from tools.book import ROOT, SPEC, Book
from tools import agreement, references, sources
from tools.page import dead_links, html_page, markdown_page

TITLE = "Tactus: specification"
EXAMPLES = SPEC / "91-worked-examples.md"
VECTORS = SPEC / "90-test-vectors.md"
BLOCK = re.compile(r"(<!-- command: (.*?) -->\n)(.*?)(<!-- end of command -->)", re.S)


# ---- Worked examples ------------------------------------------------------------------------------------------------
def output_of(command: str) -> str:
    words = shlex.split(command)
    run = subprocess.run([sys.executable, *words[1:]], cwd=ROOT, capture_output=True, text=True, check=False)
    if run.returncode:
        raise SystemExit(f"{command}: {run.stderr.strip()}")
    return run.stdout.strip()


def with_examples(text: str) -> str:
    return BLOCK.sub(lambda m: f"{m.group(1)}\n`{m.group(2)}`\n\n{output_of(m.group(2))}\n\n{m.group(4)}", text)


# ---- Digests --------------------------------------------------------------------------------------------------------
def digest_of(table: str) -> str:
    path = SPEC / table
    return hashlib.sha256(path.read_bytes()).hexdigest() if path.exists() else "none: no such file"


def with_digests(text: str) -> str:
    return re.sub(r"^\| (tables/[\w-]+\.csv) \| `.*` \|$", lambda m: f"| {m.group(1)} | `{digest_of(m.group(1))}` |", text, flags=re.M)


# ---- Check ----------------------------------------------------------------------------------------------------------
def table_findings(book: Book):
    """Chapter 90 names the SHA-256 of every table that a chapter names."""
    text = "".join(c.text for c in book.chapters)
    for name in sorted(set(re.findall(r"tables/[\w-]+\.csv", text))):
        if f"| {name} | `{digest_of(name)}` |" not in book.by_short["90"].text:
            yield f"90: {name} has the SHA-256 {digest_of(name)}"


def vector_findings(book: Book):
    """Chapter 90 has a line for every rule of the format: its vectors, or why there is none."""
    named = re.findall(r"^\| (R-[A-Z]+-\d+) \|", book.by_short["90"].text, re.M)
    of_format = [rule for rule, row in book.rules.items() if row["chapter"] != "-"]
    yield from (f"90: {rule} has no vector, and nothing says why" for rule in of_format if rule not in named)
    yield from (f"90: {rule} is no rule of the format" for rule in named if rule not in of_format)


def findings(book: Book):
    yield from book.findings()
    yield from table_findings(book)
    yield from vector_findings(book)
    yield from sources.findings(ROOT, book.rules, book.classes)
    yield from agreement.findings(book, ROOT)
    yield from references.findings(book, ROOT)
    if with_examples(book.by_short["91"].text) != book.by_short["91"].text:
        yield f"{EXAMPLES.name} is not what its commands say: run spec/make.py examples"
    page = html_page(book, TITLE)
    yield from dead_links(page)
    anchors = set(re.findall(r'\sid="([^"]+)"', page))
    yield from (f"page: {rule} has no anchor" for rule in book.rules if rule not in anchors)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("check", "examples", "html", "markdown"))
    parser.add_argument("out", nargs="?", type=Path, help="file to write")
    arguments = parser.parse_args()
    if arguments.what in ("html", "markdown") and arguments.out is None:
        parser.error("name the file to write")
    book = Book()
    if arguments.what == "check":
        found = list(findings(book))
        print("\n".join(found + [f"{len(found)} findings in {len(book.chapters)} chapters and {len(book.rules)} rules"]))
        return 1 if found else 0
    if arguments.what == "examples":
        EXAMPLES.write_text(with_examples(book.by_short["91"].text), encoding="utf-8")
        VECTORS.write_text(with_digests(book.by_short["90"].text), encoding="utf-8")
    elif arguments.what == "html":
        arguments.out.write_text(html_page(book, TITLE), encoding="utf-8")
    else:
        arguments.out.write_text(markdown_page(book, TITLE), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
