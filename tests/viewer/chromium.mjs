// SPDX-License-Identifier: Apache-2.0
// A headless Chromium, driven over its debugging pipe.
import {spawn} from "node:child_process";
import {mkdtempSync, rmSync} from "node:fs";
import {tmpdir} from "node:os";
import {join} from "node:path";

const timeout = 60000;  // ms: against a browser that hangs

export class Chromium {
  #process;
  #waiting = new Map();
  #text = "";
  #next = 1;

  static async launch(program, {webGl}) {
    const browser = new Chromium();
    browser.home = mkdtempSync(join(tmpdir(), "tactus-browser-"));
    browser.#process = spawn(program, [
      "--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--remote-debugging-pipe",
      "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-extensions", "--hide-scrollbars",
      "--force-device-scale-factor=1",
      `--user-data-dir=${browser.home}`, ...(webGl ? [] : ["--disable-3d-apis"]), "about:blank",
    ], {stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"]});
    browser.#process.stdio[4].setEncoding("utf8").on("data", (data) => browser.#hear(data));
    browser.#process.on("exit", () => browser.#fail(new Error("the browser ended")));
    browser.#process.on("error", (error) => browser.#fail(error));
    return browser;
  }

  #hear(data) {
    const messages = (this.#text + data).split("\0");
    this.#text = messages.pop();
    for (const message of messages) {
      const {id, result, error} = JSON.parse(message);
      const call = this.#waiting.get(id);
      if (!call) continue;
      this.#waiting.delete(id);
      if (error) call.reject(new Error(`${call.method}: ${error.message}`));
      else call.resolve(result);
    }
  }

  #fail(error) {
    for (const {reject} of this.#waiting.values()) reject(error);
    this.#waiting.clear();
  }

  call(method, params = {}, sessionId = undefined) {
    const id = this.#next++;
    return new Promise((resolve, reject) => {
      const timer = setTimeout(() => reject(new Error(`${method}: no answer for ${timeout / 1000} s`)), timeout);
      const settle = (react) => (value) => (clearTimeout(timer), react(value));
      this.#waiting.set(id, {method, resolve: settle(resolve), reject: settle(reject)});
      this.#process.stdio[3].write(`${JSON.stringify({id, method, params, sessionId})}\0`);
    });
  }

  // in  width, height  of the window;  dark  the system's colours
  async open(url, {width = 1280, height = 800, dark = false, mobile = false} = {}) {
    const {targetId} = await this.call("Target.createTarget", {url: "about:blank"});
    const {sessionId} = await this.call("Target.attachToTarget", {targetId, flatten: true});
    const tab = new Tab(this, targetId, sessionId);
    await tab.call("Emulation.setDeviceMetricsOverride", {width, height, deviceScaleFactor: 1, mobile});
    await tab.call("Emulation.setEmulatedMedia", {features: [{name: "prefers-color-scheme", value: dark ? "dark" : "light"}]});
    await tab.call("Page.navigate", {url});
    await tab.until("document.readyState === 'complete'");
    return tab;
  }

  async close() {
    const ended = new Promise((resolve) => this.#process.once("exit", resolve));
    this.call("Browser.close").catch(() => {});
    const timer = setTimeout(() => this.#process.kill("SIGKILL"), 5000);
    await ended;
    clearTimeout(timer);
    rmSync(this.home, {recursive: true, force: true, maxRetries: 5});
  }
}

class Tab {
  constructor(browser, target, session) {
    Object.assign(this, {browser, target, session});
  }

  call(method, params) {
    return this.browser.call(method, params, this.session);
  }

  async run(expression) {
    const {result, exceptionDetails} = await this.call("Runtime.evaluate", {expression, awaitPromise: true, returnByValue: true});
    if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
    return result.value;
  }

  async until(condition) {
    const end = Date.now() + timeout;
    while (!(await this.run(`Boolean(${condition})`))) {
      if (Date.now() > end) throw new Error(`never came true: ${condition}`);
      await new Promise((resolve) => setTimeout(resolve, 20));
    }
  }

  // The page as drawn, PNG.
  async picture() {
    await this.run("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))");
    const {data} = await this.call("Page.captureScreenshot", {format: "png"});
    return Buffer.from(data, "base64");
  }

  async key(key, {shift = false} = {}) {
    const text = key.length === 1 ? key : undefined;
    await this.call("Input.dispatchKeyEvent", {type: "keyDown", key, text, modifiers: shift ? 8 : 0});
    await this.call("Input.dispatchKeyEvent", {type: "keyUp", key, modifiers: shift ? 8 : 0});
  }

  async click(x, y) {
    for (const type of ["mousePressed", "mouseReleased"])
      await this.call("Input.dispatchMouseEvent", {type, x, y, button: "left", clickCount: 1});
  }

  close() {
    return this.browser.call("Target.closeTarget", {targetId: this.target});
  }
}
