// SPDX-License-Identifier: Apache-2.0
// A deformable object, coloured by a quantity of its vertices; or as a ghost.
import {
  BufferAttribute, BufferGeometry, Color, DoubleSide, Group, LineBasicMaterial, LineSegments, Mesh, MeshStandardMaterial, SRGBColorSpace,
} from "three";
import {colour, map, mapSteps} from "./theme.js";

// Normals of the vertices, by the areas of the triangles around them.
function computeNormals(positions, triangles, normals) {
  normals.fill(0);
  for (let t = 0; t < triangles.length; t += 3) {
    const a = 3 * triangles[t], b = 3 * triangles[t + 1], c = 3 * triangles[t + 2];
    const ux = positions[b] - positions[a], uy = positions[b + 1] - positions[a + 1], uz = positions[b + 2] - positions[a + 2];
    const vx = positions[c] - positions[a], vy = positions[c + 1] - positions[a + 1], vz = positions[c + 2] - positions[a + 2];
    const nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
    for (let k = 0; k < 3; ++k) {
      const corner = 3 * triangles[t + k];
      normals[corner] += nx;
      normals[corner + 1] += ny;
      normals[corner + 2] += nz;
    }
  }
}

// Vertices have linear colours.
const linearMap = new Float32Array(map.flatMap((rgb) => new Color().setRGB(...rgb.map((part) => part / 255), SRGBColorSpace).toArray()));

export class MeshPart {
  #rest;
  #triangles;
  #geometry = new BufferGeometry();
  #positions;
  #normals;
  #colours;

  constructor(scene, mesh, {ghost}) {
    this.mesh = mesh;
    this.ghost = ghost;
    this.group = new Group();
    this.#rest = scene.rest(mesh);
    this.#triangles = scene.triangles(mesh);
    this.displacements = new Float32Array(this.#rest.length);
    this.#positions = new BufferAttribute(this.#rest.slice(), 3);
    this.#geometry.setAttribute("position", this.#positions);
    this.#geometry.setIndex(new BufferAttribute(this.#triangles, 1));
    this.#geometry.computeBoundingSphere();
    if (ghost) this.#addWires();
    else this.#addSurface();
    this.paint();
  }

  #addSurface() {
    this.#normals = new BufferAttribute(new Float32Array(this.#rest.length), 3);
    this.#colours = new BufferAttribute(new Float32Array(this.#rest.length), 3);
    this.#geometry.setAttribute("normal", this.#normals);
    this.#geometry.setAttribute("color", this.#colours);
    const material = new MeshStandardMaterial({vertexColors: true, side: DoubleSide, roughness: 0.65, metalness: 0});
    const surface = new Mesh(this.#geometry, material);
    surface.frustumCulled = false;
    this.group.add(surface);
  }

  // The edges of the triangles share the vertices of the surface.
  #addWires() {
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", this.#positions);
    geometry.setIndex(edgesOf(this.#triangles));
    const wires = new LineSegments(geometry, new LineBasicMaterial({transparent: true, opacity: 0.35}));
    wires.frustumCulled = false;
    this.group.add(wires);
  }

  paint() {
    if (this.ghost) this.group.children[0].material.color.set(colour("ghost"));
  }

  get count() {
    return this.#rest.length / 3;
  }

  vertex(i) {
    return Array.from(this.#positions.array.subarray(3 * i, 3 * i + 3));
  }

  show(replay) {
    replay.displacements(this.mesh, this.displacements);
    const positions = this.#positions.array;
    for (let i = 0; i < positions.length; ++i) positions[i] = this.#rest[i] + this.displacements[i];
    this.#positions.needsUpdate = true;
    if (this.ghost) return;
    computeNormals(positions, this.#triangles, this.#normals.array);
    this.#normals.needsUpdate = true;
  }

  // Colour by a value of each vertex, from 0 to `most`.
  colourBy(values, most) {
    const out = this.#colours.array;
    const factor = most > 0 ? (mapSteps - 1) / most : 0;
    for (let i = 0; i < values.length; ++i) {
      const step = Math.min(Math.round(values[i] * factor), mapSteps - 1);
      for (let k = 0; k < 3; ++k) out[3 * i + k] = linearMap[3 * step + k];
    }
    this.#colours.needsUpdate = true;
  }
}

function edgesOf(triangles) {
  const seen = new Set();
  const edges = [];
  for (let t = 0; t < triangles.length; t += 3) {
    for (let k = 0; k < 3; ++k) {
      const a = triangles[t + k], b = triangles[t + ((k + 1) % 3)];
      const edge = Math.min(a, b) * 2 ** 21 + Math.max(a, b);
      if (seen.has(edge)) continue;
      seen.add(edge);
      edges.push(a, b);
    }
  }
  return edges;
}
