# SPDX-License-Identifier: Apache-2.0
"""Chapter 70 of the specification: the server's end of sessions whose objects rest, as a function of datagrams and time."""
from __future__ import annotations

import struct
from typing import Iterator, Optional

from conventions import Cursor, StreamError, fnv1a, require
from datagram import (BUTTONS, BYE, CUT, DOWN, FULL, HANDSHAKE, JOIN, LEAVE, TICK_MAPPING, PACKET, PIECE, PROTOCOL, REFUSAL, SILENCE, SPARE,
                      STATE, TOO_LARGE, UP, WELCOME, WRONG_VERSION, head, is_of_epoch, part, reason_of, sealed, varint)
from device_path import DevicePath, device_scene
from scene import read_declaration, state_bytes
from scene_decoder import SceneDecoder
from session import FIRST_ANSWER, MS, PIECE_SIZE, WINDOW, Epoch

LEAST_JOIN = 80                                             # bytes
WELCOME_EVERY, UNVALIDATED, MOST_SILENCE = 250 * MS, 10_000 * MS, 120_000 * MS
MOST_FAULTS = 100                                           # datagrams
DRIVEN_ACK_DELAY = 140 * MS
ROLES = "observer", "participant"


# ---- Section 6: the server's end of an epoch ------------------------------------------------------------------------
class ServedEpoch(Epoch):
    direction, ack_delay = DOWN, 25 * MS
    live = False
    buttons = (0, 0)                                        # tick, mask
    reached = -1                                            # tick of the device, in the simulation

    def offer(self, declaration: bytes, participates: bool) -> None:
        self.offered = [declaration[i:i + PIECE_SIZE] for i in range(0, len(declaration), PIECE_SIZE)]
        self.participates = participates
        self.carries: dict[int, int] = {}                   # piece in each datagram
        self.in_flight: set[int] = set()
        self.pieces_there: set[int] = set()
        self.open: set[int] = set()                         # own numbers whose fate is not known
        self.timeouts = 0                                   # of pieces, since the last that arrived
        self.device_packets = 0
        self.reported, self.eliciting_first = 0, None           # newest of the last acknowledgement; when the first ack-eliciting one came since
        self.reported_changed = False                       # one below it was accepted since
        self.fates: list[bool] = []                         # whether numbers were lost, as far as it is known

    def take(self, now: int, datagram: bytes) -> None:
        self.was_driving = self.path is not None
        super().take(now, datagram)

    def accept(self, now: int, number: int, parts: list[tuple], urgent: bool) -> None:
        self.reported_changed |= number < self.reported
        super().accept(now, number, parts, urgent)

    def wait_from(self, now: int) -> int:
        """Section 4: long where the path of a device is known, while all is well."""
        self.eliciting_first = now if self.eliciting_first is None else self.eliciting_first
        well = not self.reported_changed and all(n in self.accepted for n in range(self.reported + 1, max(self.accepted) + 1))
        loss = sum(self.fates[-256:]) / max(128, len(self.fates[-256:]))
        return self.eliciting_first + DRIVEN_ACK_DELAY if self.path and well and loss <= 0.01 else now + self.ack_delay

    def acknowledgement(self, now: int) -> bytes:
        self.reported, self.eliciting_first, self.reported_changed = max(self.accepted), None, False
        return super().acknowledgement(now)

    def find_lost(self, now: int, newest: int, there: set[int]) -> None:
        """Section 7."""
        self.fates += [False] * len(self.open & there)
        self.open -= there
        if self.round_trip is None:
            return
        timeout = self.round_trip[0] + max(4 * self.round_trip[1], 1000)
        for n in sorted(n for n in self.open if n < newest and (newest - n > 64 or now - self.sent_at[n] > timeout)):
            self.open.discard(n)
            self.fates.append(True)
            self.in_flight.discard(self.carries.get(n, -1))

    def take_acknowledged(self, now: int, newest: int, held: int, missing: int) -> None:
        super().take_acknowledged(now, newest, held, missing)
        self.find_lost(now, newest, self.arrived)
        for number in self.arrived & set(self.carries):
            index = self.carries.pop(number)
            self.pieces_there.add(index)
            self.in_flight.discard(index)
            self.timeouts = 0

    def ack_timeout(self) -> int:
        return self.round_trip[0] + 4 * self.round_trip[1] + 10 * MS if self.round_trip else FIRST_ANSWER

    def lose_pieces(self, now: int) -> None:
        """Section 6: what was not acknowledged for long goes again."""
        timeout = self.ack_timeout() << self.timeouts
        if not self.in_flight or not self.open or now < self.sent_at[min(self.open)] + timeout:
            return
        for n in [n for n in self.open if self.sent_at[n] <= now - timeout]:
            self.open.discard(n)
            self.in_flight.discard(self.carries.get(n, -1))
        self.timeouts = min(self.timeouts + 1, 1 if self.round_trip else 6)

    def write(self, now: int, parts: list[bytes], packet: bytes = b"") -> Optional[bytes]:
        self.open.add(self.next)
        return super().write(now, parts, packet)

    def take_received(self, kind: int, elements: tuple) -> None:
        if kind == STATE and elements[0] == 1 and not self.live:
            self.live = True
            if self.participates:
                device = device_scene(self.scene)
                self.decoders = SceneDecoder(device)
                self.path = DevicePath(device) if self.scene.follows_devices() else None
        elif kind == BUTTONS and elements[0] >= self.buttons[0]:
            self.buttons = elements

    def decode(self, now: int, number: int, packet: bytes) -> bool:
        """False also for a packet that comes too late to take effect (65, section 4)."""
        if not super().decode(now, number, packet):
            return False
        if not self.path or number in self.path.states:
            return True
        state = self.decoders.substreams[0].receiver.kept[number].states[0]
        if state.tick <= self.reached:
            return False
        self.path.add(number, state)
        return True

    def begin_mapping(self, tick: int, offset: int) -> bytes:
        """The part that signals it."""
        self.path.begin(tick, offset)
        return part(TICK_MAPPING, varint(tick) + varint(2 * offset if offset >= 0 else -2 * offset - 1))

    def simulate(self, tick: int) -> None:
        device = self.path.device_tick(tick)
        if device is not None:
            self.reached = device

    def poll(self, now: int) -> Iterator[bytes]:
        self.lose_pieces(now)
        first = next((i for i in range(len(self.offered)) if i not in self.pieces_there), len(self.offered))
        for index in range(first, min(first + WINDOW, len(self.offered))):
            if index not in self.pieces_there | self.in_flight and not self.live:
                self.in_flight.add(index)
                self.carries[self.next] = index
                yield self.write(now, [part(PIECE, varint(index) + self.offered[index])])
        if self.ack_due is not None and now >= self.ack_due:
            yield self.write(now, [])


