# SPDX-License-Identifier: Apache-2.0
"""Chapter 70 of the specification: epochs and the client's end, as functions of datagrams and time. No socket, no clock."""
from __future__ import annotations

import struct
from typing import Callable, Iterator, Optional

from conventions import Cursor, StreamError, fnv1a, require
from datagram import (UP, DOWN, HANDSHAKE, PARTS, PACKET, JOIN, WELCOME, REFUSAL, LEAVE, ACK, CLOCK, BUTTONS, PIECE, STATE, HASH, FRAGMENT,
                      PACKET_PART, REPORT, TICK_MAPPING, SEAT, BASELINES, BYE, TOO_LARGE, SILENCE, NO_SCENE, NO_TIMING, END_OF_TIME, CUT, SPARE,
                      sealed, is_of_epoch, head, varint, part, reason_of, read_parts)
from deformable_decoder import DeformableDecoder
from device_path import DevicePath, device_scene
from rigid import RigidDecoder
from scene import THESIS, Declaration, Limits, read_declaration
from scene_decoder import SceneDecoder

PREVIOUS = 0                                                # policies of baselines
MOST_HELD, BYTES_HELD, LONGEST_HELD = 1024, 1 << 16, 2_000_000
ACK_RIDES_ON = {UP: (BUTTONS, STATE), DOWN: (PIECE, TICK_MAPPING, SEAT)}   # an acknowledgement rides on these, due or not
MOST_UNREPORTED = 32                                        # numbers that are accepted until an acknowledgement is due at once
PIECE_SIZE, WINDOW, WINDOW_PER_PIECE, LARGEST_WINDOW = 1024, 64, 16, 1024
FRAGMENT_SIZE, MOST_FRAGMENTS, MOST_IN_PIECES = 1150, 1024, 32
REMEMBERED = 1024                                           # own numbers
MS = 1000                                                   # us
MOST_SILENCE, MOST_JOINING, FIRST_ANSWER = 120_000 * MS, 10_000 * MS, 250 * MS
STATE_LIMIT, HEADER_LIMIT = 1 << 28, 1 << 20                # bytes


def trunc(a: int, b: int) -> int:
    """a / b, rounded toward 0."""
    return a // b if a >= 0 else -(-a // b)


def largest_rigid(scene: Declaration) -> int:
    return 64 + (296 if scene.driven else 208) * len(scene.moving())


def largest_deformable(item) -> int:
    if item.profile == THESIS:
        return 96 + (17 + 6 * item.quant_bits) * len(item.rest)
    return 112 + 16 * item.mode_count + 40 * len(item.rest)


def largest_packet(scene: Declaration) -> int:
    """Section 5: bytes that a packet of this scene may have, the number of its substream among them."""
    moving, users = len(scene.moving()), scene.loads.users if scene.loads else 0
    most = [largest_rigid(scene) if moving else 0, 64 + (112 + 48 * users) * moving if scene.loads else 0]
    return 1 + max(most + [largest_deformable(item) for item in scene.deformables])


def may_chain(scene: Declaration, substream: int) -> bool:
    """Section 4.4: under the policy previous its packets build on the one before."""
    if not 1 <= substream <= len(scene.deformables):
        return substream == 0
    item = scene.deformables[substream - 1]
    return item.profile != THESIS and not item.layered


def largest_chained(scene: Declaration) -> int:
    has_rigid = scene.moving() or not scene.deformables
    return 1 + max([largest_rigid(scene) if has_rigid else 0] +
                   [largest_deformable(item) for i, item in enumerate(scene.deformables, 1) if may_chain(scene, i)])


