// SPDX-License-Identifier: Apache-2.0
// The page of `tactus view` and of a server that is observed: decodes a stream with the WebAssembly decoder and shows it over time.
import {load} from "@tactus-codec/decoder";
import {Clock, timeOfLink} from "./clock.js";
import {Controls} from "./controls.js";
import {Feed} from "./feed.js";
import {keptSeconds, LiveModel} from "./live_model.js";
import {Model, norm} from "./model.js";
import {Picture} from "./picture.js";
import {bytesOf} from "./read_columns.js";
import {Readings} from "./readings.js";
import {lanesOf, rowsOf} from "./strips.js";
import {colour, map, onThemeChange} from "./theme.js";
import {Timeline} from "./timeline.js";
import {inUnit, plain, units} from "./units.js";

const stripSpacing = 125;  // ms between two drawings of strips that move

const byId = (id) => document.getElementById(id);

class Page {
  #stale = true;
  #shown = -1;
  #stripsDue = 0;

  constructor(model) {
    this.model = model;
    this.clock = new Clock(model.duration, () => this.redraw());
    this.picture = this.#makePicture();
    this.timeline = new Timeline(byId("timeline"), this.#content());
    const redraw = () => this.redraw();
    this.controls = new Controls({clock: this.clock, model, picture: this.picture, timeline: this.timeline, redraw});
    this.readings = this.#makeReadings();
    this.#describe();
    this.picture?.view.controls.addEventListener("change", () => (this.#stale = true));
    new ResizeObserver(() => this.#resize()).observe(document.body);
    onThemeChange(() => this.#paint());
    this.#resize();
    if (model.isLive) this.#beginLive();
    else this.#beginLinks();
  }

  #beginLinks() {
    addEventListener("hashchange", () => this.#followLink());
    this.#followLink();
  }

  #beginLive() {
    this.clock.isLive = true;
    for (const id of ["loop-label", "link"]) byId(id).hidden = true;
    byId("follow").hidden = false;
    this.clock.move(this.model.start, this.model.duration);
    this.clock.follow();
  }

  // The model of a live page has grown.
  grow() {
    this.clock.move(this.model.start, this.model.duration);
  }

  // What the time line shows; of a live page the last half a minute.
  #content() {
    const {model} = this;
    const content = {lanes: lanesOf(model), rows: rowsOf(model)};
    if (!model.isLive) return {...content, begin: 0, end: model.duration};
    const begin = Math.max(model.start, model.duration - keptSeconds);
    return {...content, begin, end: begin + keptSeconds};
  }

  #makePicture() {
    byId("message").hidden = true;
    try {
      return new Picture(byId("scene"), this.model);
    } catch (error) {
      byId("message").textContent = /WebGL/.test(error.message)
        ? "This browser has no WebGL 2, so the scene cannot be drawn. The time line and the numbers work without it. "
          + "Browsers switch it off without a graphics driver; a current Firefox or Chrome has it."
        : `The scene cannot be drawn: ${error.message}`;
      byId("message").hidden = false;
      return null;
    }
  }

  #makeReadings() {
    const {truth, scene} = this.model;
    const readings = new Readings(byId("readings"));
    readings.add("packets", this.model.isLive ? "packets" : "packets so far");
    readings.add("bytes", this.model.isLive ? "payload" : "payload so far");
    if (this.model.isLive) readings.add("checked", "server's state");
    if (truth?.errors || truth?.meshes.length > 0) readings.group("Error against the truth");
    if (truth?.errors) readings.add("position", "position", "length");
    if (truth?.errors) readings.add("rotation", "rotation", "angle");
    if (truth?.errors?.force) readings.add("force", "normal force", "force");
    truth?.meshes.forEach((_, i) => readings.add(`mesh-${i}`, scene.deformables[i].name, "length"));
    truth?.users.forEach((user, i) => {
      readings.group(truth.users.length > 1 ? `Force on ${user.name}` : "Force");
      if (user.server) readings.add(`server-${i}`, "server", "force");
      if (user.rendered) readings.add(`rendered-${i}`, "rendered to the hand", "force");
      if (user.shown) readings.add(`shown-${i}`, "normal, decoded", "force");
    });
    return readings;
  }

  #describe() {
    const {model, picture} = this;
    const {rigid, deformables} = model.scene;
    document.title = `${model.name} – Tactus`;
    byId("title").textContent = model.name;
    const count = (n, one) => `${n} ${one}${n === 1 ? "" : "s"}`;
    const vertices = deformables.reduce((sum, mesh) => sum + mesh.vertices, 0);
    const parts = [model.isLive ? `live, ${model.tickRate} Hz` : `${model.duration.toFixed(2)} s at ${model.tickRate} Hz`];
    if (rigid.length > 0) parts.push(count(rigid.length, "rigid object"));
    if (deformables.length > 0) parts.push(`${count(deformables.length, "mesh").replace("meshs", "meshes")} of ${vertices} vertices`);
    if (!model.isLive) {
      const rate = (8 * this.#payload(0, Infinity)) / 1000 / Math.max(model.duration, 1e-9);
      parts.push(count(model.packets.ticks.length, "packet"), `${rate.toFixed(2)} kbit/s payload`);
    }
    if (model.truth && !model.isLive) parts.push(`truth: ${model.truth.name}`);
    byId("facts").textContent = parts.join(" · ");
    if (picture) this.#fillLegend();
  }

  #payload(first, end) {
    return this.model.packets.sizes.subarray(first, end).reduce((sum, size) => sum + size, 0);
  }