# ---- Section 3: one client ------------------------------------------------------------------------------------------
class Connection:
    def __init__(self, peer: int, client: int, role: int, nonce: int, limits: tuple[int, int]):
        self.peer, self.client, self.role, self.nonce, self.limits = peer, client, role, nonce, limits
        self.validated = self.repeats_welcome = self.outdated = False
        self.faults = 0                                     # datagrams that broke a rule
        self.epoch: ServedEpoch
        self.token = 0                                      # the first epoch
        self.serial = self.welcome_at = 0

    def begin(self, server: Server, epoch: int, now: int) -> None:
        self.serial += 1 if self.validated else 0
        self.repeats_welcome, self.outdated = self.validated, False
        self.welcome_at = now
        self.epoch = ServedEpoch(epoch, self.client, self.serial, len(server.declaration), fnv1a(server.declaration), server.start)
        self.token = self.token or epoch
        self.epoch.scene, self.epoch.heard_at = server.scene, now
        self.epoch.offer(server.declaration, self.role == 1)

    def welcome(self) -> bytes:
        e = self.epoch
        body = head(HANDSHAKE, WELCOME) + struct.pack("<Q", self.nonce) + varint(e.serial) + struct.pack("<QH", e.epoch, e.client)
        return sealed(body + varint(e.size) + struct.pack("<Q", e.digest) + varint(e.start) + bytes(8), 0, DOWN)

    def state(self) -> str:
        return "live" if self.epoch.live else "receiving"


