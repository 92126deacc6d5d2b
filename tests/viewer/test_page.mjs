// SPDX-License-Identifier: Apache-2.0
// test_page.mjs TACTUS BROWSER WORK CONFORMANCE SESSIONS_WASM: pages of `tactus view` in a real browser, chromium or firefox-esr.
import assert from "node:assert/strict";
import {execFileSync} from "node:child_process";
import {mkdirSync, readFileSync, readdirSync, writeFileSync} from "node:fs";
import {join, resolve} from "node:path";
import {pathToFileURL} from "node:url";
import {readSessions, readVectors} from "../wasm/read_vectors.mjs";
import {isFirefox, launch} from "./browser.mjs";
import {differingBox, readPng} from "./png.mjs";
import {near, runTests} from "./runner.mjs";

const [tactus, program, work, conformance, sessionsModule] = process.argv.slice(2);
const evil = "<img src=x onerror=globalThis.broken=1>";
mkdirSync(work, {recursive: true});
const file = (name) => resolve(work, name);
const url = (name) => pathToFileURL(file(name.split("#")[0])).href + name.slice(name.split("#")[0].length);
const run = (...args) => execFileSync(tactus, args, {cwd: work, stdio: ["ignore", "ignore", "inherit"]});

function makePages() {
  const scene = readFileSync(new URL("../../sim/scenes/rotate-push-lift.toml", import.meta.url), "utf8");
  writeFileSync(file("evil.toml"), scene.replaceAll('"cube"', `"${evil}"`));
  for (const [name, source] of [["evil", "evil.toml"], ["membrane", "membrane-large"]]) {
    run("sim", source, "--duration", "3s", "-o", `${name}.mcap`, "-f", "-q");
    run("encode", `${name}.mcap`, "-o", `${name}.tct`, "--tune", "key_interval=1s", "-f", "-q");
    run("view", `${name}.tct`, "--truth", `${name}.mcap`, "-f", "-q");
  }
}

// An expression: what a file beside the tests of the npm package exports.
function library(name, exported) {
  const source = readFileSync(new URL(`../wasm/${name}`, import.meta.url), "utf8").replaceAll(/^export /gm, "");
  return `(() => {${source}; return ${exported};})()`;
}

async function ready(browser, name, options) {
  const tab = await browser.open(url(name), options);
  await tab.until("globalThis.tactusView");
  return tab;
}

const time = (tab) => tab.run("tactusView.page.clock.time");

