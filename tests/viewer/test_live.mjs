// SPDX-License-Identifier: Apache-2.0
// test_live.mjs TACTUS BROWSER WORK: pages that observe a running `tactus serve` in a real browser.
import assert from "node:assert/strict";
import {spawn} from "node:child_process";
import {mkdirSync, writeFileSync} from "node:fs";
import {resolve} from "node:path";
import {pathToFileURL} from "node:url";
import {isFirefox, launch} from "./browser.mjs";
import {differingBox, readPng} from "./png.mjs";
import {near, runTests} from "./runner.mjs";

const [tactus, program, work] = process.argv.slice(2);
mkdirSync(work, {recursive: true});

// A program of ours; `printed(pattern)` waits for a line on its standard error, `ended` for its end.
function start(...words) {
  const child = spawn(tactus, words, {stdio: ["ignore", "pipe", "pipe"]});
  let out = "";
  let errors = "";
  let look = () => {};
  child.stdout.setEncoding("utf8").on("data", (text) => (out += text));
  child.stderr.setEncoding("utf8").on("data", (text) => ((errors += text), look()));
  child.on("error", (error) => (errors += error.message));
  const ended = new Promise((done) => child.on("close", (code) => (look(), done({code, out, errors}))));
  const printed = (pattern) => new Promise((done, fail) => {
    look = () => {
      const match = pattern.exec(errors);
      if (match) done(match[1]);
      else if (child.exitCode !== null) fail(new Error(`${words.join(" ")}: ${errors}`));
    };
    look();
  });
  return {child, printed, ended};
}

// A server with a hand that plays in it, until they are stopped.
async function serve(scene, observe = "0") {
  const server = start("serve", scene, "-p", "4%", "--listen", "0", "--observe", observe, "--duration", "60min", "--json");
  const address = await server.printed(/observe it at (\S+)/);
  const port = await server.printed(/serving .*:(\d+)/);
  const hand = start("join", port, "--scene", scene, "--duration", "60min", "-q");
  return {...server, address, hand};
}

async function stop({child, ended, hand}) {
  child.kill("SIGINT");
  const {code, out, errors} = await ended;
  assert.equal(code, 0, errors);
  await hand.ended;
  return JSON.parse(out);
}

async function observe(browser, address, options) {
  const tab = await browser.open(address, options);
  await tab.until("globalThis.tactusView");
  return tab;
}

const clock = (tab) => tab.run("(({time, start, duration, follows}) => ({time, start, duration, follows}))(tactusView.page.clock)");
const status = (tab) => tab.run("document.getElementById('status').textContent");
const checked = (tab) => tab.run("tactusView.page.model.checked");