class Server:
    """`epochs` gives the epochs of clients, one after the other."""

    def __init__(self, declaration: bytes, clients: int, epochs: Iterator[int], now: int):
        self.connections: list[Optional[Connection]] = [None] * clients
        self.epochs = epochs
        self.outbox: list[tuple[int, bytes]] = []
        self.closed: dict[int, Connection] = {}               # by number: their leaves are not sent yet
        self.left: list[tuple[int, int]] = []
        self.serve(declaration, now)

    def serve(self, declaration: bytes, now: int) -> None:
        self.declaration, self.start = declaration, now
        self.scene, _ = read_declaration(declaration)

    def there(self) -> list[Connection]:
        return [c for c in self.connections if c]

    def replace(self, declaration: bytes, now: int) -> None:
        self.serve(declaration, now)
        for c in self.there():
            if not self.fits(c.limits):
                self.end(c, TOO_LARGE, notifies=True)
            elif c.validated:
                c.begin(self, next(self.epochs), now)
            else:
                c.outdated = True

    def end(self, c: Connection, reason: int, notifies: bool) -> None:
        self.connections[c.client] = None
        self.left.append((c.client, reason))
        if notifies and c.validated:
            self.closed[c.client] = c
            self.outbox += [(c.peer, sealed(head(HANDSHAKE, LEAVE) + bytes([reason]), c.epoch.epoch, DOWN))] * 3

    def let_go(self, client: int, reason: int) -> None:
        if self.connections[client]:
            self.end(self.connections[client], reason, notifies=True)

    def handle(self, now: int, peer: int, datagram: bytes) -> None:
        """Raises StreamError if the datagram is dropped."""
        form, value = (datagram[0] & 3, struct.unpack("<H", datagram[:2])[0] >> 2) if len(datagram) > 1 else (0, 0)
        before = form == HANDSHAKE and value < LEAVE        # any epoch
        c = next((c for c in self.there() if c.peer == peer), None)
        if before or not c or not is_of_epoch(datagram, c.epoch.epoch, UP):
            require(before and is_of_epoch(datagram, 0, UP), "checksum", "R-SES-1")
            require(value == JOIN, "invalid", "R-SES-2")
            self.join(now, peer, c, Cursor(datagram, 2, len(datagram) - 4))
            return
        try:
            self.handle_own(now, c, datagram, form, value)
        except StreamError as error:
            c.faults += error.rule not in ("R-SES-4", "R-SES-6")
            if c.faults == MOST_FAULTS:
                self.end(c, PROTOCOL, notifies=True)
            raise

    def handle_own(self, now: int, c: Connection, datagram: bytes, form: int, value: int) -> None:
        """A datagram of the epoch of this session."""
        if form == HANDSHAKE or form > PACKET:
            require(form == HANDSHAKE and value == LEAVE, "invalid", "R-SES-2")
            reason = reason_of(Cursor(datagram, 2, len(datagram) - 4))
            c.validated = True
            self.end(c, reason, notifies=False)
            return
        try:
            c.epoch.take(now, datagram)
        except StreamError as error:
            if error.rule not in ("R-SES-3", "R-SES-5"):    # of these nothing is known
                self.has_spoken(c, now)
            raise
        self.has_spoken(c, now)

    def has_spoken(self, c: Connection, now: int) -> None:
        c.validated, c.repeats_welcome = True, False
        if c.outdated:
            c.begin(self, next(self.epochs), now)

    def join(self, now: int, peer: int, c: Optional[Connection], e: Cursor) -> None:
        whole = e.left() + 2 + 4
        magic, version, role, nonce = e.take(4, CUT), e.number(1, CUT), e.number(1, CUT), e.number(8, CUT)
        require(magic == b"TCTS" and (version != 1 or role < len(ROLES)), "unsupported", "R-SES-9")
        require(whole >= LEAST_JOIN, *CUT)
        if version != 1:
            self.refuse(peer, nonce, WRONG_VERSION)
            return
        token, _ = e.number(8, CUT), e.number(1, CUT)
        state_limit, header_limit = e.varint(CUT, SPARE), e.varint(CUT, SPARE)
        require(not any(e.take(e.left(), CUT)), *SPARE)
        c = self.follow(peer, c, token)
        if c and c.nonce == nonce:
            self.outbox.append((peer, c.welcome()))
            return
        if c:
            self.end(c, BYE, notifies=False)
        c = c or next((self.closed[i] for i in sorted(self.closed) if self.closed[i].peer == peer), None)
        free = [c.client] if c else [i for i, there in enumerate(self.connections) if not there and i not in self.closed]
        if not self.fits((state_limit, header_limit)):
            self.refuse(peer, nonce, TOO_LARGE)
        elif not free:
            self.refuse(peer, nonce, FULL)
        else:
            slot = free[0]
            if self.closed.pop(slot, None):                  # it need not be sent any more
                self.outbox = [item for item in self.outbox if item[0] != peer]
            c = self.connections[slot] = Connection(peer, slot, role, nonce, (state_limit, header_limit))
            c.begin(self, next(self.epochs), now)
            self.outbox.append((peer, c.welcome()))

    def follow(self, peer: int, here: Optional[Connection], token: int) -> Optional[Connection]:
        """The client of this token is at this address now."""
        known = next((k for k in self.there() if k.token == token), None)
        if known is None or known is here:
            return here
        if here:
            self.end(here, BYE, notifies=False)
        known.peer = peer
        return known

    def fits(self, limits: tuple[int, int]) -> bool:
        return state_bytes(self.scene) <= limits[0] and len(self.declaration) <= limits[1]

    def refuse(self, peer: int, nonce: int, reason: int) -> None:
        self.outbox.append((peer, sealed(head(HANDSHAKE, REFUSAL) + struct.pack("<QB", nonce, reason), 0, DOWN)))

    def pass_time(self, now: int) -> None:
        for c in self.there():
            if now >= c.epoch.heard_at + (MOST_SILENCE if c.validated else UNVALIDATED):
                self.end(c, SILENCE, notifies=True)

    def poll(self, now: int) -> Iterator[tuple[int, bytes]]:
        """What is to be sent now, and to whom."""
        yield from self.outbox
        self.outbox, self.closed = [], {}
        for c in self.there():
            if c.repeats_welcome and now >= c.welcome_at:
                c.welcome_at = now + WELCOME_EVERY
                yield c.peer, c.welcome()
            if c.validated:
                for datagram in c.epoch.poll(now):
                    yield c.peer, datagram
