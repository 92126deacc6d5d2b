// SPDX-License-Identifier: Apache-2.0
// bindings_bench.mjs PACKAGE FOLDER: time the decoder's calls of bindings_bench.cpp in JavaScript, with the npm package in PACKAGE and the
// streams that bindings_bench.py wrote into FOLDER. Median and fastest of many rounds.
import {readFile} from "node:fs/promises";
import {resolve} from "node:path";
import {pathToFileURL} from "node:url";

const [packageFolder, folder] = process.argv.slice(2);
const {load} = await import(pathToFileURL(resolve(packageFolder, "index.js")));
const tactus = await load(await readFile(resolve(packageFolder, "tactus.wasm")));
const rounds = 41;

// Time of a call [us]; begin() makes it anew for each round.
function report(name, begin, inputs) {
  const found = Array.from({length: rounds}, () => {
    const run = begin();
    const start = process.cpuUsage();
    for (const input of inputs) run(input);
    const {user, system} = process.cpuUsage(start);
    return (user + system) / inputs.length;
  }).sort((a, b) => a - b);
  console.log(`${name.padEnd(24)}${found[rounds >> 1].toFixed(2).padStart(14)}${found[0].toFixed(2).padStart(14)}`);
}

function packetsOf(file) {
  const player = tactus.openPlayer(file);
  const out = [];
  for (let tick; (tick = player.nextTick()) !== null;) {
    const {offset, bytes} = player.play(tick);
    out.push(file.subarray(offset, offset + bytes));
  }
  player.close();
  return out;
}

console.log(`${"call".padEnd(24)}${"median [us]".padStart(14)}${"least [us]".padStart(14)}`);
const ticks = Array.from({length: 4000}, (_, i) => 2000 + i);
for (const kind of ["rigid", "mesh"]) {
  const file = new Uint8Array(await readFile(resolve(folder, `${kind}.tct`)));
  const packets = packetsOf(file);
  const scene = tactus.parseScene(file);
  let receiver;
  report(`push_${kind}`, () => {
    receiver?.close();
    receiver = tactus.createReceiver(scene);
    let number = 0;
    return (packet) => receiver.push(++number, packet);
  }, packets);
  if (kind === "mesh") {
    const out = new Float32Array(3 * scene.deformables[0].vertices);
    report("show_mesh", () => (tick) => receiver.displacements(0, tick, out), ticks);
  } else {
    const out = new Float64Array(7 * scene.rigid.length);
    report("show_poses", () => (tick) => receiver.poses(tick, out), ticks);
  }
}
