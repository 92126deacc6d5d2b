// SPDX-License-Identifier: Apache-2.0
// `tactus export foxglove` against libraries that nobody here wrote: container, schemas and every message, byte for byte; and what a 3-D
// panel draws of it against the trace.
//   node foxglove_interop.mjs TACTUS FOLDER
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync, statSync } from "node:fs";
import path from "node:path";
import { McapIndexedReader } from "@mcap/core";
import rosmsg from "@foxglove/rosmsg";
import rosmsg2 from "@foxglove/rosmsg2-serialization";
import schemas from "@foxglove/schemas/internal.js";
import zstd from "@foxglove/wasm-zstd";

const [program, folder] = process.argv.slice(2);
await zstd.isLoaded;
const tactus = (...words) => execFileSync(program, words, { cwd: folder, stdio: ["ignore", "ignore", "inherit"] });
const definitionsOf = (text) =>
  rosmsg.parse(text, { ros2: true }).map(({ name, definitions }) => ({ name: name ?? "", definitions })).sort((a, b) => (a.name < b.name ? -1 : 1));

async function recording(file) {
  const bytes = readFileSync(path.join(folder, file));
  const readable = { size: async () => BigInt(bytes.length), read: async (at, size) => bytes.subarray(Number(at), Number(at + size)) };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers: { zstd: (data, size) => zstd.decompress(data, Number(size)) } });
  const codecs = new Map();
  for (const [id, channel] of reader.channelsById) {
    const schema = reader.schemasById.get(channel.schemaId);
    assert.deepEqual([schema.encoding, channel.messageEncoding], ["ros2msg", "cdr"]);
    const text = new TextDecoder().decode(schema.data);
    const definition = rosmsg.parse(text, { ros2: true });
    codecs.set(id, { topic: channel.topic, schema: schema.name, text, reader: new rosmsg2.MessageReader(definition), writer: new rosmsg2.MessageWriter(definition) });
  }
  const messages = [];
  for await (const { channelId, logTime, data } of reader.readMessages()) {
    const codec = codecs.get(channelId);
    const value = codec.reader.readMessage(data);
    assert.deepEqual(Buffer.from(codec.writer.writeMessage(value)), Buffer.from(data), `${codec.topic}: written again, other bytes`);
    messages.push({ topic: codec.topic, schema: codec.schema, time: Number(logTime), value });
  }
  assert.equal(BigInt(messages.length), reader.statistics.messageCount);
  return { messages, codecs: [...codecs.values()], size: bytes.length };
}

const length = ({ x, y, z }) => Math.hypot(x, y, z);
const plus = (a, b, s = 1) => ({ x: a.x + s * b.x, y: a.y + s * b.y, z: a.z + s * b.z });
const nanoseconds = ({ sec, nsec, nanosec }) => sec * 1e9 + (nsec ?? nanosec);
const near = (a, b, what, limit = 1e-9) => assert.ok(length(plus(a, b, -1)) <= limit, `${what}: ${JSON.stringify(a)} is not ${JSON.stringify(b)}`);
/// The x axis, turned.
const axis = ({ x, y, z, w }) => ({ x: 1 - 2 * (y * y + z * z), y: 2 * (x * y + w * z), z: 2 * (x * z - w * y) });

function checkSchemas({ codecs }) {
  for (const { schema, text } of codecs) {
    const [library, , name] = schema.split("/");
    if (library !== "foxglove_msgs") continue;
    const wanted = schemas.generateRosMsgMergedSchema(schemas.foxgloveMessageSchemas[name], { rosVersion: 2 });
    const builtin = /^builtin_interfaces\//; // theirs leaves them out: every reader knows them
    assert.deepEqual(definitionsOf(text).filter((d) => !builtin.test(d.name)), definitionsOf(wanted).filter((d) => !builtin.test(d.name)), schema);
  }
}

