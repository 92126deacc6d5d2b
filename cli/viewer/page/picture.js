// SPDX-License-Identifier: Apache-2.0
// The model in three dimensions: which parts it has, where all of it is, and how it looks at a tick.
import {Box3, Vector3} from "three";
import {MeshPart} from "./mesh_part.js";
import {norm} from "./model.js";
import {ObjectsPart} from "./objects_part.js";
import {lastUpTo} from "./read_columns.js";
import {SceneView} from "./scene_view.js";
import {UsersPart} from "./users_part.js";
import {plain, roundStep} from "./units.js";

const mostSamples = 24;  // ticks that are looked at to find out how much room all of it takes; fewer of large meshes

export class Picture {
  #model;
  #meshes;
  #ghosts;
  #users = null;
  #values;
  #errors;  // of each mesh at the tick of its newest true shape
  #displacement;  // [m] and
  #force = 0;  // [N], the largest seen

  constructor(canvas, model) {
    this.#model = model;
    const {box, displacement} = roomOf(model);
    this.#displacement = displacement;
    this.view = new SceneView(canvas, box);
    const size = this.view.extent / 9;
    this.layers = new Map();
    this.#addObjects(size);
    this.#meshes = model.scene.deformables.map((_, i) => new MeshPart(model.scene, i, {ghost: false}));
    this.#ghosts = model.ghost ? model.scene.deformables.map((_, i) => new MeshPart(model.scene, i, {ghost: true})) : [];
    this.#meshes.forEach((part) => this.view.add(part));
    this.#addLayer("truth", this.#ghosts);
    if (model.truth && model.truth.users.length > 0) this.#addUsers();
    this.colourings = this.#colourings();
    this.colouring = this.colourings[0] ?? null;
    this.#values = this.#meshes.map((part) => new Float32Array(part.count));
    this.#errors = this.#meshes.map((part) => ({tick: -1, values: new Float32Array(part.count)}));
  }

