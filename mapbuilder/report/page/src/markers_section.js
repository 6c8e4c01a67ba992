// The markers, worst first.

import { element } from "./element.js";
import { causeName, count, degrees, fixed, length } from "./format.js";
import { SortedTable } from "./tables.js";

const FLAGS = ["", "note", "warning", "error"];

function columns(submap) {
  const known = submap.covariances_known;
  return [
    { name: "Id", title: "Marker", value: (m) => m.id, show: (m) => element("b", {}, m.label), numeric: typeof submap.markers[0]?.id === "number" },
    { name: "Finding", title: "What is wrong with it", value: (m) => m.rank, numeric: true,
      show: (m) => (m.rank ? element("span", { class: `tag ${FLAGS[m.rank]}`, title: m.findings[0].text }, causeName(m.findings[0])) : "") },
    { name: "RMS px", title: "Residual over the corners of accepted views", value: (m) => m.rms_px, show: (m) => fixed(m.rms_px, 3), numeric: true },
    { name: "Views", title: "Accepted observations", value: (m) => m.observations, show: (m) => count(m.observations), numeric: true },
    { name: "Rejected", title: "Observations rejected by the gate", value: (m) => m.rejected, show: (m) => count(m.rejected), numeric: true },
    known && { name: "\u03c3 position", title: "One standard deviation of the position", value: (m) => m.sigma_position_m, show: (m) => length(m.sigma_position_m), numeric: true },
    known && { name: "\u03c3 rotation", title: "One standard deviation of the rotation", value: (m) => m.sigma_rotation_deg, show: (m) => degrees(m.sigma_rotation_deg), numeric: true },
    { name: "Size", title: "Edge length the map was built with", value: (m) => m.size_m, show: (m) => length(m.size_m, 4), numeric: true },
    ...["x", "y", "z"].map((axis, i) => ({
      name: `${axis} m`, title: "Position in the map", value: (m) => m.position_m[i], show: (m) => fixed(m.position_m[i], 3), numeric: true,
    })),
    { name: "Verified", title: "Seen from two views or more that agree", value: (m) => Number(m.verified), show: (m) => (m.verified ? "yes" : "one view") },
  ].filter(Boolean);
}

export function markersSection(model, choice) {
  const place = element("div");
  const search = element("input", { type: "search", placeholder: "Find an id", "aria-label": "Find an id",
    oninput: () => filter() });
  let table = null;
  const filter = () => {
    const wanted = search.value.trim();
    table.setFilter((marker) => wanted === "" || marker.label.includes(wanted));
  };
  const fill = () => {
    const submap = model.submaps[choice.get("submap")];
    table = new SortedTable(columns(submap), {
      rows: submap.markers, sort: "RMS px", descending: true, caption: "Markers",
      keyOf: (marker) => marker.key,
      onRow: (marker) => choice.set("marker", marker.key),
    });
    filter();
    place.replaceChildren(table.root);
  };
  choice.on(["submap"], fill);
  choice.on(["marker"], (key) => table.select(key));
  fill();
  return element("section", { id: "markers", "aria-label": "Markers" },
    element("h2", {}, "Markers", element("small", {}, "worst first; click a heading to sort")), search, place);
}
