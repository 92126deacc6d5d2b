#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The dissector over a live session: `tactus serve`, `tactus link` and `tactus join` on the loopback of a network namespace of their
own, caught by dumpcap. Each end reports what it sent and heard; the capture must show the same.

  live.py TACTUS        ends with 77 where tshark is missing or the system makes no namespace
"""
import fcntl
import json
import os
import pathlib
import re
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time

import captures
from captures import ROOT, Row, rows_of

sys.path.insert(0, str(ROOT / "conformance"))
import session  # noqa: E402

INSIDE = "TACTUS_TEST_IN_NAMESPACE"
SIOCSIFFLAGS, IFF_UP = 0x8914, 1


def enter_namespace() -> None:
    """Run again in a network namespace, where nothing else uses the loopback."""
    if INSIDE in os.environ:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
            fcntl.ioctl(any_socket, SIOCSIFFLAGS, struct.pack("16sh22x", b"lo", IFF_UP))
        return
    for program in ("unshare", "dumpcap"):
        if not shutil.which(program):
            captures.skip(f"{program} is not installed")
    unshare = ["unshare", "--net"] + ([] if os.geteuid() == 0 else ["--map-root-user"])
    made = subprocess.run([*unshare, "true"], capture_output=True, text=True, check=False)
    if made.returncode != 0:
        captures.skip(f"no network namespace can be made here: {made.stderr.strip()}")
    os.execvpe("unshare", [*unshare, sys.executable, *sys.argv], {**os.environ, INSIDE: "1"})


def start(*words) -> subprocess.Popen:
    return subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def line_with(program: subprocess.Popen, pattern: str) -> str:
    """The first group of the first line on standard error that has the pattern."""
    for line in program.stderr:
        found = re.search(pattern, line)
        if found:
            return found[1]
    raise AssertionError(f"{program.args}: ended without saying {pattern}")


def report_of(program: subprocess.Popen) -> dict:
    out, errors = program.communicate(timeout=120)
    assert program.returncode == 0, (program.args, errors)
    return json.loads(out)


def end_capture(dumpcap: subprocess.Popen, path: pathlib.Path) -> None:
    """What was sent is in the file before the capture ends: it comes there in blocks."""
    size = -1
    while size != path.stat().st_size:
        size = path.stat().st_size
        time.sleep(1)
    dumpcap.send_signal(signal.SIGINT)
    _, errors = dumpcap.communicate(timeout=60)
    dropped = re.search(r"received/dropped on interface 'Loopback: lo': \d+/(\d+)", errors)
    assert dropped and dropped[1] == "0", errors


def check(rows: list[Row], report: dict) -> str:
    """One client's conversation, by its report."""
    numbered = [r for r in rows if r.number("tactus.form") != session.HANDSHAKE]
    sent = [r for r in numbered if r.number("tactus.direction") == session.UP]
    came = {r.number("tactus.number") for r in numbered if r.number("tactus.direction") == session.DOWN}
    traffic = report["traffic"]
    assert all(r.number("tactus.check.status") == 1 for r in rows), [r for r in rows if r.number("tactus.check.status") != 1][:3]
    assert all(not r["tactus.rule"] for r in rows), [r for r in rows if r["tactus.rule"]][:3]
    assert [r.number("tactus.number") for r in sent] == list(range(1, len(sent) + 1)), "numbers of datagrams up"
    assert len(sent) == traffic["sent"]["datagrams"], (len(sent), traffic)
    assert sum(len(r.texts("tactus.packet")) for r in sent) == traffic["sent"]["packets"], traffic
    # What came when the client ended may not have been read: it heard what it acknowledged at least, and at most all.
    last = [r for r in sent if r["tactus.ack.number"]][-1]
    acknowledged = len([n for n in came if n <= last.number("tactus.ack.number")]) - last.number("tactus.ack.missing_count")
    assert 0 < acknowledged <= traffic["heard"]["datagrams"] <= len(came), (acknowledged, traffic, len(came))
    assert any(r.number("tactus.state.live") == 1 for r in sent) and traffic["heard"]["packets"] > 0
    return f"{len(rows)} datagrams, {len(sent)} up, {len(came)} down"


def main(args: list[str]) -> None:
    captures.need_tshark()
    enter_namespace()
    tactus = args[0]
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        capture = work / "live.pcapng"
        dumpcap = start("dumpcap", "-i", "lo", "-w", capture, "-B", "64", "-f", "udp")
        line_with(dumpcap, r"(File: )")
        server = start(tactus, "serve", "rotate-push-lift", "-p", "4%", "--listen", "0", "--duration", "100s", "--json")
        port = line_with(server, r":(\d+)$")
        player = start(tactus, "join", port, "--scene", "rotate-push-lift", "-o", work / "client.mcap", "--duration", "3s", "--json")
        observer = start(tactus, "join", port, "--duration", "3s", "--json")
        reports = [report_of(program) for program in (player, observer)]
        server.send_signal(signal.SIGINT)  # once both have left
        served = report_of(server)
        end_capture(dumpcap, capture)
        rows = rows_of(capture)
        printed = captures.run_tshark(capture, "-T", "fields", "-e", "udp.srcport", "-e", "udp.dstport")
        sides = [line.split() for line in printed.splitlines()]
        conversations: dict = {}
        for row, ports in zip(rows, sides, strict=True):
            assert row["frame.protocols"].endswith(":tactus"), row
            conversations.setdefault(next(p for p in ports if p != port), []).append(row)
        assert len(conversations) == len(served["clients"]) == 2, (conversations.keys(), served)
        for own in conversations.values():
            role = own[0]["_ws.col.Info"].split()[-1]
            report = next(r for r in reports if r["role"] == role)
            print(role, check(own, report))


if __name__ == "__main__":
    main(sys.argv[1:])