  #fillLegend() {
    const {truth, scene} = this.model;
    const entries = [];
    if (scene.rigid.length > 0) entries.push(["", "object", "decoded"]);
    const within = scene.rigid.length > 0 ? truth?.ghostPosition : truth?.ghostVertex;
    if (truth) entries.push(["frame", "ghost", `truth (drawn within ${plain(within, "length")})`]);
    if (truth?.users.length > 0) {
      const hasRendered = truth.users.some(({rendered}) => rendered);
      const areRendered = !hasRendered && truth.users.every(({knows}) => knows === "both");
      entries.push(["dot", "device", "device"]);
      if (truth.users.some(({server}) => server)) entries.push(["", "server", areRendered ? "rendered force" : "force of the server"]);
      if (hasRendered) entries.push(["", "rendered", "rendered force"]);
      if (truth.users.some(({shown}) => shown)) entries.push(["", "shown", "normal force, as decoded"]);
    }
    byId("legend").replaceChildren(...entries.map(([shape, named, text]) => {
      const row = document.createElement("div");
      const sample = document.createElement("i");
      sample.className = shape;
      sample.style.background = sample.style.borderColor = colour(named);
      row.append(sample, text);
      return row;
    }));
  }

  #paint() {
    this.picture?.view.paint();
    if (this.picture) this.#fillLegend();
    this.timeline.draw();
    this.redraw();
  }

  #resize() {
    this.timeline.resize();
    this.picture?.view.resize();
    this.redraw();
  }

  #followLink() {
    const time = timeOfLink(location.hash);
    if (time !== null) this.clock.seek(time);
  }

  redraw() {
    this.#stale = true;
    this.#shown = -1;
  }

  // Called for each picture of the screen.
  frame(now) {
    this.clock.advance(now);
    if (this.model.isLive && now >= this.#stripsDue) {
      this.#stripsDue = now + stripSpacing;
      this.timeline.hold(this.#content());
      this.timeline.draw();
    }
    this.picture?.view.controls.update();
    if (!this.#stale) return;
    this.#stale = false;
    const {tick} = this.controls;
    if (tick !== this.#shown) this.#showTick(tick);
    this.picture?.view.draw();
  }

  #showTick(tick) {
    this.#shown = tick;
    if (this.picture) this.picture.show(tick);
    else this.model.moveTo(tick);
    this.timeline.moveTo(this.clock.time);
    this.#fillReadings(tick);
    const isStill = !this.clock.plays && !this.model.isLive;
    if (isStill) history.replaceState(null, "", `#t=${this.clock.time.toFixed(3)}`);
  }

  #fillReadings(tick) {
    const {model, clock, picture} = this;
    byId("play").textContent = clock.plays || clock.follows ? "Pause" : "Play";
    byId("follow").disabled = clock.follows;
    byId("clock").textContent = model.isLive ? this.#liveClock() : `${clock.time.toFixed(3)} s of ${model.duration.toFixed(3)} s`;
    this.#showScales();
    const line = byId("timeline");
    line.setAttribute("aria-valuemin", String(clock.start));
    line.setAttribute("aria-valuemax", String(model.duration));
    line.setAttribute("aria-valuenow", clock.time.toFixed(3));
    line.setAttribute("aria-valuetext", `${clock.time.toFixed(3)} s`);
    const count = model.packetsUpTo(tick);
    if (model.isLive) this.#showRates(model.packetsUpTo(tick - model.tickRate), count);
    else this.#showTotals(count);
    if (model.checked) this.#showChecked(model.checked);
    this.#showTruth(tick);
    if (picture?.colouring) this.#showColours();
  }

  #showTotals(count) {
    this.readings.set("packets", String(count));
    this.readings.set("bytes", `${(this.#payload(0, count) / 1000).toFixed(2)} kB`);
  }

  // Of the last second.
  #showRates(first, end) {
    this.readings.set("packets", `${end - first} /s`);
    this.readings.set("bytes", `${((8 * this.#payload(first, end)) / 1000).toFixed(2)} kbit/s`);
  }

  #liveClock() {
    const {time, duration, follows} = this.clock;
    return follows ? `${time.toFixed(2)} s, now` : `${time.toFixed(3)} s, ${(duration - time).toFixed(1)} s ago`;
  }

  // Once a second the server sends its hashes.
  #showChecked({tick, isEqual}) {
    const at = `${(tick / this.model.tickRate).toFixed(1)} s`;
    this.readings.set("checked", isEqual ? `equal, ${at}` : `NOT equal, ${at}`, !isEqual);
  }

  #showScales() {
    const {picture, model} = this;
    if (!picture) return;
    const unknown = picture.objects?.areKnown === false ? ["axes stand for objects whose shapes are not known (--truth, --scene)"] : [];
    const lost = model.leftOut > 0 ? [`${model.leftOut} ticks were left out: the server was too busy`] : [];
    const text = [...picture.scales, ...unknown, ...lost].join(" · ");
    if (byId("scale").textContent !== text) byId("scale").textContent = text;
  }

  #showTruth(tick) {
    const {truth, scene} = this.model;
    const row = this.model.rowAt(tick);
    if (row < 0) return;
    const {errors} = truth;
    const bounds = scene.rigidBounds;
    if (errors) this.readings.set("position", errors.position[row], bounds && errors.position[row] > bounds.visualPosition);
    if (errors) this.readings.set("rotation", errors.rotation[row], bounds && errors.rotation[row] > bounds.visualRotation);
    if (errors?.force) {
      const touches = truth.users.some(({kind}) => kind[row] === 1 || kind[row] === 2);
      const bound = errors.force_bound?.[row] ?? 0;
      this.readings.set("force", touches ? errors.force[row] : null, bound > 0 && errors.force[row] > bound * (1 + 1e-9));
    }
    truth.meshes.forEach(({ticks, error}, i) => {
      let at = ticks.length - 1;
      while (at >= 0 && ticks[at] > tick) --at;
      this.readings.set(`mesh-${i}`, at >= 0 ? error[at] : null);
    });
    truth.users.forEach((user, i) => {
      const touch = user.kind[row];  // 1, 2: of a rigid object, which alone has a force as decoded
      for (const kind of ["server", "rendered", "shown"]) {
        const isKnown = kind === "shown" ? touch === 1 || touch === 2 : touch > 0;
        if (user[kind]) this.readings.set(`${kind}-${i}`, isKnown ? norm(user[kind], row) : null);
      }
    });
  }

  #showColours() {
    const {colouring} = this.picture;
    const bar = byId("colour-bar").getContext("2d");
    map.forEach((rgb, x) => {
      bar.fillStyle = `rgb(${rgb.join(" ")})`;
      bar.fillRect(x, 0, 1, 1);
    });
    const most = Math.max(...this.model.scene.deformables.map((_, i) => colouring.most(i)));
    const {name: unit} = units[colouring.kind];
    const end = (value) => Object.assign(document.createElement("span"), {textContent: `${inUnit(value, colouring.kind)} ${unit}`});
    byId("colour-range").replaceChildren(end(0), end(most));
  }
}

