# SPDX-License-Identifier: Apache-2.0
"""Facts that stand in several places: rules.csv, the registry, chapters 00, 20, 50, 55, 70, 90 and 95, the conformance suite. They say the same."""
import json
import re
from pathlib import Path

LIMITS = (("20", "9"), ("50", "1.5"), ("55", "1.3"))        # chapters and sections whose tables have limits
DECODED = range(10, 81)                                     # chapters that a class of conformance implements
KINDS = ("header", "one of `objects`", "one of `meshes`", "bounds", "line of a packet", "end", "error", "line of a client's end",
         "line of a server's end")                          # of objects in answers


def section(book, short: str, number: str) -> str:
    """Text of a section with its subsections, up to the next of its level."""
    level = 2 + number.count(".")
    found = re.search(rf"^#{{{level}}} {re.escape(number)} .*?(?=^#{{2,{level}}} |\Z)", book.by_short[short].text, re.M | re.S)
    return found.group(0) if found else ""


def rows(text: str):
    """Cells of the rows of all tables."""
    for line in text.splitlines():
        if line.startswith("|") and not re.match(r"^\|[-|]+\|$", line):
            yield [cell.strip() for cell in re.split(r"(?<!\\)\|", line.strip().strip("|"))]


def ranges(numbers) -> str:
    """(1 to 18, 22): numbers in order, runs as their ends."""
    runs: list = []
    for n in sorted(numbers):
        if runs and n == runs[-1][1] + 1:
            runs[-1][1] = n
        else:
            runs.append([n, n])
    return f"({', '.join(f'{a} to {b}' if b > a + 1 else f'{a}, {b}' if b > a else str(a) for a, b in runs)})"


# ---- Rules ----------------------------------------------------------------------------------------------------------
def numbers_of(book, wanted) -> dict:
    """Of each prefix: numbers of the rules, by what `wanted` gives for a row."""
    out: dict = {}
    for rule, row in book.rules.items():
        _, prefix, number = rule.split("-")
        out.setdefault(prefix, {}).setdefault(wanted(row), []).append(int(number))
    return out


def prefix_findings(book):
    """Registry, section 2: every prefix with its chapters, or of the implementation."""
    text = section(book, "registry", "2")
    stated = {cells[i][2:]: cells[i + 1] for cells in rows(text) for i in (0, 3) if len(cells) > i + 1 and re.fullmatch(r"R-[A-Z]+", cells[i])}
    for prefix, chapters in numbers_of(book, lambda row: row["chapter"]).items():
        if "-" in chapters:
            given = re.findall(r"\((\d+) to (\d+)\)", stated.get(prefix, ""))
            numbers = {n for first, last in given for n in range(int(first), int(last) + 1)}
            if prefix not in stated or given and numbers != set(chapters["-"]):
                yield f"registry, section 2: R-{prefix} is {stated.get(prefix)!r}; rules.csv has {sorted(chapters['-'])}"
            continue
        whole = ", ".join(c if len(chapters) == 1 else f"{c} {ranges(n)}" for c, n in sorted(chapters.items()))
        if stated.get(prefix) != whole:
            yield f"registry, section 2: R-{prefix} is of {stated.get(prefix)}, by rules.csv of {whole}"
    yield from (f"registry, section 2: R-{prefix} is no rule" for prefix in stated if not any(r.startswith(f"R-{prefix}-") for r in book.rules))


def expanded(text: str, all_of: dict) -> set:
    """Rules that a cell names: R-X-n, R-X-1, 2, R-X-8 to 13."""
    out, prefix = set(), ""
    for item in re.findall(r"R-[A-Z]+-(?:n|\d+)(?: to \d+)?|(?<![\w-])\d+(?: to \d+)?", text):
        if item.startswith("R-"):
            prefix, item = item[2:].split("-")
        first, _, last = item.partition(" to ")
        numbers = all_of[prefix] if first == "n" else range(int(first), int(last or first) + 1)
        out |= {f"R-{prefix}-{n}" for n in numbers}
    return out


def action_findings(book):
    """95, section 5: what a receiver does."""
    all_of = {prefix: [n for numbers in by.values() for n in numbers] for prefix, by in numbers_of(book, lambda row: "").items()}
    stated: dict = {}
    for cells in rows(section(book, "95", "5")):
        if len(cells) == 3 and cells[0] in ("drop", "request_key", "close", "-"):
            for rule in expanded(cells[1], all_of):
                stated.setdefault(rule, []).append(cells[0])
    for rule, row in book.rules.items():
        if row["chapter"] != "-" and stated.get(rule) != [row["action"]]:
            yield f"95, section 5: {rule} has the action {stated.get(rule)}, in rules.csv {row['action']}"


