#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Programs that stand still, and what a hand that presses a block feels meanwhile: real `tactus serve`, `link` and `join` on this machine.

  standstill.py [--seconds 0.2,1,5] [--of server,client,address,sealed,killed,restarted] [-o DIR]

`server` and `client` are stopped (SIGSTOP) for so long and go on; with `address` and `sealed` a translator gives the client another port;
`killed` is a client, `restarted` a server that is killed (SIGKILL) and begins anew. Each is checked: no force is rendered from a picture older than a second, none a
moment after the other end was last heard, all of it is there again soon, and the seat is the same. -o also writes DIR/standstill.csv, force and age
of what is shown over time, and draws it. `tactus` is on PATH. Times are those of the trace: a busy machine makes a run longer, not wrong.
"""
import argparse
import atexit
import csv
import json
import os
import pathlib
import re
import select
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENE = """
name = "hold"
duration = 600.0
gravity = [0.0, 0.0, -9.81]
floor = 0.0

[touch]
stiffness = 630.0
friction = 0.5
lift_stiffness = 68.0

[[object]]
name = "block"
size = [0.04, 0.04, 0.04]
mass = 2.0
friction = 0.7
damping = 0.999
position = [0.0, 0.0, 0.02]

[[user]]
name = "hand"
object = "block"
grip = "normal"
start = [-0.06, 0.0, 0.02]

[user.device]
max_force = 3.3
resolution = 0.055e-3
filter = 8

[[user.path]]
name = "press"
to = [-0.010, 0.0, 0.02]
duration = 0.5