function showStatus(text, isOver) {
  const status = byId("status");
  status.hidden = false;
  status.textContent = text;
  status.className = isOver ? "over" : "";
}

// What comes after an end is another run, or another program: the page begins anew with it.
function observe(tactus, begin) {
  byId("message").textContent = "Waiting for the server.";
  let hello = null;
  let page = null;
  new Feed(`ws://${location.host}/live`, {
    open: () => showStatus("live", false),
    closed: (text) => showStatus(`${text}; asking again`, true),
    message(message) {
      if (page && message.version) location.reload();
      else if (page) page.model.append(message, page.clock.follows), page.grow();
      else if (hello) page = show(tactus, new LiveModel(tactus, hello, message), begin);
      else hello = message;
    },
  });
}

async function start() {
  const begin = performance.now();
  const data = JSON.parse(byId("tactus-data").textContent);
  const tactus = await load(bytesOf(byId("tactus-wasm").textContent));
  if (data.live) observe(tactus, begin);
  else show(tactus, new Model(tactus, data), begin);
}

function show(tactus, model, begin) {
  const page = new Page(model);
  const next = (now) => {
    page.frame(now);
    requestAnimationFrame(next);
  };
  page.frame(performance.now());
  requestAnimationFrame(next);
  // For tests and scripts.
  globalThis.tactusView = {
    page, tactus, opened: performance.now() - begin,
    seek: (time) => page.clock.seek(time),
    hashes: () => page.model.replay.stateHashes(),
    project: (point) => page.picture.view.project(point),
  };
  return page;
}

start().catch((error) => {
  byId("message").textContent = `This page cannot show the stream: ${error.message}`;
  byId("message").hidden = false;
});
