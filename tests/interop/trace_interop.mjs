// SPDX-License-Identifier: Apache-2.0
// Trace files against an MCAP library, a zstd and a ROS 2 message library that nobody here wrote, in both directions.
//   node trace_interop.mjs TRACE_TOOL FOLDER
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";
import path from "node:path";
import { McapIndexedReader, McapStreamReader, McapWriter } from "@mcap/core";
import rosmsg from "@foxglove/rosmsg";
import rosmsg2 from "@foxglove/rosmsg2-serialization";
import zstd from "@foxglove/wasm-zstd";

const [tool, folder] = process.argv.slice(2);
const decompressHandlers = { zstd: (data, size) => zstd.decompress(data, Number(size)) };

// ---- they read what we wrote ----

const ticks = 2500; // as in trace_tool.cpp
const number = (tick, slot) => (tick * 1031 + slot * 7 - 5000) / 64;
const vector = (tick, slot) => ({ x: number(tick, slot), y: number(tick, slot + 1), z: number(tick, slot + 2) });
const turns = [[1, 0, 0, 0], [0.5, -0.5, 0.5, 0.5], [0, 0.6, 0, -0.8], [-0.1, 0.7, 0.5, 0.5], [0.28, 0, -0.96, 0]];
const turn = (tick) => {
  const [w, x, y, z] = turns[tick % turns.length];
  return { w, x, y, z };
};
const pose = (tick, slot) => ({ position: vector(tick, slot), orientation: turn(tick) });
const expected = {
  "/objects/cube/pose": (tick) => ({ pose: pose(tick, 0) }),
  "/objects/cube/twist": (tick) => ({ twist: { linear: vector(tick, 7), angular: vector(tick, 10) } }),
  "/objects/floor/pose": (tick) => (tick === 0 ? { pose: { position: vector(0, 100), orientation: turn(1) } } : undefined),
  "/users/hand/device": (tick) => ({ point: vector(tick, 200) }),
  "/users/hand/device_orientation": (tick) => ({ quaternion: turn(tick + 2) }),
  "/users/hand/device_velocity": (tick) => ({ vector: vector(tick, 230) }),
  "/users/hand/device_buttons": (tick) => (tick % 4 === 0 ? { down: (tick / 4) % 4 } : undefined),
  "/users/hand/device_time": (tick) => ({
    time_ref: { sec: Math.floor((tick * 1_000_003) / 1e9), nanosec: (tick * 1_000_003) % 1e9 },
    source: "device",
  }),
  "/users/hand/force": (tick) => ({ vector: vector(tick, 203) }),
  "/users/hand/server_force": (tick) => ({ vector: vector(tick, 206) }),
  "/users/hand/contact": (tick) =>
    tick % 3 === 1
      ? { kind: 2, object_index: 0, object: "cube", point: vector(tick, 209), normal: vector(tick, 212), stiffness: 630 }
      : undefined,
  "/users/hand/mesh_contact": (tick) =>
    tick % 4 === 2
      ? { mesh_index: 0, mesh: "blob", triangle: 3, weights: [0.5, 0.375, 0.125], proxy: vector(tick, 300), normal: vector(tick, 303), stiffness: 20 }
      : undefined,
  "/meshes/blob/rest": (tick) =>
    tick === 0
      ? {
          triangles: [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]].map((corners) => ({ vertex_indices: corners })),
          vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]].map(([x, y, z]) => ({ x, y, z })),
        }
      : undefined,
  "/meshes/blob/displacement": (tick) =>
    tick % 10 === 3 ? { data: Array.from({ length: 12 }, (_, k) => number(tick, 400 + k)) } : undefined,
};
const withoutHeader = new Set(["/meshes/blob/rest"]);

function decoders(channels, schemas) {
  const byChannel = new Map();
  for (const [id, channel] of channels) {
    const schema = schemas.get(channel.schemaId);
    assert.equal(schema.encoding, "ros2msg");
    assert.equal(channel.messageEncoding, "cdr");
    const definition = rosmsg.parse(new TextDecoder().decode(schema.data), { ros2: true });
    byChannel.set(id, { topic: channel.topic, reader: new rosmsg2.MessageReader(definition) });
  }
  return byChannel;
}

function checkMessage(topic, message, value) {
  const tick = message.sequence;
  assert.equal(message.logTime, BigInt(tick) * 1_000_000n);
  assert.equal(message.publishTime, message.logTime);
  const { header, ...rest } = value;
  if (withoutHeader.has(topic)) assert.equal(header, undefined);
  else assert.deepEqual(header, { stamp: { sec: Math.floor(tick / 1000), nanosec: (tick % 1000) * 1_000_000 }, frame_id: topic.endsWith("/contact") ? "cube" : "world" });
  assert.deepEqual(rest, expected[topic](tick), `${topic} at tick ${tick}`);
}

// the decoder's objects have classes of their own, its lists are typed arrays
const plain = (value) => JSON.parse(JSON.stringify(value, (_, part) => (ArrayBuffer.isView(part) ? Array.from(part) : part)));

