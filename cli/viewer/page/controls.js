// SPDX-License-Identifier: Apache-2.0
// Buttons, keys and the pointer on the time line.
import {speeds} from "./clock.js";

const keys = [
  ["Space", "play or pause"], ["← →", "one tick; with Shift 0.1 s"], ["[ ]", "packet before, next packet"],
  ["Home End", "to the start, to the end (of a running session: now)"], ["− +", "slower, faster"], ["L", "loop"], ["T D C F", "show truth, device, contact, forces"],
  ["V", "next colour of the mesh"], ["0", "see all of the scene"], ["?", "this help"],
];
const layerKeys = {t: "truth", d: "device", c: "contact", f: "forces"};

const byId = (id) => document.getElementById(id);

export class Controls {
  constructor({clock, model, picture, timeline, redraw}) {
    Object.assign(this, {clock, model, picture, timeline, redraw});
    this.#fillSpeeds();
    this.#listen();
    this.#fillHelp();
    if (picture) this.#fillLayers();
    if (picture?.colourings.length > 0) this.#fillColours();
  }

  #fillSpeeds() {
    for (const speed of speeds) byId("speed").add(new Option(`${speed} ×`, speed, false, speed === 1));
    byId("speed").addEventListener("change", ({target}) => (this.clock.speed = Number(target.value)));
  }

  #fillLayers() {
    for (const name of this.picture.layers.keys()) {
      const label = document.createElement("label");
      const box = document.createElement("input");
      box.type = "checkbox";
      box.checked = true;
      box.id = `layer-${name}`;
      box.addEventListener("change", () => {
        this.picture.setVisible(name, box.checked);
        this.redraw();
      });
      label.append(box, ` ${name}`);
      byId("layers").append(label);
    }
    byId("layers").hidden = this.picture.layers.size === 0;
  }

  #fillColours() {
    for (const {name} of this.picture.colourings) byId("colour").add(new Option(name, name));
    byId("colouring").hidden = byId("colour-bar").hidden = byId("colour-range").hidden = false;
    byId("colour").addEventListener("change", ({target}) => {
      this.picture.colouring = this.picture.colourings[target.selectedIndex];
      this.redraw();
    });
  }

  #fillHelp() {
    const table = document.createElement("table");
    for (const [key, what] of keys) {
      const row = table.insertRow();
      const head = document.createElement("th");
      for (const one of key.split(" ")) {
        const cap = document.createElement("kbd");
        cap.textContent = one;
        head.append(cap, " ");
      }
      row.append(head);
      row.insertCell().textContent = what;
    }
    const note = document.createElement("p");
    note.textContent = "Drag the scene to turn it, with the right button to move it; the wheel or two fingers zoom. Click or drag on the "
      + "time line to go there. An address that ends in #t=3.25 opens the page at 3.25 s. A packet has the colour and the row of its "
      + "strictest reason. Strips show the largest error of all moving objects and all touches; dashed is the bound that the stream "
      + "declares, red what is over it. What is drawn is decoded in this page from the packets of the stream.";
    byId("help-text").append(table, note);
  }

  #listen() {
    byId("play").addEventListener("click", () => this.clock.toggle());
    byId("back").addEventListener("click", () => this.stepPacket(-1));
    byId("next").addEventListener("click", () => this.stepPacket(1));
    byId("loop").addEventListener("change", ({target}) => (this.clock.loops = target.checked));
    byId("follow").addEventListener("click", () => this.clock.follow());
    byId("help-button").addEventListener("click", () => byId("help").showModal());
    byId("link").addEventListener("click", () => this.#copyLink());
    document.addEventListener("keydown", (event) => this.#key(event));
    const line = byId("timeline");
    line.addEventListener("pointerdown", (event) => {
      line.setPointerCapture(event.pointerId);
      this.clock.seek(this.timeline.timeAt(event.clientX));
    });
    line.addEventListener("pointermove", (event) => {
      if (line.hasPointerCapture(event.pointerId)) this.clock.seek(this.timeline.timeAt(event.clientX));
    });
  }

  get tick() {
    return Math.floor(this.clock.time * this.model.tickRate + 1e-6);
  }

  seekTick(tick) {
    this.clock.seek(tick / this.model.tickRate);
  }

  stepPacket(direction) {
    const {ticks} = this.model.packets;
    const after = this.model.packetsUpTo(this.tick);
    if (direction > 0 && after < ticks.length) this.seekTick(ticks[after]);
    if (direction < 0) {
      let before = after - 1;
      while (before >= 0 && ticks[before] >= this.tick) --before;
      this.seekTick(before >= 0 ? ticks[before] : 0);
    }
  }

  #key(event) {
    const {key, target, shiftKey, ctrlKey, metaKey, altKey} = event;
    if (ctrlKey || metaKey || altKey || byId("help").open || target.tagName === "SELECT") return;
    if (key === " " && (target.tagName === "BUTTON" || target.tagName === "INPUT")) return;
    const step = shiftKey ? Math.max(1, Math.round(this.model.tickRate / 10)) : 1;
    const actions = {
      " ": () => this.clock.toggle(),
      ArrowLeft: () => this.seekTick(this.tick - step),
      ArrowRight: () => this.seekTick(this.tick + step),
      "[": () => this.stepPacket(-1),
      "]": () => this.stepPacket(1),
      Home: () => this.clock.seek(0),
      End: () => (this.clock.isLive ? this.clock.follow() : this.clock.seek(this.clock.duration)),
      "-": () => this.#changeSpeed(-1),
      "+": () => this.#changeSpeed(1),
      "=": () => this.#changeSpeed(1),
      "?": () => byId("help").showModal(),
      l: () => byId("loop").click(),
      v: () => this.#nextColour(),
      0: () => {
        this.picture?.view.lookAtAll();
        this.redraw();
      },
    };
    const layer = layerKeys[key.toLowerCase()];
    const action = actions[key.length === 1 ? key.toLowerCase() : key] ?? (layer && (() => byId(`layer-${layer}`)?.click()));
    if (!action) return;
    event.preventDefault();
    action();
  }

  #changeSpeed(by) {
    const list = byId("speed");
    list.selectedIndex = Math.min(Math.max(list.selectedIndex + by, 0), list.length - 1);
    this.clock.speed = speeds[list.selectedIndex];
  }

  #nextColour() {
    const list = byId("colour");
    if (list.length === 0) return;
    list.selectedIndex = (list.selectedIndex + 1) % list.length;
    list.dispatchEvent(new Event("change"));
  }

  async #copyLink() {
    const {href} = location;
    try {
      await navigator.clipboard.writeText(href);
      byId("link").textContent = "Copied";
    } catch {
      byId("link").textContent = "It is in the address bar";
    }
    setTimeout(() => (byId("link").textContent = "Copy link"), 1500);
  }
}
