// SPDX-License-Identifier: Apache-2.0
// All that the page shows of one stream: the replay, its truth, and what they are at a tick.
import {bytesOf, lastUpTo, readColumn, readColumns} from "./read_columns.js";
import {Replay} from "./replay.js";

export class Model {
  constructor(tactus, data) {
    this.name = data.name;
    this.shapes = data.shapes;
    this.isLive = false;
    const bytes = bytesOf(data.stream);
    this.replay = new Replay(tactus, data.scene ? bytesOf(data.scene) : bytes, bytes, data.packets);
    this.scene = this.replay.scene;
    this.packets = this.replay.packets;
    this.lastTick = data.last_tick;
    this.tickRate = this.scene.tickRate;
    this.truth = data.truth ? readTruth(data.truth) : null;
    this.ghost = data.truth ? ghostOf(tactus, data.truth) : null;
  }

  // Seconds between which all is known.
  get start() {
    return 0;
  }

  get duration() {
    return this.lastTick / this.tickRate;
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
    return ticks.map((tick) => tick / this.tickRate);
  }
}

const readVector = (columns) => columns.map(readColumn);

const ghostOf = (tactus, {scene, stream, packets}) => new Replay(tactus, bytesOf(scene), bytesOf(stream), packets);

export function readTruth(truth) {
  const readUser = ({name, knows, kind, ...vectors}) =>
    ({name, knows, kind: readColumn(kind), ...Object.fromEntries(Object.entries(vectors).map(([key, columns]) => [key, readVector(columns)]))});
  return {
    name: truth.name, source: truth.source, ticks: readColumn(truth.ticks), errors: truth.errors ? readColumns(truth.errors) : null,
    ghostPosition: truth.ghost_position, ghostRotation: truth.ghost_rotation, ghostVertex: truth.ghost_vertex,
    users: truth.users.map(readUser), meshes: truth.meshes.map(readColumns),
  };
}

// The force that is drawn over time. A user has those that the truth knows, and the rendered one only if it is not the server's.
export const forceOf = ({rendered, server}) => rendered ?? server;
export const nameOfForce = ({knows}) => (knows === "server" ? "force of the server" : "rendered force");

export const norm = (columns, row) => Math.hypot(columns[0][row], columns[1][row], columns[2][row]);
