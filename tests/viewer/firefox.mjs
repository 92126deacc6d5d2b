// SPDX-License-Identifier: Apache-2.0
// A Firefox on a screen of its own (Xvfb: without a screen it has no WebGL), driven over Marionette, its older and simpler protocol.
import {spawn} from "node:child_process";
import {existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync} from "node:fs";
import {createConnection} from "node:net";
import {tmpdir} from "node:os";
import {join} from "node:path";

const timeout = 60000;  // ms: against a browser that hangs
const codes = {Home: "\uE011", End: "\uE010", ArrowRight: "\uE014", Shift: "\uE008"};  // WebDriver, section 15.4.2
const settings = {
  "marionette.port": 0,  // any: it is written to a file
  "webgl.force-enabled": true, "webgl.disable-fail-if-major-performance-caveat": true,  // with a software renderer
  "dom.max_script_run_time": 0,
  "app.normandy.enabled": false, "app.update.auto": false, "browser.shell.checkDefaultBrowser": false,
  "datareporting.policy.dataSubmissionEnabled": false, "services.settings.server": "data:,#remote-settings-dummy/v1",
  "browser.aboutwelcome.enabled": false, "browser.startup.homepage_override.mstone": "ignore",
};

const pause = () => new Promise((resolve) => setTimeout(resolve, 20));

async function wait(what, found) {
  for (const end = Date.now() + timeout; Date.now() < end; await pause()) {
    const value = found();
    if (value) return value;
  }
  throw new Error(`${what}: nothing for ${timeout / 1000} s`);
}

export class Firefox {
  #screen;
  #process;
  #socket;
  #heard = Buffer.alloc(0);
  #waiting = new Map();
  #next = 1;
  #first;  // handle of its first window, which stays
  #shown = null;  // of the window that calls are about

  static async launch(program, {webGl}) {
    const browser = new Firefox();
    browser.home = mkdtempSync(join(tmpdir(), "tactus-browser-"));
    const lines = Object.entries({...settings, "webgl.disabled": !webGl}).map(([name, value]) => `user_pref("${name}", ${JSON.stringify(value)});\n`);
    writeFileSync(join(browser.home, "user.js"), lines.join(""));
    const display = await browser.#openScreen();
    const options = ["--marionette", "--no-remote", "--kiosk", "--profile", browser.home, "about:blank"];
    browser.#process = spawn(program, options, {stdio: "ignore", env: {...process.env, DISPLAY: `:${display}`, WAYLAND_DISPLAY: ""}});
    browser.#process.on("exit", () => browser.#fail(new Error("the browser ended")));
    browser.#process.on("error", (error) => browser.#fail(error));
    await browser.#connect();
    await browser.call("WebDriver:NewSession", {strictFileInteractability: true});
    browser.#first = (await browser.call("WebDriver:GetWindowHandle")).value;
    await browser.call("WebDriver:SetTimeouts", {script: timeout, pageLoad: timeout});
    return browser;
  }

