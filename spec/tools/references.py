# SPDX-License-Identifier: Apache-2.0
"""References to the specification from the rest of the tree: sources, tests, pages, cases. Chapter, section and heading are there."""
import re
from pathlib import Path

from tools.book import NUMBER, SPEC

FOLDERS = ("bindings", "cli", "codec", "conformance", "device", "docs", "examples", "io", "lab", "metrics", "reports", "session", "sim", "tests", "tools")
SUFFIXES = {".c", ".cpp", ".cs", ".h", ".js", ".lua", ".md", ".mjs", ".py", ".sh", ".toml", ".ts", ".txt"}
GAP = r"(?:\s|\n[ \t]*(?://+|#|\*|--)[ \t]*)"                # between words of a comment
MANY = rf"{NUMBER}(?:(?:,{GAP}+|{GAP}+and{GAP}+|{GAP}+to{GAP}+){NUMBER})*(?![\w^%])"
PATTERNS = (
    # spec/40-rigid.md section 4, spec/40-rigid.md 2, 3 and 5, spec 40-rigid 4
    re.compile(rf"\bspec[/ ](?P<file>\d\d-[a-z-]+|guide|registry|errata)(?:\.md)?(?:`|\))?(?:,?{GAP}+sections?{GAP}+|{GAP})?(?P<many>{MANY})?"),
    # 40, section 4; (20, 4) is for pages that say so
    re.compile(rf"(?<![\d.\w-])(?P<short>\d\d),{GAP}+sections?{GAP}+(?P<many>{MANY})"),
    # chapter 40; chapter 40, section 4; Chapter 40 of the specification, section 4
    re.compile(rf"\b[Cc]hapters?{GAP}+(?P<short>\d\d)\b(?:(?: of the specification)?,{GAP}+sections?{GAP}+(?P<many>{MANY}))?"),
    # section 4 of chapter 40
    re.compile(rf"\bsections?{GAP}+(?P<many>{MANY}){GAP}+of{GAP}+chapter{GAP}+(?P<short>\d\d)\b"),
)
LINK = re.compile(r"\]\((?P<path>[^)\s#]*spec/[\w-]+\.md)(?:#(?P<anchor>[^)\s]+))?\)(?:,? sections? (?P<many>" + MANY + "))?")
CASE = re.compile(r"^ +.*?\bsection (?P<short>\d\d) (?P<heading>[A-Z][^;\n]*)", re.M)


def files(root: Path):
    """Text files of the tree, without what was built."""
    yield from sorted(root.glob("*.md"))
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix in SUFFIXES and path.is_file() and "node_modules" not in path.parts and "corpus" not in path.parts:
                yield path


def findings_in(book, path: Path, text: str):
    by_stem = {c.stem: c for c in book.chapters}
    for pattern in PATTERNS:
        for m in pattern.finditer(text):
            found, groups = m.group(0), m.groupdict()
            chapter = by_stem.get(groups["file"]) if groups.get("file") else book.by_short.get(groups["short"])
            if chapter is None:
                yield f"no chapter {found}"
                continue
            yield from (f"no section {number}: {' '.join(found.split())}" for number in re.findall(NUMBER, groups["many"] or "") if number not in chapter.sections)
    for m in LINK.finditer(text) if path.suffix == ".md" else ():
        target = (path.parent / m.group("path")).resolve()
        chapter = next((c for c in book.chapters if c.path.resolve() == target), None)
        if not target.exists():
            yield f"no file {m.group('path')}"
        elif chapter is not None:
            if m.group("anchor") and m.group("anchor") not in chapter.slugs():
                yield f"no heading {m.group('path')}#{m.group('anchor')}"
            yield from (f"no section {n}: {m.group(0)}" for n in re.findall(NUMBER, m.group("many") or "") if n not in chapter.sections)


def case_findings(book, path: Path, text: str):
    """Sections under test: a chapter, and the title of one of its sections."""
    for m in CASE.finditer(text):
        chapter = book.by_short.get(m.group("short"))
        titles = {re.sub(rf"^{NUMBER} ", "", heading) for _, heading in chapter.headings} if chapter else set()
        if m.group("heading").strip() not in titles:
            yield f"no section {m.group('short')} {m.group('heading').strip()}"


def findings(book, root: Path):
    for path in files(root):
        text = path.read_text(encoding="utf-8", errors="replace")
        check = case_findings if path.parent.name == "cases" else findings_in
        yield from (f"{path.relative_to(root)}: {what}" for what in dict.fromkeys(check(book, path, text)))
