# SPDX-License-Identifier: Apache-2.0
"""Command lines of the scripts: options that all of them have, errors with a remedy, exit status.

    parser = arguments.parser("sweep", "Run a command over a grid of parameters", examples="tactus sweep plan.toml")
    arguments.add_report_options(parser)
    arguments.run(parser, work)          # calls work(options), which returns an exit status or None, or raises Refusal

Exit status as the program's: 0 done, 1 an input was refused or the work failed, 2 the arguments are wrong, 3 done, but a bound is broken.
"""
import argparse
import json
import os
import sys

OK, FAILED, USAGE, BROKEN, SIGNALLED = 0, 1, 2, 3, 128
LONGEST_TEXT = 1500
WHOLE_LINE = argparse.RawDescriptionHelpFormatter


class Refusal(Exception):
    """Why a command fails: what is wrong, and a remedy. `findings`: all of several, each a pair (text, remedy)."""

    def __init__(self, text, remedy="", status=FAILED, findings=(), **fields):
        super().__init__(text)
        self.text, self.remedy, self.status, self.fields = text, remedy, status, fields
        self.findings = list(findings) or [(text, remedy)]


def how_to_install(*packages):
    """Packages for the Python that runs this: Debian's own gets them from apt, any other from its pip."""
    from_apt = "apt-get install " + " ".join("python3-" + package for package in packages)
    if sys.prefix == "/usr":
        return "Install it: " + from_apt
    return (f"Install it for this Python: {sys.executable} -m pip install {' '.join(packages)}. "
            f"Or use Debian's Python: {from_apt}; PATH=/usr/bin:$PATH")


class Parser(argparse.ArgumentParser):
    def error(self, message):
        raise Refusal(message, f"`{self.prog} --help` lists what it takes.", USAGE)


def parser(name, what, examples=""):
    """`name`: words of the command, "bench delay"."""
    made = Parser(prog="tactus " + name, description=what, epilog=examples, formatter_class=WHOLE_LINE, allow_abbrev=False)
    made._optionals.title = "options"
    return made


def add_report_options(made, output="-o", output_help="Where to write", metavar="DIR", force=False):
    made.add_argument(output, "--output", dest="output", metavar=metavar, help=output_help)
    if force:
        made.add_argument("-f", "--force", action="store_true", help="Replace files that exist")
    made.add_argument("--json", action="store_true", help="Report as JSON, in SI units")
    made.add_argument("-q", "--quiet", action="store_true", help="Print no progress and no table; --json still reports")
    made.add_argument("--no-progress", action="store_true", help="No progress bar")


def add_jobs(made, what="Points computed in parallel"):
    made.add_argument("-j", "--jobs", type=whole(1, 1024), default=os.cpu_count() or 1, metavar="N",
                      help=f"{what} [one per core]; give 1 where times matter")


def whole(least, most):
    """A type of argparse: a whole number between two."""
    def read(typed):
        if not typed.isdecimal() or not least <= int(typed) <= most:
            raise argparse.ArgumentTypeError(f"{typed}: give a whole number from {least} to {most}")
        return int(typed)
    return read


def printable(text):
    """The text with its control characters escaped, for terminals, and without the middle of what nobody reads to the end."""
    if len(text) > LONGEST_TEXT:
        text = f"{text[:LONGEST_TEXT // 2]} ... {text[-LONGEST_TEXT // 4:]}"
    return "".join(c if c == "\n" or (c.isprintable() and c != "\x7f") else c.encode("unicode_escape").decode() for c in text)


def complain(refusal, as_json):
    if as_json:
        error = {"text": refusal.text} | ({"remedy": refusal.remedy} if refusal.remedy else {}) | refusal.fields
        if len(refusal.findings) > 1:
            error["findings"] = [{"text": text, "remedy": remedy} for text, remedy in refusal.findings]
        print(json.dumps({"schema": "tactus.error/1", "error": error}, indent=2, ensure_ascii=False), file=sys.stderr)
        return
    bold = sys.stderr.isatty() and "NO_COLOR" not in os.environ and os.environ.get("TERM") != "dumb"
    label = "\x1b[1;31merror:\x1b[0m" if bold else "error:"
    for text, remedy in refusal.findings:
        print(f"{label} {printable(text)}", file=sys.stderr)
        if remedy:
            print(f"       {printable(remedy)}", file=sys.stderr)


def run(made, work, words=None):
    """Parse, work, and end the process with the status."""
    words = sys.argv[1:] if words is None else words
    if sys.version_info < (3, 11):
        complain(Refusal(f"this is Python {sys.version.split()[0]}", "Install Python 3.11 or later."), "--json" in words)
        sys.exit(FAILED)
    try:
        status = work(made.parse_args(words)) or OK
        sys.stdout.flush()
    except Refusal as refusal:
        sys.stdout.flush()
        complain(refusal, "--json" in words)
        status = refusal.status
    except BrokenPipeError:  # the reader has gone: nothing is left to be said to it
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        status = FAILED
    except OSError as refused:
        complain(Refusal(f"{refused.filename or 'a file'}: {refused.strerror}", "Check the path and the rights to it."), "--json" in words)
        status = FAILED
    except MemoryError:
        complain(Refusal("there is not enough memory", "Give smaller inputs, or run it on a larger machine."), "--json" in words)
        status = FAILED
    except KeyboardInterrupt:
        status = SIGNALLED + 2
    sys.exit(status)
