// SPDX-License-Identifier: Apache-2.0
// The decoder of Tactus. index.d.ts says what each part does; the names are those of the C interface, bindings/c/tactus.h.
import {constants, layouts} from "./interface.js";
import {Memory} from "./memory.js";

export {constants};

const interpolations = ["none", "linear", "hermite", "blending", "playout"];
const kinds = ["rigid", "deformable", "load"];
const layers = ["haptic", "visual", "all"];
const reasons = ["request", "heartbeat", "visual", "haptic"];
const advices = ["none", "drop", "request key", "close"];
const hapticRules = ["off", "isotropic", "cone", "fixed", "perceptual"];
const profiles = ["thesis", "main"];

export class TactusError extends Error {
  constructor({status, name, rule, text, remedy, advice, bitOffset}) {
    super(`${text} (${name}, ${rule})`);
    this.name = "TactusError";
    Object.assign(this, {status, errorClass: name, rule, remedy, advice, bitOffset});
  }
}

/** Instantiate the module. */
export async function load(source = new URL("./tactus.wasm", import.meta.url)) {
  const module = source instanceof WebAssembly.Module ? source : await WebAssembly.compile(await bytesOf(source));
  const instance = await WebAssembly.instantiate(module, {});
  instance.exports._initialize();
  return new Tactus(instance.exports);
}

async function bytesOf(source) {
  if (!(source instanceof URL)) return source;
  if (source.protocol !== "file:") return (await fetch(source)).arrayBuffer();
  const {readFile} = await import("node:fs/promises");
  return readFile(source);
}

function checkBytes(bytes) {
  if (!ArrayBuffer.isView(bytes) || bytes.BYTES_PER_ELEMENT !== 1) throw new TypeError("tactus: give bytes as a Uint8Array");
}

function checkNumber(number) {
  if (!Number.isSafeInteger(number)) throw new TypeError("tactus: a packet's number is a whole number, and comes before its bytes");
}

class Tactus {
  constructor(exports) {
    this.exports = exports;
    this.memory = new Memory(exports);
  }

  get version() {
    const version = this.exports.tactus_version();
    return `${version >> 16}.${(version >> 8) & 255}.${version & 255}`;
  }

  openPlayer(file, options = {}) {
    return new Player(this, file, options);
  }

  parseScene(bytes, limits = undefined) {
    checkBytes(bytes);
    return withLimits(this, limits, (limitsAt) => this.memory.with(bytes.length + 8, (at) => {
      this.memory.bytes(at + 8, bytes.length).set(bytes);
      this.call("tactus_scene_parse", at + 8, bytes.length, limitsAt, at, at + 4);
      return new Scene(this, this.memory.view.getUint32(at, true), this.memory.view.getUint32(at + 4, true));
    }));
  }

  createReceiver(scene, options = {}) {
    return withOptions(this, options, (optionsAt) => this.memory.with(4, (at) => {
      this.call("tactus_receiver_create", scene.handle, optionsAt, at);
      return new Receiver(this, this.memory.view.getUint32(at, true), true);
    }));
  }

  // Call a function that can fail; the error is thrown. Returns whether something was there.
  call(name, ...args) {
    return this.memory.with(layouts.tactus_error.size, (error) => {
      const status = this.exports[name](...args, error);
      if (status === constants.TACTUS_OK) return true;
      if (status === constants.TACTUS_NOTHING) return false;
      throw this.error(error);
    });
  }

  error(at) {
    const {status, advice, bit_offset: bitOffset, name, rule, text, remedy} = this.memory.struct("tactus_error", at);
    return new TactusError({
      status, bitOffset, name: this.memory.text(name), rule: this.memory.text(rule), text: this.memory.text(text),
      remedy: this.memory.text(remedy), advice: advices[advice],
    });
  }

  // The answer of a function that fills a struct, or null.
  ask(struct, name, ...args) {
    return this.memory.withAnswer(struct, (at) => (this.call(name, ...args, at) ? this.memory.struct(struct, at) : null));
  }
}

function withLimits(tactus, limits, body) {
  if (limits === undefined) return body(0);
  return tactus.memory.with(layouts.tactus_limits.size, (at) => {
    tactus.exports.tactus_init(constants.TACTUS_LIMITS, at, layouts.tactus_limits.size);
    for (const [name, value] of Object.entries(limits)) tactus.memory.set("tactus_limits", name, at, value);
    return body(at);
  });
}

function withOptions(tactus, {interpolation = "none", limits = undefined}, body) {
  const {size} = layouts.tactus_receiver_options;
  return withLimits(tactus, limits, (limitsAt) => tactus.memory.with(size, (at) => {
    tactus.exports.tactus_init(constants.TACTUS_RECEIVER_OPTIONS, at, size);
    tactus.memory.set("tactus_receiver_options", "interpolation", at, interpolations.indexOf(interpolation));
    tactus.memory.set("tactus_receiver_options", "limits", at, limitsAt);
    return body(at);
  }));
}

