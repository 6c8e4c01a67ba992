// What the residuals say about the corners, the lenses and the cameras.

import { histogramChart, imageField, radiusChart, radiusLegend } from "./charts.js";
import { element } from "./element.js";
import { count, fixed, pixels } from "./format.js";

function chartFigure(title, hint, ...content) {
  return element("figure", { class: "card" },
    element("figcaption", {}, element("h3", {}, title), hint ? element("p", { class: "hint" }, hint) : null), content);
}

function cameraCard(camera) {
  const { root, enlarge } = imageField(camera);
  const share = camera.observations ? (100 * camera.rejected) / camera.observations : 0;
  const row = (name, value) => element("div", {}, element("dt", {}, name), element("dd", {}, value));
  return element("figure", { class: "card camera" },
    element("figcaption", {}, element("h3", {}, camera.camera)),
    element("dl", { class: "rows" },
      row("RMS", pixels(camera.rms_px)),
      row("Observations", count(camera.observations)),
      row("Rejected", `${count(camera.rejected)} (${fixed(share, share < 10 ? 1 : 0)} %)`),
      row("Mean x, y", `${fixed(camera.mean_px[0], 3)}, ${fixed(camera.mean_px[1], 3)} px`)),
    root,
    element("p", { class: "hint" }, `Mean residual over the image, arrows \u00d7 ${count(enlarge)}`),
    radiusChart(camera.by_radius, `Residuals of ${camera.camera} by distance from the principal point`));
}

export function residualsSection(model) {
  const { residuals } = model.summary;
  if (residuals.corners === 0) return null;
  const { accepted_beyond: beyond, rejected_beyond: lost } = residuals.histogram;
  const further = [beyond && `${count(beyond)} accepted`, lost && `${count(lost)} rejected`].filter(Boolean);
  const last = residuals.histogram.bin_px * residuals.histogram.accepted.length;
  return element("section", { id: "residuals", "aria-label": "Residuals" },
    element("h2", {}, "Residuals", element("small", {}, `${count(residuals.corners)} accepted corners`)),
    element("div", { class: "cards wide" },
      chartFigure("How far corners lie from where the map puts them", null,
        element("p", { class: "legend" }, element("span", { class: "key accepted" }, "accepted"),
          element("span", { class: "key rejected" }, "rejected")),
        histogramChart(residuals),
        further.length ? element("p", { class: "hint" }, `Beyond ${fixed(last, 2)} px: ${further.join(", ")}.`) : null),
      chartFigure("By image radius", null, radiusLegend(),
        radiusChart(residuals.by_radius, "Residuals by distance from the principal point"),
        element("p", { class: "hint" }, "A mean that leaves zero with the radius tells of a lens or focal length that does not fit."))),
    element("h3", { class: "group" }, "By camera"),
    element("div", { class: "cards" }, model.cameras.map((camera) => cameraCard(camera))));
}
