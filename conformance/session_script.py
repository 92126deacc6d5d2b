# SPDX-License-Identifier: Apache-2.0
"""Answers of the two ends of a session to a script of datagrams and times (README.md)."""
from __future__ import annotations

import json
import struct
from typing import Iterator, Optional

from conventions import Cursor, StreamError
from datagram import ACK, CUT, HANDSHAKE, HASH, PARTS, SPARE, UP, WELCOME, head, part, sealed
from scene import Limits
from session import MS, Client
from session_server import ROLES, ServedEpoch, Server

CLIENT_ACK_DELAY, SERVER_ACK_DELAY = 10 * MS, 25 * MS      # an acknowledgement is due by then


def lines(script: str, limits: Limits = Limits()) -> Iterator[dict]:
    """A line for each line of a script: what the end that it is for makes of it, and what it sends then. `limits` are a client's."""
    serves = '"serve":' in script.split("\n", 1)[0]
    return server_lines(script) if serves else client_lines(script, limits)


# ---- The client's end -----------------------------------------------------------------------------------------------
def sent_by(datagrams: list[bytes]) -> dict:
    """What a client has sent, apart from when: acknowledgement, hashes, whole handshakes."""
    out: dict = {}
    for datagram in datagrams:
        form = datagram[0] & 3
        if form == HANDSHAKE:
            out.setdefault("says", []).append(datagram.hex())
        cursor = Cursor(datagram, 2, len(datagram) - 4)
        while form == PARTS and cursor.left():
            kind, size = cursor.number(1, CUT), cursor.varint(CUT, SPARE)
            e = Cursor(cursor.take(size, CUT), 0, size)
            if kind == ACK:
                out["acknowledges"] = [e.number(2, CUT), e.number(2, CUT), f"{e.varint(CUT, SPARE):016x}"]
            elif kind == HASH:
                out.setdefault("hashes", []).append([e.number(1, CUT), e.number(2, CUT), f"{e.number(4, CUT):08x}"])
    return {name: out[name] for name in ("acknowledges", "hashes", "says") if name in out}


def client_lines(script: str, limits: Limits) -> Iterator[dict]:
    client: Optional[Client] = None
    reported = None
    for number, line in enumerate(script.splitlines()):
        step, error, out = json.loads(line), None, []
        if client:
            client.pass_time(step["at"])
        try:
            if "join" in step:
                client = Client(int(step["join"], 16), now=step["at"], limits=limits)
            elif "heard" in step:
                client.handle(step["at"], bytes.fromhex(step["heard"]))
            else:
                client.leave()
        except StreamError as e:
            error = e
        sent = sent_by(list(client.poll(step["at"] + CLIENT_ACK_DELAY)))
        newest, held, missing = sent.get("acknowledges", (None, 0, None))
        if reported == (newest, missing):
            del sent["acknowledges"]                        # nothing new
        reported = (newest, missing) if newest is not None else reported
        answer = {"line": number, "state": client.state}
        if client.state == "closed":
            answer["reason"] = client.reason
        if error:
            answer["error"] = {"errc": error.errc, "rule": error.rule}
        answer.update(sent)
        if client.state == "live":
            answer["states"] = [f"{d.state_hash():016x}" for d in client.epoch.decoders.substreams.values()]
        yield answer


# ---- The server's end -----------------------------------------------------------------------------------------------
def split_mix(state: int) -> Iterator[int]:
    """SplitMix64."""
    most = (1 << 64) - 1
    while True:
        state = (state + 0x9E3779B97F4A7C15) & most
        z = ((state ^ state >> 30) * 0xBF58476D1CE4E5B9) & most
        z = ((z ^ z >> 27) * 0x94D049BB133111EB) & most
        yield z ^ z >> 31 or 1


class Listener:
    """What the server has sent to each address."""

    def __init__(self) -> None:
        self.newest: dict[int, int] = {}                    # number of a datagram
        self.reported: dict[int, tuple] = {}

    def acknowledgement(self, peer: int, number: int, epoch: int, parts: bytes) -> bytes:
        ack = part(ACK, struct.pack("<HHB", self.newest.get(peer, 0), 65535, 0))
        return sealed(head(PARTS, number) + ack + parts, epoch, UP)

    def hear(self, sent: list[tuple[int, bytes]]) -> dict:
        acks, handshakes = {}, set()
        for peer, datagram in sent:
            value = struct.unpack("<H", datagram[:2])[0] >> 2
            if datagram[0] & 3 == HANDSHAKE:
                handshakes.add((peer, datagram.hex()))
                if value == WELCOME and datagram not in self.reported.get(("welcome", peer), ()):
                    self.newest[peer] = 0
                    self.reported.pop(peer, None)
                    self.reported["welcome", peer] = (datagram,)
                continue
            self.newest[peer] = value
            cursor = Cursor(datagram, 2, len(datagram) - 4)
            while cursor.left():
                kind, size = cursor.number(1, CUT), cursor.varint(CUT, SPARE)
                e = Cursor(cursor.take(size, CUT), 0, size)
                if kind == ACK:
                    acks[peer] = [peer, e.number(2, CUT), e.number(2, CUT), f"{e.varint(CUT, SPARE):016x}"]
        out: dict = {}
        for peer, ack in sorted(acks.items()):
            if self.reported.get(peer) != (ack[1], ack[3]):
                out.setdefault("acknowledges", []).append(ack)
            self.reported[peer] = ack[1], ack[3]
        if handshakes:
            out["says"] = [list(item) for item in sorted(handshakes)]
        return out


def server_lines(script: str) -> Iterator[dict]:
    """Who is there, and what the server sends 25 ms later."""
    server, listener = None, Listener()
    for number, line in enumerate(script.splitlines()):
        step, error = json.loads(line), None
        now, peer = step["at"], step.get("from", 0)
        if "serve" in step:
            server = Server(bytes.fromhex(step["serve"]), step["clients"], split_mix(int(step["entropy"], 16)), now)
        server.pass_time(now)
        try:
            if "heard" in step:
                server.handle(now, peer, bytes.fromhex(step["heard"]))
            elif "acknowledges" in step:
                server.handle(now, peer, listener.acknowledgement(peer, step["acknowledges"], int(step["epoch"], 16), bytes.fromhex(step["parts"])))
            elif "scene" in step:
                server.replace(bytes.fromhex(step["scene"]), now)
            elif "closes" in step:
                server.let_go(step["closes"], step["reason"])
        except StreamError as e:
            error = e
        sent = listener.hear(list(server.poll(now + SERVER_ACK_DELAY)))
        answer: dict = {"line": number, "clients": [[c.peer, c.client, ROLES[c.role], c.state()] for c in server.there()]}
        if server.left:
            answer["left"] = [list(item) for item in server.left]
            server.left = []
        if error:
            answer["error"] = {"errc": error.errc, "rule": error.rule}
        answer.update(sent)
        devices = [device_of(c.epoch) for c in server.there() if c.epoch.live and c.epoch.participates]
        if devices:
            answer["devices"] = devices
        yield answer


def device_of(epoch: ServedEpoch) -> list:
    decoder = epoch.decoders.substreams[0]
    return [epoch.client, f"{decoder.state_hash():016x}"] + ([epoch.buttons[1]] if epoch.packets else [])
