#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A decoder of Tactus files with rigid objects, to show how little it takes:  python3 decoder.py FILE.tct

Prints a line of JSON for every update of an object: tick, object, position [m], rotation (w, x, y, z), velocity [m/s] and angular
velocity [rad/s], all in the world frame. Read it beside the specification in spec/: "40, 3" is section 3 of chapter 40.
Input that breaks a rule is refused with the name of the rule. Deformable objects (chapter 50) and loads (45) are left out, and so are
the rules about names, limits and extension records, which decoding does not need. conformance/decoder.py is complete.
"""
import csv, json, struct, sys, zlib
from math import isqrt
from pathlib import Path

ONE, END_OF_TICKS = 1 << 30, (1 << 32) - 1
TABLE = Path(__file__).resolve().parent.parent / "spec" / "tables" / "rigid-start-models.csv"
START_MODELS = {row["model"]: (int(row["zero"]), int(row["rate"])) for row in csv.DictReader(TABLE.read_text().splitlines())}

class Refused(Exception): pass

def require(kept, rule):
    if not kept: raise Refused(rule)

# ---- Bytes (10, 4), arithmetic (10, 5 and 6) ------------------------------------------------------------------------
class Bytes:
    """Reads data from its start; the rule is broken if it ends too early."""
    def __init__(self, data, rule): self.data, self.rule, self.at = data, rule, 0

    def take(self, size):
        require(self.at + size <= len(self.data), self.rule)
        self.at += size
        return self.data[self.at - size:self.at]

    def numbers(self, layout): return struct.unpack("<" + layout, self.take(struct.calcsize("<" + layout)))

    def varint(self, overlong):
        value = 0
        for i in range(10):
            byte, = self.take(1)
            value |= (byte & 127) << 7 * i
            if byte < 128 and value < 1 << 64 and (byte > 0 or i == 0): return value
            require(byte >= 128, overlong)
        raise Refused(overlong)

def clamp(v, lo, hi): return max(lo, min(v, hi))
def sat32(v): return clamp(v, -1 << 31, (1 << 31) - 1)
def round_shift(v, n): return v + (1 << n >> 1) >> n
def round_div(a, b): return (a + b // 2) // b
def unit30(v): return clamp(round_shift(v, 30), -ONE, ONE)

def sin30(t):
    quadrant, x = t >> 30 & 3, t % ONE
    x = ONE - x if quadrant & 1 else x
    s, total = round_shift(x * x, 30), -3670
    for c in 172032, -5026852, 85569264, -693598663, 1686629713: total = c + round_shift(total * s, 30)
    return round_shift(total * x, 30) * (-1 if quadrant >= 2 else 1)

def turned(q, p):
    """renorm(mul(q, p)): the rotation p, followed by q."""
    (a, b, c, d), (w, x, y, z) = q, p
    r = [unit30(v) for v in (a * w - b * x - c * y - d * z, a * x + b * w + c * z - d * y,
                             a * y - b * z + c * w + d * x, a * z + b * y - c * x + d * w)]
    f = 3 * ONE - round_shift(sum(v * v for v in r), 30) >> 1
    return tuple(unit30(v * f) for v in r)

# ---- Range decoder (30) ---------------------------------------------------------------------------------------------
class Payload:
    def __init__(self, data):
        self.data, self.models, self.position = data, dict(START_MODELS), 4
        self.range, self.code = (1 << 32) - 1, int.from_bytes(data[:4].ljust(4, b"\0"), "big")

    def narrow(self, low, size):
        self.code, self.range = self.code - low, size
        while self.range < 1 << 24:
            byte = self.data[self.position] if self.position < len(self.data) else 0
            self.code, self.range, self.position = self.code << 8 | byte, self.range << 8, self.position + 1

    def bit(self, name):                                    # 30, 2
        zero, rate = self.models[name]
        bound = (self.range >> 15) * zero
        value = self.code >= bound
        self.models[name] = zero - (zero >> rate) if value else zero + (32768 - zero >> rate), min(rate + 1, 6)
        self.narrow(*(bound, self.range - bound) if value else (0, bound))
        return int(value)

    def raw(self, n):                                       # 30, 3
        step, last = self.range >> n, (1 << n) - 1
        value = min(self.code // step, last)
        self.narrow(value * step, self.range - value * step if value == last else step)
        return value

    def tree(self, name, n):                                # 30, 4
        node = 1
        for _ in range(n): node = 2 * node + self.bit(f"{name}[{node}]")
        return node - (1 << n)

    def magnitude(self, name):
        width = self.tree(name, 4)
        if width == 15: width += self.raw(5)
        require(width <= 32, "R-RNG-4")
        value, left = min(width, 1), width - 1
        while left > 0:
            n = min(left, 16)
            value, left = value << n | self.raw(n), left - n
        return value

    def signed(self, name, sign=None, like=0):              # signed_like with a `like` that is not 0
        m = self.magnitude(name)
        negative = m > 0 and (self.bit(sign) != (like < 0) if like else self.raw(1))
        require(m < 1 << 31, "R-RNG-4")
        return -m if negative else m

# ---- Scene declaration (20) -----------------------------------------------------------------------------------------
class Scene:
    def __init__(self, file):
        require(file.data[:4] == b"\x89TCT", "R-STR-1")
        version, profile, flags, body_size = file.numbers("4xBBHI")
        require(version == 2, "R-STR-2")
        require(profile == 0, "R-STR-3")
        require(flags <= 127, "R-STR-4")
        body = Bytes(file.take(body_size), "R-STR-5")
        require((zlib.crc32(file.data[:file.at]),) == file.numbers("I"), "R-STR-15")
        (self.tick_rate, self.position_exp, velocity_exp, self.rotation_exp, self.angular_exp, self.max_extrapolation,
         self.baseline_span) = body.numbers("IBBBBHB")
        object_count = body.varint("R-STR-5")
        self.exponents = self.position_exp, 30, velocity_exp, self.angular_exp          # of what a state holds
        self.linear, self.angular = self.position_exp - velocity_exp, self.rotation_exp - self.angular_exp
        require(1 <= self.tick_rate <= 1000000, "R-STR-6")
        require(8 <= self.position_exp <= 30 and 0 <= self.linear <= 12 and 8 <= self.rotation_exp <= 28
                and 0 <= self.angular <= 12 and self.angular_exp <= 20, "R-STR-7")
        require(self.max_extrapolation >= 1, "R-STR-8")
        require(1 <= self.baseline_span <= 64, "R-STR-9")
        require(32 * object_count <= len(body.data) - body.at, "R-STR-5")
        self.names, self.dof, self.initial = [], [], []     # a state: tick, position, rotation, velocities, smoothing_exp and retained
        for _ in range(object_count): self.add_object(body)
        self.smoothed = flags == 4
        require(flags in (0, 4), "deformable objects (50), loads (45), motion constants (40, 4), driven objects (42) and interest (44) are left out here")
        self.moving = [i for i, dof in enumerate(self.dof) if dof]

    def add_object(self, body):                             # 20, 3
        require(body.numbers("B") == (1,), "R-STR-10")
        dof, name_size = body.numbers("BB")
        self.names.append(body.take(name_size).decode("utf-8", "replace"))
        pose = body.numbers("7i")
        position, rotation = pose[:3], pose[3:]
        require(dof >> 3 in (0, 1, 2, 4, 7), "R-STR-12")
        require(max(map(abs, rotation)) <= ONE and abs(sum(c * c for c in rotation) - ONE * ONE) <= 1 << 41, "R-STR-13")
        self.dof.append(dof)
        self.initial.append((0, position, rotation, (0, 0, 0), (0, 0, 0), (0, 0)))

# ---- Rigid objects (40) ---------------------------------------------------------------------------------------------
def residual(payload, dof, reason):                         # 40, 3
    r = [[0, 0, 0] for _ in range(4)]
    for k in range(2):
        (pose, motion), axes, largest = r[2 * k:2 * k + 2], [a for a in range(3) if dof >> 3 * k + a & 1], 0
        for a in axes:
            context = reason if a == axes[0] else 4 + min(largest.bit_length(), 7)
            pose[a] = payload.signed(f"POSE[{k}][{context}]")
            largest = max(largest, abs(pose[a]))
        largest = 0
        for a in axes:
            size, near = (0, 1, 1, 2, 2, 2, 3)[min(largest.bit_length(), 6)], (0, 1, 2, 2, 3, 3, 4)[min(abs(pose[a]).bit_length(), 6)]
            context = near if a == axes[0] else 5 + 5 * size + near
            motion[a] = payload.signed(f"MOTION[{k}][{context}]", f"SIGN[{k}][{reason}][1]", pose[a])
            largest = max(largest, abs(motion[a]))
    return r

def predict(scene, state, t):                               # 40, 4
    tick, position, rotation, velocity, o, _ = state
    dt = min(t - tick, scene.max_extrapolation)
    x = [sat32(p + round_div(v * dt << scene.linear, scene.tick_rate)) for p, v in zip(position, velocity)]
    speed = isqrt(sum(c * c for c in o) << 10)
    angle = round_div(speed * dt, scene.tick_rate)
    half = (angle * 341782638 + (1 << scene.angular_exp + 4) >> scene.angular_exp + 5) % (1 << 32)
    if half == 0: return x, rotation
    step = [round_shift(round_div(c << 35, speed) * sin30(half), 30) for c in o]
    return x, turned((sin30(half + ONE), *step), rotation)

def update(scene, base, t, reason, level, smoothed, r):        # 40, 5
    p, rotation = predict(scene, base, t)
    tick, _, _, v, o, _ = base
    s, dt, axes, length = level, t - tick, range(3), 1 << scene.rotation_exp
    e, m = [sat32(c << s) for c in r[0]], [c << s for c in r[2]]
    n = sum(c * c for c in m)
    require(n <= length * length, "R-RIG-6")
    if n > 0:
        k = min(30, 60 - 2 * scene.rotation_exp)
        d = length * length + n >> 30 - k
        rotation = turned((round_div(length * length - n << k, d), *(round_div(2 * length * c << k, d) for c in m)), rotation)
    if reason == 3 and dt > 0:                              # haptic
        v = [sat32(v[a] + round_div(3 * e[a] * scene.tick_rate, 2 * dt << scene.linear)) for a in axes]
        o = [sat32(o[a] + round_div(6 * m[a] * scene.tick_rate, dt << scene.angular)) for a in axes]
    return (t, [sat32(p[a] + (r[0][a] << s)) for a in axes], rotation,
            [sat32(round_shift(v[a], s) + r[1][a] << s) for a in axes],
            [clamp(round_shift(o[a], s) + r[3][a] << s, -1 << 25, 1 << 25) for a in axes], smoothed)

class Decoder:
    """Turns packets into states (25, 5; 40, 2). Substream 0 is the only one of a scene without deformable objects."""
    def __init__(self, scene): self.scene, self.tick, self.states, self.newest, self.kept = scene, 0, scene.initial, None, {}

    def decode(self, number, packet):
        """Returns which objects were updated."""
        scene, moving, several = self.scene, self.scene.moving, len(self.scene.moving) > 1
        reordered = self.newest is not None and number <= self.newest
        require(not reordered or (number > min(self.kept) and number not in self.kept), "R-PKT-5")
        payload = Payload(packet)
        key = payload.bit("KEY[1]")
        baseline_delta = payload.magnitude("BASELINE") if not key and scene.baseline_span > 1 else 1
        tick_delta = payload.magnitude("TICK")
        count = payload.magnitude("COUNT") if several else 1
        require(1 <= baseline_delta <= (4095 if scene.baseline_span > 1 else 1), "R-PKT-3")
        require(key or number - baseline_delta in self.kept, "R-PKT-4")
        base_tick, states = (0, scene.initial) if key else self.kept[number - baseline_delta]
        tick, states, named, i = base_tick + tick_delta, list(states), [], -1
        require(tick < END_OF_TICKS and (tick <= self.tick if reordered else tick >= self.tick), "R-RIG-1")
        require(1 <= count <= len(moving), "R-RIG-3")
        for _ in range(count):
            i += 1 + (payload.magnitude("GAP") if several else 0)
            require(i < len(moving), "R-RIG-4")
            reason, level = payload.tree("REASON", 2), payload.tree("LEVEL", 4)
            usual = max(0, min(scene.tick_rate // 62, 255).bit_length() - 1)
            smoothing_exp = (usual - payload.tree("SMOOTHING_EXP", 3)) % 8 if scene.smoothed else 0          # for a client (60, 8), which is left out
            retained = payload.tree("RETAINED", 2) if smoothing_exp else 0
            r = residual(payload, scene.dof[moving[i]], reason)
            states[moving[i]] = update(scene, states[moving[i]], tick, reason, level, (smoothing_exp, retained), r)
            named.append(moving[i])
        require(len(payload.data) <= payload.position, "R-RNG-2")
        require(payload.data[-1:] != b"\0", "R-RNG-3")
        self.kept[number] = (tick, states)
        if len(self.kept) > scene.baseline_span: del self.kept[min(self.kept)]
        if not reordered: self.tick, self.states, self.newest = tick, states, number
        return named

# ---- File (80) ------------------------------------------------------------------------------------------------------
def updates(data):
    """Yields for each packet of a file the decoder, whose states are those after it, and the objects that were updated."""
    file, tick, number, packets = Bytes(data, "R-STR-5"), 0, 0, None
    decoder = Decoder(Scene(file))
    file.rule = "R-FIL-2"
    while file.at < len(data):
        start, kind, size = file.at, file.take(1)[0], file.varint("R-FIL-6")
        require(kind in (1, 2, 3, 4) or kind >= 128, "R-FIL-3")
        if kind in (1, 4):                                  # packets, counted or with their numbers
            require(packets in (None, kind), "R-FIL-9")
            packets = kind
        require(kind != 3 or size == 8, "R-FIL-6")
        record = Bytes(file.take(size), "R-FIL-6")
        require((zlib.crc32(data[start:file.at]),) == file.numbers("I"), "R-FIL-5")
        if kind == packets:
            tick += record.varint("R-FIL-6")
            number = record.varint("R-FIL-6") if kind == 4 else number + 1
            require(tick < END_OF_TICKS and 1 <= number < 1 << 62, "R-FIL-6")
            named = decoder.decode(number, record.data[record.at:])
            require(decoder.tick == tick, "R-FIL-7")
            yield decoder, named
        require(kind != 3 or file.at == len(data), "R-FIL-8")

def in_units(scene, i, state):                              # 20, 2
    vectors = [[c * 2.0 ** -exponent for c in vector] for vector, exponent in zip(state[1:], scene.exponents)]
    names = "tick", "object", "position", "rotation", "velocity", "angular_velocity"
    return dict(zip(names, (state[0], scene.names[i], *vectors)))

if __name__ == "__main__":
    if len(sys.argv) != 2: sys.exit("usage: decoder.py FILE.tct")
    try:
        for decoder, named in updates(Path(sys.argv[1]).read_bytes()):
            for i in named: print(json.dumps(in_units(decoder.scene, i, decoder.states[i])))
    except Refused as refused:
        sys.exit(f"refused: {refused}")
