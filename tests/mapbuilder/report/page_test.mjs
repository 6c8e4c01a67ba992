// The report page as people meet it: opened from disk in headless Chromium, at a desktop's and a phone's width.
// Usage: node page_test.mjs CHROMIUM REPORT_FOLDER

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join, resolve } from "node:path";
import { after, before, describe, test } from "node:test";
import { pathToFileURL } from "node:url";
import { Browser } from "./browser.mjs";

const [chromium, folder] = process.argv.slice(2);
const url = pathToFileURL(join(resolve(folder), "index.html")).href;
const summary = JSON.parse(readFileSync(join(folder, "summary.json"), "utf8"));
const SCREENS = {
  desktop: { width: 1440, height: 900 },
  phone: { width: 390, height: 844, scale: 2, touch: true },
  "phone, dark": { width: 390, height: 844, scale: 2, touch: true, dark: true },
};

let browser;
before(async () => { browser = await Browser.start(chromium); });
after(async () => { await browser?.close(); });

/** A figure in the panel of the chosen marker; null where there is none. */
function field(page, name) {
  return page.evaluate(`document.querySelector('.inspector [data-field="${name}"]')?.textContent ?? null`);
}

/** Where a marker is drawn in the window, once the view has been scrolled to. */
async function markerInWindow(page, view, id) {
  await page.evaluate(`document.getElementById("${view}").scrollIntoView({ block: "center", behavior: "instant" })`);
  await page.painted();
  return page.evaluate(`(() => {
    const { model } = waymarkReport;
    const marker = model.markersOfId(${JSON.stringify(id)})[0];
    const [x, y] = waymarkReport.${view}.pixelOf(marker);
    const box = document.getElementById("${view}").getBoundingClientRect();
    return [box.x + x, box.y + y];
  })()`);
}

/** The markers whose ids are easiest to hit: far from all others on a view. */
async function loneliest(page, view) {
  return page.evaluate(`(() => {
    const { markers } = waymarkReport.model.submaps[0];
    const at = markers.map((marker) => waymarkReport.${view}.pixelOf(marker));
    const room = at.map(([x, y], i) => Math.min(...at.map(([u, v], j) => i === j ? 1e9 : Math.hypot(u - x, v - y))));
    return markers[room.indexOf(Math.max(...room))].id;
  })()`);
}

function expectFigures(id) {
  const marker = summary.submaps[0].markers.find((candidate) => candidate.id === id);
  return {
    id: String(id),
    rms: `${marker.rms_px.toFixed(3)} px`,
    observations: String(marker.observations),
    position: marker.position_m.map((value) => value.toFixed(3).replace("-", "\u2212").replace(/^\u2212(0\.000)$/, "$1")).join("  "),
  };
}

async function figures(page) {
  const entries = ["id", "rms", "observations", "position"].map(async (name) => [name, await field(page, name)]);
  return Object.fromEntries(await Promise.all(entries));
}

