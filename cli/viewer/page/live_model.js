// SPDX-License-Identifier: Apache-2.0
// A model that a server feeds: the newest half a minute, without what lies before a key tick, to begin at.
import {GrowingTable} from "./growing.js";
import {Model, readTruth} from "./model.js";
import {bytesOf} from "./read_columns.js";

export const keptSeconds = 30;
const mostBytes = 64 * 2 ** 20;  // of packets

export class LiveModel extends Model {
  #hello;
  #rows;
  #meshes;
  #keyTicks = [];  // to begin at: how much of each table lies before them
  #gone;         // the same of what has left

  // in  hello, batch  the first two messages of the server
  constructor(tactus, hello, batch) {
    super(tactus, {...hello, ...batch, truth: {...hello.truth, ...batch.truth}});
    this.isLive = true;
    this.#hello = hello;
    const {meshes, ...rows} = this.truth;
    this.#rows = new GrowingTable(rows);
    this.#meshes = meshes.map((mesh) => new GrowingTable(mesh));
    this.truth = Object.assign(this.#rows.value, {meshes});
    this.checked = null;  // the tick whose state was last held against the server's, and whether it is the same
    this.#gone = this.#lengths.map(() => 0);
    this.#note(batch, this.#lengths.map(() => 0));
    this.#check(batch);
  }

  get #tables() {
    return [this.replay, this.ghost, this.#rows, ...this.#meshes];
  }

  get #lengths() {
    return this.#tables.map(({length}) => length);
  }

  get start() {
    return this.#keyTicks[0].tick / this.tickRate;
  }

  // in  follows  the newest tick is shown
  append(batch, follows) {
    const before = this.#lengths.map((length, i) => this.#gone[i] + length);
    this.replay.append(bytesOf(batch.stream), batch.packets);
    this.ghost.append(bytesOf(batch.truth.stream), batch.truth.packets);
    const {meshes, ...rows} = readTruth({...this.#hello.truth, ...batch.truth});
    this.#rows.add(rows);
    this.#meshes.forEach((table, i) => table.add(meshes[i]));
    this.lastTick = batch.last_tick;
    this.#note(batch, before);
    this.#forget();
    if (follows) this.#check(batch);
  }

  #note(batch, before) {
    this.leftOut = batch.left_out;
    if (batch.key) this.#keyTicks.push({tick: this.truth.ticks[before[2] - this.#gone[2]], before});
  }

  #drop(counts) {
    this.#tables.forEach((table, i) => table.drop(counts[i]));
    this.#gone = this.#gone.map((gone, i) => gone + counts[i]);
  }

  #forget() {
    const isOld = ({tick}) => tick <= this.lastTick - keptSeconds * this.tickRate;
    const isMuch = () => this.replay.bytes + this.ghost.bytes > mostBytes;
    while (this.#keyTicks.length > 1 && (isOld(this.#keyTicks[1]) || isMuch())) {
      this.#keyTicks.shift();
      this.#drop(this.#keyTicks[0].before.map((count, i) => count - this.#gone[i]));
    }
  }

  #check({hashes, last_tick: tick}) {
    if (!hashes) return;
    this.replay.moveTo(tick);
    this.checked = {tick, isEqual: JSON.stringify(this.replay.stateHashes()) === JSON.stringify(hashes)};
  }
}
