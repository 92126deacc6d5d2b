// SPDX-License-Identifier: Apache-2.0
// A stream at any tick: packets are decoded as time goes on; going elsewhere begins at key packets.
import {Growing, GrowingTable} from "./growing.js";
import {lastUpTo, readColumns} from "./read_columns.js";

export class Replay {
  #tactus;
  #bytes;
  #offset = 0;  // of the first byte that is still there
  #table;
  #done = 0;  // packets decoded
  #receiver = null;

  constructor(tactus, declaration, bytes, packets) {
    this.#tactus = tactus;
    this.#bytes = new Growing(bytes);
    this.#table = new GrowingTable(readColumns(packets));
    this.packets = this.#table.value;
    this.scene = tactus.parseScene(declaration);
    this.#restart();
    this.tick = 0;
    this.moveTo(0);
  }

  get length() {
    return this.packets.ticks.length;
  }

  get bytes() {
    return this.#bytes.length;
  }

  // in  packets  with offsets into `bytes`
  append(bytes, packets) {
    const columns = readColumns(packets);
    const end = this.#offset + this.#bytes.length;
    columns.offsets = columns.offsets.map((offset) => end + offset);
    this.#bytes.add(bytes);
    this.#table.add(columns);
  }

  // The first packets are forgotten.   pre  what follows them can be decoded without
  drop(count) {
    const offset = this.packets.offsets[count] ?? this.#offset + this.#bytes.length;
    this.#bytes.drop(offset - this.#offset);
    this.#offset = offset;
    this.#table.drop(count);
    if (this.#done < count) this.#restart();  // what was decoded is gone
    else this.#done -= count;
  }

  #restart() {
    this.#receiver?.close();
    this.#receiver = this.#tactus.createReceiver(this.scene);
    this.#done = 0;
  }

  moveTo(tick) {
    const end = lastUpTo(this.packets.ticks, tick) + 1;
    this.tick = tick;
    if (end < this.#done || end - this.#done > 64) {
      const first = this.#keysBefore(end);
      const nearest = Math.min(...first);
      if (end < this.#done || nearest > this.#done) {
        this.#restart();
        for (let i = nearest; i < end; ++i) if (i >= first[this.packets.substreams[i]]) this.#push(i);
        this.#done = end;
        return;
      }
    }
    for (; this.#done < end; ++this.#done) this.#push(this.#done);
  }

  // For each substream the packet to begin with.
  #keysBefore(end) {
    const first = new Array(this.scene.substreams).fill(0);
    let left = new Set(first.keys());
    for (let i = end - 1; i >= 0 && left.size > 0; --i)
      if (this.packets.keys[i] && left.delete(this.packets.substreams[i])) first[this.packets.substreams[i]] = i;
    const seen = new Set(this.packets.substreams.subarray(0, end));
    return first.map((at, substream) => (seen.has(substream) ? at : end));
  }

  #push(i) {
    const {numbers, offsets, sizes} = this.packets;
    const at = offsets[i] - this.#offset;
    this.#receiver.push(numbers[i], this.#bytes.view.subarray(at, at + sizes[i]));
  }

  poses(out) {
    return this.#receiver.poses(this.tick, out);
  }

  displacements(mesh, out) {
    return this.#receiver.displacements(mesh, this.tick, out);
  }

  stateHashes() {
    return Array.from({length: this.scene.substreams}, (_, i) => this.#receiver.stateHash(i));
  }
}