for (const [name, screen] of Object.entries(SCREENS)) {
  describe(name, () => {
    let page;
    before(async () => { page = await browser.open(url, screen); });
    after(async () => { await page?.close(); });

    test("nothing but the file itself is asked for", () => {
      assert.deepEqual(page.requests.filter((request) => !request.startsWith("data:")), [url]);
    });

    test("hostile names are shown as text", async () => {
      assert.equal(await page.evaluate("document.querySelector('h1').textContent"), summary.map);
      assert.equal(await page.evaluate("document.querySelectorAll('img').length"), 0);
    });

    test("the worst finding comes first", async () => {
      const kinds = await page.evaluate("[...document.querySelectorAll('.finding .badge')].map((badge) => badge.textContent)");
      assert.deepEqual(kinds, ["Error", "Warning", "Note"]);
      const top = await page.evaluate("document.querySelector('main > section').id");
      assert.equal(top, "findings");
    });

    test("nothing is wider than the window", async () => {
      assert.equal(await page.evaluate("document.documentElement.scrollWidth"), screen.width);
      const wide = await page.evaluate(`[...document.querySelectorAll("main *, header *")]
        .filter((node) => !node.closest(".scroll, svg, nav") && node.getBoundingClientRect().right > innerWidth + 0.5)
        .map((node) => node.tagName + "." + node.className)`);
      assert.deepEqual(wide, []);
    });

    test("plan and 3D view have drawn the markers", async () => {
      const inks = await page.evaluate(`(() => {
        const canvas = document.getElementById("plan");
        const data = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
        const seen = new Set();
        for (let i = 0; i < data.length; i += 4) seen.add(data[i] << 16 | data[i + 1] << 8 | data[i + 2]);
        return seen.size;
      })()`);
      assert.ok(inks > 50, `only ${inks} colours on the plan`);
      const drawn = await page.evaluate(`waymarkReport.scene.renderer.info.render.triangles`);
      assert.ok(drawn > 2 * summary.submaps[0].markers.length, `only ${drawn} triangles in 3D`);
    });

    for (const view of ["plan", "scene"]) {
      test(`a marker clicked on the ${view} tells its figures`, async () => {
        await page.evaluate("waymarkReport.choice.set('marker', null)");
        assert.equal(await field(page, "id"), null);
        const id = await loneliest(page, view);
        const [x, y] = await markerInWindow(page, view, id);
        await page.click(x, y, screen.touch);
        assert.deepEqual(await figures(page), expectFigures(id));
      });
    }

    test("the chosen marker's figures lie within the window", async () => {
      const box = await page.evaluate(`(() => {
        const { top, bottom, left, right } = document.querySelector('.inspector [data-field="rms"]').getBoundingClientRect();
        return { top, bottom, left, right };
      })()`);
      assert.ok(box.top >= 0 && box.left >= 0 && box.right <= screen.width && box.bottom <= screen.height, JSON.stringify(box));
    });

    test("a row of the table tells its figures, by key", async () => {
      const key = await page.evaluate(`(() => {
        const row = document.querySelector("#markers tbody tr:nth-child(3)");
        row.focus();
        return row.dataset.key;
      })()`);
      await page.key("Enter");
      const id = await page.evaluate(`waymarkReport.model.marker(${JSON.stringify(key)}).id`);
      assert.deepEqual(await figures(page), expectFigures(id));
    });

    test("the table is sorted by worst, and by what is clicked", async () => {
      const column = (at) => page.evaluate(`[...document.querySelectorAll("#markers tbody tr td:nth-child(${at})")].map((cell) => Number(cell.textContent))`);
      const rms = await column(3);
      assert.deepEqual(rms, [...rms].sort((a, b) => b - a));
      await page.evaluate("document.querySelector('#markers th:nth-child(1) button').click()");
      await page.evaluate("document.querySelector('#markers th:nth-child(1) button').click()");
      const ids = await column(1);
      assert.deepEqual(ids, [...ids].sort((a, b) => a - b));
    });

    test("keys move the plan and choose markers", async () => {
      await page.evaluate("document.getElementById('plan').focus(); waymarkReport.choice.set('marker', null)");
      const before = await page.evaluate("waymarkReport.plan.scale");
      await page.key("+");
      assert.ok((await page.evaluate("waymarkReport.plan.scale")) > before);
      await page.key("0");
      await page.key("n");
      assert.equal(await field(page, "id"), String(summary.submaps[0].markers[0].id));
      await page.key("Escape");
      assert.equal(await field(page, "id"), null);
    });

    test("a chip of a finding shows its marker", async () => {
      await page.evaluate("document.querySelector('.finding button.chip').click()");
      assert.equal(await field(page, "id"), String(summary.findings.find((f) => f.severity === "error").markers[0]));
    });

    test("all ways to draw it work without a complaint", async () => {
      await page.evaluate(`for (const [name, values] of Object.entries({
        view: ["front", "side", "top"], colour: ["residual", "uncertainty", "findings"], enlarge: [0, 1],
        ids: [false, true], normals: [false, true], track: [false, true], truth: [false, true],
      })) for (const value of values) waymarkReport.choice.set(name, value);
      document.querySelector(".theme").click()`);
      await page.painted();
      assert.deepEqual(page.problems, []);
      assert.deepEqual(page.requests.filter((request) => !request.startsWith("data:")), [url]);
    });
  });
}
