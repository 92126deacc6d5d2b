# SPDX-License-Identifier: Apache-2.0
"""The chapters as data: their sections, the rules that they define, the references between them, and what is wrong with any of these."""
import csv
import re
from pathlib import Path

from tools.markdown import slug

SPEC = Path(__file__).resolve().parent.parent
ROOT = SPEC.parent
RULE = r"R-[A-Z]+-\d+"
NUMBER = r"\d+(?:\.\d+)*"
REFERENCE = re.compile(
    rf"(?P<rule>{RULE})(?![\w-])"
    rf"|(?:\b(?P<book>\d\d|registry|errata|guide), )?\b(?:section (?P<one>{NUMBER})|sections (?P<many>{NUMBER}(?:(?:, | and | to ){NUMBER})*))"
    r"|\b[Cc]hapters? (?P<chapters>\d\d(?:(?:, | and )\d\d)*)")
ELSEWHERE = re.compile(r"(?:\bits|[Tt]hesis,|RFC \d+,) $")       # before "section": of another document
ACTIONS = {"drop", "request_key", "close", "-"}
VECTORS = re.compile(r"<!-- vectors:.*?<!-- end of vectors -->", re.S)


def rule_key(rule: str):
    _, prefix, number = rule.split("-")
    return prefix, int(number)


class Chapter:
    def __init__(self, path: Path, text: str | None = None):
        """A chapter from its file, or one whose text is made: it has no file."""
        self.path, self.name = path, path.name
        self.stem = path.stem
        self.short = self.stem[:2] if self.stem[:2].isdigit() else self.stem      # as references name it
        self.text = path.read_text(encoding="utf-8") if text is None else text
        self.title = re.match(r"# (.*)", self.text).group(1)
        prose = re.sub(r"^```.*?^```", "", self.text, flags=re.S | re.M)
        self.headings = re.findall(r"^(#{2,3}) (.*)$", prose, re.M)
        self.sections = {m.group(1) for _, h in self.headings if (m := re.match(rf"({NUMBER}) ", h))}

    def slugs(self):
        return {slug(heading) for _, heading in self.headings}

    def definitions(self):
        """(rule, class as text, section) of every row of a table with the columns rule, text and class."""
        section = ""
        for part in re.split(r"^(?=#{2,3} )", self.text, flags=re.M):
            if m := re.match(rf"#{{2,3}} ({NUMBER}) ", part):
                section = m.group(1)
            for body in re.findall(r"^\| rule \| \| class \|\n\|[-|]+\|\n((?:\|.*\n)+)", part + "\n", re.M):
                for row in body.splitlines():
                    columns = re.split(r"(?<!\\)\|", row.strip("|"))
                    yield columns[0].strip(), columns[-1].strip(), section


