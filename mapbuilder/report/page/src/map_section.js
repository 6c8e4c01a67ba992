// The map: floor plan, 3D view and the figures of what is chosen.

import { element } from "./element.js";
import { length, pixels } from "./format.js";
import { Inspector } from "./inspector.js";
import { markerColours } from "./palette.js";
import { Plan } from "./plan.js";
import { SceneView } from "./scene.js";
import { toolbar, viewSwitch, zoomButtons } from "./toolbar.js";

/** What the colours of the markers mean. */
function legend(model, choice, palette) {
  const root = element("p", { class: "legend" });
  const fill = () => {
    const submap = model.submaps[choice.get("submap")];
    const by = choice.get("colour");
    const { range } = markerColours(submap, by, palette);
    if (range) {
      const text = by === "residual" ? pixels : length;
      root.replaceChildren(element("span", {}, text(range[0])), element("span", { class: "ramp" }),
        element("span", {}, text(range[1])));
      return;
    }
    const entries = [["sound", "sound", 0], ["note", "note", 1], ["warning", "warning", 2], ["error", "error", 3]]
      .filter(([, , rank]) => submap.markers.some((marker) => marker.rank === rank))
      .map(([kind, text]) => element("span", { class: `key ${kind}` }, text));
    const single = submap.markers.some((marker) => !marker.verified)
      ? element("span", { class: "key hollow" }, "one view") : null;
    root.replaceChildren(...entries, ...(single ? [single] : []));
  };
  choice.on(["submap", "colour"], fill);
  palette.onChange(fill);
  fill();
  return root;
}

function frame(kind, title, canvases, ...controls) {
  return element("figure", { class: `view ${kind}` },
    element("figcaption", {}, element("h3", {}, title), ...controls),
    element("div", { class: "canvas" }, canvases));
}

function planFigure(parts, model, choice, palette) {
  const canvas = element("canvas", {
    id: "plan", tabindex: 0, role: "application",
    "aria-label": "Floor plan. Arrow keys pan, plus and minus zoom, 0 fits, N and P choose the next and the previous marker.",
  });
  const figure = frame("plan", "Floor plan", [canvas], legend(model, choice, palette), viewSwitch(choice));
  parts.later.push(() => {
    parts.plan = new Plan(canvas, model, choice, palette);
    figure.querySelector("figcaption").append(zoomButtons(parts.plan));
  });
  return figure;
}

function sceneFigure(parts, model, choice, palette) {
  const canvas = element("canvas", {
    id: "scene", tabindex: 0, role: "application",
    "aria-label": "3D view. Arrow keys turn, plus and minus zoom, 0 fits.",
  });
  const overlay = element("canvas", { class: "overlay", "aria-hidden": "true" });
  const figure = frame("scene", "3D view", [canvas, overlay]);
  parts.later.push(() => {
    try {
      parts.scene = new SceneView(canvas, overlay, model, choice, palette);
      figure.querySelector("figcaption").append(zoomButtons(parts.scene));
    } catch (error) {
      const why = element("p", { class: "absent" }, `This browser shows no WebGL, so there is no 3D view (${error.message}).`);
      figure.querySelector(".canvas").replaceChildren(why);
    }
  });
  return figure;
}

/** The section, and `parts` with plan and scene once `start` was called on a page that is laid out. */
export function mapSection(model, choice, palette) {
  const parts = { plan: null, scene: null, later: [] };
  const show = (marker) => {
    choice.set("submap", marker.submap);
    choice.set("marker", marker.key);
    parts.plan?.show(marker);
    parts.scene?.show(marker);
  };
  const inspector = new Inspector(model, choice, show);
  const root = element("section", { id: "map", "aria-label": "Map" },
    element("h2", {}, "Map"),
    toolbar(model, choice),
    element("div", { class: "map" },
      element("div", { class: "views" },
        planFigure(parts, model, choice, palette), sceneFigure(parts, model, choice, palette)),
      inspector.root),
    element("p", { class: "hint keys" },
      "Drag to pan or turn. Click a view, then scroll to zoom; or use the keys: arrows, +, \u2212, 0 to fit, N and P for the next and the previous marker."));
  const start = () => parts.later.forEach((step) => step());
  return { root, parts, show, start };
}