# ---- Sections 4 to 6: one end of an epoch ---------------------------------------------------------------------------
class Epoch:
    direction, ack_delay = UP, 10 * MS                       # of what it sends; until an acknowledgement is due

    def __init__(self, epoch: int, client: int, serial: int, size: int, digest: int, start: int):
        self.epoch, self.client, self.serial, self.start = epoch, client, serial, start
        self.size, self.digest = size, digest
        self.pieces: dict[int, bytes] = {}
        self.scene: Optional[Declaration] = None
        self.decoders: Optional[SceneDecoder] = None
        self.newest, self.received = 0, set()               # numbers of datagrams, down
        self.heard_at = 0                                   # when the newest came
        self.accepted: dict[int, int] = {}                  # when each came
        self.ack_due: Optional[int] = None
        self.unreported = 0                                 # accepted since the last acknowledgement
        self.next, self.acknowledged = 1, 0                 # own numbers
        self.sent_at: dict[int, int] = {}
        self.arrived: set[int] = set()                      # own numbers that were acknowledged
        self.eliciting, self.progress_at = 0, 0             # own number; when one was acknowledged, or the first ack-eliciting one went
        self.eliciting_at = self.last_sent = 0              # when an ack-eliciting one went, and any
        self.round_trip: Optional[tuple[int, int]] = None   # smoothed, variation
        self.largest = 0                                    # packet; 0: there is no scene yet
        self.fragments: dict[tuple, dict] = {}
        self.hash: Optional[bytes] = None
        self.packets = self.shapes = 0                      # decoded; of deformable objects
        self.packet_at = -10 ** 9                           # when the last was
        self.policy = PREVIOUS
        # Packets of chains that miss their baseline, by number and substream: when they came.
        self.held: dict[tuple[int, int], tuple[int, bytes]] = {}
        self.path: Optional[DevicePath] = None              # of the device, where it moves objects
        self.limits = Limits()                              # of the declaration
        self.own: Optional[RigidDecoder] = None             # its packets

    def extend(self, value: int) -> int:
        number = self.newest + (value + 12287 - self.newest) % (1 << 14) - 12287
        require(number >= 1 and number > self.newest - 1024 and number not in self.received, "state", "R-SES-4")
        return number

    def take(self, now: int, datagram: bytes) -> None:
        """A numbered datagram whose check holds."""
        body = datagram[:-4]
        form, value = body[0] & 3, struct.unpack("<H", body[:2])[0] >> 2
        decoded, shapes = self.packets, self.shapes
        parts = [(PACKET_PART, (0, body[2:]))] if form == PACKET else list(read_parts(body, 1 - self.direction))
        number = self.extend(value)
        self.received.add(number)
        if number > self.newest:
            self.newest, self.heard_at = number, now
        self.received = {n for n in self.received if n > self.newest - 1024}
        complete = True
        for kind, elements in parts:
            complete &= self.take_part(now, number, kind, elements)
        if self.packets > decoded:
            self.packet_at = now
        if complete:
            self.accept(now, number, parts, self.shapes > shapes)

    def take_part(self, now: int, number: int, kind: int, elements: tuple) -> bool:
        if kind == ACK:
            newest, held, _ = elements
            back = (self.next - 1 - newest) % (1 << 16)
            require(back < 4096 and back < self.next - 1, "invalid", "R-SES-6")
            self.take_acknowledged(now, self.next - 1 - back, held, elements[2])
        elif kind == PIECE and self.direction == UP:
            self.take_piece(*elements)
        elif kind == FRAGMENT:
            return self.take_fragment(now, number, *elements)
        elif kind == PACKET_PART:
            back, packet = elements
            return self.decode(now, number - back, packet)
        elif kind == BASELINES and self.direction == UP:
            self.policy = elements[0]
        elif kind == TICK_MAPPING and self.direction == UP:
            self.take_mapping(*elements)
        else:
            self.take_received(kind, elements)
        return True

    def measure(self, sample: int) -> None:
        """Section 7."""
        smoothed, variation = self.round_trip or (sample, sample // 2)
        if self.round_trip:
            smoothed, variation = smoothed + trunc(sample - smoothed, 8), variation + trunc(abs(smoothed - sample) - variation, 4)
        self.round_trip = smoothed, variation

    def ack_timeout(self) -> int:
        return self.round_trip[0] + 4 * self.round_trip[1] + 25 * MS if self.round_trip else FIRST_ANSWER

    def take_acknowledged(self, now: int, newest: int, held: int, missing: int) -> None:
        """An acknowledgement of own numbers."""
        if held != NO_TIMING and newest not in self.arrived and newest > self.next - 1 - REMEMBERED:
            self.measure(max(0, now - self.sent_at[newest] - 16 * held))
        numbers = {newest} | {newest - 1 - i for i in range(64) if not missing >> i & 1 and newest - 1 - i > 0}
        if any(n not in self.arrived and n > self.next - 1 - REMEMBERED for n in numbers):
            self.progress_at = now
        self.arrived |= numbers
        self.acknowledged = max(self.acknowledged, newest)
        if self.direction == UP and self.path:              # which packets of the device take effect
            self.path.acknowledge(numbers)

    def take_mapping(self, begin: int, offset: int) -> None:
        if self.path:
            self.path.begin(begin, offset)

    def drives(self) -> None:
        """A device whose packets go up moves objects."""
        self.path = DevicePath(device_scene(self.scene))
        self.own = RigidDecoder(self.path.scene)

    def keep_device(self, number: int, packet: bytes) -> None:
        self.path.add(number, self.own.decode(number, packet).moment.states[0])

    def take_received(self, kind: int, elements: tuple) -> None:
        """What comes up only."""

    def take_piece(self, index: int, data: bytes) -> None:
        front = next(i for i in range(self.size // PIECE_SIZE + 2) if i not in self.pieces)
        window = min(WINDOW + WINDOW_PER_PIECE * len(self.pieces), LARGEST_WINDOW)
        inside = index * PIECE_SIZE < self.size and index < front + window
        require(inside and len(data) == min(PIECE_SIZE, self.size - index * PIECE_SIZE), "invalid", "R-SES-8")
        self.pieces.setdefault(index, data)

    def begin(self) -> bool:
        """The scene, once all pieces are there."""
        if self.scene or sum(map(len, self.pieces.values())) < self.size:
            return False
        declaration = b"".join(self.pieces[i] for i in sorted(self.pieces))
        require(fnv1a(declaration) == self.digest, "checksum", "R-SES-10")
        self.scene, _ = read_declaration(declaration, self.limits)
        self.decoders = SceneDecoder(self.scene)
        self.largest = largest_packet(self.scene)
        return True

    def take_fragment(self, now: int, number: int, back: int, substream: int, index: int, count: int, data: bytes) -> bool:
        sound = 2 <= count <= MOST_FRAGMENTS and index < count and back < number and 0 < len(data) <= FRAGMENT_SIZE
        fits = FRAGMENT_SIZE < self.largest and index * FRAGMENT_SIZE + len(data) <= self.largest
        require(sound and fits and (index == count - 1 or len(data) == FRAGMENT_SIZE), "invalid", "R-SES-7")
        name = number - back, substream
        have = self.fragments.setdefault(name, {"count": count, "data": {}, "decoded": None})
        if len(self.fragments) > MOST_IN_PIECES:
            del self.fragments[min(self.fragments)]
            if name not in self.fragments:
                return False                                # older than all
        require(have["count"] == count, "invalid", "R-SES-7")
        have["data"].setdefault(index, data)
        if len(have["data"]) < count:
            return True
        if not have["decoded"]:
            have["decoded"] = self.decode(now, number - back, b"".join(have["data"][i] for i in range(count)))
            if not have["decoded"]:
                del have["data"][index]                     # as if it had never come
        return have["decoded"]

    def decode(self, now: int, number: int, packet: bytes) -> bool:
        if number < 1 or not self.decoders:
            return False
        try:
            if not self.push(number, packet):
                return True                                 # it came before
        except StreamError as error:
            return self.hold(now, number, packet, error)
        for name, (_, waiting) in sorted(self.held.items()):  # each may be the baseline of the next
            if name in self.held:
                self.retry(name, waiting)
        return True

    def retry(self, name: tuple[int, int], packet: bytes) -> None:
        """One that is held stays while its baseline is missing; a broken one goes."""
        try:
            self.push(name[0], packet)
        except StreamError as error:
            if error.errc != "state":
                del self.held[name]

    def push(self, number: int, packet: bytes) -> bool:
        """False: it was decoded before."""
        substream, payload = self.decoders.split(packet)
        decoder = self.decoders.substreams[substream]
        if number in decoder.receiver.kept:
            return False
        decoder.decode(number, payload)
        self.packets += 1
        self.shapes += isinstance(decoder, DeformableDecoder)
        layered = isinstance(decoder, DeformableDecoder) and self.scene.deformables[substream - 1].layered
        if number % 64 == 0 and number == decoder.receiver.newest and not layered:
            self.hash = struct.pack("<BHI", substream, number % (1 << 16), decoder.state_hash() % (1 << 32))
        self.held = {name: of for name, of in self.held.items() if name[1] != substream or name[0] > decoder.receiver.newest}
        return True

    def hold(self, now: int, number: int, packet: bytes, error: StreamError) -> bool:
        """Section 4.4: a packet of a chain waits for its baseline."""
        if self.direction == DOWN or self.policy != PREVIOUS or error.errc != "state":
            return False
        substream = self.decoders.split(packet)[0]
        if not may_chain(self.scene, substream):
            return False
        if number <= self.decoders.substreams[substream].receiver.newest:
            return True                                     # no use any more
        self.held = {name: of for name, of in self.held.items() if now <= of[0] + LONGEST_HELD}
        if (number, substream) in self.held:
            return True                                     # here already
        room = max(BYTES_HELD, largest_chained(self.scene))
        if len(self.held) == MOST_HELD or sum(len(p) for _, p in self.held.values()) + len(packet) > room:
            return False
        self.held[number, substream] = now, packet
        return True

    def report(self, now: int) -> bytes:
        """The playout delay, 0 as nothing is shown here, and whether a key packet is needed."""
        is_stuck = any(at + max(500 * MS, 4 * self.ack_timeout()) < now <= at + LONGEST_HELD for at, _ in self.held.values())
        return part(REPORT, varint(0) + bytes([is_stuck]))

    def accept(self, now: int, number: int, parts: list[tuple], urgent: bool) -> None:
        self.accepted[number] = now
        self.unreported += 1
        full = self.unreported >= MOST_UNREPORTED
        if not full and all(kind in (ACK, CLOCK) or kind > PACKET_PART for kind, _ in parts):
            return
        urgent = full or urgent or any(kind == STATE and not self.was_driving for kind, _ in parts)
        due = now if urgent else self.wait_from(now)
        self.ack_due = due if self.ack_due is None else min(self.ack_due, due)

    was_driving = False                                     # at the server: the client was live before this datagram, in a scene with paths

    def wait_from(self, now: int) -> int:
        """When an acknowledgement of something ack-eliciting now is due."""
        return now + self.ack_delay

    def acknowledgement(self, now: int) -> bytes:
        newest = max(self.accepted)
        held = min((now - self.accepted[newest]) // 16, NO_TIMING)
        missing = sum(1 << i for i in range(64) if newest - 1 - i > 0 and newest - 1 - i not in self.accepted)
        self.accepted = {n: at for n, at in self.accepted.items() if n > newest - 1024}
        self.ack_due, self.unreported = None, 0
        return part(ACK, struct.pack("<HH", newest % (1 << 16), held) + varint(missing))

    def unanswered(self) -> Optional[int]:
        """Since when an answer is missing."""
        return self.progress_at if self.eliciting > self.acknowledged else None

    def next_send(self, wanted: int) -> int:
        """Section 9: an end sends little while nothing is acknowledged for long."""
        if self.unanswered() is None or wanted <= self.progress_at + max(1000 * MS, 4 * self.ack_timeout()):
            return wanted
        return max(wanted, self.last_sent + max(50 * MS, (max(self.last_sent, self.progress_at) - self.progress_at) // 1024))

    def write(self, now: int, parts: list[bytes], packet: bytes = b"") -> Optional[bytes]:
        """A numbered datagram of these parts and a packet of its own number, with an acknowledgement if one rides on it."""
        if self.next - 4096 > self.acknowledged:
            return None
        if packet or any(p[0] != HASH for p in parts):      # it waits for an answer
            self.progress_at = self.progress_at if self.unanswered() is not None else now
            self.eliciting, self.eliciting_at = self.next, now
        self.last_sent = now
        if self.ack_due is not None or self.accepted and any(p[0] in ACK_RIDES_ON[self.direction] for p in parts):
            parts = [self.acknowledgement(now)] + parts
        if packet and parts:
            parts = parts + [part(PACKET_PART, varint(0) + packet)]
        form = PARTS if parts else PACKET
        self.sent_at[self.next] = now
        datagram = sealed(head(form, self.next % (1 << 14)) + (b"".join(parts) or packet), self.epoch, self.direction)
        self.next += 1
        return datagram


# ---- Section 3: the client ------------------------------------------------------------------------------------------
class Client:
    """State is closed, joining, receiving or live. `device(number)` gives the packet of the device for a datagram of that number."""

    def __init__(self, nonce: int, device: Optional[Callable[[int], bytes]] = None, token: int = 0, now: int = 0,
                 limits: Limits = Limits()):
        self.nonce, self.device, self.opened_at, self.limits = nonce, device, now, limits
        self.state, self.reason = "joining", 0
        self.leaving = b""
        self.epoch: Optional[Epoch] = None
        self.token, self.seat = token, 0
        self.retry_at, self.retry = 0, 100 * MS
        self.rejoins = False                                # in this silence
        self.keep_alive_at = self.device_at = 0                   # of the last keep-alive, 0: none yet; of the next packet
        self.packet_at = -10 ** 9                           # when the last packet was decoded
        self.first_live: Optional[int] = None               # number of the first datagram that reported it

    def handle(self, now: int, datagram: bytes) -> None:
        """Raises StreamError if the datagram is dropped."""
        form, value = (datagram[0] & 3, struct.unpack("<H", datagram[:2])[0] >> 2) if len(datagram) > 1 else (0, 0)
        before = form == HANDSHAKE and value < LEAVE        # any epoch
        require(before or self.state in ("receiving", "live"), "checksum", "R-SES-1")
        require(is_of_epoch(datagram, 0 if before else self.epoch.epoch), "checksum", "R-SES-1")
        if form in (PARTS, PACKET):
            self.epoch.take(now, datagram)
            self.packet_at = max(self.packet_at, self.epoch.packet_at)
            self.rejoins = self.rejoins and self.epoch.unanswered() is not None
            self.begin()
            return
        require(form == HANDSHAKE and value in (WELCOME, REFUSAL, LEAVE), "invalid", "R-SES-2")
        e = Cursor(datagram, 2, len(datagram) - 4)
        if value == WELCOME:
            self.welcomed(now, e)
            return
        nonce = e.number(8, CUT) if value == REFUSAL else self.nonce
        reason = reason_of(e)
        if nonce == self.nonce and (value == LEAVE or self.state == "joining"):
            self.state, self.reason = "closed", reason

    def welcomed(self, now: int, e: Cursor) -> None:
        nonce, serial, epoch, client = e.number(8, CUT), e.varint(CUT, SPARE), e.number(8, CUT), e.number(2, CUT)
        size, digest, start, _ = e.varint(CUT, SPARE), e.number(8, CUT), e.varint(CUT, SPARE), e.number(8, CUT)
        require(start < END_OF_TIME and e.left() == 0, *SPARE)
        anew = self.rejoins and serial == 0 and epoch != self.token
        again = self.state != "joining" and self.epoch and serial <= self.epoch.serial and not anew
        if nonce != self.nonce or self.state == "closed" or again:
            return
        self.epoch = Epoch(epoch, client, serial, size, digest, start)
        self.epoch.heard_at, self.epoch.limits = now, self.limits
        self.state, self.keep_alive_at, self.first_live, self.rejoins = "receiving", 0, None, False
        self.token = epoch if serial == 0 else self.token
        if size > HEADER_LIMIT:
            self.leave(TOO_LARGE)

    def begin(self) -> None:
        """Live, once the declaration is here; closed, if it cannot be read."""
        if self.state != "receiving":
            return
        try:
            if self.epoch.begin():
                self.state, self.keep_alive_at = "live", 0
                if self.device and self.epoch.scene.follows_devices():
                    self.epoch.drives()
        except StreamError as error:
            self.leave(TOO_LARGE if error.errc == "limit_exceeded" else NO_SCENE)
            raise

    def poll(self, now: int) -> Iterator[bytes]:
        """What is to be sent now."""
        if self.leaving:
            yield self.leaving
        self.leaving = b""
        if now >= self.join_at():
            if self.state != "joining" and not self.rejoins:
                self.rejoins, self.retry = True, 250 * MS
            self.retry_at, self.retry = now + self.retry, min((3 if self.state == "joining" else 4) * self.retry // 2, 2000 * MS)
            body = head(HANDSHAKE, JOIN) + b"TCTS" + struct.pack("<BBQQB", 1, 1 if self.device else 0, self.nonce, self.token, self.seat)
            yield sealed((body + varint(STATE_LIMIT) + varint(HEADER_LIMIT)).ljust(76, b"\0"), 0)
        if self.state not in ("receiving", "live"):
            return
        live, parts, packet = self.state == "live", [], b""
        if now >= self.keep_alive_due():
            self.keep_alive_at = now
            if live:
                parts.append(self.epoch.report(now))
            parts.append(part(STATE, bytes([live])))
            self.first_live = self.epoch.next if live and self.first_live is None else self.first_live
        if live and self.device and now >= self.device_at:
            self.device_at = now + 10 * MS
            packet = self.device(self.epoch.next)
            if self.epoch.path:
                self.epoch.keep_device(self.epoch.next, packet)
        due = self.epoch.ack_due is not None and now >= self.epoch.ack_due
        if self.epoch.hash and (parts or packet or due):
            parts.append(part(HASH, self.epoch.hash))
            self.epoch.hash = None
        datagram = self.epoch.write(now, parts, packet) if parts or packet or due else None
        if datagram:
            yield datagram

    def join_at(self) -> float:
        """When the next join goes."""
        if self.state == "joining" or self.rejoins:
            return self.retry_at if self.state != "closed" else float("inf")
        since = self.epoch.unanswered() if self.state in ("receiving", "live") else None
        return float("inf") if since is None else since + max(400 * MS, 2 * self.epoch.ack_timeout())

    def keep_alive_due(self) -> int:
        """When the next keep-alive goes: sections 3.1 and 10."""
        if self.keep_alive_at == 0:
            return 0
        epoch, live = self.epoch, self.state == "live"
        if live and (self.first_live is None or epoch.acknowledged < self.first_live):
            return epoch.next_send(self.keep_alive_at + 50 * MS)
        sent = max(self.keep_alive_at, epoch.eliciting_at)
        served = not live or sent < self.packet_at + 1000 * MS
        pause = (100 if epoch.path else 50) if self.device else 100 if served else 1000
        return epoch.next_send(sent + pause * MS)

    def pass_time(self, now: int) -> None:
        if self.state == "joining" and now >= self.opened_at + MOST_JOINING:
            self.leave(SILENCE)
        elif self.state in ("receiving", "live") and now >= self.epoch.heard_at + MOST_SILENCE:
            self.leave(SILENCE)

    def leave(self, reason: int = BYE) -> None:
        """poll() sends it to the server."""
        if self.state in ("receiving", "live"):
            self.leaving = sealed(head(HANDSHAKE, LEAVE) + bytes([reason]), self.epoch.epoch)
        if self.state != "closed":
            self.state, self.reason = "closed", reason