function packetOf(info) {
  const {tick, number, bytes, offset, substream, kind, key, layer, reason, updates} = info;
  return {
    tick: Number(tick), number: Number(number), bytes, offset: Number(offset), substream, kind: kinds[kind], key: key !== 0,
    layer: layers[layer], reason: reasons[reason], updates,
  };
}

export class Scene {
  #tactus;
  #own;

  constructor(tactus, handle, used = null) {
    this.#tactus = tactus;
    this.#own = used !== null;
    this.handle = handle;
    this.bytes = used;
    const info = tactus.ask("tactus_scene_info", "tactus_scene_get", handle);
    this.tickRate = info.tick_rate;
    this.substreams = info.substreams;
    this.positionExp = info.position_exp;
    this.smoothed = info.smoothed !== 0;
    this.loadUsers = info.has_loads ? info.load_users : null;
    this.rigid = Array.from({length: info.rigid}, (_, i) => this.#rigid(i));
    this.deformables = Array.from({length: info.deformables}, (_, i) => this.#deformable(i));
  }

  #rigid(i) {
    const {name, dof, initial} = this.#tactus.ask("tactus_rigid_info", "tactus_scene_get_rigid", this.handle, i);
    return {name: this.#tactus.memory.text(name), dof, initial};
  }

  #deformable(i) {
    const info = this.#tactus.ask("tactus_deformable_info", "tactus_scene_get_deformable", this.handle, i);
    return {
      name: this.#tactus.memory.text(info.name), vertices: info.vertices, triangles: info.triangles, modes: info.modes,
      profile: profiles[info.profile], layered: info.layered !== 0, framePeriod: info.frame_period, clusters: info.clusters,
    };
  }

  // One array of a deformable object, of so many bytes; null: it has none.
  #array(i, field, bytes, read) {
    const {memory} = this.#tactus;
    const {vertices, triangles} = this.deformables[i];
    return memory.with(bytes, (at) => memory.withAnswer("tactus_mesh_arrays", (arrays) => {
      const given = {vertices, triangles, [field]: at};
      for (const [name, value] of Object.entries(given)) memory.set("tactus_mesh_arrays", name, arrays, value);
      return this.#tactus.call("tactus_scene_get_mesh", this.handle, i, arrays) ? read(at) : null;
    }));
  }

  rest(i) {
    const count = 3 * this.deformables[i].vertices;
    return this.#array(i, "rest", 4 * count, (at) => this.#tactus.memory.floats(at, count).slice());
  }

  triangles(i) {
    const count = 3 * this.deformables[i].triangles;
    return this.#array(i, "corners", 4 * count, (at) => this.#tactus.memory.numbers(at, count).slice());
  }

  stiffness(i) {
    const count = this.deformables[i].vertices;
    return this.#array(i, "stiffness", 8 * count, (at) => this.#tactus.memory.doubles(at, count).slice());
  }

  // Bounds of a kind; null: they are not declared. The arguments before and after their place in memory are those of the function.
  #bounds(struct, before, after) {
    const {memory} = this.#tactus;
    return memory.withAnswer(struct, (at) =>
      this.#tactus.call("tactus_scene_get_bounds", this.handle, ...before, at, ...after) ? memory.struct(struct, at) : null);
  }

  get rigidBounds() {
    const bounds = this.#bounds("tactus_rigid_bounds", [], [0, 0, 0]);
    return bounds && {
      haptic: hapticRules[bounds.haptic], heartbeat: bounds.heartbeat, visualPosition: bounds.visual_position,
      visualRotation: bounds.visual_rotation, weberFraction: bounds.weber_fraction, perceptualFraction: bounds.perceptual_fraction,
      coneAngle: bounds.cone_angle, fixedPosition: bounds.fixed_position, fixedRotation: bounds.fixed_rotation,
      forceFloor: bounds.force_floor,
    };
  }

  deformableBounds(i) {
    const bounds = this.#bounds("tactus_deformable_bounds", [0, i], [0]);
    return bounds && {
      visual: bounds.visual, weberFraction: bounds.haptic ? bounds.weber_fraction : null, depthFloor: bounds.depth_floor,
      kept: bounds.kept !== 0,
    };
  }

  close() {
    if (this.#own) this.#tactus.exports.tactus_scene_destroy(this.handle);
    this.#own = false;
    this.handle = 0;  // the module refuses it
  }
}

export class Receiver {
  #tactus;
  #handle;
  #own;

  constructor(tactus, handle, own) {
    this.#tactus = tactus;
    this.#handle = handle;
    this.#own = own;
    this.scene = new Scene(tactus, tactus.exports.tactus_receiver_scene(handle));
  }

