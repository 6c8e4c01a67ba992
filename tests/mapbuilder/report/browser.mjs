// A headless Chromium, driven over its debugging pipe: no package and no port needed.

import { spawn } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

// Drawn by the processor alone, beside other work: a frame may take long.
const PATIENCE_MS = 240_000;

export class Browser {
  #next = 0;
  #waiting = new Map();
  #listeners = [];

  static async start(program) {
    const profile = mkdtempSync(join(tmpdir(), "waymark-browser-"));
    const process = spawn(program, [
      "--headless=new", "--remote-debugging-pipe", `--user-data-dir=${profile}`, "--no-sandbox",
      "--no-first-run", "--no-default-browser-check", "--disable-background-networking",
      "--disable-component-update", "--disable-extensions", "--disable-sync", "--hide-scrollbars",
      // A loaded machine is no hung graphics driver, and a page behind another one still draws.
      "--disable-gpu-watchdog", "--disable-backgrounding-occluded-windows", "--disable-renderer-backgrounding",
      "--disable-background-timer-throttling",
      "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--font-render-hinting=none",
      "about:blank",
    ], { stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"], env: { ...globalThis.process.env, HOME: profile } });
    return new Browser(process, profile);
  }

  constructor(process, profile) {
    Object.assign(this, { process, profile });
    this.ended = new Promise((resolve) => process.once("exit", resolve));
    let text = "";
    process.stdio[4].setEncoding("utf8");
    process.stdio[4].on("data", (piece) => {
      const messages = (text + piece).split("\0");
      text = messages.pop();
      for (const message of messages) this.#receive(JSON.parse(message));
    });
    process.once("exit", (code) => {
      for (const { reject } of this.#waiting.values()) reject(new Error(`the browser ended with ${code}`));
    });
    process.once("error", (error) => {
      for (const { reject } of this.#waiting.values()) reject(error);
    });
  }

  send(method, params = {}, sessionId = undefined) {
    const id = ++this.#next;
    this.process.stdio[3].write(`${JSON.stringify({ id, method, params, sessionId })}\0`);
    return new Promise((resolve, reject) => {
      const late = setTimeout(() => reject(new Error(`${method}: no answer`)), PATIENCE_MS);
      this.#waiting.set(id, {
        resolve: (value) => { clearTimeout(late); resolve(value); },
        reject: (error) => { clearTimeout(late); reject(error); },
      });
    });
  }

  on(listener) {
    this.#listeners.push(listener);
  }

  /** A page of `width` × `height` CSS pixels that shows `url`, once it has loaded. */
  async open(url, { width, height, scale = 1, touch = false, dark = false }) {
    const { targetId } = await this.send("Target.createTarget", { url: "about:blank" });
    const { sessionId } = await this.send("Target.attachToTarget", { targetId, flatten: true });
    const page = new Page(this, sessionId, targetId);
    for (const domain of ["Page", "Runtime", "Network", "Log"]) await page.send(`${domain}.enable`);
    await page.send("Emulation.setDeviceMetricsOverride", { width, height, deviceScaleFactor: scale, mobile: touch });
    await page.send("Emulation.setTouchEmulationEnabled", { enabled: touch });
    await page.send("Emulation.setEmulatedMedia", { features: [{ name: "prefers-color-scheme", value: dark ? "dark" : "light" }] });
    const loaded = page.once("Page.loadEventFired");
    await page.send("Page.navigate", { url });
    await loaded;
    await page.painted();
    return page;
  }

  async close() {
    await this.send("Browser.close").catch(() => {});
    await this.ended;
    rmSync(this.profile, { recursive: true, force: true, maxRetries: 10, retryDelay: 100 });
  }

  #receive(message) {
    const waiting = this.#waiting.get(message.id);
    if (waiting) {
      this.#waiting.delete(message.id);
      if (message.error) waiting.reject(new Error(message.error.message));
      else waiting.resolve(message.result);
      return;
    }
    for (const listener of this.#listeners) listener(message);
  }
}

export class Page {
  /** What went wrong, and what was asked for, since the page was opened. */
  problems = [];
  requests = [];

  constructor(browser, sessionId, targetId) {
    Object.assign(this, { browser, sessionId, targetId });
    browser.on((message) => {
      if (message.sessionId !== sessionId) return;
      const { method, params } = message;
      if (method === "Runtime.exceptionThrown") this.problems.push(params.exceptionDetails.exception?.description ?? params.exceptionDetails.text);
      if (method === "Runtime.consoleAPICalled" && ["error", "warning"].includes(params.type)) {
        this.problems.push(params.args.map((arg) => arg.value ?? arg.description).join(" "));
      }
      if (method === "Log.entryAdded" && ["error", "warning"].includes(params.entry.level)) this.problems.push(params.entry.text);
      if (method === "Network.requestWillBeSent") this.requests.push(params.request.url);
    });
  }

  send(method, params = {}) {
    return this.browser.send(method, params, this.sessionId);
  }

  once(method) {
    return new Promise((resolve) => {
      this.browser.on((message) => {
        if (message.sessionId === this.sessionId && message.method === method) resolve(message.params);
      });
    });
  }

  close() {
    return this.browser.send("Target.closeTarget", { targetId: this.targetId });
  }

  /** The value of a JavaScript expression in the page. */
  async evaluate(expression) {
    const { result, exceptionDetails } = await this.send("Runtime.evaluate", { expression, returnByValue: true, awaitPromise: true });
    if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
    return result.value;
  }

  /** After two frames: what was asked for has been drawn. */
  painted() {
    return this.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(true))))");
  }

  /** Clicks a point of the window (CSS pixels), with the mouse or a finger. */
  async click(x, y, touch = false) {
    if (touch) {
      await this.send("Input.dispatchTouchEvent", { type: "touchStart", touchPoints: [{ x, y }] });
      await this.send("Input.dispatchTouchEvent", { type: "touchEnd", touchPoints: [] });
    } else {
      for (const type of ["mouseMoved", "mousePressed", "mouseReleased"]) {
        await this.send("Input.dispatchMouseEvent", { type, x, y, button: "left", clickCount: type === "mouseMoved" ? 0 : 1 });
      }
    }
    await this.painted();
  }

  async key(key) {
    for (const type of ["keyDown", "keyUp"]) {
      await this.send("Input.dispatchKeyEvent", { type, key, text: type === "keyDown" && key.length === 1 ? key : undefined });
    }
    await this.painted();
  }
}
