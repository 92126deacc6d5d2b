// SPDX-License-Identifier: Apache-2.0
// The first program, its receiver: plays first.tct, which first.py writes, and prints what the other programs of this folder print.
import {readFile} from "node:fs/promises";
import {load} from "@tactus-codec/decoder";

const tactus = await load();
const player = tactus.openPlayer(await readFile("first.tct"));  // the file declares the scene

let count = 0, bytes = 0;
for (let tick = 0; tick < 1000; ++tick) {
  for (let packet; (packet = player.play(tick)) !== null;) {  // mostly none: the receiver predicts
    console.log(`tick ${tick}: ${packet.bytes} bytes`);
    count += 1, bytes += packet.bytes;
  }
}

const [x, y, z] = player.receiver.poses(999);
console.log(`${count} packets, ${bytes} bytes; ` +
  `shown at tick 999: x ${x.toFixed(4)} m, y ${y.toFixed(4)} m, z ${z.toFixed(4)} m`);
player.close();
