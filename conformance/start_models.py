# SPDX-License-Identifier: Apache-2.0
"""Tables of start models of chapters 40 and 50."""
from __future__ import annotations

import csv
import functools
from pathlib import Path


@functools.lru_cache(maxsize=None)
def start_models(file: str) -> dict[str, list]:
    """A table by name without the node: {"TICK": [None, (zero, rate), ...], "POSE[0][3]": ...}."""
    here = Path(__file__).resolve().parent
    tables = here / "tables" if (here / "tables").is_dir() else here.parent / "spec" / "tables"
    trees: dict[str, list] = {}
    with open(tables / file, encoding="ascii", newline="") as table:
        for row in csv.DictReader(table):
            name, _, node = row["model"].rpartition("[")
            models = trees.setdefault(name, [None])
            if node != f"{len(models)}]":
                raise ValueError(f"{table.name}: {row['model']} is out of order; take the file as published")
            models.append((int(row["zero"]), int(row["rate"])))
    return trees


class Models(dict):
    """The models of one packet: each tree starts from its table when it is first used."""

    def __init__(self, file: str):
        super().__init__()
        self.file = file

    def __missing__(self, name: str) -> list:
        self[name] = [None] + [list(m) for m in start_models(self.file)[name][1:]]
        return self[name]