# ---- Numbers of the registry ----------------------------------------------------------------------------------------
def flag_findings(book):
    """Bits of the declaration's flags: 20, sections 4 and 8, the extensions, 00."""
    of_bit = {int(cells[0]): cells for cells in rows(section(book, "20", "4")) if len(cells) == 4 and cells[0].isdigit()}
    bits = list(of_bit)
    if bits != list(range(len(bits))):
        yield f"20, section 4: flags are bits {bits}"
    checks = {int(bit): where for bit, where in re.findall(r"^if bit (\d+) of flags is set: (.*)$", section(book, "20", "8"), re.M)}
    if sorted(checks) != [bit for bit, cells in of_bit.items() if cells[2] != "none"]:
        yield f"20, section 8: the order of checks has the elements of bits {sorted(checks)}"
    for bit, cells in of_bit.items():
        extension = re.match(r"(\d\d), section (\d+(?:\.\d+)*)$", cells[3])
        if extension and extension.group(1) != "40" and f"Bit {bit} of `flags` is set (20, section 4)" not in section(book, *extension.groups()):
            yield f"{cells[3]}: does not say that bit {bit} of `flags` is set"
    for cells in rows(section(book, "00", "5")):
        number = re.match(r"\d", cells[1]) if len(cells) == 6 else None
        if number and not of_bit.get(int(number.group()), [""] * 4)[3].startswith(cells[0][1:3]):
            yield f"00, section 5: {cells[0]} has bit {cells[1]}; 20, section 4 has another"


def names_in(text: str) -> dict:
    return {int(number): name for number, name in re.findall(r"(\d+) ([a-z]+(?: [a-z]+)*)", text)}


def session_findings(book):
    """Forms, kinds, parts and reasons: 70, sections 2 and 3, registry."""
    stated = {re.sub(r" \(.*", "", cells[0]) + ("" if "70, section 3" not in cells[0] else " 3"): names_in(cells[1])
            for cells in rows(section(book, "registry", "4")) if "(70, section" in cells[0]}
    two, three = section(book, "70", "2"), section(book, "70", "3")
    tables = list(rows(two))
    is_part = [len(c) == 4 and c[2] in ("up", "down", "both") for c in tables]
    forms = {int(c[0]): c[1] for c, part in zip(tables, is_part) if not part and len(c) == 4 and re.fullmatch(r"[0-2]", c[0])}
    kinds = names_in(next(c[2] for c in tables if c[:2] == ["0", "handshake"]))
    parts = {direction: {int(c[0]): c[1] for c in tables if re.fullmatch(r"\d", c[0]) and len(c) == 4 and c[2] in (direction, "both")}
             for direction in ("up", "down")}
    reasons = {int(c[0]): c[1] for c in rows(three) if len(c) == 3 and re.fullmatch(r"\d", c[0])}
    for name, here in (("form of a datagram", forms), ("kind of a handshake", kinds), ("part `type` up", parts["up"]), ("part `type` down", parts["down"]),
                       ("`reason` 3", reasons)):
        if stated.get(name) != here:
            yield f"registry, section 4: {name} is {stated.get(name)}; 70 has {here}"
    for number, direction in (("3.1", "down"), ("3.2", "up")):
        named = {cells[0] for cells in rows(section(book, "70", number)) if len(cells) == 3}
        yield from (f"70, section {number}: nothing says what the part {part} does" for part in parts[direction].values() if part not in named)
        asked = {word for cells in rows(section(book, "70", number)) if len(cells) == 5 for word in re.findall(r"\w+", cells[0])}
        yield from (f"70, section {number}: nothing says what the handshake {kind} does" for kind in kinds.values() if kind not in asked)


# ---- Chapters and limits --------------------------------------------------------------------------------------------
def chapter_findings(book):
    """00: every chapter is listed, and implemented by a class."""
    listed = re.findall(r"\]\((\d\d)-[\w-]+\.md\)", section(book, "00", "5"))
    there = [c.short for c in book.chapters if c.short.isdigit() and c.short != "00"]
    if sorted(listed) != sorted(there):
        yield f"00, section 5: lists the chapters {listed}; there are {there}"
    classes = " ".join(cells[2] for cells in rows(section(book, "00", "4")) if len(cells) == 3)
    named = set(re.findall(r"\b\d\d\b", classes))
    yield from (f"00, section 4: no class implements chapter {short}" for short in there if int(short) in DECODED and short not in named)


def core_findings(book):
    """00: how many words the core has, with the sections of 00 that belong to it."""
    core = re.findall(r"\]\((\d\d)-[\w-]+\.md\)", section(book, "00", "5").split("**extension**")[0])
    stated = re.search(r"sections (\d) to (\d) here and the core \(section 5\): some (\d+) 000 words", book.by_short["00"].text)
    first, last, thousands = (int(n) for n in stated.groups()) if stated else (1, 0, 0)
    texts = [section(book, "00", str(n)) for n in range(first, last + 1)] + [book.by_short[short].text for short in core if short in book.by_short]
    words = sum(len(text.split()) for text in texts)
    if abs(words - 1000 * thousands) > 750:
        yield f"00, section 1: the core has {words} words"


