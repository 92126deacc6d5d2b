// SPDX-License-Identifier: Apache-2.0
// All that the page shows of one stream: the replay, its truth, and what they are at a tick.
import {bytesOf, lastUpTo, readColumn, readColumns} from "./read_columns.js";
import {Replay} from "./replay.js";

export class Model {
  constructor(tactus, data) {
    this.name = data.name;
    this.shapes = data.shapes;
    this.bytes = bytesOf(data.stream);
    this.replay = new Replay(tactus, this.bytes, data.packets);
    this.scene = this.replay.scene;
    this.packets = this.replay.packets;
    this.lastTick = data.last_tick;
    this.tickRate = this.scene.tickRate;
    this.duration = this.lastTick / this.tickRate;
    this.truth = data.truth ? readTruth(data.truth) : null;
    this.ghost = data.truth ? new Replay(tactus, bytesOf(data.truth.stream), data.truth.packets) : null;
  }

  moveTo(tick) {
    this.replay.moveTo(tick);
    this.ghost?.moveTo(tick);
  }

  // Row of the truth at a tick, or -1.
  rowAt(tick) {
    return this.truth ? lastUpTo(this.truth.ticks, tick) : -1;
  }

  packetsUpTo(tick) {
    return lastUpTo(this.packets.ticks, tick) + 1;
  }

  seconds(ticks) {
    return Float64Array.from(ticks, (tick) => tick / this.tickRate);
  }
}

const readVector = (columns) => columns.map(readColumn);

function readTruth(truth) {
  const readUser = ({name, kind, ...vectors}) =>
    ({name, kind: readColumn(kind), ...Object.fromEntries(Object.entries(vectors).map(([key, columns]) => [key, readVector(columns)]))});
  return {
    name: truth.name, source: truth.source, ticks: readColumn(truth.ticks), errors: truth.errors ? readColumns(truth.errors) : null,
    ghostPosition: truth.ghost_position, ghostRotation: truth.ghost_rotation, ghostVertex: truth.ghost_vertex,
    users: truth.users.map(readUser), meshes: truth.meshes.map(readColumns),
  };
}

export const norm = (columns, row) => Math.hypot(columns[0][row], columns[1][row], columns[2][row]);
