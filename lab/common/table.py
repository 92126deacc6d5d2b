# SPDX-License-Identifier: Apache-2.0
"""Rows as an aligned table for people, and as CSV (RFC 4180) for everything else."""
import csv
import io
import os
import tempfile

from .arguments import Refusal


def aligned(head, rows):
    """Lines of a table: the first column and columns of text to the left, numbers to the right."""
    cells = [[str(cell) for cell in row] for row in rows]
    widths = [max(len(row[i]) for row in [list(map(str, head)), *cells]) for i in range(len(head))]
    is_text = [i == 0 or any(row[i][:1].isalpha() or row[i][:1] == "/" for row in cells) for i in range(len(head))]
    def line(row):
        return "  ".join(f"{c:<{w}}" if left else f"{c:>{w}}" for c, w, left in zip(row, widths, is_text)).rstrip()
    return [line(row) for row in [list(map(str, head)), *cells]]


def show(head, rows):
    print("\n".join(aligned(head, rows)))


def csv_text(rows):
    out = io.StringIO()
    csv.writer(out, lineterminator="\n").writerows(rows)
    return out.getvalue()


def write_csv(path, head, rows, replace=True):
    write_whole(path, csv_text([head, *rows]).encode(), replace)


def write_whole(path, content, replace=True):
    """A file that is either whole or not there: written aside, then given its name. No link is followed."""
    if not replace and os.path.lexists(path):
        raise Refusal(f"{path}: exists", "Choose another name, or replace it with -f.")
    if os.path.lexists(path) and not os.path.isfile(path):
        raise Refusal(f"{path}: is not a file", "Choose another name.")
    folder, name = os.path.split(path)
    try:
        number, aside = tempfile.mkstemp(prefix=f".{name}.", dir=folder or ".")
    except OSError as refused:
        raise Refusal(f"{path}: cannot be written: {refused.strerror}", "Check that its folder is there and may be written to.") from None
    try:
        with os.fdopen(number, "wb") as out:
            out.write(content)
            out.flush()
            os.fsync(out.fileno())
        umask = os.umask(0)
        os.umask(umask)
        os.chmod(aside, 0o666 & ~umask)
        os.replace(aside, path)
    except BaseException:
        os.unlink(aside)
        raise