def limits_of(text: str) -> list:
    """Numbers of objects, bytes of the body, of states, of a packet, vertices, triangles, work of bases, work of bodies."""
    return [m if "^" in m or int(m) > 100 else "" for m in re.findall(r"\d+\^\d+|\b\d{4,}\b", text)]


def limit_findings(book, conformance: Path):
    """20, section 9, with those of the extensions, and the testee's limits."""
    least = [cells[1] for short, number in LIMITS for cells in rows(section(book, short, number)) if len(cells) == 3 and re.match(r"R-", cells[2])]
    readme = (conformance / "README.md").read_text(encoding="utf-8")
    sentence = re.search(r"A testee has these limits:(.*?)\n\n", readme, re.S)
    stated = limits_of(re.sub(r"\([^)]*\)", "", sentence.group(1))) if sentence else []
    if stated != least:
        yield f"conformance/README.md: a testee's limits are {stated}; 20, section 9, 50, section 1.5 and 55, section 1.3 have {least}"
    states = re.search(r"^STATE_LIMIT, HEADER_LIMIT = 1 << (\d+), 1 << (\d+)", (conformance / "session.py").read_text(encoding="utf-8"), re.M)
    if states and [f"2^{states.group(2)}", f"2^{states.group(1)}"] != least[1:3]:
        yield f"conformance/session.py: joins with 2^{states.group(1)} and 2^{states.group(2)} bytes; 20, section 9 has {least[2]} and {least[1]}"


# ---- The conformance suite ------------------------------------------------------------------------------------------
def is_in_order(members, order: list) -> bool:
    indices = [order.index(name) if name in order else -1 for name in members]
    return -1 not in indices and indices == sorted(indices)


def kind_of(line: dict) -> str:
    if "packet" in line:
        return "line of a packet"
    if "line" in line:
        return "line of a server's end" if "clients" in line else "line of a client's end"
    return next(iter(line))


def objects_in(line: dict):
    """(kind, members) of a line of an answer and of what is in it."""
    kind = kind_of(line)
    inner = line[kind] if kind in ("header", "end", "error") else line
    yield kind, list(inner)
    for name, one in (("objects", "one of `objects`"), ("meshes", "one of `meshes`")):
        yield from ((one, list(item)) for item in inner.get(name, ()) if isinstance(item, dict))
    for name in ("bounds", "error"):
        if isinstance(inner.get(name), dict):
            yield name, list(inner[name])


def suite_findings(book, conformance: Path):
    """The README: stems, files, and the order of members in every answer."""
    readme = (conformance / "README.md").read_text(encoding="utf-8")
    order: dict = {}
    for cells in rows(readme):
        kind = cells[0] if cells[0] in KINDS else cells[0].strip("`")
        if len(cells) == 2 and kind in KINDS:
            order.setdefault(kind, re.findall(r"`(\w+)`", cells[1]))
    yield from (f"conformance/README.md: no order of members for {kind}" for kind in KINDS if kind not in order)
    stems = json.loads((conformance / "manifest.json").read_text(encoding="utf-8"))["stems"]
    stated = [cells[0].strip("`") for cells in rows(section(book, "90", "1")) if len(cells) == 2 and re.fullmatch(r"`\w+`", cells[0])]
    if sorted(stated) != sorted(stems):
        yield f"90, section 1: stems are {stated}; the manifest has {list(stems)}"
    wrong = set()
    for stem in stems:
        for line in (conformance / "vectors" / f"{stem}.answers").read_text(encoding="ascii").splitlines():
            for kind, members in objects_in(json.loads(line)):
                if not is_in_order(members, order.get(kind, [])) and (kind, *members) not in wrong:
                    wrong.add((kind, *members))
                    yield f"conformance/README.md: {kind} has the members {members} in a vector of {stem}, in another order than {order.get(kind)}"
    folder = readme.split("## In this folder")[-1]
    for path in sorted(conformance.glob("*.[pch]*")):
        names = (path.name, f"{path.stem}.*")
        stars = re.findall(r"`(\w+\*)\.py`", folder)
        if path.suffix in (".py", ".cpp", ".h") and not any(f"`{n}`" in folder for n in names) and not any(path.match(f"{s}.py") for s in stars):
            yield f"conformance/README.md: the table of this folder does not name {path.name}"


def findings(book, root: Path):
    """In a copy of the specification alone the suite is not looked at."""
    for check in (prefix_findings, action_findings, flag_findings, session_findings, chapter_findings, core_findings):
        yield from check(book)
    if (root / "conformance" / "README.md").exists():
        yield from limit_findings(book, root / "conformance")
        yield from suite_findings(book, root / "conformance")
