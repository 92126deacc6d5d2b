// SPDX-License-Identifier: Apache-2.0
// The time line: packets as ticks by reason, and strips of values with their bounds, over one axis of time.
import {colour} from "./theme.js";
import {digits, roundStep} from "./units.js";

const laneHeight = 13;
const stripHeights = [30, 46];  // in low and in high windows
const axisHeight = 22;
const gap = 5;

export class Timeline {
  #element;
  #strips;
  #cursor;
  #lanes;
  #rows;
  #begin = 0;
  #end = 1;
  #width = 0;
  #strip = stripHeights[1];
  #left = 0;

  constructor(element, content) {
    this.#element = element;
    [this.#strips, this.#cursor] = element.querySelectorAll("canvas");
    this.hold(content);
  }

  // in  begin, end [s];  lanes  {name, colour, times};  rows  {name, unit, times, series: [{colour, values, dashed}]}
  hold({begin, end, lanes, rows}) {
    this.#begin = begin;
    this.#end = Math.max(end, begin + 1e-9);
    this.#lanes = lanes;
    this.#rows = rows;
  }

  get #height() {
    return 4 + this.#lanes.length * laneHeight + this.#rows.length * (this.#strip + gap) + axisHeight;
  }

  resize() {
    this.#width = this.#element.clientWidth;
    this.#left = this.#width < 600 ? 8 : 208;
    const room = 0.45 * innerHeight - this.#lanes.length * laneHeight - axisHeight;
    this.#strip = Math.min(Math.max(room / this.#rows.length - gap, stripHeights[0]), stripHeights[1]);
    this.#element.style.height = `${this.#height}px`;
    for (const canvas of [this.#strips, this.#cursor]) {
      canvas.style.height = `${this.#height}px`;
      canvas.width = Math.round(this.#width * devicePixelRatio);
      canvas.height = Math.round(this.#height * devicePixelRatio);
      canvas.getContext("2d").setTransform(devicePixelRatio, 0, 0, devicePixelRatio, 0, 0);
    }
    this.draw();
  }

  xOf(time) {
    const fraction = Math.min(Math.max((time - this.#begin) / (this.#end - this.#begin), 0), 1);
    return this.#left + fraction * (this.#width - this.#left - 14);
  }

  timeAt(clientX) {
    const x = clientX - this.#element.getBoundingClientRect().left;
    const fraction = Math.min(Math.max((x - this.#left) / (this.#width - this.#left - 14), 0), 1);
    return this.#begin + fraction * (this.#end - this.#begin);
  }

  draw() {
    const c = this.#strips.getContext("2d");
    c.clearRect(0, 0, this.#width, this.#height);
    c.font = `12px ${getComputedStyle(document.body).fontFamily}`;
    c.textBaseline = "middle";
    let y = 4;
    const narrow = this.#left < 100;
    for (const lane of this.#lanes) {
      this.#drawLane(c, lane, y, narrow);
      y += laneHeight;
    }
    for (const row of this.#rows) {
      y += gap;
      this.#drawRow(c, row, y, narrow);
      y += this.#strip;
    }
    this.#drawAxis(c, y);
  }

  #drawLane(c, {name, colour: named, times}, y, narrow) {
    c.fillStyle = colour(named);
    let last = -1;
    for (const time of times) {
      if (time < this.#begin) continue;
      const x = Math.round(this.xOf(time));
      if (x !== last) c.fillRect(x, y + 1, 1, laneHeight - 3);
      last = x;
    }
    this.#label(c, `${name}: ${times.length}`, y + laneHeight / 2 - 1, narrow, colour(named));
  }

  #label(c, text, y, narrow, ink) {
    if (narrow) {
      const {width} = c.measureText(text);
      c.fillStyle = colour("panel");
      c.globalAlpha = 0.75;
      c.fillRect(this.#left, y - 7, width + 6, 13);
      c.globalAlpha = 1;
    }
    c.fillStyle = ink;
    c.textAlign = narrow ? "left" : "right";
    c.fillText(text, narrow ? this.#left + 3 : this.#left - 10, y);
  }

  #drawRow(c, {name, unit, times, series}, y, narrow) {
    const right = this.#width - 14;
    let most = 0;
    for (const {values} of series) for (const value of values) if (value > most) most = value;
    const top = most > 0 ? most * 1.08 : 1;
    const bottom = y + this.#strip - 1;
    const heightOf = (value) => (value / top) * (this.#strip - 4);
    c.strokeStyle = colour("line");
    c.lineWidth = 1;
    c.strokeRect(this.#left - 0.5, y + 0.5, right - this.#left + 1, this.#strip - 1);
    for (const line of series) {
      if (line.dashed) this.#drawLine(c, times, line, bottom, heightOf);
      else this.#drawArea(c, times, line, bottom, heightOf);
    }
    this.#label(c, narrow ? `${name} [${unit}], to ${digits(most)}` : `${name} [${unit}]`, y + 9, narrow, colour("ink"));
    if (narrow) return;
    c.fillStyle = colour("soft");
    const bound = series.find(({dashed}) => dashed);
    const limit = bound?.fixed ? `, bound ${digits(bound.values[0])}` : bound ? ", dashed: bound" : "";
    c.fillText(`largest ${digits(largest(series[0].values))}${limit}`, this.#left - 10, y + 23);
  }

  // The largest value of each pixel.
  #byPixel(times, values) {
    const out = new Float64Array(Math.ceil(this.#width) + 1).fill(-1);
    let last = -1;
    for (let i = 0; i < times.length; ++i) {
      const x = Math.round(this.xOf(times[i]));
      if (x - last > 1 && last >= 0) out.fill(values[i - 1], last + 1, x);  // holds until then
      out[x] = Math.max(out[x], values[i]);
      last = x;
    }
    return out;
  }

  #drawArea(c, times, {values, colour: named, over}, bottom, heightOf) {
    const columns = this.#byPixel(times, values);
    const limits = over ? this.#byPixel(times, over) : null;
    const [ink, broken] = [colour(named), colour("over")];
    columns.forEach((value, x) => {
      if (value < 0) return;
      c.fillStyle = limits && limits[x] > 0 && value > limits[x] * (1 + 1e-9) ? broken : ink;
      const height = Math.max(value > 0 ? 1 : 0, heightOf(value));
      c.fillRect(x, bottom - height, 1, height);
    });
  }

  #drawLine(c, times, {values, colour: named}, bottom, heightOf) {
    c.strokeStyle = colour(named);
    c.setLineDash([5, 3]);
    c.beginPath();
    let open = false;
    this.#byPixel(times, values).forEach((value, x) => {
      if (value <= 0) open = false;
      else if (open) c.lineTo(x + 0.5, bottom - heightOf(value));
      else c.moveTo(x + 0.5, bottom - heightOf(value)), (open = true);
    });
    c.stroke();
    c.setLineDash([]);
  }

  #drawAxis(c, y) {
    const pixels = this.#width - this.#left - 14;
    const length = this.#end - this.#begin;
    const step = roundStep(Math.max(length / Math.max(2, pixels / 80), 1e-3));
    const spacing = length / step > pixels / 45 ? 2 * step : step;
    const first = Math.ceil(this.#begin / spacing - 1e-9);
    c.fillStyle = colour("soft");
    c.strokeStyle = colour("line");
    c.textAlign = "center";
    for (let i = first; i * spacing <= this.#end * (1 + 1e-9); ++i) {
      const x = Math.round(this.xOf(i * spacing)) + 0.5;
      c.beginPath();
      c.moveTo(x, y + 1);
      c.lineTo(x, y + 5);
      c.stroke();
      const text = `${+(i * spacing).toPrecision(6)}`;
      c.fillText(i === first ? `${text} s` : text, x, y + 13);
    }
  }

  moveTo(time) {
    const c = this.#cursor.getContext("2d");
    const x = this.xOf(time);
    c.clearRect(0, 0, this.#width, this.#height);
    c.fillStyle = colour("accent");
    c.fillRect(x - 0.75, 0, 1.5, this.#height - axisHeight + 5);
    c.beginPath();
    c.arc(x, this.#height - axisHeight + 5, 4, 0, 7);
    c.fill();
  }
}

function largest(values) {
  let most = 0;
  for (const value of values) if (value > most) most = value;
  return most;
}
