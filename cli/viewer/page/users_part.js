// SPDX-License-Identifier: Apache-2.0
// Users: their devices with the path of the last second, what they touch, and the forces on their hands.
import {
  BufferAttribute, BufferGeometry, ConeGeometry, CylinderGeometry, Group, Line, LineBasicMaterial, Mesh, MeshBasicMaterial,
  MeshStandardMaterial, RingGeometry, SphereGeometry, Vector3,
} from "three";
import {colour} from "./theme.js";

const trailSeconds = 1;
const trailPoints = 128;
const up = new Vector3(0, 1, 0);

class Arrow extends Group {
  constructor(radius) {
    super();
    this.radius = radius;
    const material = new MeshBasicMaterial({depthTest: false, transparent: true});
    this.shaft = new Mesh(new CylinderGeometry(1, 1, 1, 12).translate(0, 0.5, 0), material);
    this.head = new Mesh(new ConeGeometry(2.6, 7, 16).translate(0, -3.5, 0), material);
    this.shaft.renderOrder = this.head.renderOrder = 1;
    this.add(this.shaft, this.head);
    this.material = material;
  }

  point(from, along) {
    const length = along.length();
    this.visible = length > 2 * this.radius;
    if (!this.visible) return;
    this.position.copy(from);
    this.quaternion.setFromUnitVectors(up, along.clone().divideScalar(length));
    const head = Math.min(this.radius, length / 8);
    this.shaft.scale.set(this.radius, Math.max(0.001, length - 6 * head), this.radius);
    this.head.scale.setScalar(head);
    this.head.position.y = length;
  }
}

export class UsersPart {
  #users;
  #size;

  // in  size  of a device [m];  perNewton  length of an arrow [m/N]
  constructor(truth, {size, perNewton, tickRate}) {
    this.group = new Group();
    this.#size = size;
    this.perNewton = perNewton;
    this.tickRate = tickRate;
    this.truth = truth;
    this.layers = {device: new Group(), contact: new Group(), forces: new Group()};
    this.group.add(...Object.values(this.layers));
    this.#users = truth.users.map((user) => this.#user(user));
    this.paint();
  }

  #user(user) {
    const device = new Mesh(new SphereGeometry(this.#size, 24, 16), new MeshStandardMaterial({roughness: 0.5}));
    const trail = new Line(new BufferGeometry(), new LineBasicMaterial({transparent: true, opacity: 0.55}));
    trail.geometry.setAttribute("position", new BufferAttribute(new Float32Array(3 * trailPoints), 3));
    trail.frustumCulled = false;
    this.layers.device.add(device, trail);
    const contact = new Mesh(new RingGeometry(1.5 * this.#size, 2 * this.#size, 32), new MeshBasicMaterial({side: 2, depthTest: false}));
    const tie = new Line(new BufferGeometry(), new LineBasicMaterial());
    tie.geometry.setAttribute("position", new BufferAttribute(new Float32Array(6), 3));
    tie.frustumCulled = false;
    this.layers.contact.add(contact, tie);
    const arrows = {};
    for (const [kind, radius] of [["server", 0.42], ["rendered", 0.3], ["shown", 0.2]]) {
      if (user[kind]) this.layers.forces.add((arrows[kind] = new Arrow(radius * this.#size)));
    }
    return {data: user, device, trail, contact, tie, arrows};
  }

  paint() {
    for (const {device, trail, contact, tie, arrows} of this.#users) {
      device.material.color.set(colour("device"));
      for (const line of [trail, tie, contact]) line.material.color.set(colour("soft"));
      for (const [kind, arrow] of Object.entries(arrows)) arrow.material.color.set(colour(kind));
    }
  }

  show(row, camera) {
    for (const {data, device, trail, contact, tie, arrows} of this.#users) {
      const at = (columns, i = row) => new Vector3(columns[0][i], columns[1][i], columns[2][i]);
      device.position.copy(at(data.device));
      this.#showTrail(trail, data.device, row);
      const touches = data.kind[row] > 0;
      contact.visible = tie.visible = touches;
      if (touches) {
        contact.position.copy(at(data.contact));
        contact.quaternion.copy(camera.quaternion);
        contact.position.toArray(tie.geometry.attributes.position.array, 0);
        device.position.toArray(tie.geometry.attributes.position.array, 3);
        tie.geometry.attributes.position.needsUpdate = true;
      }
      for (const [kind, arrow] of Object.entries(arrows)) arrow.point(device.position, at(data[kind]).multiplyScalar(this.perNewton));
    }
  }

  #showTrail(trail, columns, row) {
    const {ticks} = this.truth;
    let first = row;
    while (first > 0 && ticks[row] - ticks[first - 1] <= trailSeconds * this.tickRate) --first;
    const step = Math.max(1, Math.ceil((row - first) / (trailPoints - 1)));
    const out = trail.geometry.attributes.position;
    let count = 0;
    for (let i = row; i >= first && count < trailPoints; i -= step, ++count) out.setXYZ(count, columns[0][i], columns[1][i], columns[2][i]);
    trail.geometry.setDrawRange(0, count);
    out.needsUpdate = true;
  }
}