const tests = {
  async "it follows the newest tick, and its states are the server's"(browser, {rigid}) {
    const tab = await observe(browser, rigid.address);
    assert.equal(await status(tab), "live");
    const before = await clock(tab);
    await tab.until(`tactusView.page.clock.duration > ${before.duration + 0.5} && tactusView.page.model.checked.tick > 2000`);
    const after = await clock(tab);
    assert.equal(after.follows, true);
    assert.equal(after.time, after.duration);
    assert.equal((await checked(tab)).isEqual, true);
    // What the server sends, against what the page decodes; and the check can fail, for as long as a slow page takes to draw it.
    const received = await tab.run(`new Promise((done) => {
      const {model} = tactusView.page;
      const append = model.append.bind(model);
      model.append = (batch, follows) => {
        const hashes = batch.hashes;
        if (hashes) batch.hashes = hashes.map((hash) => hash.split("").reverse().join(""));
        append(batch, follows);
        if (hashes) done({hashes, own: model.replay.stateHashes(), tick: model.replay.tick, last: batch.last_tick, checked: model.checked});
      };
    })`);
    assert.deepEqual(received.own, received.hashes);
    assert.equal(received.tick, received.last);
    assert.equal(received.checked.isEqual, false);
    await tab.until("[...document.querySelectorAll('#readings tr.over')].some(({textContent}) => /NOT equal/.test(textContent))");
    await tab.run("delete tactusView.page.model.append");
    await tab.until("tactusView.page.model.checked.isEqual");
    await tab.until("document.querySelectorAll('#readings tr.over').length === 0");
    await tab.close();
  },

  async "it is paused, looked back in, and follows again"(browser, {rigid}) {
    const tab = await observe(browser, rigid.address);
    await tab.until("tactusView.page.clock.duration - tactusView.page.clock.start > 2");
    await tab.key(" ");
    const held = await clock(tab);
    assert.equal(held.follows, false);
    await tab.until(`tactusView.page.clock.duration > ${held.duration + 0.3}`);
    assert.equal((await clock(tab)).time, held.time);
    await tab.key("Home");
    near((await clock(tab)).time, (await clock(tab)).start, 1e-9);
    await tab.key("ArrowRight", {shift: true});
    await tab.until("document.getElementById('clock').textContent.endsWith('s ago')");
    const same = await tab.run(`(() => {
      const {model, clock} = tactusView.page;
      const at = (tick) => (model.moveTo(tick), JSON.stringify([model.replay.stateHashes(), [...model.replay.poses()]]));
      const tick = Math.floor((clock.start + 1.5) * 1000);
      const back = at(tick);
      for (let t = Math.floor(clock.start * 1000); t < tick; ++t) at(t);
      return back === at(tick);
    })()`);
    assert.equal(same, true);
    await tab.key("End");
    assert.equal((await clock(tab)).follows, true);
    await tab.close();
  },

  async "the mesh is where its vertices are projected"(browser, {mesh}) {
    const tab = await observe(browser, mesh.address);
    await tab.until("tactusView.page.model.checked.isEqual");
    await tab.run(`["truth", "device", "contact", "forces"].forEach((name) => document.getElementById("layer-" + name).click())`);
    await tab.key(" ");
    const box = "document.getElementById('scene').getBoundingClientRect()";
    const stage = await tab.run(`(({left, top, right, bottom}) => [left, top, right, bottom])(${box})`);
    const shown = readPng(await tab.picture());
    await tab.run("tactusView.page.picture.setMeshes(false), tactusView.page.redraw()");
    const drawn = differingBox(shown, readPng(await tab.picture()), stage.map(Math.round));
    const points = await tab.run("Array.from({length: 714}, (_, i) => tactusView.project(tactusView.page.picture.vertex(0, i)))");
    const wanted = [Math.min, Math.min, Math.max, Math.max].map((most, k) => most(...points.map((p) => p[k % 2])));
    drawn.forEach((edge, k) => near(edge, wanted[k], 2));
    await tab.close();
  },

  async "another page may not look, and pages have no room beyond the stage"(browser, {rigid}) {
    writeFileSync(resolve(work, "other.html"), "<!doctype html><title>another page</title>");
    const tab = await browser.open(pathToFileURL(resolve(work, "other.html")).href);
    const address = `${rigid.address.replace("http", "ws")}live`;
    const heard = await tab.run(`new Promise((done) => {
      const socket = new WebSocket(${JSON.stringify(address)});
      socket.onopen = () => done("open");
      socket.onerror = () => done("refused");
    })`);
    assert.equal(heard, "refused");
    await tab.close();
    for (const dark of [false, true]) {
      const phone = await observe(browser, rigid.address, {width: 390, height: 844, mobile: true, dark});
      assert.equal(await phone.run("document.documentElement.scrollWidth <= innerWidth"), true);
      await phone.close();
    }
  },

  async "it forgets what is older than half a minute"(browser, {rigid}) {
    if (isFirefox(program)) return "left out: it takes that long";
    const tab = await observe(browser, rigid.address);
    await tab.run("tactusView.page.clock.seek(0)");  // looks at the oldest
    await tab.until("tactusView.page.clock.duration - tactusView.page.clock.start > 29");
    const first = await clock(tab);
    await tab.until(`tactusView.page.clock.start > ${first.start + 2}`);
    const {start, duration, time} = await clock(tab);
    near(time, start, 1.2);
    near(duration - start, 30.5, 1);
    const [ticks, rows, span] = await tab.run(`(({model: {truth}}) =>
      [truth.ticks.length, truth.users[0].device[1].length, truth.ticks[truth.ticks.length - 1] - truth.ticks[0]])(tactusView.page)`);
    near(span, 30500, 1100);  // a server on a busy machine leaves out ticks
    assert.ok(ticks <= span + 1, `${ticks} rows of ${span + 1} ticks`);
    assert.equal(ticks, rows);
    await tab.run("tactusView.page.clock.follow()");
    const {tick} = await checked(tab);
    await tab.until(`tactusView.page.model.checked.tick > ${tick}`);
    assert.equal((await checked(tab)).isEqual, true);
    await tab.close();
  },

  async "it says that the server has ended, and finds the next one"(browser, {rigid}) {
    const tab = await observe(browser, rigid.address);
    const report = await stop(rigid);
    assert.equal(report.observers.too_slow, 0);
    assert.ok(report.observers.came >= 5, JSON.stringify(report.observers));
    await tab.until("/^the server has ended; asking again/.test(document.getElementById('status').textContent)");
    await tab.run("globalThis.isOld = true");
    const next = await serve("push-1dof", new URL(rigid.address).port);
    await tab.until("!globalThis.isOld && globalThis.tactusView && document.getElementById('title').textContent === 'push-1dof'");
    assert.equal(await status(tab), "live");
    await stop(next);
    await tab.close();
  },
};

const servers = {rigid: await serve("rotate-push-lift"), mesh: await serve("membrane-large")};
const browser = await launch(program);
try {
  await runTests(tests, browser, servers);
} finally {
  await browser.close();
  for (const {child, hand} of Object.values(servers)) [child, hand.child].forEach((one) => one.kill("SIGKILL"));
}