/// What a panel needs: each entity's frame hangs on the world at its time, and an entity is whole in its message.
function checkScene({ messages }) {
  const known = new Map([["world", 0]]);
  for (const { topic, time, value } of messages) {
    for (const t of value.transforms ?? []) {
      assert.deepEqual([t.parent_frame_id, nanoseconds(t.timestamp)], ["world", time]);
      assert.ok(Math.abs(Math.hypot(t.rotation.x, t.rotation.y, t.rotation.z, t.rotation.w) - 1) < 1e-6);
      known.set(t.child_frame_id, time);
    }
    for (const entity of value.entities ?? []) {
      assert.ok(known.has(entity.frame_id), `${topic}: ${entity.frame_id} hangs on nothing`);
      assert.equal(nanoseconds(entity.timestamp), time);
      assert.equal(nanoseconds(entity.lifetime), 0);
      for (const list of entity.triangles) {
        assert.ok(list.indices.length > 0 && list.indices.length % 3 === 0 && Math.max(...list.indices) < list.points.length);
        assert.ok(list.colors.length === 0 || list.colors.length === list.points.length);
      }
      for (const arrow of entity.arrows) assert.ok(arrow.shaft_length > 0 && arrow.head_length > 0);
    }
  }
}

/// Arrows end where the forces of the same time end, at 5 cm per newton.
function checkForces({ messages }) {
  const last = new Map();
  let arrows = 0;
  for (const { topic, time, value } of messages) {
    last.set(topic, { time, value });
    const user = topic.match(/^\/users\/(.*)\/server_force$/)?.[1];
    if (user === undefined) continue;
    const of = (name) => last.get(`/users/${user}/${name}`).value;
    const hand = of("device").point;
    const [entity] = last.get(`/scene/users/${user}`).value.entities;
    near(entity.spheres[0].pose.position, hand, "device");
    const forces = [of("force").vector, of("server_force").vector].filter((f) => 0.05 * length(f) > 1e-4);
    assert.equal(entity.arrows.length, forces.length);
    forces.forEach((force, i) => {
      const { pose, shaft_length, head_length } = entity.arrows[i];
      near(plus(pose.position, axis(pose.orientation), shaft_length + head_length), plus(hand, force, 0.05), "tip of an arrow", 1e-9);
      ++arrows;
    });
    if (forces.length > 0 && entity.spheres.length === 2)
      assert.ok(length(plus(entity.spheres[1].pose.position, hand, -1)) < 0.05, "the touched point is far from the hand");
  }
  assert.ok(arrows > 50, `${arrows} arrows`);
}

const times = ({ messages }, topic) => messages.filter((m) => m.topic === topic).map((m) => m.time);

// A rigid object: its shape once, its transforms at 60 Hz.
tactus("sim", "rotate-push-lift", "--duration", "6s", "-o", "rigid.mcap", "-f", "-q");
tactus("export", "foxglove", "rigid.mcap", "-o", "rigid-3d.mcap", "-f", "-q");
const rigid = await recording("rigid-3d.mcap");
checkSchemas(rigid), checkScene(rigid), checkForces(rigid);
assert.equal(times(rigid, "/tf").length, 360);
assert.deepEqual(times(rigid, "/scene/objects"), [0]);
const [cube] = rigid.messages.find((m) => m.topic === "/scene/objects").value.entities;
assert.deepEqual([cube.frame_id, cube.frame_locked, cube.cubes[0].size], ["objects/cube", true, { x: 0.04, y: 0.04, z: 0.04 }]);
const poses = rigid.messages.filter((m) => m.topic === "/objects/cube/pose");
rigid.messages.filter((m) => m.topic === "/tf").forEach(({ value }, i) => {
  const t = value.transforms.find((one) => one.child_frame_id === "objects/cube");
  assert.deepEqual([t.translation, t.rotation], [poses[i].value.pose.position, poses[i].value.pose.orientation]);
});

