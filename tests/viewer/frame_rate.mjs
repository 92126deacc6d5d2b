// SPDX-License-Identifier: Apache-2.0
// frame_rate.mjs TACTUS BROWSER WORK: how fast a page shows deforming meshes of 10^3, 10^4 and 10^5 vertices, with software WebGL.
import {execFileSync} from "node:child_process";
import {mkdirSync, statSync, writeFileSync} from "node:fs";
import {resolve} from "node:path";
import {pathToFileURL} from "node:url";
import {launch} from "./browser.mjs";

const [tactus, program, work] = process.argv.slice(2);
const frames = 20;

// A wave runs over a square sheet of side 0.2 m.
function writeFrames(folder, side) {
  mkdirSync(folder, {recursive: true});
  const faces = [];
  for (let i = 0; i + 1 < side; ++i) {
    for (let j = 0; j + 1 < side; ++j) {
      const a = i * side + j + 1;
      faces.push(`f ${a} ${a + side} ${a + 1}`, `f ${a + 1} ${a + side} ${a + side + 1}`);
    }
  }
  for (let frame = 0; frame < frames; ++frame) {
    const lines = [];
    for (let i = 0; i < side; ++i) {
      for (let j = 0; j < side; ++j) {
        const [x, y] = [(0.2 * i) / (side - 1), (0.2 * j) / (side - 1)];
        const z = frame === 0 ? 0 : 0.01 * Math.sin(30 * x + 0.4 * frame) * Math.cos(20 * y);
        lines.push(`v ${x.toFixed(6)} ${y.toFixed(6)} ${z.toFixed(6)}`);
      }
    }
    writeFileSync(`${folder}/${String(frame).padStart(3, "0")}.obj`, `${lines.join("\n")}\n${faces.join("\n")}\n`);
  }
}

const run = (...args) => execFileSync(tactus, args, {cwd: work, stdio: "inherit"});

mkdirSync(work, {recursive: true});
const browser = await launch(program);
for (const side of [32, 100, 316]) {
  const name = `sheet-${side}`;
  writeFrames(`${work}/${name}`, side);
  run("import", "mesh", name, "--rate", "60", "-o", `${name}.mcap`, "-f", "-q");
  run("encode", `${name}.mcap`, "-o", `${name}.tct`, "-f", "-q");
  run("view", `${name}.tct`, "-f", "-q");
  const page = resolve(work, `${name}.html`);
  const tab = await browser.open(pathToFileURL(page).href);
  await tab.until("globalThis.tactusView");
  const [opened, decoding, preparing, perFrame] = await tab.run(`(() => {
    const {page} = tactusView;
    const {ticks} = page.model.packets;
    const gl = document.getElementById("scene").getContext("webgl2");
    const pixel = new Uint8Array(4);
    const decodeBegin = performance.now();
    for (const tick of ticks) page.model.replay.moveTo(tick);
    const decoding = (performance.now() - decodeBegin) / ticks.length;
    const showBegin = performance.now();
    for (const tick of ticks) page.picture.show(tick);
    const preparing = (performance.now() - showBegin) / ticks.length;
    let shown = 0;
    const begin = performance.now();
    while (performance.now() - begin < 3000) {
      tactusView.seek(ticks[shown++ % ticks.length] / page.model.tickRate);
      page.frame(performance.now());
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    }
    return [tactusView.opened, decoding, preparing, (performance.now() - begin) / shown];
  })()`);
  console.log(`${side * side} vertices: page ${(statSync(page).size / 1e6).toFixed(2)} MB, first picture after ${opened.toFixed(0)} ms, `
    + `packet decoded in ${decoding.toFixed(2)} ms, ${(1000 / perFrame).toFixed(1)} pictures/s, ${perFrame.toFixed(1)} ms each, of which `
    + `${preparing.toFixed(1)} ms are the page's and the rest software WebGL's`);
  await tab.close();
}
await browser.close();