  async #openScreen() {
    const options = ["-displayfd", "3", "-screen", "0", "1280x800x24", "-nolisten", "tcp"];
    this.#screen = spawn("Xvfb", options, {stdio: ["ignore", "ignore", "ignore", "pipe"]});
    let text = "";
    this.#screen.stdio[3].setEncoding("utf8").on("data", (data) => (text += data));
    return (await wait("Xvfb", () => text.endsWith("\n") && text)).trim();
  }

  async #connect() {
    const file = join(this.home, "MarionetteActivePort");
    const port = await wait("Marionette", () => existsSync(file) && Number(readFileSync(file, "utf8")));
    this.#socket = createConnection(port, "127.0.0.1");
    this.#socket.on("data", (data) => this.#hear(data)).on("error", (error) => this.#fail(error));
  }

  // Messages are LENGTH:JSON; an answer is [1, id, error, result].
  #hear(data) {
    this.#heard = Buffer.concat([this.#heard, data]);
    for (;;) {
      const colon = this.#heard.indexOf(":");
      const end = colon + 1 + Number(this.#heard.subarray(0, Math.max(colon, 0)));
      if (colon < 0 || this.#heard.length < end) return;
      const message = JSON.parse(this.#heard.subarray(colon + 1, end));
      this.#heard = this.#heard.subarray(end);
      if (Array.isArray(message)) this.#answer(message);
    }
  }

  #answer([, id, error, result]) {
    const call = this.#waiting.get(id);
    if (!call) return;
    this.#waiting.delete(id);
    if (error) call.reject(new Error(`${call.command}: ${error.error}: ${error.message}`));
    else call.resolve(result);
  }

  #fail(error) {
    for (const {reject} of this.#waiting.values()) reject(error);
    this.#waiting.clear();
  }

  call(command, params = {}) {
    const id = this.#next++;
    return new Promise((resolve, reject) => {
      const timer = setTimeout(() => reject(new Error(`${command}: no answer for ${timeout / 1000} s`)), timeout);
      const settle = (react) => (value) => (clearTimeout(timer), react(value));
      this.#waiting.set(id, {command, resolve: settle(resolve), reject: settle(reject)});
      const text = JSON.stringify([0, id, command, params]);
      this.#socket.write(`${Buffer.byteLength(text)}:${text}`);
    });
  }

  async callIn(window, command, params) {
    if (this.#shown !== window) await this.call("WebDriver:SwitchToWindow", {handle: window, focus: true});
    this.#shown = window;
    return this.call(command, params);
  }

  async open(url) {
    const {handle} = await this.callIn(this.#first, "WebDriver:NewWindow", {type: "tab", focus: true});
    const tab = new Tab(this, handle);
    await tab.call("WebDriver:Navigate", {url});
    return tab;
  }

  async close() {
    const ended = new Promise((resolve) => this.#process.once("exit", resolve));
    this.call("Marionette:Quit", {flags: ["eForceQuit"]}).catch(() => {});
    const timer = setTimeout(() => this.#process.kill("SIGKILL"), 5000);
    await ended;
    clearTimeout(timer);
    this.#socket.destroy();
    this.#screen.kill();
    rmSync(this.home, {recursive: true, force: true, maxRetries: 5});
  }
}

class Tab {
  constructor(browser, handle) {
    Object.assign(this, {browser, handle});
  }

  call(command, params) {
    return this.browser.callIn(this.handle, command, params);
  }

  // It has global names of its own behind those of the page, so that it is given whose to set.
  async run(expression) {
    const script = `return ((globalThis) => (${expression}))(window);`;
    const {value} = await this.call("WebDriver:ExecuteScript", {script, args: []});
    return value;
  }

  async until(condition) {
    const end = Date.now() + timeout;
    while (!(await this.run(`Boolean(${condition})`))) {
      if (Date.now() > end) throw new Error(`never came true: ${condition}`);
      await pause();
    }
  }

  // The page as drawn, PNG.
  async picture() {
    await this.run("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(0))))");
    const {value} = await this.call("WebDriver:TakeScreenshot", {full: false, hash: false});
    return Buffer.from(value, "base64");
  }

  #perform(...actions) {
    return this.call("WebDriver:PerformActions", {actions});
  }

  key(key, {shift = false} = {}) {
    const press = (value) => [{type: "keyDown", value}, {type: "keyUp", value}];
    const [down, up] = press(codes.Shift);
    const pressed = press(codes[key] ?? key);
    return this.#perform({type: "key", id: "keys", actions: shift ? [down, ...pressed, up] : pressed});
  }

  click(x, y) {
    const actions = [{type: "pointerMove", x: Math.round(x), y: Math.round(y)}, {type: "pointerDown", button: 0}, {type: "pointerUp", button: 0}];
    return this.#perform({type: "pointer", id: "mouse", actions});
  }

  close() {
    return this.call("WebDriver:CloseWindow");
  }
}
