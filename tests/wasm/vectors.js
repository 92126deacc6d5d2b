// SPDX-License-Identifier: Apache-2.0
// A conformance vector through the WebAssembly decoder: what it makes of the stream against the expected lines. For Node and browsers.
const testeeLimits = {header_bytes: 1 << 20, packet_bytes: 1 << 20};
const playoutDelay = 100;  // ticks
const reasons = ["request", "heartbeat", "visual", "haptic"];

// FNV-1a of 64 bits, spec/10-conventions.md section 7.
class Fnv {
  value = 0xcbf29ce484222325n;

  add(number, bytes) {
    let left = BigInt.asUintN(8 * bytes, BigInt(number));
    for (let i = 0; i < bytes; ++i, left >>= 8n) this.value = BigInt.asUintN(64, (this.value ^ (left & 255n)) * 0x100000001b3n);
  }

  text() {
    return this.value.toString(16).padStart(16, "0");
  }
}

function shownAt(receiver, tick) {
  const {deformables, positionExp} = receiver.scene;
  const poses = receiver.poseHash(tick);
  if (deformables.length === 0) return poses;
  const hash = new Fnv();
  hash.add(BigInt(`0x${poses}`), 8);
  for (let i = 0; i < deformables.length; ++i)
    for (const metres of receiver.displacements(i, tick)) hash.add(Math.round(metres * 2 ** positionExp), 4);
  return hash.text();
}

/** Bytes of a stream, with what its file omits. */
export function expand(bytes, repeat) {
  if (!repeat) return bytes;
  const piece = Uint8Array.from(repeat.bytes.match(/../g), (digits) => parseInt(digits, 16));
  const out = new Uint8Array(bytes.length + piece.length * repeat.times);
  out.set(bytes.subarray(0, repeat.at));
  for (let i = 0; i < repeat.times; ++i) out.set(piece, repeat.at + i * piece.length);
  out.set(bytes.subarray(repeat.at), repeat.at + piece.length * repeat.times);
  return out;
}

// What of the declaration the interface returns.
function headerOf(scene) {
  const header = {tick_rate: scene.tickRate, objects: scene.rigid.map(({name, dof}) => ({name, dof}))};
  if (scene.deformables.length > 0) {
    header.meshes = scene.deformables.map(({name, profile, vertices, triangles, modes}, i) => {
      const mesh = {name, profile: profile === "main" ? 1 : 0, vertices, triangles, modes};
      if (scene.stiffness(i) !== null) mesh.stiffness = "declared";
      return mesh;
    });
  }
  return header;
}

/** Lines as the testee contract has them, but for the state of the range decoder.   out  lines, and the error if any */
export function decode(tactus, bytes, args) {
  const wanted = args[0] === "--replica" && args[1] !== "device" ? args[1] : null;  // a decoder has no device: sessions.js
  const lines = [];
  let player = null;
  try {
    player = tactus.openPlayer(bytes, {limits: testeeLimits});
    const past = wanted === "playout";
    if (wanted !== null && (past || !player.scene.smoothed)) {
      player.close();
      player = tactus.openPlayer(bytes, {limits: testeeLimits, interpolation: wanted});
    }
    lines.push(...play(player, wanted !== null, past ? playoutDelay : 0));
  } catch (error) {
    if (error.rule === undefined) throw error;
    lines.push(...(error.lines ?? (player ? [{header: headerOf(player.scene)}] : [])));
    lines.push({error: {errc: error.errorClass, rule: error.rule}});
  } finally {
    player?.close();
  }
  return lines;
}

function play(player, looks, delay) {
  const {receiver, scene} = player;
  const lines = [{header: headerOf(scene)}];
  const all = new Fnv();
  let looked = 0;
  const lookUntil = (tick) => {
    for (; looks && looked < tick; ++looked) all.add(BigInt(`0x${shownAt(receiver, looked - delay)}`), 8);
  };
  try {
    for (let number = 0, tick; (tick = player.nextTick()) !== null; ++number) {
      lookUntil(tick);
      const packet = player.play(tick);
      const line = {packet: number, number: packet.number, key: packet.key, tick, state: receiver.stateHash(packet.substream),
        part: packet.substream};
      if (packet.kind === "rigid") line.updates = receiver.updates().map((u) => [u.object, reasons.indexOf(u.reason), u.level]);
      if (packet.kind === "deformable") line.vertices = packet.updates;
      if (packet.kind === "load") line.loads = packet.updates;
      if (looks) line.shown = shownAt(receiver, tick - delay);
      lines.push(line);
    }
  } catch (error) {
    error.lines = lines;
    throw error;
  }
  lookUntil(looked + (looks ? 1 : 0) + delay);
  const end = {complete: player.complete, packets: lines.length - 1};
  if (looks) end.shown = all.text();
  lines.push({end});
  return lines;
}

/** What is wrong, or null. */
export function check(tactus, {bytes, expected, args = [], repeat}) {
  const lines = decode(tactus, expand(bytes, repeat), args);
  if (lines.length !== expected.length) return `${lines.length} lines, not ${expected.length}`;
  for (let i = 0; i < lines.length; ++i) {
    const [kind] = Object.keys(lines[i]);
    if (!(kind in expected[i])) return `line ${i} is a ${kind}`;
    for (const mesh of expected[i].header?.meshes ?? []) if (mesh.stiffness) mesh.stiffness = "declared";
    const [made, wanted] = kind === "packet" ? [lines[i], expected[i]] : [lines[i][kind], expected[i][kind]];
    for (const [name, value] of Object.entries(made))
      if ((name in wanted || name !== "part") && JSON.stringify(value) !== JSON.stringify(wanted[name]))
        return `line ${i}: ${name} is ${JSON.stringify(value)}`;
  }
  return null;
}
