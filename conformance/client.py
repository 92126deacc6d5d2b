#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A client written from the specification alone: joins `tactus serve` over UDP and moves a device about.

  client.py PORT [--seconds S] [--observe] [--token FILE] [--seat N]
      prints one line of JSON at the end: packets, epochs, round trip, hash of each substream's state; in a driven scene also the tick mappings of the
      device, and how many of its packets did not act

It ends when the server leaves, or after S seconds. Without an answer it joins again by itself, by its token, that --token also keeps for
a program that begins anew.
"""
from __future__ import annotations

import argparse
import json
import math
import pathlib
import secrets
import socket
import sys
import time
from typing import Optional

from conventions import StreamError
from range_encoder import RangeEncoder
from rigid import NEAR
from session import Client
from start_models import Models


class Device:
    """Chapter 65: the device moves on a circle; each of its packets is a key packet, so that none needs another."""

    RADIUS, SPEED = 0.05, 2.0                               # m, rad/s

    def __init__(self, position_exp: int, tick_rate: int, now: float):
        self.scale, self.tick_rate, self.start = 2.0 ** position_exp, tick_rate, now

    def packet(self, now: float) -> bytes:
        angle = self.SPEED * (now - self.start)
        position = (self.RADIUS * math.cos(angle), self.RADIUS * math.sin(angle), 0.0)
        models, encoder = Models("rigid-start-models.csv"), RangeEncoder()
        encoder.bit(models["KEY"][1], 1)
        encoder.magnitude(models["TICK"], int((now - self.start) * self.tick_rate))
        encoder.tree(models["REASON"], 2, 0)
        encoder.tree(models["LEVEL"], 4, 0)
        for k in range(2):                                  # position and velocity, rotation and angular velocity
            pose = [round(c * self.scale) for c in position] if k == 0 else [0, 0, 0]
            largest = 0
            for a in range(3):
                encoder.signed(models[f"POSE[{k}][{0 if a == 0 else 4 + min(largest.bit_length(), 7)}]"], pose[a])
                largest = max(largest, abs(pose[a]))
            for a in range(3):                              # no velocity
                near = NEAR[min(abs(pose[a]).bit_length(), 6)]
                encoder.signed(models[f"MOTION[{k}][{near if a == 0 else 5 + near}]"], 0)
        return encoder.finish()


def run(port: int, seconds: float, observe: bool, kept: Optional[pathlib.Path] = None, seat: int = 0) -> tuple[Client, int]:
    """The client and how many epochs it had."""
    sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sock.connect(("127.0.0.1", port))
    device: Optional[Device] = None
    epochs: list = []

    def next_packet(number: int) -> bytes:
        nonlocal device
        if device is None:
            device = Device(client.epoch.scene.position_exp, client.epoch.scene.tick_rate, time.monotonic())
        return device.packet(time.monotonic())

    token = int(kept.read_text(encoding="ascii"), 16) if kept and kept.exists() else 0
    client = Client(secrets.randbits(64), None if observe else next_packet, token)
    client.seat = seat
    end = time.monotonic() + seconds
    while client.state != "closed" and time.monotonic() < end:
        for datagram in client.poll(time.monotonic_ns() // 1000):
            sock.send(datagram)
        sock.settimeout(0.002)
        try:
            client.handle(time.monotonic_ns() // 1000, sock.recv(2048))
        except (StreamError, TimeoutError, ConnectionRefusedError):
            pass                                            # dropped; nothing has come; nobody is there yet
        if client.epoch and (not epochs or client.epoch is not epochs[-1]):
            epochs.append(client.epoch)
            device = None                                   # its ticks begin anew
            if kept:
                kept.write_text(f"{client.token:x}", encoding="ascii")
    client.leave()
    for datagram in client.poll(time.monotonic_ns() // 1000):
        sock.send(datagram)
    return client, len(epochs)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("port", type=int)
    parser.add_argument("--seconds", type=float, default=1e9)
    parser.add_argument("--observe", action="store_true", help="look on, without a device")
    parser.add_argument("--token", type=pathlib.Path, metavar="FILE", help="what lets this client come back after a crash")
    parser.add_argument("--seat", type=int, default=0, help="of the scene's users, from 1; 0: any")
    arguments = parser.parse_args()
    client, epochs = run(arguments.port, arguments.seconds, arguments.observe, arguments.token, arguments.seat)
    epoch = client.epoch
    if epoch is None or epoch.decoders is None:
        print("no session", file=sys.stderr)
        return 1
    report = {"client": epoch.client, "packets": epoch.packets, "epochs": epochs, "round_trip_us": epoch.round_trip and epoch.round_trip[0],
            "state_hashes": [f"{d.state_hash():016x}" for d in epoch.decoders.substreams.values()]}
    if epoch.path:
        report.update({"tick_mappings": len(epoch.path.offsets), "without_effect": sum(not epoch.path.takes_effect(n) for n in epoch.path.states)})
    print(json.dumps(report))
    return 0


if __name__ == "__main__":
    sys.exit(main())
