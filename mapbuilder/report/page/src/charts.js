// Charts of the residuals, as SVG that scales with its column.

import { element, svg } from "./element.js";
import { count, fixed, pixels } from "./format.js";
import { roundStep } from "./geometry.js";

const WIDTH = 480;
const HEIGHT = 240;
const EDGE = { left: 46, right: 14, top: 14, bottom: 38 };

/** Axes, grid and scales of a chart over [x0, x1] × [y0, y1]. */
class Frame {
  constructor({ x: [x0, x1], y: [y0, y1], xName, yName, label }) {
    Object.assign(this, { x0, x1, y0, y1 });
    this.root = svg("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, class: "chart", role: "img", "aria-label": label });
    this.#ticks(x0, x1, 6, (value, text) => {
      const x = this.x(value);
      this.root.append(svg("text", { x, y: HEIGHT - EDGE.bottom + 16, class: "tick", "text-anchor": "middle" }, text));
    });
    this.#ticks(y0, y1, 4, (value, text) => {
      const y = this.y(value);
      const kind = value === 0 ? "base" : "rule";
      this.root.append(
        svg("line", { x1: EDGE.left, x2: WIDTH - EDGE.right, y1: y, y2: y, class: kind }),
        svg("text", { x: EDGE.left - 7, y: y + 3.5, class: "tick", "text-anchor": "end" }, text));
    });
    this.root.append(
      svg("text", { x: WIDTH - EDGE.right, y: HEIGHT - 5, class: "name", "text-anchor": "end" }, xName),
      svg("text", { x: EDGE.left - 38, y: EDGE.top - 3, class: "name" }, yName));
  }

  x(value) {
    return EDGE.left + ((value - this.x0) / (this.x1 - this.x0)) * (WIDTH - EDGE.left - EDGE.right);
  }

  y(value) {
    return HEIGHT - EDGE.bottom - ((value - this.y0) / (this.y1 - this.y0)) * (HEIGHT - EDGE.top - EDGE.bottom);
  }

  bar(from, to, low, high, kind, title) {
    const [top, bottom] = [this.y(high), this.y(low)];
    this.root.append(
      svg("rect", {
        x: this.x(from) + 0.5, width: Math.max(0.5, this.x(to) - this.x(from) - 1), y: top,
        height: Math.max(0, bottom - top), class: kind,
      }, svg("title", {}, title)));
  }

  path(points, kind) {
    const place = points.map(([x, y]) => `${this.x(x).toFixed(1)},${this.y(y).toFixed(1)}`).join(" ");
    this.root.append(svg("polyline", { points: place, class: kind }));
  }

  dot(x, y, kind, title) {
    this.root.append(svg("circle", { cx: this.x(x), cy: this.y(y), r: 3.2, class: kind }, svg("title", {}, title)));
  }

  mark(x, text, row) {
    const at = this.x(x);
    const right = at > WIDTH - 130;
    this.root.append(
      svg("line", { x1: at, x2: at, y1: EDGE.top, y2: HEIGHT - EDGE.bottom, class: "mark" }),
      svg("text", {
        x: at + (right ? -5 : 5), y: EDGE.top + 10 + 14 * row, class: "said",
        "text-anchor": right ? "end" : "start",
      }, text));
  }

  #ticks(from, to, about, draw) {
    const step = roundStep((to - from) / about);
    const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
    for (let i = Math.ceil(from / step - 1e-9); i * step <= to + step * 1e-6; ++i) {
      draw(i * step, step >= 1000 ? count(i * step) : fixed(i * step, digits));
    }
  }
}

export function histogramChart(residuals) {
  const { bin_px: bin, accepted, rejected } = residuals.histogram;
  const highest = Math.max(1, ...accepted.map((n, i) => n + rejected[i]));
  const frame = new Frame({
    x: [0, bin * accepted.length], y: [0, highest * 1.06], xName: "corner residual, px", yName: "corners",
    label: `Histogram of ${count(residuals.corners)} corner residuals, median ${pixels(residuals.median_px)}`,
  });
  accepted.forEach((n, i) => {
    const range = `${fixed(i * bin, 3)} to ${fixed((i + 1) * bin, 3)} px`;
    if (n > 0) frame.bar(i * bin, (i + 1) * bin, 0, n, "accepted", `${count(n)} accepted, ${range}`);
    if (rejected[i] > 0) {
      frame.bar(i * bin, (i + 1) * bin, n, n + rejected[i], "rejected", `${count(rejected[i])} rejected, ${range}`);
    }
  });
  const marks = [[residuals.median_px, "median"], [residuals.rms_px, "RMS"], [residuals.quantile90_px, "90 %"]];
  marks.sort((a, b) => a[0] - b[0]).forEach(([value, name], row) => {
    if (value < bin * accepted.length) frame.mark(value, `${name} ${pixels(value)}`, row);
  });
  return frame.root;
}