  #addObjects(size) {
    const {scene, shapes, ghost} = this.#model;
    if (scene.rigid.length === 0) return;
    this.objects = new ObjectsPart(scene, shapes.objects, {ghost: false, size});
    this.view.add(this.objects);
    if (!ghost) return;
    this.ghosts = new ObjectsPart(scene, shapes.objects, {ghost: true, size});
    this.#addLayer("truth", [this.ghosts]);
  }

  #addUsers() {
    const {truth, tickRate} = this.#model;
    for (let i = 0; i < truth.ticks.length; ++i) this.#force = Math.max(this.#force, forceAt(truth, i));
    if (this.#model.isLive) this.#force = powerOfTwo(this.#force);
    this.#users = new UsersPart(truth, {size: this.view.extent / 90, perNewton: this.#perNewton, tickRate});
    this.view.add(this.#users);
    for (const [name, group] of Object.entries(this.#users.layers)) this.layers.set(name, [group]);
  }

  get #perNewton() {
    return this.#force > 0 ? (0.22 * this.view.extent) / this.#force : 1;
  }

  // What lengths in the picture mean.
  get scales() {
    if (!this.#users) return [this.view.scale];
    const force = roundStep((0.1 * this.view.extent) / this.#perNewton);
    return [this.view.scale, `an arrow of ${plain(force * this.#perNewton, "length")} is ${plain(force, "force")}`];
  }

  #addLayer(name, parts) {
    if (parts.length === 0) return;
    for (const part of parts) if (part !== undefined) this.view.add(part);
    this.layers.set(name, [...(this.layers.get(name) ?? []), ...parts.map(({group}) => group)]);
  }

  setVisible(layer, visible) {
    for (const group of this.layers.get(layer)) group.visible = visible;
  }

  setMeshes(visible) {
    for (const {group} of this.#meshes) group.visible = visible;
  }

  // What meshes can be coloured by: values of the vertices and the range of the colours.
  #colourings() {
    const {scene, ghost} = this.#model;
    if (scene.deformables.length === 0) return [];
    const moved = (parts, i) => parts[i].displacements;
    const out = [{
      name: "displacement", kind: "length", most: () => this.#displacement, fill: (i, values) => fillLengths(moved(this.#meshes, i), values),
    }];
    if (ghost) {
      const visual = (i) => scene.deformableBounds(i)?.visual ?? 2.5e-4;
      out.push({name: "error", kind: "length", most: visual, fill: (i, values) => values.set(this.#errors[i].values), needsErrors: true});
    }
    const stiffness = scene.deformables.map((_, i) => scene.stiffness(i));
    if (stiffness.every((values) => values !== null)) {
      const most = (i) => stiffness[i].reduce((largest, value) => (value < Infinity ? Math.max(largest, value) : largest), 0);
      out.push({name: "stiffness", kind: "stiffness", most, fill: (i, values) => values.set(stiffness[i])});
    }
    return out;
  }

  show(tick) {
    const {replay, ghost} = this.#model;
    if (this.colouring?.needsErrors) this.#judge(tick);
    this.#model.moveTo(tick);
    this.objects?.show(replay);
    this.#meshes.forEach((part) => part.show(replay));
    if (ghost) {
      this.ghosts?.show(ghost);
      this.#ghosts.forEach((part) => part.show(ghost));
    }
    const row = this.#model.rowAt(tick);
    if (this.#model.isLive) this.#widen(row);
    if (this.#users) {
      this.#users.group.visible = row >= 0;
      if (row >= 0) this.#users.show(row, this.view.camera);
    }
    this.#meshes.forEach((part, i) => {
      this.colouring.fill(i, this.#values[i]);
      part.colourBy(this.#values[i], this.colouring.most(i));
    });
  }

  // Nobody knows what will come: scales and room follow what is seen.
  #widen(row) {
    const {truth, replay, scene} = this.#model;
    const {box} = this.view;
    if (row >= 0 && forceAt(truth, row) > this.#force) {
      this.#force = powerOfTwo(forceAt(truth, row));
      this.#users.perNewton = this.#perNewton;
    }
    for (const {device} of row >= 0 ? truth.users : []) box.expandByPoint(new Vector3(device[0][row], device[1][row], device[2][row]));
    const poses = scene.rigid.length > 0 ? replay.poses() : [];
    for (let i = 0; i < poses.length; i += 7) box.expandByPoint(new Vector3(poses[i], poses[i + 1], poses[i + 2]));
    for (const {displacements} of this.#meshes) this.#displacement = Math.max(this.#displacement, largestLength(displacements));
  }

  // A client moves on between true shapes: the two are compared at the ticks of these.
  #judge(tick) {
    const {replay, ghost, truth} = this.#model;
    const newest = (ticks) => ticks[lastUpTo(ticks, tick)] ?? 0;
    const due = this.#errors.map((error, i) => ({error, i, at: newest(truth.meshes[i].ticks)}));
    for (const {error, i, at} of due.filter((one) => one.error.tick !== one.at).sort((a, b) => a.at - b.at)) {
      this.#model.moveTo(at);
      fillDifferences(replay.displacements(i), ghost.displacements(i), error.values);
      error.tick = at;
    }
  }

  vertex(mesh, i) {
    return this.#meshes[mesh].vertex(i);
  }
}

function fillLengths(vectors, out) {
  for (let i = 0; i < out.length; ++i) out[i] = Math.hypot(vectors[3 * i], vectors[3 * i + 1], vectors[3 * i + 2]);
}

function largestLength(vectors) {
  let most = 0;
  for (let i = 0; i < vectors.length; i += 3) most = Math.max(most, Math.hypot(vectors[i], vectors[i + 1], vectors[i + 2]));
  return most;
}

const forceAt = ({users}, row) => Math.max(0, ...users.flatMap(({server, rendered}) => [server, rendered]).map((force) => (force ? norm(force, row) : 0)));

const powerOfTwo = (value) => 2 ** Math.ceil(Math.log2(Math.max(1, value)));

function fillDifferences(a, b, out) {
  for (let i = 0; i < out.length; ++i) out[i] = Math.hypot(a[3 * i] - b[3 * i], a[3 * i + 1] - b[3 * i + 1], a[3 * i + 2] - b[3 * i + 2]);
}

// A box around all that there ever is, and the largest displacement, by looking at some ticks.
function roomOf(model) {
  const {scene, replay, shapes, truth} = model;
  const box = new Box3();
  const point = new Vector3();
  const known = new Map(shapes.objects.map((shape) => [shape.name, shape]));
  const reach = scene.rigid.map(({name}) => (known.has(name) ? Math.hypot(...known.get(name).size) / 2 : 0));
  scene.deformables.forEach((_, i) => {
    const rest = scene.rest(i);
    for (let v = 0; v < rest.length; v += 3) box.expandByPoint(point.set(rest[v], rest[v + 1], rest[v + 2]));
  });
  const vertices = scene.deformables.reduce((sum, mesh) => sum + mesh.vertices, 0);
  const samples = Math.round(Math.min(mostSamples, Math.max(4, 5e5 / (vertices + 1))));
  let displacement = 0;
  for (let k = 0; k < samples; ++k) {
    replay.moveTo(Math.floor((k / (samples - 1)) * model.lastTick));
    const poses = scene.rigid.length > 0 ? replay.poses() : [];
    reach.forEach((radius, i) => {
      point.set(poses[7 * i], poses[7 * i + 1], poses[7 * i + 2]);
      box.expandByPoint(point.clone().addScalar(radius)).expandByPoint(point.addScalar(-radius));
    });
    scene.deformables.forEach((_, i) => (displacement = Math.max(displacement, largestLength(replay.displacements(i)))));
  }
  for (const {device} of truth?.users ?? [])
    for (let i = 0; i < truth.ticks.length; i += 10) box.expandByPoint(point.set(device[0][i], device[1][i], device[2][i]));
  if (model.isLive) box.expandByVector(box.getSize(point).multiplyScalar(0.2));  // for what is to come
  if (shapes.floor !== undefined) box.min.z = Math.min(shapes.floor, box.max.z);
  if (box.isEmpty() || box.getSize(point).length() < 1e-6) box.expandByScalar(0.05);
  return {box, displacement};
}
