// SPDX-License-Identifier: Apache-2.0
// The numbers at the cursor, as rows of a table.
import {inUnit, units} from "./units.js";

export class Readings {
  #body;
  #rows = new Map();

  constructor(table) {
    this.#body = table.tBodies[0];
  }

  group(name) {
    const row = this.#body.insertRow();
    row.className = "group";
    const head = document.createElement("th");
    head.colSpan = 3;
    head.textContent = name;
    row.append(head);
  }

  add(key, name, kind) {
    const row = this.#body.insertRow();
    const head = document.createElement("th");
    head.textContent = name;
    const value = document.createElement("td");
    const unit = document.createElement("td");
    unit.className = "unit";
    unit.textContent = kind ? units[kind].name : "";
    row.append(head, value, unit);
    this.#rows.set(key, {row, value, kind});
  }

  // in  value  SI, a text, or null: nothing to show
  set(key, value, isOver = false) {
    const {row, value: cell, kind} = this.#rows.get(key);
    const text = value === null ? "–" : kind ? inUnit(value, kind) : value;
    if (cell.textContent !== text) cell.textContent = text;
    row.className = isOver ? "over" : "";
  }
}