/** RMS and signed means of radius bins. */
export function radiusChart(bins, label) {
  const used = bins.filter((bin) => bin.corners > 0);
  const middle = (bin) => (bin.from_px + bin.to_px) / 2;
  const values = used.flatMap((bin) => [bin.rms_px, bin.mean_radial_px, bin.mean_tangential_px, 0]);
  const [low, high] = [Math.min(0, ...values), Math.max(1e-3, ...values)];
  const room = (high - low) * 0.08;
  const frame = new Frame({
    x: [0, bins.length ? bins.at(-1).to_px : 1], y: [low < 0 ? low - room : 0, high + room],
    xName: "distance from the principal point, px", yName: "px", label,
  });
  const most = Math.max(1, ...used.map((bin) => bin.corners));
  for (const bin of used) {
    const share = (bin.corners / most) * (high + room) * 0.9;
    frame.bar(bin.from_px, bin.to_px, 0, share, "share", `${count(bin.corners)} corners`);
  }
  for (const [key, kind, name] of [["rms_px", "rms", "RMS"], ["mean_radial_px", "radial", "mean outward"],
    ["mean_tangential_px", "tangential", "mean around"]]) {
    frame.path(used.map((bin) => [middle(bin), bin[key]]), `series ${kind}`);
    for (const bin of used) {
      frame.dot(middle(bin), bin[key], `dot ${kind}`,
        `${name} ${pixels(bin[key])} at ${fixed(bin.from_px, 0)}\u2013${fixed(bin.to_px, 0)} px, ${count(bin.corners)} corners`);
    }
  }
  return frame.root;
}

export function radiusLegend() {
  const entry = (kind, text) => element("span", { class: `key ${kind}` }, text);
  return element("p", { class: "legend" }, entry("rms", "RMS"), entry("radial", "mean outward"),
    entry("tangential", "mean around"), entry("share", "corners"));
}

/** Mean residuals over the image, enlarged arrows in a grid: a lens that fits shows noise. */
export function imageField(camera) {
  const { columns, rows, cells } = camera.grid;
  const [width, height] = [camera.width_px, camera.height_px];
  const cell = width / columns;
  const trusted = cells.map(([corners, x, y]) => (corners >= 8 ? [x, y] : null));
  const longest = Math.max(1e-9, ...trusted.filter(Boolean).map(([x, y]) => Math.hypot(x, y)));
  const enlarge = Math.max(1, roundStep((0.9 * cell) / longest / 2));
  const most = Math.max(1, ...cells.map(([corners]) => corners));
  const root = svg("svg", {
    viewBox: `0 0 ${width} ${height}`, class: "field", role: "img",
    "aria-label": `Mean residual over the image of ${camera.camera}, arrows enlarged ${enlarge} times`,
  });
  cells.forEach(([corners, x, y], i) => {
    const [left, top] = [(i % columns) * (width / columns), Math.floor(i / columns) * (height / rows)];
    root.append(
      svg("rect", { x: left, y: top, width: width / columns, height: height / rows, class: "cell",
        "fill-opacity": (0.34 * Math.sqrt(corners / most)).toFixed(3) },
      svg("title", {}, corners ? `${count(corners)} corners, mean ${fixed(x, 3)}, ${fixed(y, 3)} px` : "no corners")));
  });
  trusted.forEach((mean, i) => {
    if (!mean) return;
    const [x, y] = [((i % columns) + 0.5) * (width / columns), (Math.floor(i / columns) + 0.5) * (height / rows)];
    const [tipX, tipY] = [x + mean[0] * enlarge, y + mean[1] * enlarge];
    root.append(
      svg("line", { x1: x, y1: y, x2: tipX, y2: tipY, class: "arrow", "stroke-width": width / 260 }),
      svg("circle", { cx: x, cy: y, r: width / 200, class: "root" }));
  });
  return { root, enlarge };
}
