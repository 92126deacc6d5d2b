#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Check the specification and make what is made from it. Python 3 and its standard library are enough.

  make.py check              links, section references, rules (here and in the sources), examples, index, page; exit 1 when anything is wrong
  make.py index              write rules.md from rules.csv
  make.py examples           write the tables of 91-worked-examples.md by the commands beside them
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
from tools.book import ROOT, SPEC, Book, rule_key
from tools import sources
from tools.page import dead_links, html_page, markdown_page

TITLE = "Tactus: specification"
EXAMPLES = SPEC / "91-worked-examples.md"
BLOCK = re.compile(r"(<!-- command: (.*?) -->\n)(.*?)(<!-- end of command -->)", re.S)


# ---- Index of rules -------------------------------------------------------------------------------------------------
def rules_table(head: str, rows) -> str:
    return f"| {head} |\n|{'---|' * (head.count('|') + 1)}\n" + "".join(f"| {row} |\n" for row in rows)


def classes_of(row: dict) -> str:
    return row["class"].replace("|", ", ")


def index_of_rules(book: Book) -> str:
    of_format = [row for row in book.rules.values() if row["chapter"] != "-"]
    of_library = [row for row in book.rules.values() if row["chapter"] == "-"]
    place = {rule: f"{chapter.short}, section {section}" for rule, (chapter, _, section) in book.defined.items()}
    out = ["# Index of rules\n\nInformative. Made by `spec/make.py index` from `rules.csv`; the tables of the chapters are normative.\n\n"
           "## 1 Rules of the format\n\n\"Action\" is what a receiver of packets does (95, section 5).\n"]
    order = sorted(of_format, key=lambda r: (r["rule"].split("-")[1] != "VAR", rule_key(r["rule"])))
    out.append(rules_table("rule | what must hold | class | action | defined in", (
        f"{r['rule']} | {r['text']} | {classes_of(r)} | {r['action']} | {place.get(r['rule'], '?')}" for r in order)))
    out.append("## 2 Rules of the reference implementation\n\nThey concern calls, recordings, scenes and meshes, not streams. "
               "Registry, section 2 tells the prefixes apart.\n")
    out.append(rules_table("rule | what must hold | class | remedy", (
        f"{r['rule']} | {r['text']} | {classes_of(r)} | {r['remedy']}" for r in of_library)))
    return "\n".join(out)


# ---- Worked examples ------------------------------------------------------------------------------------------------
def told_by(command: str) -> str:
    words = shlex.split(command)
    run = subprocess.run([sys.executable, *words[1:]], cwd=ROOT, capture_output=True, text=True, check=False)
    if run.returncode:
        raise SystemExit(f"{command}: {run.stderr.strip()}")
    return run.stdout.strip()


def with_examples(text: str) -> str:
    return BLOCK.sub(lambda m: f"{m.group(1)}\n`{m.group(2)}`\n\n{told_by(m.group(2))}\n\n{m.group(4)}", text)


# ---- Check ----------------------------------------------------------------------------------------------------------
def table_findings(book: Book):
    """Chapter 90 names the SHA-256 of every table that a chapter names."""
    text = "".join(c.text for c in book.chapters)
    for name in sorted(set(re.findall(r"tables/[\w-]+\.csv", text))):
        path = SPEC / name
        digest = hashlib.sha256(path.read_bytes()).hexdigest() if path.exists() else "none: no such file"
        if f"| {name} | `{digest}` |" not in book.by_short["90"].text:
            yield f"90: {name} has the SHA-256 {digest}"


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
    if index_of_rules(book) != book.by_short["rules"].text:
        yield "rules.md is not what rules.csv says: run spec/make.py index"
    if with_examples(book.by_short["91"].text) != book.by_short["91"].text:
        yield f"{EXAMPLES.name} is not what its commands say: run spec/make.py examples"
    page = html_page(book, TITLE)
    yield from dead_links(page)
    anchors = set(re.findall(r'\sid="([^"]+)"', page))
    yield from (f"page: {rule} has no anchor" for rule in book.rules if rule not in anchors)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("check", "index", "examples", "html", "markdown"))
    parser.add_argument("out", nargs="?", type=Path, help="file to write")
    arguments = parser.parse_args()
    if arguments.what in ("html", "markdown") and arguments.out is None:
        parser.error("name the file to write")
    if arguments.what == "index" and not (SPEC / "rules.md").exists():
        (SPEC / "rules.md").write_text("# Index of rules\n", encoding="utf-8")
    book = Book()
    if arguments.what == "check":
        found = list(findings(book))
        print("\n".join(found + [f"{len(found)} findings in {len(book.chapters)} chapters and {len(book.rules)} rules"]))
        return 1 if found else 0
    if arguments.what == "index":
        (SPEC / "rules.md").write_text(index_of_rules(book), encoding="utf-8")
    elif arguments.what == "examples":
        EXAMPLES.write_text(with_examples(book.by_short["91"].text), encoding="utf-8")
    elif arguments.what == "html":
        arguments.out.write_text(html_page(book, TITLE), encoding="utf-8")
    else:
        arguments.out.write_text(markdown_page(book, TITLE), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
