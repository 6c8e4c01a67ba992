// What is drawn, and how: switches above the map.

import { element } from "./element.js";

function segments(choice, name, entries, label) {
  const buttons = entries.map(([value, text]) =>
    element("button", { type: "button", onclick: () => choice.set(name, value) }, text));
  const mark = () => buttons.forEach((button, i) =>
    button.setAttribute("aria-pressed", String(choice.get(name) === entries[i][0])));
  choice.on([name], mark);
  mark();
  return element("div", { class: "segments", role: "group", "aria-label": label }, buttons);
}

function toggle(choice, name, text, kind) {
  const box = element("input", { type: "checkbox", onchange: () => choice.set(name, box.checked) });
  box.checked = choice.get(name);
  return element("label", { class: `toggle ${kind ?? ""}` }, box, text);
}

function select(choice, name, entries, label) {
  const box = element("select", { onchange: () => choice.set(name, entries[box.selectedIndex][0]) },
    entries.map(([, text]) => element("option", {}, text)));
  const mark = () => { box.selectedIndex = entries.findIndex(([value]) => value === choice.get(name)); };
  choice.on([name], mark);
  mark();
  return element("label", { class: "select" }, label, box);
}

/** Enlargements on offer: the usual one with its neighbours, and none. */
function enlargements(usual) {
  const values = [...new Set([1, usual / 10, usual, usual * 10].filter((value) => value >= 1))];
  return [[0, "off"], ...values.map((value) => [value, value === 1 ? "true size" : `\u00d7 ${Math.round(value)}`])];
}

export function toolbar(model, choice) {
  const submap = model.submaps[choice.get("submap")];
  const hasSigma = model.submaps.some((s) => s.covariances_known);
  const parts = [
    model.submaps.length > 1
      ? select(choice, "submap", model.submaps.map((s, i) => [i, `${i + 1} \u2013 ${s.markers.length} markers`]), "Sub-map")
      : null,
    select(choice, "colour", [["findings", "findings"], ["residual", "residual"],
      ...(hasSigma ? [["uncertainty", "uncertainty"]] : [])], "Colour by"),
    hasSigma ? select(choice, "enlarge", enlargements(submap.enlargement), "1\u03c3 ellipses") : null,
    toggle(choice, "ids", "ids"),
    toggle(choice, "normals", "normals"),
    model.submaps.some((s) => s.hasTracks) ? toggle(choice, "track", "trajectory", "track") : null,
    model.submaps.some((s) => s.hasTruth) ? toggle(choice, "truth", "truth", "truth") : null,
  ];
  return element("div", { class: "toolbar" }, parts.filter(Boolean));
}

export function viewSwitch(choice) {
  return segments(choice, "view", [["top", "Top"], ["front", "Front"], ["side", "Side"]], "Direction of view");
}

export function zoomButtons(view) {
  const button = (text, label, action) =>
    element("button", { type: "button", "aria-label": label, title: label, onclick: action }, text);
  return element("div", { class: "segments zoom", role: "group", "aria-label": "Zoom" },
    button("+", "Zoom in", () => view.zoom(1.5)),
    button("\u2212", "Zoom out", () => view.zoom(1 / 1.5)),
    button("Fit", "Show everything", () => view.fit()));
}
