// SPDX-License-Identifier: Apache-2.0
// package_test.mjs CONFORMANCE STREAM: the installed npm package over the conformance vectors, its errors, and what calls cost.
import assert from "node:assert/strict";
import {readFileSync} from "node:fs";
import {createRequire} from "node:module";
import {load, TactusError} from "@tactus-codec/decoder";
import {readVectors} from "./read_vectors.mjs";
import {check} from "./vectors.js";

const [conformance, stream] = process.argv.slice(2);
const wasm = readFileSync(createRequire(import.meta.url).resolve("@tactus-codec/decoder/tactus.wasm"));
const module = await WebAssembly.compile(wasm);
assert.deepEqual(WebAssembly.Module.imports(module), []);
assert.ok(wasm.length < 212 * 1024, `${wasm.length} bytes`);
const tactus = await load(module);
assert.match(tactus.version, /^\d+\.\d+\.\d+$/);

const vectors = readVectors(conformance);
const wrong = vectors.map((vector) => [vector.id, check(tactus, vector)]).filter(([, problem]) => problem !== null);
assert.deepEqual(wrong, []);
console.log(`${vectors.length} vectors, all states and errors as expected`);

const [one] = vectors.filter(({id, expected}) => id.startsWith("rigid/") && expected[1].state);
one.expected[1].state = "0123456789abcdef";
assert.match(check(tactus, one), /state is/);

const isRefusal = (error) => error instanceof TactusError && /^R-/.test(error.rule) && error.message.length > 20;
assert.throws(() => tactus.openPlayer(new Uint8Array([1, 2, 3])), isRefusal);

// A scene and its packets without a file give what the file gives.
const bytes = new Uint8Array(readFileSync(stream));
const player = tactus.openPlayer(bytes);
const scene = tactus.parseScene(bytes);
assert.equal(scene.bytes, player.headerBytes);
const receiver = tactus.createReceiver(scene);
let packets = 0;
const begin = process.hrtime.bigint();
for (let tick; (tick = player.nextTick()) !== null; ++packets) {
  const packet = player.play(tick);
  assert.equal(receiver.push(packet.number, bytes.subarray(packet.offset, packet.offset + packet.bytes)).number, packet.number);
  assert.equal(receiver.stateHash(0), player.receiver.stateHash(0));
  assert.deepEqual(receiver.poses(tick), player.receiver.poses(tick));
}
assert.ok(packets > 0 && player.complete);
const each = Number(process.hrtime.bigint() - begin) / 1000 / packets;
console.log(`${packets} packets by player and receiver, ${each.toFixed(1)} us each with hashes and poses of both`);
assert.throws(() => receiver.push(bytes), /number.*before its bytes/);
assert.throws(() => receiver.push(0, bytes), (error) => error.rule === "R-API-5");
receiver.close();
scene.close();
player.close();

// What was closed is refused, and so is what lived in it; memory that somebody else may have is not read.
for (const closed of [() => receiver.poses(0), () => receiver.stateHash(0), () => receiver.scene.rigidBounds, () => scene.rigidBounds,
  () => tactus.createReceiver(scene), () => player.nextTick(), () => player.receiver.poses(0), () => player.scene.rigidBounds])
  assert.throws(closed, (error) => error instanceof TactusError && error.rule === "R-API-12", String(closed));
for (const wrong of [bytes.buffer, new Uint16Array(4), "abc", [1, 2], {length: 4}, null, undefined])
  for (const take of ["openPlayer", "parseScene"]) assert.throws(() => tactus[take](wrong), TypeError);

// Nothing is kept: memory does not grow with use.
const size = () => tactus.exports.memory.buffer.byteLength;
for (let i = 0; i < 20; ++i) tactus.openPlayer(bytes).close();
const before = size();
for (let i = 0; i < 2000; ++i) tactus.openPlayer(bytes).close();
assert.equal(size(), before);
