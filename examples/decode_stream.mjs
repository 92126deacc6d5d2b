// SPDX-License-Identifier: Apache-2.0
// decode_stream.mjs STREAM [EXPECTED]: decode a stream with the npm package, print where its objects are and the hashes of its states,
// and compare these with the lines of a conformance vector.
import {readFile} from "node:fs/promises";
import {load} from "@tactus-codec/decoder";

const [stream, expected] = process.argv.slice(2);
const tactus = await load();
const player = tactus.openPlayer(await readFile(stream));
const {scene, receiver} = player;

const states = [];
for (let tick = player.nextTick(); tick !== null; tick = player.nextTick()) {
  const packet = player.play(tick);
  states.push(receiver.stateHash(packet.substream));
  const [x, y, z] = scene.rigid.length > 0 ? receiver.poses(tick) : scene.rest(0);
  console.log(`${(tick / scene.tickRate).toFixed(3)} s ${packet.kind} ${packet.bytes} bytes ${states.at(-1)} (${x}, ${y}, ${z}) m`);
}
player.close();

if (expected) {
  const lines = (await readFile(expected, "utf8")).trim().split("\n").map((line) => JSON.parse(line));
  const wanted = lines.filter((line) => "packet" in line).map((line) => line.state);
  if (JSON.stringify(states) !== JSON.stringify(wanted)) {
    console.error("other states than expected");
    process.exit(1);
  }
  console.log(`${states.length} states as expected`);
}
