#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A live session between two network namespaces, over two TUN devices and the emulated link between them: what both ends report agrees with
what the link did.

  run.py TUN_LINK TACTUS        ends with 77, and says why, where no namespaces or TUN devices can be made
"""
import json
import pathlib
import shlex
import subprocess
import sys
import tempfile

DELAY_US = {"up": 15_000, "down": 25_000}
LOSS = 0.05


def network(direction: str, seed: int) -> str:
    return f"delay={DELAY_US[direction]}us,loss={LOSS},seed={seed}"


def main(args: list[str]) -> int:
    tun_link, tactus = args
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        path = {name: shlex.quote(str(work / name)) for name in ("server.json", "client.json", "client.done", "client.mcap")}
        program = shlex.quote(tactus)
        # The server stays two seconds longer, and hears all that arrives.
        server = (f"{program} serve rotate-push-lift -p 4% --listen 127.0.0.1:7447 --duration 100s -q --json > {path['server.json']} & "
                  f"server=$!; until [ -e {path['client.done']} ]; do sleep 0.1; done; sleep 2; kill -TERM $server; wait $server")
        client = (f"{program} join 127.0.0.1:7447 --scene rotate-push-lift -o {path['client.mcap']} --duration 5s --json "
                  f"> {path['client.json']}; status=$?; touch {path['client.done']}; exit $status")
        done = subprocess.run([tun_link, network("up", 3), network("down", 4), server, client], capture_output=True, text=True, check=False,
                              timeout=120)
        if done.returncode == 77:
            print(done.stderr.strip())
            return 77
        assert done.returncode == 0, (done.stdout, done.stderr)
        link = json.loads(done.stdout)
        server, client = (json.loads((work / f"{name}.json").read_text()) for name in ("server", "client"))
    up, down = link["up"], link["down"]
    assert len(server["clients"]) == 1, server
    at_server, at_client = server["clients"][0]["traffic"], client["traffic"]

    # Counts. The link keeps the order, so that nothing comes after the client's leave.
    assert up["refused"] == down["refused"] == 0, link
    assert at_client["sent"]["datagrams"] == up["numbered_sent"], (at_client, up)
    assert at_server["heard"]["datagrams"] == up["numbered_arrived"], (at_server, up)
    assert at_server["sent"]["datagrams"] == down["numbered_sent"], (at_server, down)
    assert 0 < at_client["heard"]["datagrams"] <= down["numbered_arrived"], (at_client, down)
    for direction in (up, down):
        assert direction["sent"] == direction["arrived"] + direction["lost"] and 0 < direction["lost"] < direction["sent"], direction
    for traffic in (at_server, at_client):
        assert traffic["wrong_states"] == 0 and traffic["heard"]["packets"] > 0, traffic

    # A round trip is never shorter than both ways; `held` is rounded down, so that no sample comes out below it.
    trips = [server["clients"][0]["round_trip"], client["round_trip"]]
    assert all(trip["least_us"] >= sum(DELAY_US.values()) for trip in trips), trips
    print(f"up {up}, down {down}")
    print("round trips", trips, "losses as the ends saw them", client["loss"], at_client["sent"]["lost"], at_server["sent"]["lost"])
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
