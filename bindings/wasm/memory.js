// SPDX-License-Identifier: Apache-2.0
// Structs, bytes and texts in the memory of the WebAssembly module.
import {layouts} from "./interface.js";

const readers = {
  int32_t: "getInt32", uint32_t: "getUint32", tactus_status: "getInt32", size_t: "getUint32", pointer: "getUint32",
  int64_t: "getBigInt64", uint64_t: "getBigUint64", float: "getFloat32", double: "getFloat64", uint8_t: "getUint8",
};
const decoder = new TextDecoder();

export class Memory {
  #exports;

  constructor(exports) {
    this.#exports = exports;
  }

  // The memory moves when it grows: a view is used before the next call of the module.
  get view() {
    return new DataView(this.#exports.memory.buffer);
  }

  bytes(at, size) {
    return new Uint8Array(this.#exports.memory.buffer, at, size);
  }

  floats(at, count) {
    return new Float32Array(this.#exports.memory.buffer, at, count);
  }

  doubles(at, count) {
    return new Float64Array(this.#exports.memory.buffer, at, count);
  }

  numbers(at, count) {
    return new Uint32Array(this.#exports.memory.buffer, at, count);
  }

  allocate(size) {
    const at = this.#exports.malloc(Math.max(1, size));
    if (at === 0) throw new RangeError("tactus: the module has no memory left");
    return at;
  }

  release(at) {
    this.#exports.free(at);
  }

  // Room that lasts for one call of `body`.
  with(size, body) {
    const at = this.allocate(size);
    try {
      return body(at);
    } finally {
      this.release(at);
    }
  }

  copy(bytes) {
    const at = this.allocate(bytes.length);
    this.bytes(at, bytes.length).set(bytes);
    return at;
  }

  text(at) {
    if (at === 0) return "";
    const {buffer} = this.#exports.memory;
    const all = new Uint8Array(buffer, at);
    return decoder.decode(all.subarray(0, all.indexOf(0)));
  }

  field(struct, name, at) {
    const {type, offset, count} = layouts[struct].fields[name];
    const one = (address) => (type in layouts ? this.struct(type, address) : this.view[readers[type]](address, true));
    if (count === 1) return one(at + offset);
    const size = layouts[type]?.size ?? sizes[type];
    return Array.from({length: count}, (_, i) => one(at + offset + i * size));
  }

  // All fields of a struct but the size that it begins with.
  struct(name, at) {
    const fields = Object.keys(layouts[name].fields).filter((field) => field !== "size" && field !== "reserved");
    return Object.fromEntries(fields.map((field) => [field, this.field(name, field, at)]));
  }

  set(struct, name, at, value) {
    const {type, offset} = layouts[struct].fields[name];
    this.view[readers[type].replace("get", "set")](at + offset, value, true);
  }

  // A struct that begins with its size, for an answer.
  withAnswer(struct, body) {
    return this.with(layouts[struct].size, (at) => {
      this.bytes(at, layouts[struct].size).fill(0);
      this.set(struct, "size", at, layouts[struct].size);
      return body(at);
    });
  }
}

const sizes = {int32_t: 4, uint32_t: 4, tactus_status: 4, size_t: 4, pointer: 4, int64_t: 8, uint64_t: 8, float: 4, double: 8, uint8_t: 1};
