# SPDX-License-Identifier: Apache-2.0
"""Writes recordings as ROS 2 programs do: MCAP without compression, messages in CDR. For tests."""
import math
import struct

SCHEMAS = {"pose": "geometry_msgs/msg/PoseStamped", "twist": "geometry_msgs/msg/TwistStamped", "odometry": "nav_msgs/msg/Odometry",
           "wrench": "geometry_msgs/msg/WrenchStamped", "transform": "geometry_msgs/msg/TransformStamped", "tf": "tf2_msgs/msg/TFMessage",
           "joints": "sensor_msgs/msg/JointState"}
MAGIC = b"\x89MCAP0\r\n"
START = 1_700_000_000.0


def text(value):
    data = value.encode()
    return struct.pack("<I", len(data)) + data


def record(opcode, content):
    return struct.pack("<BQ", opcode, len(content)) + content


def about_z(angle):
    """x, y, z, w"""
    return (0.0, 0.0, math.sin(angle / 2), math.cos(angle / 2))


class Cdr:
    def __init__(self):
        self.body = b""

    def put(self, form, *values):
        size = struct.calcsize("<" + form)
        for value in values:
            self.body += bytes(-len(self.body) % size) + struct.pack("<" + form, value)
        return self

    def text(self, value):
        data = value.encode() + b"\0"
        self.put("I", len(data))
        self.body += data
        return self

    def header(self, stamp, frame):
        nanoseconds = round(stamp * 1e9)
        return self.put("i", nanoseconds // 10**9).put("I", nanoseconds % 10**9).text(frame)

    def bytes(self):
        return b"\0\1\0\0" + self.body


def pose(stamp, frame="world", at=(0, 0, 0), turn=(0, 0, 0, 1)):
    return Cdr().header(stamp, frame).put("d", *at, *turn).bytes()


def twist(stamp, frame="world", linear=(0, 0, 0), angular=(0, 0, 0)):
    return Cdr().header(stamp, frame).put("d", *linear, *angular).bytes()


def wrench(stamp, frame="sensor", force=(0, 0, 0), torque=(0, 0, 0)):
    return Cdr().header(stamp, frame).put("d", *force, *torque).bytes()


def odometry(stamp, frame="odom", child="base", at=(0, 0, 0), turn=(0, 0, 0, 1), linear=(0, 0, 0), angular=(0, 0, 0), covariance=0.0,
             twist_covariance=0.0):
    out = Cdr().header(stamp, frame).text(child).put("d", *at, *turn, *[covariance] * 36, *linear, *angular, *[twist_covariance] * 36)
    return out.bytes()


def put_transform(out, stamp, frame, child, at, turn):
    return out.header(stamp, frame).text(child).put("d", *at, *turn)


def transform(stamp, frame="map", child="tool", at=(0, 0, 0), turn=(0, 0, 0, 1)):
    return put_transform(Cdr(), stamp, frame, child, at, turn).bytes()


def tf(*links):
    """Links are (stamp, frame, child, at, turn)."""
    out = Cdr().put("I", len(links))
    for link in links:
        put_transform(out, *link)
    return out.bytes()


class Bag:
    def __init__(self):
        self.messages, self.channels, self.count = [], [], 0

    def channel(self, topic, kind, encoding="cdr", metadata=b""):
        self.channels.append((topic, SCHEMAS.get(kind, kind), encoding, metadata))
        return len(self.channels)

    def add(self, channel, log, message):
        """Log time in seconds since 1970."""
        self.messages.append((channel, round(log * 1e9), message))

    def write(self, path):
        out = MAGIC + record(1, text("ros2") + text("test"))
        for number, (topic, schema, encoding, metadata) in enumerate(self.channels, 1):
            out += record(3, struct.pack("<H", number) + text(schema) + text("ros2msg") + text(""))
            out += record(4, struct.pack("<HH", number, number) + text(topic) + text(encoding) + text("") + metadata)
        body = [record(5, struct.pack("<HIQQ", channel, 0, log, log) + message) for channel, log, message in self.messages]
        out += b"".join(body) + record(15, struct.pack("<I", 0)) + record(2, struct.pack("<QQI", 0, 0, 0)) + MAGIC
        with open(path, "wb") as file:
            file.write(out)
