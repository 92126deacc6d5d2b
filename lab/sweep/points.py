# SPDX-License-Identifier: Apache-2.0
"""Points of a sweep: their inputs are made, their commands run, what they report is kept.

DIR/points/HASH.json holds what was measured of one point. HASH is of the program's build, the words of the command and the content of
its inputs and of other files that it reads: a killed sweep resumes, shards and machines that share DIR (or whose folders are copied
together) add to one another, and results of two builds, commands or recordings never mix. DIR/points/FILE.made holds the same of the
command that made an input.
"""
import hashlib
import json
import os
import shutil
import socket
import tempfile
import time

from common import program
from common.arguments import USAGE, Refusal
from common.table import write_whole
from .plan import HOST, SECONDS, filled

WRITING = {"-o", "--output", "--layout", "--pcap", "--plot", "--stiffness-map", "--stream"}  # options of the program whose value is written
TYPED = "Give a folder with the files that the points use, named as `--list` shows them."


def as_argument(path):
    """A path that no command takes for an option."""
    return "./" + path if path.startswith("-") else path


def files_read(words):
    """Files that are there and that a command names, but for those that it writes."""
    found = set()
    for before, word in zip(["", *words], words):
        option, equals, value = word.partition("=") if word.startswith("--") else ("", "", "")
        if before not in WRITING and option not in WRITING:
            found.add(value if equals else word)
    return sorted(filter(os.path.isfile, found))


class Inputs:
    """Where the files of a plan's inputs are: in the sweep's folder, or where the user has them."""

    def __init__(self, plan, folder, given):
        self.folder, self.given, self.digests, self.read = as_argument(folder), {}, {}, {}
        files = {file for point in plan.points() for file in plan.files_of(point)} if given else set()
        for one in given:
            self.take(plan, files, one)

    def take(self, plan, files, one):
        if os.path.isdir(one):
            found = {file: f"{as_argument(one)}/{file}" for file in files if os.path.exists(f"{one}/{file}")}
            if not found:
                raise Refusal(f"--inputs {one}: holds no file of an input of the plan", TYPED, USAGE)
            self.given |= found
            return
        name, equals, path = one.partition("=")
        if not equals or name not in plan.inputs:
            raise Refusal(f"--inputs {one}: is no folder, and no input of the plan with its file",
                          "Give a folder, or NAME=FILE with the name of an [[input]].", USAGE)
        if plan.inputs[name].file not in files:
            raise Refusal(f"--inputs {one}: no point uses a file {plan.inputs[name].file}", TYPED, USAGE)
        self.given[plan.inputs[name].file] = as_argument(path)

    def path_of(self, file):
        return self.given.get(file, f"{self.folder}/{file}")

    @staticmethod
    def words(made, point, path):
        return [filled(word, point | {"file": path}) for word in made.command]

    def commands(self, plan, points):
        """Of the inputs that would be made where nothing is there yet."""
        wanted = {file: (made, point) for point in reversed(points) for file, made in plan.files_of(point).items()}
        return [self.words(made, point, self.path_of(file)) for file, (made, point) in sorted(wanted.items(), key=lambda one: one[0])
                if made.command and file not in self.given]

    def make(self, plan, points, build, jobs, shown):
        """Make those that these points use and that are not there, or were made by another build, command or file."""
        wanted = {file: (made, point) for point in reversed(points) for file, made in plan.files_of(point).items()}
        progress = program.Progress("inputs", len(wanted), shown)
        program.side_by_side(lambda file: self.make_one(file, *wanted[file], build), sorted(wanted), jobs, progress)

    def make_one(self, file, made, point, build):
        path, record = self.path_of(file), f"{self.folder}/points/{file}.made"
        words = self.words(made, point, "{file}")
        now = json.dumps([build, words, self.digests_of(words)]) + "\n"
        if file in self.given or os.path.exists(path) and text_of(record) in (None, now):  # without a record it is the user's
            return
        if not made.command:
            raise Refusal(f"input {made.name}: the plan has no command that makes it", f"Give the file with --inputs {made.name}=FILE.")
        aside = tempfile.mkdtemp(prefix=".unfinished.", dir=self.folder)
        try:  # a file with the right name is whole; where two shards make the same, either stays
            program.run(self.words(made, point, f"{aside}/{file}") + ["--quiet"])
            if not os.path.exists(f"{aside}/{file}"):
                raise Refusal(f"input {made.name}: the command left no file", "Let the command write to {file}.")
            os.replace(f"{aside}/{file}", path)
            write_whole(record, now.encode())
        finally:
            shutil.rmtree(aside, ignore_errors=True)

    def digest_of(self, file):
        """Of what the file of an input holds; None: it is not there.   raises OSError"""
        return digest(self.digests, file, self.path_of(file))

    def digests_of(self, words):
        """[[file, digest]] of other files that a command reads.   raises OSError"""
        return [[path, digest(self.read, path, path)] for path in files_read(words)]