[[user.path]]
name = "hold"
to = [-0.010, 0.0, 0.02]
duration = 599
"""
STALE, OLDEST, SLACK = 400, 1000, 200  # [ms] until all force is gone after the last news; no force is rendered of an older picture; of this machine
NONE = 0.02                            # [N]
WHOLE = 0.8                            # of the force before


class Program:
    """One of ours, whose messages are kept."""

    def __init__(self, *words):
        self.process = subprocess.Popen(["tactus", *words], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        atexit.register(self.process.kill)                      # when a check fails
        self.lines = []
        threading.Thread(target=self.read, daemon=True).start()

    def read(self):
        for line in self.process.stderr:
            self.lines.append(line.rstrip("\n"))

    def wait(self, wanted, count=1, within=60):
        """The line that matches for the count-th time, or what else `wanted` returns of one."""
        for _ in range(50 * within):
            found = [got for got in map(wanted, list(self.lines)) if got]
            if len(found) >= count:
                return found[count - 1]
            time.sleep(0.02)
        raise AssertionError(f"nothing of the kind was printed: {self.lines}")

    def signal(self, number):
        os.kill(self.process.pid, number)

    def end(self):
        self.signal(signal.SIGTERM)  # which who runs tests in the background does not ignore
        status = self.process.wait(timeout=120)
        assert status in (0, 3), (status, self.lines)


def event(kind):
    def of(line):
        printed = json.loads(line) if line.startswith("{") else {}
        return printed if printed.get("event") == kind else None
    return of


class Translator(threading.Thread):
    """Between a client and a server; it may forget which port it gave."""

    def __init__(self, to):
        super().__init__(daemon=True)
        self.near, self.to, self.client = self.listener(), ("127.0.0.1", int(to)), None
        self.rebind()
        self.port = str(self.near.getsockname()[1])
        self.start()

    @staticmethod
    def listener():
        out = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        out.bind(("127.0.0.1", 0))
        return out

    def rebind(self):
        self.far = self.listener()

    def run(self):
        while True:
            for readable in select.select([self.near, self.far], [], [], 0.01)[0]:
                data, source = readable.recvfrom(65536)
                if readable is self.near:
                    self.client = source
                    self.far.sendto(data, self.to)
                elif readable is self.far:
                    self.near.sendto(data, self.client)


class Trial:
    """A server, a network and a hand that presses a block, until something happens to one of them."""

    def __init__(self, kind, seconds):
        self.kind, self.seconds = kind, seconds
        self.key = ["--key", "lab.key"] if kind == "sealed" else []
        self.server = self.serve("0")
        port = self.own_port = self.server.wait(lambda line: re.search(r":(\d+)$", line))[1]
        self.link = None
        if kind in ("address", "sealed"):
            self.network = Translator(port)
            self.port = self.network.port
        else:
            self.link = Program("link", "--listen", "0", "--to", port, "--link", "delay=20ms")
            self.port = self.link.wait(lambda line: re.search(r":(\d+)\b", line))[1]
        self.hand = self.join("client.mcap")
        self.seat = self.server.wait(event("seated"))
        time.sleep(2.5)
        self.begin = time.monotonic()

    def serve(self, port):
        return Program("serve", "hold.toml", "-p", "4%", "--listen", port, "--log", "json", "-o", "served.mcap", "-f", *self.key)

    def join(self, trace):
        return Program("join", self.port, "--scene", "hold.toml", "-o", trace, "-f", *self.key)

    def happen(self):
        if self.kind in ("server", "client"):
            stopped = self.server if self.kind == "server" else self.hand
            stopped.signal(signal.SIGSTOP)
            time.sleep(self.seconds)
            stopped.signal(signal.SIGCONT)
        elif self.kind == "killed":
            self.hand.signal(signal.SIGKILL)
            self.hand.process.wait()
            self.hand = self.join("again.mcap")
            self.server.wait(event("joined"), 2)
        elif self.kind == "restarted":
            self.server.signal(signal.SIGKILL)
            self.server.process.wait()
            time.sleep(1)
            self.server = self.serve(self.own_port)
            self.server.wait(event("seated"))
        else:
            self.network.rebind()
            moved = self.server.wait(event("moved"))
            assert moved["client"] == self.seat["client"], moved

    def end(self):
        time.sleep(3)
        end = time.monotonic()
        unseated = [line for line in self.server.lines if event("unseated")(line)]
        assert not unseated or self.seconds > 8, unseated
        self.hand.end()
        self.server.end()
        if self.link:
            self.link.end()
        seats = [e for e in map(event("seated"), self.server.lines) if e]
        assert {(e["client"], e["user"]) for e in seats} == {(self.seat["client"], "hand")}, seats
        rendered = rows_of("again.mcap" if self.kind == "killed" else "client.mcap", "force")
        self.zero = rendered[-1][0] - round(1000 * (end - self.begin))  # the tick at which it happened, about
        return rendered, rows_of("served.mcap", "server_force")


def rows_of(trace, force):
    """Of each tick its number [ms], the force at the hand [N] and how old the tick is that is shown [ms]."""
    subprocess.run(["tactus", "export", "csv", trace, "-o", "rows.csv", "-f", "-q"], check=True)
    with open("rows.csv", encoding="utf8", newline="") as file:
        return [(int(row["tick"]), sum(float(row[f"/users/hand/{force}_{axis}"] or 0) ** 2 for axis in "xyz") ** 0.5,
                 int(row["tick"]) - int(row.get("shown_tick") or row["tick"])) for row in csv.DictReader(file)]


def longest(rows):
    """Ticks before and after the longest time without any."""
    return max(((a[0], b[0]) for a, b in zip(rows, rows[1:])), key=lambda pair: pair[1] - pair[0])


def check(trial, rendered, served):
    """The force at the hand, by what the trace says."""
    pressed = [force for tick, force, _ in rendered if trial.zero - 1000 < tick < trial.zero - 200]
    whole = sorted(pressed)[len(pressed) // 2] if pressed else sorted(force for _, force, _ in rendered)[len(rendered) // 2]
    assert whole > 1, (trial.kind, whole)
    for tick, force, age in rendered:
        assert force < NONE or age <= OLDEST + SLACK, f"at tick {tick} {force} N of a picture {age} ms old"
    if trial.kind == "restarted":  # the trace ends there: the new server has a time of its own
        assert max(force for _, force, _ in rendered[-300:]) < NONE, rendered[-1]
        before = [force for _, force, _ in served[-1000:-300]]  # the hand leaves first
        assert min(before) > WHOLE * whole, (whole, min(before))
        return "force at the new server's hand again"
    begin, end = trial.zero, trial.zero + round(1000 * trial.seconds)
    if trial.kind == "client":
        begin, end = longest(rendered)
        assert end - begin >= 900 * trial.seconds, (begin, end)
        if trial.seconds > 2:  # the server's own hand of that end lifts off within a second
            silent = [force for tick, force, _ in served if begin + 1000 + SLACK < tick < end - SLACK]
            assert silent and max(silent) < NONE, (len(silent), max(silent, default=0))
    elif trial.kind == "server" and trial.seconds > 0.5:
        still_rendered = [force for tick, force, _ in rendered if begin + STALE + SLACK < tick < end - SLACK]
        assert still_rendered and max(still_rendered) < NONE, (len(still_rendered), max(still_rendered, default=0))
    again = [force for _, force, _ in rendered[-300:]]  # 3 s after it was over
    assert min(again) > WHOLE * whole, (whole, min(again))
    without = [tick for tick, force, _ in rendered if tick >= begin and force < NONE]
    return f"without force for {without[-1] - without[0]} ms" if without else "never without force"


def draw(rows, stem):
    """in   rows  of the table: what, time_ms, force_N, age_ms"""
    sys.path.insert(0, str(ROOT / "lab"))
    from common import figure
    fig, axes = figure.panels(4)
    stopped = {end: [name for name in dict.fromkeys(row[0] for row in rows) if name.startswith(end + " stopped")] for end in ("server", "client")}
    others = [name for name in dict.fromkeys(row[0] for row in rows) if " stopped" not in name]
    force, age = (2, "force [N]"), (3, "age of the picture [ms]")
    for panel, names, (column, label) in zip(axes, (stopped["server"], stopped["server"], stopped["client"], others), (force, age, force, force)):
        for i, name in enumerate(names):
            own = [row for row in rows if row[0] == name]
            y = [a[column] if b[1] - a[1] < 100 else float("nan") for a, b in zip(own, own[1:])]
            figure.line(panel, [1e-3 * row[1] for row in own[:-1]], y, i, label=name, marked=False)
        panel.set_ylabel(label)
        panel.legend(loc="center right")
    axes[1].set_ylim(10, 2e4)
    figure.logarithmic(axes[1], "y")
    axes[-1].set_xlim(-1, max(13, 1.6 * max(row[1] for row in rows) * 1e-3))
    axes[-1].set_xlabel("time since it happened [s]")
    for ending in (".svg", ".png"):
        figure.save(fig, str(stem) + ending)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", default="0.2,1,5", help="how long the server and the client are stopped")
    parser.add_argument("--of", default="server,client,address,sealed,killed,restarted", help="what happens")
    parser.add_argument("-o", "--output", type=pathlib.Path, help="folder of the table and the figure")
    options = parser.parse_args()
    output = options.output.resolve() if options.output else None
    results = {}
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        pathlib.Path("hold.toml").write_text(SCENE, encoding="utf8")
        subprocess.run(["tactus", "key", "-o", "lab.key", "-q"], check=True)
        for kind in options.of.split(","):
            for seconds in map(float, options.seconds.split(",")) if kind in ("server", "client") else [0.0]:
                trial = Trial(kind, seconds)
                trial.happen()
                rendered, served = trial.end()
                found = check(trial, rendered, served)
                name = f"{kind} stopped for {seconds:g} s" if seconds else \
                    {"address": "another address", "sealed": "another address, sealed", "killed": "client killed, and back", "restarted": "server killed, and anew"}[kind]
                print(f"{name}: {found}")
                if kind != "restarted":
                    results[name] = [(t - trial.zero, f, a) for t, f, a in rendered if -1000 <= t - trial.zero <= 1000 * seconds + 4000]
        if output:
            output.mkdir(parents=True, exist_ok=True)
            rows = [[name, t, f, a] for name, of in results.items() for t, f, a in of if t % 20 == 0]
            with open(output / "standstill.csv", "w", encoding="utf8", newline="") as file:
                table = csv.writer(file, lineterminator="\n")
                table.writerow(["what", "time_ms", "force_N", "age_ms"])
                table.writerows([name, t, f"{f:.3f}", a] for name, t, f, a in rows)
            draw(rows, output / "standstill")


if __name__ == "__main__":
    main()
