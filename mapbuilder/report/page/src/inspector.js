// The figures of the chosen marker, or of the whole sub-map.

import { element } from "./element.js";
import { causeName, coordinates, count, degrees, fixed, length, pixels } from "./format.js";

const FRAMES = {
  arbitrary: "Origin and axes are the mapper\u2019s choice; the stated sizes set the scale.",
  scaled: "Origin and axes are the mapper\u2019s choice; measured distances set the scale.",
  facility: "Origin, axes and scale are the survey\u2019s.",
};

function rows(entries) {
  return element("dl", { class: "rows" }, entries.filter(Boolean).map(([name, value, field]) =>
    element("div", {}, element("dt", {}, name), element("dd", { "data-field": field }, value))));
}

function tilt(marker) {
  const level = (Math.asin(Math.max(-1, Math.min(1, marker.normal[2]))) * 180) / Math.PI;
  if (level > 75) return "faces up";
  if (level < -75) return "faces down";
  return Math.abs(level) < 15 ? "stands upright" : `leans ${fixed(Math.abs(level), 0)}\u00b0 ${level > 0 ? "up" : "down"}`;
}

function aboutMarker(marker, { close, show }) {
  const restated = marker.size_m !== marker.stated_size_m;
  const along = marker.covariance
    ? [0, 1, 2].map((i) => length(Math.sqrt(Math.max(0, marker.covariance[i][i])))).join(", ")
    : null;
  return [
    element("header", {},
      element("h3", {}, element("span", { class: "kind" }, "Marker"),
        element("span", { class: "id", "data-field": "id" }, marker.label)),
      element("button", { type: "button", class: "close", "aria-label": "Close", onclick: close }, "\u00d7")),
    marker.findings.map((finding) =>
      element("p", { class: `flag ${finding.severity}` }, `${causeName(finding)}: ${finding.text}`)),
    rows([
      ["Residual, RMS", pixels(marker.rms_px), "rms"],
      ["Views accepted", count(marker.observations), "observations"],
      ["Views rejected", count(marker.rejected), "rejected"],
      ["Verified", marker.verified ? "yes, by two views or more" : "no, one view", "verified"],
      ["Position, 1\u03c3", length(marker.sigma_position_m), "sigma"],
      along && ["along plan x, y, up", along, "sigmas"],
      ["Rotation, 1\u03c3", degrees(marker.sigma_rotation_deg), "sigma-rotation"],
      ["Size", restated ? `${length(marker.size_m, 4)} (stated ${length(marker.stated_size_m, 4)})` : length(marker.size_m, 4), "size"],
      ["Position x y z, m", coordinates(marker.position_m), "position"],
      ["Front", tilt(marker), "front"],
      ["Family", marker.family, "family"],
    ]),
    element("p", { class: "actions" },
      element("button", { type: "button", onclick: show }, "Zoom to it")),
  ];
}

function aboutSubMap(submap, many) {
  const sizes = [...new Set(submap.markers.map((marker) => marker.size_m))].sort((a, b) => a - b);
  const { low, high } = submap.bounds;
  const span = [0, 1, 2].map((i) => fixed(high[i] - low[i], 1)).join(" \u00d7 ");
  const unverified = submap.markers.filter((marker) => !marker.verified).length;
  return [
    element("header", {}, element("h3", {}, many ? `Sub-map ${submap.index + 1}` : "The map")),
    element("p", { class: "hint" }, "Choose a marker on the plan, in the 3D view or in the table to read its figures."),
    rows([
      ["Markers", count(submap.markers.length)],
      ["of one view only", count(unverified)],
      ["Extent", `${span} m`],
      ["Sizes", sizes.length <= 4 ? sizes.map((size) => length(size, 4)).join(", ") : `${count(sizes.length)} different`],
      ["Frame sets localized", count(submap.frame_sets)],
      ["Frame sets ambiguous", count(submap.ambiguous_frame_sets)],
      ["Observations", count(submap.observations)],
      ["rejected", count(submap.rejected)],
      ["RMS of accepted", pixels(submap.rms_px)],
      ["RMS of all", pixels(submap.rms_all_px)],
      ["Corner \u03c3", pixels(submap.corner_sigma_px)],
    ]),
    submap.tracks.filter((track) => track.translation_rmse_m !== null).map((track) =>
      element("p", { class: "hint" },
        `Trajectory against the truth of ${track.capture}: ${length(track.translation_rmse_m)}, ${degrees(track.rotation_rmse_deg)} RMSE.`)),
    element("p", { class: "hint" }, FRAMES[submap.frame],
      submap.zIsUp ? null : " Which way is up is guessed for these views from walls and cameras."),
  ];
}

/** The panel beside the map. `show(marker)` brings one into view. */
export class Inspector {
  constructor(model, choice, show) {
    Object.assign(this, { model, choice, show });
    this.root = element("aside", { class: "inspector", "aria-live": "polite", "aria-label": "Figures" });
    choice.on(["marker", "submap"], () => this.#fill());
    this.#fill();
  }

  #fill() {
    const marker = this.model.marker(this.choice.get("marker"));
    this.root.classList.toggle("chosen", Boolean(marker));
    const submap = this.model.submaps[this.choice.get("submap")];
    const content = marker
      ? aboutMarker(marker, {
          close: () => this.choice.set("marker", null),
          show: () => this.show(marker),
        })
      : aboutSubMap(submap, this.model.submaps.length > 1);
    this.root.replaceChildren(...content.flat(2));
  }
}