class Book:
    def __init__(self):
        paths = sorted(SPEC.glob("[0-9][0-9]-*.md")) + [SPEC / f"{n}.md" for n in ("errata", "guide", "registry")]
        self.chapters = [Chapter(p) for p in paths if p.exists()]
        self.by_short = {c.short: c for c in self.chapters}
        with open(SPEC / "rules.csv", encoding="utf-8", newline="") as table:
            self.rules = {row["rule"]: row for row in csv.DictReader(table)}
        self.defined = {}                                   # rule: (chapter, class, section), the first definition
        self.twice = []
        for chapter in self.chapters:
            for rule, classes, section in chapter.definitions():
                if rule in self.defined:
                    self.twice.append(rule)
                self.defined.setdefault(rule, (chapter, classes, section))
        registry = self.by_short["registry"].text
        self.classes = set(re.findall(r"^\| \d+ \| (\w+) \| ", registry.split("## 2 ")[0], re.M))
        self.withdrawn = set(re.findall(RULE, re.search(r"^Withdrawn: .*$", registry, re.M).group(0)))
        self.chapters.append(Chapter(SPEC / "rules.csv", self.index_of_rules()))
        self.by_short["rules"] = self.chapters[-1]

    # ---- The index of rules: a chapter of the pages, made from rules.csv ----
    def index_of_rules(self) -> str:
        def table(head: str, rows) -> str:
            return f"| {head} |\n|{'---|' * (head.count('|') + 1)}\n" + "".join(f"| {row} |\n" for row in rows)

        def classes(row: dict) -> str:
            return row["class"].replace("|", ", ")

        of_format = sorted((row for row in self.rules.values() if row["chapter"] != "-"),
                           key=lambda r: (r["rule"].split("-")[1] != "VAR", rule_key(r["rule"])))
        of_library = [row for row in self.rules.values() if row["chapter"] == "-"]
        defined_in = {rule: f"{chapter.short}, section {section}" for rule, (chapter, _, section) in self.defined.items()}
        return "\n".join((
            "# Index of rules\n\nInformative. The tables of the chapters are normative.\n\n## 1 Rules of the format\n\n"
            "\"Action\" is what a receiver of packets does (95, section 5).\n",
            table("rule | what must hold | class | action | defined in", (
                f"{r['rule']} | {r['text']} | {classes(r)} | {r['action']} | {defined_in.get(r['rule'], '?')}" for r in of_format)),
            "## 2 Rules of the reference implementation\n\nThey concern calls, recordings, scenes and meshes, not streams. "
            "Registry, section 2 distinguishes the prefixes.\n",
            table("rule | what must hold | class | remedy", (
                f"{r['rule']} | {r['text']} | {classes(r)} | {r['remedy']}" for r in of_library))))

    # ---- References within text ----
    def references(self, chapter: Chapter, text: str):
        """(start, end, target) of each reference; target is an anchor, or None where there is nothing to refer to."""
        for m in REFERENCE.finditer(text):
            if m.group("rule"):
                yield m.start(), m.end(), self.rule_target(m.group("rule"))
                continue
            if m.group("chapters"):
                for n in re.finditer(r"\d\d", m.group("chapters")):
                    at = m.start("chapters")
                    yield at + n.start(), at + n.end(), self.section_target(n.group(), "")
                continue
            if not m.group("book") and ELSEWHERE.search(text[max(0, m.start() - 12):m.start()]):
                continue
            book = m.group("book") or chapter.short
            group = "one" if m.group("one") else "many"
            numbers = list(re.finditer(NUMBER, m.group(group)))
            for i, n in enumerate(numbers):
                start = m.start() if i == 0 else m.start(group) + n.start()
                yield start, m.start(group) + n.end(), self.section_target(book, n.group())

    def rule_target(self, rule: str):
        return rule if rule in self.rules else "registry-2" if rule in self.withdrawn else None

    def section_target(self, short: str, section: str):
        chapter = self.by_short.get(short)
        if chapter is None or section and section not in chapter.sections:
            return None
        return f"{chapter.stem}-{section}" if section else chapter.stem

    # ---- What is wrong ----
    def findings(self):
        yield from (f"{rule} is defined twice" for rule in self.twice)
        for rule, (chapter, classes, _) in self.defined.items():
            row = self.rules.get(rule)
            if row is None:
                yield f"{chapter.name}: {rule} is not in rules.csv"
                continue
            stated = {word for word in re.findall(r"\w+", classes) if word in self.classes}
            if stated != set(row["class"].split("|")):
                yield f"{rule}: {chapter.name} says {sorted(stated)}, rules.csv {row['class']}"
            if row["chapter"] != chapter.short:
                yield f"{rule}: defined in {chapter.name}, but rules.csv names chapter {row['chapter']}"
        for rule, row in self.rules.items():
            if not set(row["class"].split("|")) <= self.classes:
                yield f"rules.csv: {rule} has a class that is not registered: {row['class']}"
            if row["chapter"] != "-" and rule not in self.defined:
                yield f"rules.csv: {rule} is defined in no table of chapter {row['chapter']}"
            if row["action"] not in ACTIONS or not row["text"].endswith(".") or not row["remedy"].endswith("."):
                yield f"rules.csv: {rule} lacks an action, a sentence or a remedy"
            if not row["fault"] or row["fault"].endswith("."):
                yield f"rules.csv: the fault of {rule} is not the middle of a sentence"
        if list(self.rules) != sorted(self.rules, key=lambda r: (self.rules[r]["chapter"] == "-", self.rules[r]["chapter"],
                                                                 list(self.rules).index(r))):
            yield "rules.csv: rules of the format come first, by chapter"
        for chapter in self.chapters:
            yield from self.broken_references(chapter)

    def broken_references(self, chapter: Chapter):
        text = VECTORS.sub("", chapter.text)                # the table of vectors is made and checked by its generator
        flat = re.sub(r"\s+", " ", text)
        for start, end, target in self.references(chapter, flat):
            if target is None:
                yield f"{chapter.name}: nothing is there: {flat[start:end]}"
        for url in re.findall(r"\]\(([^)\s]+)\)", text):
            path, _, anchor = url.partition("#")
            if re.match(r"https?:", url):
                continue
            target = (SPEC / path) if path else chapter.path
            if not target.exists():
                yield f"{chapter.name}: no file {url}"
            elif anchor and anchor not in {s for c in self.chapters if c.path == target for s in c.slugs()}:
                yield f"{chapter.name}: no heading {url}"
