// SPDX-License-Identifier: Apache-2.0
// Rigid objects: boxes and solids where a scene has their shapes, else axes.
import {
  AxesHelper, BoxGeometry, BufferAttribute, BufferGeometry, EdgesGeometry, Group, LineBasicMaterial, LineDashedMaterial, LineSegments, Mesh,
  MeshStandardMaterial,
} from "three";
import {colour} from "./theme.js";

function geometryOf(shape) {
  if (!shape) return null;
  if (!shape.vertices) return new BoxGeometry(...shape.size);
  const indexed = new BufferGeometry();
  indexed.setAttribute("position", new BufferAttribute(new Float32Array(shape.vertices), 3));
  indexed.setIndex(shape.triangles);
  const geometry = indexed.toNonIndexed();
  geometry.computeVertexNormals();
  return geometry;
}

export class ObjectsPart {
  #poses;
  #bodies;

  // in  ghost  draw the edges alone
  constructor(scene, shapes, {ghost, size}) {
    this.group = new Group();
    this.ghost = ghost;
    this.#poses = new Float64Array(7 * scene.rigid.length);
    const known = new Map(shapes.map((shape) => [shape.name, shape]));
    this.areKnown = scene.rigid.every(({name}) => known.has(name));
    this.#bodies = scene.rigid.map(({name}) => this.#body(geometryOf(known.get(name)), size));
    this.paint();
  }

  #body(geometry, size) {
    const body = new Group();
    if (geometry === null) body.add(new AxesHelper(size));
    if (geometry !== null && !this.ghost) {
      const behindEdges = {polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1};
      body.add(new Mesh(geometry, new MeshStandardMaterial({roughness: 0.75, metalness: 0, ...behindEdges})));
    }
    if (geometry !== null) {
      const material = this.ghost ? new LineDashedMaterial({dashSize: size / 12, gapSize: size / 16}) : new LineBasicMaterial();
      const edges = new LineSegments(new EdgesGeometry(geometry, 20), material);
      edges.computeLineDistances();
      body.add(edges);
    }
    this.group.add(body);
    return body;
  }

  paint() {
    this.group.traverse((node) => {
      if (node.isMesh) node.material.color.set(colour("object"));
      else if (node.isLineSegments && !(node instanceof AxesHelper)) node.material.color.set(colour(this.ghost ? "ghost" : "edge"));
    });
  }

  show(replay) {
    replay.poses(this.#poses);
    this.#bodies.forEach((body, i) => {
      const [x, y, z, qw, qx, qy, qz] = this.#poses.subarray(7 * i, 7 * i + 7);
      body.position.set(x, y, z);
      body.quaternion.set(qx, qy, qz, qw);
    });
  }
}