async function readIndexed(bytes) {
  const readable = {
    size: async () => BigInt(bytes.length),
    read: async (offset, size) => bytes.subarray(Number(offset), Number(offset + size)),
  };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  assert.equal(reader.header.profile, "ros2");
  const byChannel = decoders(reader.channelsById, reader.schemasById);
  // what the registry of MCAP profiles asks of "ros2"
  for (const channel of reader.channelsById.values()) assert.match(channel.metadata.get("offered_qos_profiles"), /^- history: 1\n  depth: \d+\n  reliability: 1\n/);
  assert.deepEqual([...byChannel.values()].map((c) => c.topic).sort(), Object.keys(expected).sort());
  const counts = new Map();
  for await (const message of reader.readMessages({ validateCrcs: true })) {
    const { topic, reader: decoder } = byChannel.get(message.channelId);
    checkMessage(topic, message, plain(decoder.readMessage(message.data)));
    counts.set(message.channelId, (counts.get(message.channelId) ?? 0n) + 1n);
  }
  for (const [id, { topic }] of byChannel) {
    const due = Array.from({ length: ticks }, (_, tick) => expected[topic](tick)).filter((value) => value !== undefined).length;
    assert.equal(counts.get(id), BigInt(due), topic);
    assert.equal(reader.statistics.channelMessageCounts.get(id), BigInt(due), topic);
  }
  assert.ok(reader.chunkIndexes.length > 1);
  for await (const { name, metadata } of reader.readMetadata()) {
    assert.equal(name, "tactus");
    const entries = { format_version: "2", tick_rate: "1000", source: "interop", objects: "cube\nfloor", users: "hand", meshes: "blob" };
    assert.deepEqual(Object.fromEntries(metadata), entries);
  }
  const attachments = [];
  for await (const attachment of reader.readAttachments({ validateCrcs: true })) attachments.push(attachment);
  assert.equal(attachments.length, 1);
  assert.equal(attachments[0].name, "scene.toml");
  assert.equal(attachments[0].mediaType, "application/toml");
  assert.equal(new TextDecoder().decode(attachments[0].data), "# scene\n");
  return [...counts.values()].reduce((a, b) => a + b);
}

function readStreaming(bytes) {
  const reader = new McapStreamReader({ decompressHandlers, validateCrcs: true });
  let messages = 0n;
  for (let at = 0; at < bytes.length; at += 4096) {
    reader.append(bytes.subarray(at, at + 4096));
    for (let record; (record = reader.nextRecord()) != undefined; ) messages += record.type === "Message" ? 1n : 0n;
  }
  assert.ok(reader.done());
  return messages;
}

// ---- we read what they wrote ----

const poseText = `std_msgs/Header header
geometry_msgs/Pose pose
${"=".repeat(80)}
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
${"=".repeat(80)}
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
${"=".repeat(80)}
MSG: geometry_msgs/Pose
geometry_msgs/Point position
geometry_msgs/Quaternion orientation
${"=".repeat(80)}
MSG: geometry_msgs/Point
float64 x
float64 y
float64 z
${"=".repeat(80)}
MSG: geometry_msgs/Quaternion
float64 x
float64 y
float64 z
float64 w
`;

async function writeForeign(file, compressChunk) {
  const parts = [];
  let size = 0n;
  const writable = {
    position: () => size,
    write: async (part) => {
      parts.push(Uint8Array.from(part));
      size += BigInt(part.length);
    },
  };
  const writer = new McapWriter({ writable, chunkSize: 20_000, compressChunk });
  await writer.start({ profile: "ros2", library: "interop" });
  const data = new TextEncoder().encode(poseText);
  const schemaId = await writer.registerSchema({ name: "geometry_msgs/msg/PoseStamped", encoding: "ros2msg", data });
  const channelId = await writer.registerChannel({ topic: "/robot/pose", messageEncoding: "cdr", schemaId, metadata: new Map() });
  const encoder = new rosmsg2.MessageWriter(rosmsg.parse(poseText, { ros2: true }));
  for (let tick = 0; tick < 1000; ++tick) {
    const time = 1_700_000_000_000_000_000n + BigInt(tick) * 4_000_000n; // 250 Hz on a wall clock
    const stamp = { sec: Number(time / 1_000_000_000n), nanosec: Number(time % 1_000_000_000n) };
    const message = encoder.writeMessage({ header: { stamp, frame_id: "map" }, pose: pose(tick, 0) });
    await writer.addMessage({ channelId, sequence: tick, logTime: time, publishTime: time, data: message });
  }
  await writer.end();
  writeFileSync(file, Buffer.concat(parts));
}

function checkForeign(file) {
  const [names, ...rows] = execFileSync(tool, ["csv", file], { encoding: "utf8" }).trimEnd().split("\n").map((row) => row.split(","));
  assert.equal(rows.length, 1000);
  rows.forEach((row, tick) => {
    const value = (name) => Number(row[names.indexOf(name)]);
    const { position, orientation } = pose(tick, 0);
    assert.equal(value("tick"), tick);
    assert.equal(value("time_s"), tick / 250);
    for (const axis of "xyz") assert.equal(value(`/objects/robot/${axis}`), position[axis]);
    for (const part of "wxyz") assert.equal(value(`/objects/robot/q${part}`), orientation[part]);
    const speed = tick === 0 ? 0 : (1031 / 64) * 250;
    assert.ok(Math.abs(value("/objects/robot/vx") - speed) < 1e-9 * speed + 1e-12, `speed at tick ${tick}`);
  });
  return rows.length;
}

await zstd.isLoaded;
const ours = path.join(folder, "ours.mcap");
execFileSync(tool, ["write", ours]);
const bytes = new Uint8Array(readFileSync(ours));
const messages = await readIndexed(bytes);
assert.equal(readStreaming(bytes), messages);
console.log(`@mcap/core read ${messages} messages on ${Object.keys(expected).length} channels: every value as written`);

for (const [name, compressChunk] of [
  ["zstd", (data) => ({ compression: "zstd", compressedData: zstd.compress(data) })],
  ["plain", undefined],
]) {
  const theirs = path.join(folder, `theirs-${name}.mcap`);
  await writeForeign(theirs, compressChunk);
  console.log(`read ${checkForeign(theirs)} frames that @mcap/core wrote (${name}): every value as written`);
}
