// What is wrong, worst first.

import { element } from "./element.js";
import { causeName, figure, plural } from "./format.js";

const NAMES = { error: "Error", warning: "Warning", note: "Note" };
const MOST_CHIPS = 40;

function chips(finding, model, choose) {
  const nodes = finding.markers.slice(0, MOST_CHIPS).map((id) => {
    const mapped = model.markersOfId(id);
    const marker = mapped.find((m) => m.submap === finding.submap) ?? mapped[0];
    return marker
      ? element("button", { type: "button", class: "chip", title: `Show marker ${id}`, onclick: () => choose(marker) }, String(id))
      : element("span", { class: "chip absent", title: "Not in the map" }, String(id));
  });
  const left = finding.markers.length - MOST_CHIPS;
  if (left > 0) nodes.push(element("span", { class: "chip absent" }, `and ${left} more`));
  for (const name of [...finding.cameras, ...finding.captures]) {
    nodes.push(element("span", { class: "chip absent" }, name));
  }
  return nodes.length ? element("p", { class: "chips" }, nodes) : null;
}

function card(finding, model, choose) {
  const figures = finding.figures.map((entry) =>
    element("div", {}, element("dt", {}, entry.name), element("dd", {}, figure(entry))));
  return element("article", { class: `finding ${finding.severity}`, "data-cause": finding.cause },
    element("h3", {}, element("span", { class: "badge" }, NAMES[finding.severity]), `${finding.subject}: ${causeName(finding)}`),
    element("p", {}, finding.text),
    finding.explains ? element("p", { class: "fine" }, `Explains ${finding.explains}.`) : null,
    figures.length ? element("dl", { class: "figures" }, figures) : null,
    finding.remedy ? element("p", { class: "remedy" }, element("b", {}, "What to do: "), finding.remedy) : null,
    chips(finding, model, choose));
}

/** The section of findings; `choose(marker)` shows one on the map. */
export function findingsSection(model, choose) {
  const { findings } = model;
  const said = ["error", "warning", "note"]
    .map((severity) => [severity, findings.filter((f) => f.severity === severity).length])
    .filter(([, number]) => number > 0)
    .map(([severity, number]) => plural(number, severity, `${severity}s`))
    .join(", ");
  return element("section", { id: "findings", "aria-label": "Findings" },
    element("h2", {}, "Findings", element("small", {}, said)),
    findings.length
      ? element("div", { class: "findings" }, findings.map((finding) => card(finding, model, choose)))
      : element("p", { class: "fine" }, "Nothing to report: no check of this build found anything wrong."));
}