// A deformable object: its shapes are those of the trace, to the precision of a float.
tactus("sim", "membrane", "--duration", "4s", "-o", "mesh.mcap", "-f", "-q");
tactus("export", "foxglove", "mesh.mcap", "-o", "mesh-3d.mcap", "-f", "-q");
const mesh = await recording("mesh-3d.mcap");
checkSchemas(mesh), checkScene(mesh), checkForces(mesh);
const truth = await recording("mesh.mcap");
const rest = truth.messages.find((m) => m.topic === "/meshes/membrane/rest").value;
const shapes = new Map(truth.messages.filter((m) => m.topic === "/meshes/membrane/displacement").map((m) => [m.time, m.value.data]));
const drawn = mesh.messages.filter((m) => m.topic === "/scene/meshes/membrane");
assert.ok(drawn.length > 150, `${drawn.length} shapes`);
let coloured = 0;
for (const { time, value } of drawn.slice(1)) {
  const [list] = value.entities[0].triangles;
  const before = [...shapes.keys()].filter((t) => t <= time).pop();
  const u = shapes.get(before);
  list.points.forEach((p, v) => near(p, plus(rest.vertices[v], { x: u[3 * v], y: u[3 * v + 1], z: u[3 * v + 2] }), `vertex ${v} at ${time}`, 1e-7));
  assert.deepEqual([...list.indices], rest.triangles.flatMap((t) => [...t.vertex_indices]));
  coloured += list.colors.some((c) => c.r !== list.colors[0].r) ? 1 : 0;
}
assert.ok(coloured > 100, `${coloured} shapes with more than one colour`);

// A stream, decoded, at another rate; the trace holds no shape.
tactus("encode", "rigid.mcap", "-o", "rigid.tct", "-f", "-q");
tactus("export", "foxglove", "rigid.tct", "--rate", "10", "-o", "stream-3d.mcap", "-f", "-q");
const stream = await recording("stream-3d.mcap");
checkSchemas(stream), checkScene(stream);
assert.equal(stream.messages.find((m) => m.topic === "/scene/objects").value.entities[0].arrows.length, 3);
assert.ok(times(stream, "/tf").length <= 60 && times(stream, "/tf").length > 50);

// The layouts name topics and fields that are there.
const field = (value, names) => names.reduce((part, name) => part?.[name], value);
function checkLayouts(input, { messages }) {
  const last = new Map(messages.map((m) => [m.topic, m.value]));
  const isNumber = (topic, names) => assert.equal(typeof field(last.get(topic), names), "number", `${topic} ${names}`);
  tactus("export", "foxglove", input, "-o", "again.mcap", "--layout", "layout.json", "-f", "-q");
  const layout = JSON.parse(readFileSync(path.join(folder, "layout.json"), "utf8"));
  const leaves = (node) => (typeof node === "string" ? [node] : [...leaves(node.first), ...leaves(node.second)]);
  assert.deepEqual(leaves(layout.layout).sort(), Object.keys(layout.configById).sort());
  assert.deepEqual(Object.keys(layout.configById["3D!scene"].topics).sort(), [...last.keys()].filter((t) => t.startsWith("/scene/")).sort());
  const plots = Object.values(layout.configById).flatMap((config) => config.paths ?? []);
  for (const { value } of plots) isNumber(...[value.match(/^"(.*)"\.(.*)$/)].map(([, t, f]) => [t, f.split(".")])[0]);
  tactus("export", "foxglove", input, "-o", "again.mcap", "--layout", "layout.xml", "-f", "-q");
  const curves = [...readFileSync(path.join(folder, "layout.xml"), "utf8").matchAll(/curve name="([^"]*)"/g)].map((m) => m[1]);
  for (const curve of curves) {
    const topic = [...last.keys()].find((t) => curve.startsWith(`${t}/`));
    isNumber(topic, curve.slice(topic.length + 1).split("/"));
  }
  return plots.length + curves.length;
}
const drawnCurves = checkLayouts("rigid.mcap", rigid) + checkLayouts("mesh.mcap", mesh);
assert.equal(drawnCurves, 12 + 12 + 9 + 9);
const kib = (file) => (statSync(path.join(folder, file)).size / 1024).toFixed(0);
console.log(`${rigid.messages.length + mesh.messages.length + stream.messages.length} messages; rigid ${kib("rigid-3d.mcap")} of ${kib("rigid.mcap")} KiB, membrane ${kib("mesh-3d.mcap")} of ${kib("mesh.mcap")} KiB`);
