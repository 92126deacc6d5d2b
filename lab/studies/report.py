# SPDX-License-Identifier: Apache-2.0
"""What the reports of all studies have in common: the folder they go to, the machine they name, numbers and Markdown tables."""
import json
import os
import sys

from common import figure, program, table
from common.arguments import Refusal


class Folder:
    """Where a study writes, if anywhere (-o). Its files are checked before the work: none is replaced without -f."""

    def __init__(self, path, files, replace):
        self.path, self.replace = path, replace
        if not path:
            return
        make_folder(path)
        for name in files:
            if os.path.lexists(self.of(name)) and not replace:
                raise Refusal(f"{self.of(name)}: the file already exists", "Give -f to replace it, or another name.")

    def of(self, name):
        return os.path.join(self.path, name)

    def write(self, name, text):
        table.write_whole(self.of(name), text.encode(), self.replace)

    def write_csv(self, name, head, rows):
        table.write_csv(self.of(name), head, rows, self.replace)

    def draw(self, name, make):
        """make() yields the figure. Without matplotlib there is none, and a note says so.   out  whether it was drawn"""
        try:
            made = make()
        except Refusal as refusal:
            if "missing" not in refusal.fields:
                raise
            note_missing(refusal)
            return False
        figure.save_all(made, self.of(name), self.replace)
        return True


def note_missing(refusal, noted=[]):  # once a run
    if not noted:
        sys.stderr.write(f"note: no figures: {refusal.text}. {refusal.remedy}\n")
    noted.append(refusal)


def make_folder(path):
    try:
        os.makedirs(path, exist_ok=True)
    except OSError as refused:
        raise Refusal(f"{path}: the folder cannot be made: {refused.strerror}", "Check the path and your permissions.") from None


def context():
    """The machine, compiler, build and version that figures depend on."""
    known = program.context()
    model = " ".join(known["processor"].split()[:2]) or "unknown processor"
    cores = known["cores"]
    machine = f"{cores} core{'' if cores == 1 else 's'} of an {model}{', virtual machine' if is_virtual() else ''}"
    return {"build": known["build"], "compiler": known["compiler"], "machine": machine, "tactus": program.version_and_commit()}


def is_virtual():
    try:
        with open("/proc/cpuinfo", encoding="utf8") as lines:
            return any(line.startswith("flags") and " hypervisor" in line for line in lines)
    except OSError:
        return False


def print_json(value):
    print(json_text(value), end="")


def json_text(value):
    return json.dumps(value, indent=2, ensure_ascii=False) + "\n"


def show(head, rows):
    """Text to the left, numbers to the right."""
    table.show(head, rows)


def markdown(head, rows, left=1):
    """A table whose first `left` columns are text."""
    lines = [f"| {' | '.join(head)} |", "|" + "---|" * left + "---:|" * (len(head) - left)]
    return "\n".join(lines + [f"| {' | '.join(map(str, row))} |" for row in rows]) + "\n"


def per(amount, base):
    return amount / base if base > 0 else 0


def significant(value, digits=3):
    return "-" if value is None else "0" if value == 0 else f"{value:.{digits}g}"


def duration(seconds):
    if seconds < 1e-3:
        return f"{1e6 * seconds:.2f} us"
    return f"{1e3 * seconds:.1f} ms" if seconds < 1 else f"{seconds:.2f} s"
