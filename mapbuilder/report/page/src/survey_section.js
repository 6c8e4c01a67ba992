// What was measured on site, against the map.

import { element } from "./element.js";
import { fixed, length } from "./format.js";
import { SortedTable } from "./tables.js";

export function surveySection(summary) {
  if (summary.survey.length === 0) return null;
  const sigmas = (entry) => (entry.residual_m === null || !entry.sigma_m ? null : Math.abs(entry.residual_m) / entry.sigma_m);
  const size = (entry) => (entry.residual_m === null ? null : Math.abs(entry.residual_m));
  const kind = (value) => (sigmas(value) > 5 ? "tag error" : sigmas(value) > 3 ? "tag warning" : "");
  const columns = [
    { name: "Entry", value: (e) => e.entry, show: (e) => e.entry },
    { name: "Use", title: "Fit, or only a check", value: (e) => e.use, show: (e) => e.use },
    { name: "Measured m", numeric: true, value: (e) => e.measured_m, show: (e) => fixed(e.measured_m, 4) },
    { name: "Map m", numeric: true, value: (e) => e.mapped_m, show: (e) => fixed(e.mapped_m, 4) },
    { name: "Residual", numeric: true, title: "Map less measured; of points the distance", value: size,
      show: (e) => (e.residual_m === null ? "not in the map" : length(e.residual_m)) },
    { name: "in \u03c3", numeric: true, title: "Residual by the stated sigma", value: sigmas,
      show: (e) => element("span", { class: kind(e) }, fixed(sigmas(e), 1)) },
    { name: "Stated \u03c3", numeric: true, value: (e) => e.sigma_m, show: (e) => length(e.sigma_m) },
  ];
  const rmse = (use) => {
    const values = summary.survey.filter((e) => e.use === use && e.residual_m !== null).map((e) => e.residual_m);
    return values.length ? `${use} ${length(Math.hypot(...values) / Math.sqrt(values.length))} RMS of ${values.length}` : null;
  };
  const table = new SortedTable(columns, {
    rows: summary.survey, sort: "Residual", descending: true, caption: "Survey", keyOf: (entry) => entry.entry,
  });
  return element("section", { id: "survey", "aria-label": "Survey" },
    element("h2", {}, "Survey", element("small", {}, [rmse("fit"), rmse("check")].filter(Boolean).join("; "))), table.root);
}
