// SPDX-License-Identifier: Apache-2.0
// What the time line shows of a model.
import {forceOf, nameOfForce, norm} from "./model.js";
import {units} from "./units.js";

const reasons = ["request", "heartbeat", "visual", "haptic"];

export function lanesOf(model) {
  const {packets, scene} = model;
  const {length} = packets.ticks;
  const times = (matches) => Float64Array.from([...Array(length).keys()].filter(matches), (i) => packets.ticks[i] / model.tickRate);
  const isExpected = (reason) => model.isLive && (reasons[reason] !== "heartbeat" || scene.rigidBounds?.heartbeat > 0);
  const lanes = [];
  const rigid = scene.rigid.some(({dof}) => dof !== 0);
  for (let reason = 3; rigid && reason >= 0; --reason) {
    const found = times((i) => packets.substreams[i] === 0 && packets.reasons[i] === reason);
    if (found.length > 0 || isExpected(reason)) lanes.push({name: `packets, ${reasons[reason]}`, colour: reasons[reason], times: found});
  }
  const meshes = times((i) => packets.substreams[i] > 0 && packets.substreams[i] <= scene.deformables.length);
  if (meshes.length > 0) lanes.push({name: "packets, shapes", colour: "deformable", times: meshes});
  const loads = times((i) => packets.substreams[i] > scene.deformables.length);
  if (loads.length > 0) lanes.push({name: "packets, loads", colour: "load", times: loads});
  return lanes;
}

function strip(name, kind, times, values, {bound = null, colour = "visual"}) {
  const {factor, name: unit} = units[kind];
  const scaled = (column) => column.map((value) => value * factor);
  const fixed = typeof bound === "number";
  const limit = bound === null ? null : fixed ? new Float64Array(values.length).fill(bound * factor) : scaled(bound);
  const series = [{colour, values: scaled(values), over: limit}];
  if (limit) series.push({colour: "ink", values: limit, dashed: true, fixed});
  return {name, unit, times, series};
}

export function rowsOf(model) {
  const {truth, scene} = model;
  const rows = [];
  if (truth) {
    const times = model.seconds(truth.ticks);
    const {errors} = truth;
    const bounds = scene.rigidBounds;
    const add = (name, kind, values, options) => rows.push(strip(name, kind, times, values, options));
    if (errors) add("position error", "length", errors.position, {bound: bounds?.visualPosition ?? null});
    if (errors) add("rotation error", "angle", errors.rotation, {bound: bounds?.visualRotation ?? null});
    if (errors?.force) add("normal force error", "force", errors.force, {bound: errors.force_bound ?? null, colour: "haptic"});
    truth.meshes.forEach(({ticks, error}, i) => {
      const bound = scene.deformableBounds(i);
      const name = truth.meshes.length > 1 ? `vertex error, ${short(scene.deformables[i].name)}` : "vertex error";
      rows.push(strip(name, "length", model.seconds(ticks), error, {bound: bound?.kept ? bound.visual : null, colour: "deformable"}));
    });
    truth.users.forEach((user) => {
      const force = truth.ticks.map((_, row) => norm(forceOf(user), row));
      const kind = nameOfForce(user);
      const name = truth.users.length > 1 ? `${kind}, ${short(user.name)}` : kind;
      add(name, "force", force, {colour: user.rendered ? "rendered" : "server"});
    });
  }
  rows.push(rateRow(model));
  return rows;
}

const short = (name) => (name.length > 14 ? `${name.slice(0, 13)}…` : name);

// Payload of tenths of a second, of longer spans in a long stream.
function rateRow(model) {
  const window = Math.max(0.1, (model.duration - model.start) / 10000);
  const first = Math.floor(model.start / window);
  const count = Math.max(1, Math.ceil(model.duration / window) - first);
  const rate = new Float64Array(count);
  model.packets.ticks.forEach((tick, i) => {
    rate[Math.min(count - 1, Math.floor(tick / model.tickRate / window) - first)] += (8 * model.packets.sizes[i]) / window / 1000;
  });
  const times = rate.map((_, i) => (first + i) * window);
  return {name: "payload", unit: "kbit/s", times, series: [{colour: "soft", values: rate, over: null}]};
}
