# SPDX-License-Identifier: Apache-2.0
"""The files of vectors: vectors/<stem>.json lists the cases of a stem, <stem>.pack has their inputs and <stem>.answers their answers,
one after another. Unpacked, every input and every answer is a file of its own (README.md, "What a vector is")."""
from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import NamedTuple, Optional

FORMAT, UNPACKED = 3, 2                                     # `format` of the lists and of the manifest
MEMBERS = ("errc", "rule", "section", "rules")


class Part(NamedTuple):
    """Some bytes of a file."""
    file: Path
    offset: int
    size: int

    def read(self) -> bytes:
        with open(self.file, "rb") as file:
            file.seek(self.offset)
            data = file.read(self.size)
        if len(data) != self.size:
            raise ValueError(f"{self.file.name} ends before byte {self.offset + self.size}")
        return data


class Entry(NamedTuple):
    fields: dict                                            # what the list says of a case, but for the extents
    input: bytes                                            # without the bytes that are repeated
    answer: bytes


def is_script(fields: dict) -> bool:
    return "session" in fields["flags"]


def without_repeat(data: bytes, repeat: Optional[dict]) -> bytes:
    if not repeat:
        return data
    size = len(bytes.fromhex(repeat["bytes"])) * repeat["times"]
    return data[:repeat["at"]] + data[repeat["at"] + size:]


def with_repeat(data: bytes, repeat: Optional[dict]) -> bytes:
    if not repeat:
        return data
    return data[:repeat["at"]] + bytes.fromhex(repeat["bytes"]) * repeat["times"] + data[repeat["at"]:]


def case_json(fields: dict, extents: str) -> str:
    """One case of a list, on three or four lines."""
    def members(names: tuple) -> str:
        return ", ".join(f'"{name}": {json.dumps(fields[name], ensure_ascii=False)}' for name in names if name in fields)

    first = members(("name", "result", *MEMBERS))
    second = members(("profile", "flags", "args", "repeat"))
    return f'    {{{first},\n     {second},\n     {extents}"sha256": "{fields["sha256"]}",\n     {members(("what",))}}}'


def list_json(stem: str, what: str, entries: list[Entry], form: int) -> str:
    cases, offset, answer = [], 0, 0
    for entry in entries:
        extents = f'"input": [{offset}, {len(entry.input)}], "answer": [{answer}, {len(entry.answer)}], ' if form == FORMAT else ""
        cases.append(case_json(entry.fields, extents))
        offset += len(entry.input)
        answer += len(entry.answer)
    head = f'{{\n  "format": {form},\n  "stem": "{stem}",\n  "what": {json.dumps(what)},\n  "cases": [\n'
    return head + ",\n".join(cases) + "\n  ]\n}\n"


def manifest_json(stems: list[tuple[str, int, str]], flags: dict[str, str], form: int) -> str:
    """Of stems with their numbers of cases and lists."""
    rows = [f'    "{name}": {{"cases": {count}, "sha256": "{hashlib.sha256(text.encode("utf-8")).hexdigest()}"}}' for name, count, text in stems]
    meanings = [f"    {json.dumps(name)}: {json.dumps(meaning)}" for name, meaning in flags.items()]
    return (f'{{\n  "format": {form},\n  "licence": "CC0-1.0",\n  "stems": {{\n' + ",\n".join(rows)
            + '\n  },\n  "flags": {\n' + ",\n".join(meanings) + "\n  }\n}\n")


def unpack(root: Path, folder: Path) -> int:
    """Writes every input and answer as a file, and the lists and the manifest of these; returns how many cases there are."""
    manifest = json.loads((root / "manifest.json").read_text("utf-8"))
    stems = []
    for stem in manifest["stems"]:
        base = root / "vectors" / stem
        listed = json.loads(base.with_suffix(".json").read_text("utf-8"))
        own = folder / "vectors" / stem
        own.mkdir(parents=True, exist_ok=True)
        entries = []
        for fields in listed["cases"]:
            data, answer = (Part(base.with_suffix(suffix), *fields.pop(part)).read()
                            for suffix, part in ((".pack", "input"), (".answers", "answer")))
            (own / f"{fields['name']}{'.script' if is_script(fields) else '.tct'}").write_bytes(data)
            (own / f"{fields['name']}.jsonl").write_bytes(answer)
            entries.append(Entry(fields, data, answer))
        text = list_json(stem, listed["what"], entries, UNPACKED)
        own.with_suffix(".json").write_text(text, "utf-8")
        stems.append((stem, len(entries), text))
    (folder / "manifest.json").write_text(manifest_json(stems, manifest["flags"], UNPACKED), "utf-8")
    return sum(count for _, count, _ in stems)
