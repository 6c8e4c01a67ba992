// Pictures of a report for the documents. Usage: node pictures.mjs CHROMIUM REPORT_FOLDER OUTPUT_FOLDER

import { writeFileSync } from "node:fs";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { Browser } from "./browser.mjs";

const [chromium, folder, output] = process.argv.slice(2);
const url = pathToFileURL(join(resolve(folder), "index.html")).href;
const desktop = { width: 1440, height: 1000 };
const phone = { width: 390, height: 844, scale: 2, touch: true };

/** Where a picture begins: an element's top (less a little), below what sticks to the window's top. */
const scrollTo = (selector) => `document.documentElement.style.scrollBehavior = "auto";
  window.scrollBy(0, document.querySelector("${selector}").getBoundingClientRect().top - 52)`;
const firstNamed = `waymarkReport.choice.set("marker",
  (waymarkReport.model.submaps[0].markers.find((marker) => marker.rank > 0) ?? waymarkReport.model.submaps[0].markers[0]).key)`;

const pictures = [
  { name: "map", screen: desktop, prepare: `${firstNamed}; ${scrollTo("#findings h2")}` },
  { name: "3d", screen: desktop, prepare: `waymarkReport.choice.set("colour", "uncertainty"); ${scrollTo(".view.scene")}` },
  { name: "residuals", screen: desktop, prepare: scrollTo("#residuals h2") },
  { name: "phone", screen: phone, prepare: `${firstNamed}; ${scrollTo(".view.plan")}` },
  { name: "phone-dark", screen: { ...phone, dark: true }, prepare: scrollTo(".view.scene") },
];

const browser = await Browser.start(chromium);
try {
  for (const { name, screen, prepare } of pictures) {
    const page = await browser.open(url, screen);
    await page.evaluate(prepare);
    await page.painted();
    await page.painted();
    const { data } = await page.send("Page.captureScreenshot", { format: "jpeg", quality: 82 });
    writeFileSync(join(output, `${name}.jpg`), Buffer.from(data, "base64"));
    await page.close();
    if (page.problems.length) throw new Error(page.problems.join("\n"));
  }
} finally {
  await browser.close();
}