  push(number, packet, now = null) {
    checkNumber(number);
    checkBytes(packet);
    const {memory} = this.#tactus;
    const applied = now === null ? -(2n ** 63n) : BigInt(now);  // TACTUS_PACKET_TICK
    return memory.with(Math.max(1, packet.length), (at) => {
      memory.bytes(at, packet.length).set(packet);
      return packetOf(this.#tactus.memory.withAnswer("tactus_packet_info", (info) => {
        this.#tactus.call("tactus_receiver_push", this.#handle, BigInt(number), at, packet.length, applied, info);
        return memory.struct("tactus_packet_info", info);
      }));
    });
  }

  skipNumber(number) {
    checkNumber(number);
    this.#tactus.call("tactus_receiver_push", this.#handle, BigInt(number), 0, 0, 0n, 0);
  }

  updates() {
    const {size} = layouts.tactus_update;
    const room = Math.max(1, this.scene.rigid.length);
    return this.#tactus.memory.with(size * room + 4, (at) => {
      this.#tactus.call("tactus_receiver_updates", this.#handle, at + 4, room, at);
      return Array.from({length: this.#tactus.memory.view.getUint32(at, true)}, (_, i) => {
        const {object, reason, level} = this.#tactus.memory.struct("tactus_update", at + 4 + size * i);
        return {object, reason: reasons[reason], level};
      });
    });
  }

  poses(tick, out = new Float64Array(7 * this.scene.rigid.length)) {
    const count = this.scene.rigid.length;
    return this.#tactus.memory.with(8 * 7 * count, (at) => {
      this.#tactus.call("tactus_receiver_poses", this.#handle, BigInt(tick), 0, count, at, 0);
      out.set(this.#tactus.memory.doubles(at, 7 * count));
      return out;
    });
  }

  displacements(object, tick, out = new Float32Array(3 * this.scene.deformables[object].vertices)) {
    const count = 3 * this.scene.deformables[object].vertices;
    return this.#tactus.memory.with(4 * count, (at) => {
      this.#tactus.call("tactus_receiver_displacements", this.#handle, object, BigInt(tick), at, count);
      out.set(this.#tactus.memory.floats(at, count));
      return out;
    });
  }

  loads(object, tick) {
    const count = 3 * (2 + (this.scene.loadUsers ?? 0));
    return this.#tactus.memory.with(8 * count, (at) =>
      this.#tactus.call("tactus_receiver_loads", this.#handle, object, BigInt(tick), at, count)
        ? this.#tactus.memory.doubles(at, count).slice()
        : null);
  }

  stateHash(substream) {
    return this.#hash((at) => [substream, at, 0n, 0]);
  }

  poseHash(tick) {
    return this.#hash((at) => [0, 0, BigInt(tick), at]);
  }

  #hash(argumentsFor) {
    return this.#tactus.memory.with(8, (at) => {
      this.#tactus.call("tactus_receiver_hash", this.#handle, ...argumentsFor(at));
      return this.#tactus.memory.view.getBigUint64(at, true).toString(16).padStart(16, "0");
    });
  }

  close() {
    if (this.#own) this.#tactus.exports.tactus_receiver_destroy(this.#handle);
    this.#own = false;
    this.#handle = 0;
    this.scene.close();
  }
}

export class Player {
  #tactus;
  #file;
  #handle;

  constructor(tactus, file, options) {
    checkBytes(file);
    this.#tactus = tactus;
    this.#file = tactus.memory.copy(file);
    try {
      this.#handle = withOptions(tactus, options, (optionsAt) => tactus.memory.with(4, (at) => {
        tactus.call("tactus_player_open", this.#file, file.length, optionsAt, at);
        return tactus.memory.view.getUint32(at, true);
      }));
    } catch (error) {
      tactus.memory.release(this.#file);
      throw error;
    }
    this.receiver = new Receiver(tactus, tactus.exports.tactus_player_receiver(this.#handle), false);
    this.scene = this.receiver.scene;
  }

  play(tick) {
    const info = this.#tactus.ask("tactus_packet_info", "tactus_player_play", this.#handle, BigInt(tick));
    return info && packetOf(info);
  }

  #info() {
    return this.#tactus.ask("tactus_player_info", "tactus_player_get", this.#handle);
  }

  nextTick() {
    const {next_tick: tick} = this.#info();
    return tick === 2n ** 63n - 1n ? null : Number(tick);
  }

  get headerBytes() {
    return Number(this.#info().header_bytes);
  }

  get complete() {
    return this.#info().complete !== 0;
  }

  close() {
    if (this.#handle === 0) return;
    this.receiver.close();
    this.#tactus.exports.tactus_player_destroy(this.#handle);
    this.#tactus.memory.release(this.#file);
    this.#handle = 0;
  }
}
