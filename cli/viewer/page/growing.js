// SPDX-License-Identifier: Apache-2.0
// Numbers that come at the end and leave at the front, in a few times the room that they take.
export class Growing {
  #room;
  #begin = 0;
  #end;

  // in  values  a typed array, which becomes its own
  constructor(values) {
    this.#room = values;
    this.#end = values.length;
  }

  get length() {
    return this.#end - this.#begin;
  }

  // All of them; valid until the next change.
  get view() {
    return this.#room.subarray(this.#begin, this.#end);
  }

  add(values) {
    if (this.#end + values.length > this.#room.length) this.#makeRoom(this.length + values.length);
    this.#room.set(values, this.#end);
    this.#end += values.length;
  }

  #makeRoom(wanted) {
    const kept = this.view;
    if (2 * wanted > this.#room.length) this.#room = new this.#room.constructor(2 * wanted);
    this.#room.set(kept);
    this.#begin = 0;
    this.#end = kept.length;
  }

  drop(count) {
    this.#begin += count;
  }
}

function columnsOf(value, found = []) {
  for (const [name, part] of Object.entries(value)) {
    if (part instanceof Float64Array) found.push({holder: value, name});
    else if (typeof part === "object" && part !== null) columnsOf(part, found);
  }
  return found;
}

// A table that grows: an object with columns of one length in it, at any depth. They are views, renewed with each change.
export class GrowingTable {
  #columns;

  constructor(value) {
    this.value = value;
    this.#columns = columnsOf(value).map(({holder, name}) => ({holder, name, numbers: new Growing(holder[name])}));
  }

  get length() {
    return this.#columns[0].numbers.length;
  }

  // in  value  of the same form
  add(value) {
    columnsOf(value).forEach(({holder, name}, i) => this.#columns[i].numbers.add(holder[name]));
    this.#renew();
  }

  drop(count) {
    for (const {numbers} of this.#columns) numbers.drop(count);
    this.#renew();
  }

  #renew() {
    for (const {holder, name, numbers} of this.#columns) holder[name] = numbers.view;
  }
}
