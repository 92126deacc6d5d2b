#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What clients cost a server: processor, memory and bits, by its own figures (the table of docs/operator.md).

  serve_load.py PROGRAM SCENE OBSERVERS...   one participant who touches, and so many who look on, sealed, over the loopback, for 10 s each
"""
import pathlib
import re
import subprocess
import sys
import tempfile
import time
import urllib.request

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "tools"))
from prometheus import parse, value

SECONDS = 10


def measure(program, scene, observers, folder):
    def start(*words):
        return subprocess.Popen([program, *words], cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)

    server = start("serve", scene, "-p", "4%", "--listen", "0", "--key", "load.key", "--clients", str(observers + 1), "--metrics", "0", "--log", "json")
    port = re.search(r":(\d+)$", server.stderr.readline().strip())[1]
    url = server.stderr.readline().split()[-1]

    def figures():
        with urllib.request.urlopen(url, timeout=60) as answer:
            return parse(answer.read().decode())

    alone = value(figures(), "process_resident_memory_bytes")
    clients = [start("join", port, "--key", "load.key", "--scene", scene, "-q")]
    clients += [start("join", port, "--key", "load.key", "-q") for _ in range(observers)]
    while value(figures(), "tactus_clients", state="live") < observers + 1:
        time.sleep(0.2)
    time.sleep(2)
    before, begin = figures(), time.monotonic()
    time.sleep(SECONDS)
    after, seconds = figures(), time.monotonic() - begin
    for client in clients:
        client.terminate()
    server.terminate()
    for program_ in (*clients, server):
        program_.communicate()

    def rate(name, **labels):
        return (value(after, name, **labels) - value(before, name, **labels)) / seconds

    def layers(direction):
        return [8e-3 * rate(f"tactus_{direction}_bytes_total", layer=layer) / (observers + 1) for layer in ("payload", "session", "seal", "udp_ip")]

    work = before["tactus_tick_work_seconds"].samples, after["tactus_tick_work_seconds"].samples
    count = [rows["tactus_tick_work_seconds_count", ()] for rows in work]
    late = [rows["tactus_tick_work_seconds_bucket", (("le", "0.001"),)] for rows in work]
    down, up = layers("sent"), layers("received")
    memory = value(after, "process_resident_memory_bytes") - alone
    print(f"| {observers + 1} | {100 * rate('process_cpu_seconds_total'):.1f} % | {sum(down):.1f} (payload {down[0]:.1f}) | {sum(up):.1f} "
          f"| {memory / (observers + 1) / 1e6:.2f} MB | {100 * (1 - (late[1] - late[0]) / (count[1] - count[0])):.2f} % |", flush=True)


def main(program, scene, *observers):
    print("| clients | of a processor | kbit/s down, each | up, each | memory, each | ticks of more than 1 ms |\n|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([program, "key", "-o", f"{folder}/load.key", "-q"], check=True)
        for count in observers:
            measure(program, scene, int(count), folder)


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    main(str(pathlib.Path(sys.argv[1]).resolve()), *sys.argv[2:])
