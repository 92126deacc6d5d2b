// SPDX-License-Identifier: Apache-2.0
// The picture: camera, light, ground, and what stands on it. Throws where the browser has no WebGL 2.
import {
  Color, DirectionalLight, GridHelper, HemisphereLight, Mesh, MeshBasicMaterial, PerspectiveCamera, PlaneGeometry, Scene, Vector3,
  WebGLRenderer,
} from "three";
import {OrbitControls} from "three/examples/jsm/controls/OrbitControls.js";
import {colour} from "./theme.js";
import {plain, roundStep} from "./units.js";

const towardsCamera = new Vector3(-0.32, -0.8, 0.5).normalize();

export class SceneView {
  #renderer;
  #canvas;
  #parts = [];
  #grid = null;

  constructor(canvas, box) {
    if (!canvas.getContext("webgl2")) throw new Error("no WebGL 2");
    this.#canvas = canvas;
    this.#renderer = new WebGLRenderer({canvas, antialias: true});
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(38, 1, 0.001, 1000);
    this.camera.up.set(0, 0, 1);
    this.box = box;
    this.extent = box.getSize(new Vector3()).length();
    this.#addLight();
    this.#addGround(box);
    this.controls = new OrbitControls(this.camera, canvas);
    this.lookAtAll();
    this.resize();
  }

  add(part) {
    this.#parts.push(part);
    this.scene.add(part.group);
  }

  #addLight() {
    this.scene.add(new HemisphereLight(0xffffff, 0x8a8f96, 1.7));
    const sun = new DirectionalLight(0xffffff, 1.5);
    sun.position.set(-0.5, -0.9, 1.6);
    this.scene.add(sun);
  }

  #addGround(box) {
    const centre = box.getCenter(new Vector3());
    const cell = roundStep(this.extent / 8);
    const room = box.getSize(new Vector3());
    const cells = 2 * Math.ceil((0.8 * Math.max(room.x, room.y)) / cell + 1);
    const at = (value) => Math.round(value / cell) * cell;
    this.#grid = new GridHelper(cells * cell, cells);
    this.#grid.rotation.x = Math.PI / 2;
    this.#grid.position.set(at(centre.x), at(centre.y), box.min.z);
    this.floor = new Mesh(new PlaneGeometry(cells * cell, cells * cell), new MeshBasicMaterial({depthWrite: false}));
    this.floor.position.copy(this.#grid.position);
    this.floor.renderOrder = -1;
    this.#grid.material.depthWrite = false;
    this.scene.add(this.floor, this.#grid);
    this.scale = `grid ${plain(cell, "length")}`;
    this.paint();
  }

  // Take the colours of the page.
  paint() {
    this.scene.background = new Color(colour("ground"));
    this.floor.material.color.set(colour("floor"));
    this.#grid.material.vertexColors = false;
    this.#grid.material.color.set(colour("grid"));
    this.#grid.material.needsUpdate = true;
    for (const part of this.#parts) part.paint();
  }

  lookAtAll() {
    const centre = this.box.getCenter(new Vector3());
    const distance = this.#distanceToSee(centre);
    this.camera.position.copy(centre).addScaledVector(towardsCamera, distance);
    this.camera.near = distance / 200;
    this.camera.far = distance * 20;
    this.controls.target.copy(centre);
    this.controls.update();
  }

  // From where all corners of the box are in the picture, with some room around them.
  #distanceToSee(centre) {
    const right = new Vector3(0, 0, 1).cross(towardsCamera).normalize();
    const up = towardsCamera.clone().cross(right);
    const high = 0.86 * Math.tan((this.camera.fov * Math.PI) / 360);
    const wide = (high * this.#canvas.clientWidth) / Math.max(1, this.#canvas.clientHeight);
    let distance = 0;
    for (let corner = 0; corner < 8; ++corner) {
      const at = new Vector3(...["x", "y", "z"].map((axis, k) => this.box[corner >> k & 1 ? "max" : "min"][axis])).sub(centre);
      const reach = Math.max(Math.abs(at.dot(right)) / wide, Math.abs(at.dot(up)) / high);
      distance = Math.max(distance, reach + at.dot(towardsCamera));
    }
    return distance;
  }

  resize() {
    const {clientWidth: width, clientHeight: height} = this.#canvas;
    if (width === 0 || height === 0) return;
    this.#renderer.setPixelRatio(Math.min(2, devicePixelRatio));
    this.#renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
  }

  draw() {
    this.#renderer.render(this.scene, this.camera);
  }

  // Position of a point in the window, in CSS pixels.
  project(point) {
    const p = new Vector3(...point).project(this.camera);
    const at = this.#canvas.getBoundingClientRect();
    return [at.left + (0.5 + p.x / 2) * at.width, at.top + (0.5 - p.y / 2) * at.height];
  }
}