def digest(known, name, path):
    if name not in known:
        try:
            with open(path, "rb") as content:
                known[name] = hashlib.file_digest(content, "sha256").hexdigest()
        except FileNotFoundError:
            return None
    return known[name]


def text_of(path):
    """None: it is not there."""
    try:
        with open(path, encoding="utf8") as file:
            return file.read()
    except FileNotFoundError:
        return None


def pointed(report, pointer):
    """The text of the value at a JSON pointer; None where there is none, or more than a value."""
    for token in pointer.split("/")[1:]:
        token = token.replace("~1", "/").replace("~0", "~")
        if isinstance(report, list) and token.isdecimal() and int(token) < len(report):
            report = report[int(token)]
        elif isinstance(report, dict) and token in report:
            report = report[token]
        else:
            return None
    if isinstance(report, (dict, list)):
        return None
    return report if isinstance(report, str) else json.dumps(report)


class Points:
    """The points of a plan in a folder. `failures`: why, by the number of the point among those that were computed."""

    def __init__(self, plan, folder, inputs):
        self.plan, self.folder, self.inputs, self.build = plan, folder, inputs, program.version_and_commit()
        self.failures = {}
        os.makedirs(f"{folder}/points", exist_ok=True)

    def words(self, point):
        return self.plan.words(point, self.inputs.path_of)

    def file_of(self, point):
        """Where the point's result is. Inputs count by what they hold, not by where they are.   pre  they are there"""
        words = self.plan.words(point, lambda file: f"sha256:{self.inputs.digest_of(file)}")
        others = self.inputs.digests_of(words)
        text = json.dumps([self.build, words, others] if others else [self.build, words])
        return f"{self.folder}/points/{hashlib.sha256(text.encode()).hexdigest()[:32]}.json"

    def row(self, point):
        """{column: text} of a point that is there; None: it is to be computed. What is not whole counts as nothing."""
        if any(self.inputs.digest_of(file) is None for file in self.plan.files_of(point)):
            return None
        try:
            with open(self.file_of(point), encoding="utf8") as file:
                return self.row_of(point, json.load(file))
        except (OSError, ValueError, KeyError, TypeError, RecursionError):
            return None

    def compute(self, points, jobs, shown):
        """Run the commands of these points and keep what they report."""
        progress = program.Progress(f"sweep {self.plan.name}", len(points), shown)
        program.side_by_side(self.compute_one, list(enumerate(points)), jobs, progress)

    def compute_one(self, numbered):
        number, point = numbered
        words, start = self.words(point), time.monotonic()
        try:
            report = program.report(words, number=str)
            kept = {"command": words, "host": socket.gethostname(), "seconds": round(time.monotonic() - start, 3),
                    "values": self.measured(words, report)}
            write_whole(self.file_of(point), (json.dumps(kept, indent=1, ensure_ascii=False) + "\n").encode())
        except Refusal as refused:
            self.failures[number] = refused

    def measured(self, words, report):
        """{JSON pointer: text} of all that the plan measures."""
        values = {pointer: pointed(report, pointer) for pointer in [*self.plan.measures.values(), *self.plan.times.values()]}
        for pointer, value in values.items():
            if value is None:
                raise Refusal(f"{program.as_typed(words)}\n       its report has no value at {pointer}",
                              "Look at what the command prints with --json.")
        return values

    def row_of(self, point, kept):
        """{column: text} of a point, without derived columns."""
        columns = {column: str(kept["values"][pointer]) for column, pointer in [*self.plan.measures.items(), *self.plan.times.items()]}
        return point | columns | {HOST: str(kept["host"]), SECONDS: f"{kept['seconds']:.3f}"}