const tests = {
  async "the state hashes of all vectors, in the page"(browser) {
    const tab = await ready(browser, "evil.html");
    await tab.run(`void (globalThis.check = ${library("vectors.js", "check")})`);
    const vectors = readVectors(conformance).map((vector) => ({...vector, bytes: Buffer.from(vector.bytes).toString("base64")}));
    const checked = (some) => `${JSON.stringify(some)}.map((vector) => {
      const bytes = Uint8Array.from(atob(vector.bytes), (c) => c.charCodeAt(0));
      return [vector.id, check(tactusView.tactus, {...vector, bytes})];
    }).filter(([, problem]) => problem !== null)`;
    const wrong = [];
    for (let at = 0; at < vectors.length; at += 100) {
      wrong.push(...await tab.run(checked(vectors.slice(at, at + 100))));
    }
    assert.deepEqual(wrong, []);
    assert.ok(vectors.length > 700);
    const [one] = vectors.filter(({id}) => id.startsWith("rigid/"));
    one.expected[1].state = "0123456789abcdef";
    const [[, problem]] = await tab.run(checked([one]));
    assert.match(problem, /state is/);  // the check itself can fail
    await tab.close();
    return `${vectors.length} vectors`;
  },

  async "the answers to all sessions and of clients with a device, in the page"(browser) {
    const tab = await ready(browser, "evil.html");
    const bytes = readFileSync(sessionsModule).toString("base64");
    await tab.run(`(async () => {
      const {loadSessions, checkSession} = ${library("sessions.js", "{loadSessions, checkSession}")};
      const answer = await loadSessions(Uint8Array.from(atob("${bytes}"), (c) => c.charCodeAt(0)));
      globalThis.check = (sessions) => sessions.map((one) => [one.id, checkSession(answer, one)]).filter(([, problem]) => problem !== null);
    })()`);
    const sessions = readSessions(conformance);
    assert.deepEqual(await tab.run(`check(${JSON.stringify(sessions)})`), []);
    assert.ok(sessions.length > 60);
    const [one] = sessions.filter(({expected}) => expected.includes('"states"'));
    const wrong = {...one, expected: one.expected.replace(/("states":\[")./, "$1x")};
    const [[, problem]] = await tab.run(`check(${JSON.stringify([wrong])})`);
    assert.match(problem, /line \d+ is/);  // the check itself can fail
    await tab.close();
    return `${sessions.length} vectors`;
  },

  async "going anywhere shows what playing to there shows"(browser) {
    for (const name of ["evil.html", "membrane.html"]) {
      const tab = await ready(browser, name);
      const answers = await tab.run(`(() => {
        const {model} = tactusView.page;
        const ticks = [2500, 17, 1999, 0, 2999, 1001, 1000, 400, 2600];
        const shapes = (replay) => replay.scene.deformables.map((_, i) => [...replay.displacements(i)].slice(0, 300));
        const view = (replay) => JSON.stringify([replay.stateHashes(), [...replay.poses()], shapes(replay)]);
        const sought = ticks.map((tick) => (model.replay.moveTo(tick), view(model.replay)));
        const played = new Map();
        for (let tick = 0; tick < 3000; ++tick) {
          model.replay.moveTo(tick);
          if (ticks.includes(tick)) played.set(tick, view(model.replay));
        }
        return ticks.filter((tick, i) => sought[i] !== played.get(tick));
      })()`);
      assert.deepEqual(answers, [], name);
      await tab.close();
    }
  },

  async "the mesh is where its vertices are projected, and moves"(browser) {
    const tab = await ready(browser, "membrane.html");
    await tab.run(`["truth", "device", "contact", "forces"].forEach((name) => document.getElementById("layer-" + name).click())`);
    const boxes = [];
    for (const seconds of [0, 2.6]) {
      await tab.run(`tactusView.seek(${seconds})`);
      const shown = readPng(await tab.picture());
      await tab.run("tactusView.page.picture.setMeshes(false), tactusView.page.redraw()");
      const hidden = readPng(await tab.picture());
      await tab.run("tactusView.page.picture.setMeshes(true), tactusView.page.redraw()");
      const drawn = differingBox(shown, hidden);
      const points = await tab.run("Array.from({length: 714}, (_, i) => tactusView.project(tactusView.page.picture.vertex(0, i)))");
      const wanted = [Math.min, Math.min, Math.max, Math.max].map((most, k) => most(...points.map((p) => p[k % 2])));
      drawn.forEach((edge, k) => near(edge, wanted[k], 2));
      boxes.push(points);
    }
    const moved = boxes[0].map(([x, y], i) => Math.hypot(x - boxes[1][i][0], y - boxes[1][i][1]));
    assert.ok(Math.max(...moved) > 5, "the touch moves no vertex by 5 pixels");
    assert.ok(Math.min(...moved) < 0.5, "a fixed vertex moves");
    await tab.close();
  },

  async "colours of the error are within what was measured"(browser) {
    const tab = await ready(browser, "membrane.html");
    for (let i = 0; i < 2; ++i) await tab.key("v");
    assert.equal(await tab.run("tactusView.page.picture.colouring.name"), "displacement");  // the stream declares no stiffness
    await tab.key("v");
    const off = await tab.run(`(() => {
      const {picture, model} = tactusView.page;
      const {ticks, error} = model.truth.meshes[0];
      const values = new Float32Array(714);
      return [2000, 1003, 1500, 2998].map((tick) => {
        picture.show(tick);
        picture.colouring.fill(0, values);
        return Math.max(...values) - error[ticks.findLastIndex((one) => one <= tick)];
      });
    })()`);
    for (const difference of off) near(difference, 0, 1.25e-5 + 1e-7);  // how far the ghost may be off
    await tab.close();
  },

  async "keys"(browser) {
    const tab = await ready(browser, "evil.html");
    const plays = () => tab.run("tactusView.page.clock.plays");
    await tab.run("tactusView.page.clock.speed = 0.05");  // a minute: on no machine does it end before it is looked at
    await tab.key(" ");
    assert.equal(await plays(), true);
    await tab.until("tactusView.page.clock.time > 0.005");
    await tab.key(" ");
    assert.equal(await plays(), false);
    await tab.run("tactusView.page.clock.speed = 1");
    await tab.key("Home");
    assert.equal(await time(tab), 0);
    await tab.key("ArrowRight");
    near(await time(tab), 0.001, 1e-9);
    await tab.key("ArrowRight", {shift: true});
    near(await time(tab), 0.101, 1e-9);
    await tab.key("]");
    const first = await tab.run("tactusView.page.model.packets.ticks.find((tick) => tick > 101) / 1000");
    near(await time(tab), first, 1e-9);
    await tab.key("End");
    near(await time(tab), 2.999, 1e-9);
    await tab.key("l");
    assert.equal(await tab.run("tactusView.page.clock.loops"), true);
    await tab.key("+");
    assert.equal(await tab.run("tactusView.page.clock.speed"), 2);
    await tab.key("f");
    assert.equal(await tab.run("document.getElementById('layer-forces').checked"), false);
    await tab.key("?");
    assert.equal(await tab.run("document.getElementById('help').open"), true);
    await tab.close();
  },

  async "the time line and links seek"(browser) {
    const tab = await ready(browser, "evil.html#t=1.25");
    near(await time(tab), 1.25, 1e-9);
    await tab.until("document.getElementById('clock').textContent.startsWith('1.250 s')");
    const {left, top} = await tab.run("document.getElementById('timeline').getBoundingClientRect().toJSON()");
    await tab.click(left + (await tab.run("tactusView.page.timeline.xOf(2)")), top + 30);
    near(await time(tab), 2, 0.01);
    await tab.until("location.hash === `#t=${tactusView.page.clock.time.toFixed(3)}`");
    await tab.run("location.hash = '#t=0.5'");
    await tab.until("tactusView.page.clock.time === 0.5");
    await tab.run("location.hash = '#t=1e9<x>'");
    near(await time(tab), 0.5, 0);
    await tab.close();
  },

  async "the errors are those of compare, and names are text"(browser) {
    run("decode", "evil.tct", "-o", "evil-replica.mcap", "--like", "evil.mcap", "-f", "-q");
    const report = JSON.parse(execFileSync(tactus, ["compare", "evil.mcap", "evil-replica.mcap", "--json"], {cwd: work}));
    const tab = await ready(browser, "evil.html");
    const largest = "([name, values]) => [name, Math.max(...values)]";
    const errors = await tab.run(`Object.fromEntries(Object.entries(tactusView.page.model.truth.errors).map(${largest}))`);
    near(errors.position, report.error.position_m.max, 1e-7);
    near(errors.rotation, report.error.rotation_rad.max, 1e-6);
    near(errors.force, report.error.contact_force_N.max, 1e-5);
    assert.equal(await tab.run("tactusView.page.model.scene.rigid[0].name"), evil);
    assert.equal(await tab.run("document.images.length"), 0);
    assert.equal(await tab.run("typeof globalThis.broken"), "undefined");
    await tab.close();
  },

  async "a force is named after whose it is"(browser) {
    const named = async (source) => {
      run("encode", `${source}.mcap`, "-o", "forces.tct", "-f", "-q");
      run("view", "forces.tct", "--truth", `${source}.mcap`, "-f", "-q");
      const tab = await ready(browser, "forces.html");
      const drawn = await tab.run(`(() => {
        const texts = [];
        const draw = CanvasRenderingContext2D.prototype.fillText;
        CanvasRenderingContext2D.prototype.fillText = function (text, ...position) { texts.push(text), draw.call(this, text, ...position); };
        tactusView.page.timeline.draw();
        return texts.filter((text) => /^(rendered )?force/.test(text));
      })()`);
      const legend = await tab.run("[...document.querySelectorAll('#legend div')].map((row) => row.textContent)");
      await tab.close();
      return [drawn, legend.filter((text) => /^(rendered )?force/.test(text))];
    };
    run("serve", "push-1dof", "--listen", "0", "--duration", "300ms", "-o", "served.mcap", "-f", "-q");
    assert.deepEqual(await named("served"), [["force of the server [N]"], ["force of the server"]]);
    run("sim", "push-1dof", "--duration", "300ms", "-o", "played.mcap", "-f", "-q");
    assert.deepEqual(await named("played"), [["rendered force [N]"], ["rendered force"]]);
    assert.deepEqual(await named("membrane"), [["rendered force [N]"], ["force of the server", "rendered force"]]);
  },

  async "odd streams"(browser) {
    for (const stream of ["client/001-empty", "rigid/002-free-object", "load/001", "deformable/001", "scene/001"]) {
      const [stem, number] = stream.split("/");
      const name = readdirSync(join(conformance, "vectors", stem)).find((entry) => entry.startsWith(number) && entry.endsWith(".tct"));
      run("view", join(resolve(conformance), "vectors", stem, name), "-o", "odd.html", "-f", "-q");
      const tab = await ready(browser, "odd.html");
      const tick = await tab.run(`(() => {
        const {page} = tactusView;
        for (const time of [1e9, 0]) page.clock.seek(time), page.frame(performance.now());
        return page.controls.tick;
      })()`);
      assert.equal(tick, 0, stream);
      assert.equal(await tab.run("document.getElementById('message').hidden"), true, stream);
      await tab.close();
    }
  },

  async "a phone, and the dark"(browser) {
    if (isFirefox(program)) return "left out: its windows are wider than a phone";
    for (const dark of [false, true]) {
      const tab = await ready(browser, "membrane.html#t=1", {width: 390, height: 844, mobile: true, dark});
      assert.equal(await tab.run("document.documentElement.scrollWidth <= innerWidth"), true);
      for (const id of ["scene", "play", "timeline"]) {
        const {width, bottom} = await tab.run(`document.getElementById("${id}").getBoundingClientRect().toJSON()`);
        assert.ok(width > 50 && bottom <= 844, `${id} is not in the window`);
      }
      const corner = readPng(await tab.picture()).at(385, 80);
      assert.equal(corner.every((part) => (dark ? part < 60 : part > 200)), true, `${corner}`);
      await tab.close();
    }
  },

  async "without WebGL it says so, and the rest works"() {
    const browser = await launch(program, {webGl: false});
    try {
      const tab = await ready(browser, "evil.html");
      assert.match(await tab.run("document.getElementById('message').textContent"), /no WebGL 2/);
      assert.equal(await tab.run("document.getElementById('message').hidden"), false);
      await tab.run("tactusView.seek(2)");
      await tab.until("document.getElementById('clock').textContent.startsWith('2.000 s')");
    } finally {
      await browser.close();
    }
  },
};

makePages();
const browser = await launch(program);
await runTests(tests, browser);
await browser.close();
