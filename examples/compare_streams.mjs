// SPDX-License-Identifier: Apache-2.0
// Play two streams of one scene side by side: packets, hash of the last state, and how far apart the first object is shown. With the npm
// package; compare_streams.c and compare_streams.py are the same program.   usage: compare_streams.mjs A.tct B.tct
import {readFile} from "node:fs/promises";
import {load} from "@tactus-codec/decoder";

const paths = process.argv.slice(2);
if (paths.length !== 2) {
  console.error("usage: compare_streams.mjs A.tct B.tct");
  process.exit(2);
}
const tactus = await load();
const packets = [0, 0], bytes = [0, 0];
let at = 0, farthest = 0;
try {
  const players = [];
  for (; at < 2; ++at) {
    players.push(tactus.openPlayer(await readFile(paths[at])));
    if (players[at].receiver.scene.rigid.length === 0) throw new Error("no rigid object");
  }
  for (let tick = 0, more = true; more; ++tick) {
    const [a, b] = players.map((player, i) => {
      for (let packet; (packet = player.play(tick)) !== null; ++packets[i]) bytes[i] += packet.bytes;
      return player.receiver.poses(tick);
    });
    farthest = Math.max(farthest, Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]));
    more = players.some((player) => player.nextTick() !== null);
  }
  players.forEach((player, i) => {
    console.log(`${paths[i]}: ${packets[i]} packets, ${bytes[i]} bytes, state ${player.receiver.stateHash(0)}`);
    player.close();
  });
  console.log(`at most ${(1e3 * farthest).toFixed(3)} mm apart`);
} catch (error) {
  console.error(`${paths[at] ?? paths.join(", ")}: ${error.message}`);
  process.exit(1);
}
