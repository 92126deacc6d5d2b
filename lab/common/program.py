# SPDX-License-Identifier: Apache-2.0
"""The program that is measured: where it is, runs of it, many at a time, and what they ran on.

    program.report(["sim", "push-1dof", "-p", "4%"])      -> the JSON that `tactus sim push-1dof -p 4% --json -q` prints
    program.side_by_side(work, items, jobs, progress)     -> [work(item), ...] in the order of the items
"""
import concurrent.futures
import json
import os
import platform
import shlex
import shutil
import subprocess
import sys
import time

from .arguments import BROKEN, FAILED, OK, Refusal


def tactus():
    """The path of the program: TACTUS in the environment, else on PATH."""
    found = os.environ.get("TACTUS") or shutil.which("tactus")
    if not found:
        raise Refusal("the program tactus is not on PATH", "Install it, or name it in the variable TACTUS of the environment.")
    return found


def study():
    """The path of tactus-study (lab/study), which only a build tree has."""
    found = os.environ.get("TACTUS_STUDY")
    if not found or not os.path.exists(found):
        raise Refusal("this needs the program tactus-study, which is not here",
                      "It is not installed with tactus: use the tactus of a build, such as that of ./go demo (TACTUS_WITH_STUDY=ON).")
    return found


def point(name, **request):
    """The JSON object of one point of one study: lab/study/README.md."""
    done = subprocess.run([study(), name, json.dumps(request)], capture_output=True, stdin=subprocess.DEVNULL, check=False)
    if done.returncode != OK:
        text, _, remedy = done.stderr.decode(errors="replace").removeprefix("error: ").rstrip().partition("\n       ")
        raise Refusal(text or f"tactus-study {name} ended with status {done.returncode}", remedy, max(done.returncode, FAILED))
    return json.loads(done.stdout)


def as_typed(words, name="tactus"):
    return " ".join([name, *map(shlex.quote, words)])


def in_words(errors):
    """What a command wrote on standard error, its error not as JSON."""
    errors = errors.rstrip("\n")
    start = 0 if errors.startswith("{") else errors.find("\n{\n") + 1
    if start == 0 and not errors.startswith("{"):
        return errors
    try:
        error = json.loads(errors[start:])["error"]
    except (ValueError, KeyError, TypeError):
        return errors
    return errors[:start] + "error: " + error.get("text", "") + ("\n       " + error["remedy"] if error.get("remedy") else "")


def run(words, path=None, stdin=None):
    """Standard output of a run as bytes. A broken bound (status 3) is a result.   raises Refusal with the command and what it wrote"""
    path = path or tactus()
    try:
        done = subprocess.run([path, *words], capture_output=True, stdin=stdin or subprocess.DEVNULL, check=False)
    except OSError as refused:
        raise Refusal(f"{path}: the program cannot be started: {refused.strerror}", "Check the installation.") from None
    if done.returncode not in (OK, BROKEN):
        errors = in_words(done.stderr.decode(errors="replace")) or f"it ended with status {done.returncode}"
        raise Refusal(f"{as_typed(words, os.path.basename(path))}\n{errors}")
    return done.stdout


def report(words, path=None, number=float):
    """A run's JSON report.   in   number   of the text of a number with a fraction: str keeps its digits"""
    text = run([*words, "--json", "--quiet"], path)
    try:
        return json.loads(text, parse_float=number)
    except (ValueError, RecursionError):
        raise Refusal(as_typed(words) + "\n       printed no JSON report", "Give a command that takes --json.") from None


def version():
    return json.loads(run(["--version", "--json"]))


def version_and_commit():
    """"0.1.0, commit 0123456789ab"; without the commit where none is known."""
    known = version()
    return known["version"] + (f", commit {known['commit']}" if known.get("commit") else "")


def context():
    """What a result depends on beside its options."""
    known = version()
    return {"version": known["version"], "commit": known.get("commit", ""), "compiler": known["compiler"], "build": known["build"],
            "machine": platform.machine(), "processor": processor(), "cores": os.cpu_count(), "system": platform.system()}


def processor():
    try:
        with open("/proc/cpuinfo", encoding="utf8") as lines:
            return next((line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), platform.processor())
    except OSError:
        return platform.processor()


class Progress:
    """A line on standard error that says how far the work is and how long it will take: on terminals alone."""

    def __init__(self, label, total, shown=True):
        self.label, self.total, self.done, self.start, self.next = label, total, 0, time.monotonic(), 0.0
        self.shown = shown and sys.stderr.isatty() and os.environ.get("TERM") != "dumb"

    def step(self):
        self.done += 1
        now = time.monotonic()
        if not self.shown or now < self.next:
            return
        self.next = now + 0.1
        part = min(1.0, self.done / max(self.total, 1))
        bar = "━" * round(30 * part) + "─" * (30 - round(30 * part))
        left = (now - self.start) * (1 - part) / part
        print(f"\r{self.label} {bar} {100 * part:3.0f} %  {left:.0f} s left\x1b[K", end="", file=sys.stderr, flush=True)

    def clear(self):
        if self.shown:
            print("\r\x1b[K", end="", file=sys.stderr, flush=True)


def side_by_side(work, items, jobs=1, progress=None):
    """[work(item), ...] in the order of the items, `jobs` at a time. Each waits for a process, so threads are enough.
    An interrupt or an exception of one stops those that have not begun."""
    items = list(items)
    with concurrent.futures.ThreadPoolExecutor(max(1, min(jobs, len(items) or 1))) as pool:
        begun = [pool.submit(work, item) for item in items]
        try:
            for one in concurrent.futures.as_completed(begun):
                one.result()
                if progress:
                    progress.step()
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
        finally:
            if progress:
                progress.clear()
    return [one.result() for one in begun]
