// The report page: reads the data block and lays out the sections.

import { Choice } from "./choice.js";
import { element } from "./element.js";
import { findingsSection } from "./findings.js";
import { count, length, pixels, plural } from "./format.js";
import { median } from "./geometry.js";
import { mapSection } from "./map_section.js";
import { markersSection } from "./markers_section.js";
import { makeModel } from "./model.js";
import { Palette } from "./palette.js";
import { residualsSection } from "./residuals_section.js";
import { surveySection } from "./survey_section.js";

function themeButton(palette) {
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const button = element("button", { type: "button", class: "theme" });
  const now = () => document.documentElement.dataset.theme ?? (dark.matches ? "dark" : "light");
  const name = () => { button.textContent = now() === "dark" ? "Light" : "Dark"; };
  button.addEventListener("click", () => {
    document.documentElement.dataset.theme = now() === "dark" ? "light" : "dark";
    name();
    palette.refresh();
  });
  dark.addEventListener("change", name);
  name();
  return button;
}

function keyFigures(model) {
  const markers = model.submaps.flatMap((submap) => submap.markers);
  const sets = model.submaps.reduce((sum, submap) => sum + submap.frame_sets, 0);
  const sigmas = markers.map((m) => m.sigma_position_m).filter((sigma) => sigma !== null);
  const figure = (value, name, kind) =>
    element("div", { class: kind ?? null }, element("dd", {}, value), element("dt", {}, name));
  const worst = model.findings[0]?.severity;
  const bad = model.findings.filter((finding) => finding.severity !== "note").length;
  return element("dl", { class: "key-figures" },
    figure(count(bad), bad === 1 ? "warning" : "warnings", bad ? worst : "fine"),
    figure(count(markers.length), "markers"),
    model.submaps.length > 1 ? figure(count(model.submaps.length), "sub-maps") : null,
    figure(count(sets), "frame sets localized"),
    figure(pixels(model.summary.residuals.rms_px), "corner residual, RMS"),
    sigmas.length ? figure(length(median(sigmas), 2), "position, median 1\u03c3") : null);
}

function header(model, palette) {
  const { summary } = model;
  const names = summary.captures.map((capture) => capture.name.replace(/\/+$/, "").split("/").at(-1));
  return element("header", { class: "top" },
    element("div", {},
      element("p", { class: "over" }, "Map report"),
      element("h1", {}, summary.map || "Marker map"),
      element("p", { class: "under" }, `from ${plural(names.length, "capture", "captures")}: ${names.join(", ")}`)),
    themeButton(palette),
    keyFigures(model));
}

function navigation(sections) {
  return element("nav", { "aria-label": "Sections" }, sections.map((section) =>
    element("a", { href: `#${section.id}` }, section.getAttribute("aria-label"))));
}

function footer(summary) {
  const row = (name, value) => element("div", {}, element("dt", {}, name), element("dd", {}, value));
  const left = [
    summary.unmapped.length ? row("Seen but not mapped", summary.unmapped.join(", ")) : null,
    row("Frame sets without a pose", count(summary.unlocalized_frame_sets)),
    row("Frame sets without markers", count(summary.frame_sets_without_markers)),
    ...summary.captures.map((capture) => row("Capture", `${capture.name} (${capture.fingerprint})`)),
    row("Rig", summary.rig_fingerprint),
    row("Map", summary.content_hash),
    row("Built by", `mapbuilder ${summary.builder_version}`),
  ];
  return element("section", { id: "build", "aria-label": "Build" },
    element("h2", {}, "Build"), element("dl", { class: "rows" }, left.filter(Boolean)),
    element("p", { class: "hint" }, "A pose or map is an estimate with a covariance, not a safety function."));
}

function main() {
  const model = makeModel(JSON.parse(document.getElementById("data").textContent));
  const palette = new Palette();
  const choice = new Choice({
    submap: 0, marker: null, view: "top", colour: "findings", enlarge: model.submaps[0].enlargement,
    ids: true, normals: true, track: true, truth: true,
  });
  // A marker stands in one sub-map: when another is looked at, none is chosen.
  choice.on(["submap"], (submap) => {
    const marker = model.marker(choice.get("marker"));
    if (marker && marker.submap !== submap) choice.set("marker", null);
  });
  const map = mapSection(model, choice, palette);
  const showOnMap = (marker) => {
    map.show(marker);
    map.root.scrollIntoView({ behavior: "smooth" });
  };
  const sections = [
    findingsSection(model, showOnMap), map.root, residualsSection(model),
    markersSection(model, choice), surveySection(model.summary), footer(model.summary),
  ].filter(Boolean);
  document.title = `${model.summary.map || "Marker map"} \u2013 map report`;
  document.getElementById("report").append(
    header(model, palette), navigation(sections), element("main", {}, sections));
  map.start();
  // For tests and for the curious: where a marker is drawn.
  window.waymarkReport = { model, choice, plan: map.parts.plan, scene: map.parts.scene };
}

main();
