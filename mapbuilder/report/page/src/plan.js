// The floor plan: markers to scale on a canvas, with pan and zoom.

import { ellipse, roundStep } from "./geometry.js";
import { drawLabels, placeLabels } from "./labels.js";
import { fixed } from "./format.js";
import { PlanControls } from "./plan_controls.js";
import { markerColours } from "./palette.js";

/** Which way the plan looks: what goes right and what goes up on the page. */
const VIEWS = {
  top: [0, 1],
  front: [0, 2],
  side: [1, 2],
};
const SCALE_BAR_PX = 24;
const PADDING_PX = 40;

export class Plan {
  /** `canvas` fills its parent; `choice` holds submap, marker, view and what is drawn. */
  constructor(canvas, model, choice, palette) {
    Object.assign(this, { canvas, model, choice, palette });
    this.context = canvas.getContext("2d");
    this.family = getComputedStyle(document.body).fontFamily;
    this.hovered = null;
    this.pending = false;
    const redraw = () => this.redraw();
    choice.on(["submap", "view"], () => this.fit());
    choice.on(["marker", "colour", "enlarge", "ids", "normals", "track", "truth"], redraw);
    palette.onChange(redraw);
    this.size = { width: 0, height: 0 };
    new ResizeObserver(() => this.#resize()).observe(canvas.parentElement);
    this.controls = new PlanControls(this);
    this.#resize();
  }

  get submap() {
    return this.model.submaps[this.choice.get("submap")];
  }

  /** Page coordinates (m) of a point of the plan frame. */
  project(point) {
    const [right, up] = VIEWS[this.choice.get("view")];
    return [point[right], point[up]];
  }

  /** Canvas pixel of page coordinates. */
  pixel([right, up]) {
    return [
      this.size.width / 2 + (right - this.centre[0]) * this.scale,
      this.size.height / 2 - (up - this.centre[1]) * this.scale,
    ];
  }

  /** Where a marker's centre is drawn (CSS pixels within the canvas). */
  pixelOf(marker) {
    return this.pixel(this.project(marker.centre));
  }

  /** Shows everything. */
  fit() {
    const { low, high } = this.submap.bounds;
    const [left, bottom] = this.project(low);
    const [right, top] = this.project(high);
    const room = (size, taken) => Math.max(40, size - 2 * PADDING_PX - taken);
    this.scale = Math.min(
      room(this.size.width, 0) / Math.max(0.1, right - left),
      room(this.size.height, SCALE_BAR_PX) / Math.max(0.1, top - bottom));
    this.centre = [(left + right) / 2, (bottom + top) / 2 - SCALE_BAR_PX / 2 / this.scale];
    this.fittedScale = this.scale;
    this.redraw();
  }

  /** Zooms by `factor`, keeping the canvas pixel where it is. */
  zoom(factor, [x, y] = [this.size.width / 2, this.size.height / 2]) {
    const scale = Math.min(this.fittedScale * 400, Math.max(this.fittedScale / 4, this.scale * factor));
    const [dx, dy] = [x - this.size.width / 2, y - this.size.height / 2];
    this.centre[0] += dx / this.scale - dx / scale;
    this.centre[1] -= dy / this.scale - dy / scale;
    this.scale = scale;
    this.redraw();
  }

  pan(dx, dy) {
    this.centre[0] -= dx / this.scale;
    this.centre[1] += dy / this.scale;
    this.redraw();
  }

  /** Brings a marker to the middle, at least so large that it can be read. */
  show(marker) {
    this.centre = this.project(marker.centre);
    this.scale = Math.max(this.scale, Math.min(this.fittedScale * 8, 36 / marker.size_m));
    this.redraw();
  }

  /** The marker at a canvas pixel, or null: the nearest within a finger's reach. */
  markerAt(x, y, reach) {
    let best = null;
    let nearest = reach;
    for (const marker of this.submap.markers) {
      const [mx, my] = this.pixelOf(marker);
      const distance = Math.max(0, Math.hypot(mx - x, my - y) - (marker.size_m / 2) * this.scale * 0.7);
      const tie = distance === nearest && best && marker.rank > best.rank;
      if (distance < nearest || tie) [best, nearest] = [marker, distance];
    }
    return best;
  }

  hover(marker) {
    if (marker === this.hovered) return;
    this.hovered = marker;
    this.canvas.style.cursor = marker ? "pointer" : "";
    this.redraw();
  }

  redraw() {
    if (this.pending || !this.centre) return;
    this.pending = true;
    requestAnimationFrame(() => {
      this.pending = false;
      this.#draw();
    });
  }

  #resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
    if (width === 0 || (width === this.size.width && height === this.size.height)) return;
    const first = this.size.width === 0;
    const atRest = !first && this.scale === this.fittedScale;
    this.size = { width, height };
    const ratio = Math.min(3, window.devicePixelRatio || 1);
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    this.context.setTransform(ratio, 0, 0, ratio, 0, 0);
    if (first || atRest) this.fit();
    else this.redraw();
  }

  #draw() {
    const { context: c, palette } = this;
    c.fillStyle = palette.of("paper");
    c.fillRect(0, 0, this.size.width, this.size.height);
    this.#drawGrid();
    // The truth as a broad band below: where the estimate leaves it, it shows.
    if (this.choice.get("truth")) this.#drawTracks("truePieces", palette.of("truth", 0.3), 6);
    if (this.choice.get("track")) this.#drawTracks("pieces", palette.of("track"), 1.5);
    this.#drawEllipses();
    this.#drawMarkers();
    this.#drawLabels();
    this.#drawScaleBar();
    this.#drawAxes();
  }

  #drawGrid() {
    const { context: c, palette } = this;
    const step = roundStep(70 / this.scale);
    const [left, bottom] = [this.centre[0] - this.size.width / 2 / this.scale,
      this.centre[1] - this.size.height / 2 / this.scale];
    c.lineWidth = 1;
    c.strokeStyle = palette.of("grid");
    c.beginPath();
    for (let i = Math.ceil(left / step); (i * step - left) * this.scale < this.size.width; ++i) {
      const x = Math.round(this.pixel([i * step, 0])[0]) + 0.5;
      c.moveTo(x, 0);
      c.lineTo(x, this.size.height);
    }
    for (let i = Math.ceil(bottom / step); (i * step - bottom) * this.scale < this.size.height; ++i) {
      const y = Math.round(this.pixel([0, i * step])[1]) + 0.5;
      c.moveTo(0, y);
      c.lineTo(this.size.width, y);
    }
    c.stroke();
  }

  #drawTracks(which, colour, width) {
    const { context: c } = this;
    c.strokeStyle = colour;
    c.lineWidth = width;
    c.lineJoin = "round";
    c.beginPath();
    for (const track of this.submap.tracks) {
      for (const piece of track[which]) {
        piece.forEach((point, i) => {
          const [x, y] = this.pixel(this.project(point));
          if (i === 0) c.moveTo(x, y);
          else c.lineTo(x, y);
        });
      }
    }
    c.stroke();
  }

  #drawEllipses() {
    const enlarge = this.choice.get("enlarge");
    if (enlarge === 0) return;
    const { context: c, palette } = this;
    const [right, up] = VIEWS[this.choice.get("view")];
    c.fillStyle = palette.of("sigma", 0.16);
    c.strokeStyle = palette.of("sigma", 0.5);
    c.lineWidth = 1;
    for (const marker of this.submap.markers) {
      if (!marker.covariance) continue;
      const m = marker.covariance;
      const { major, minor, angle } = ellipse(m[right][right], m[right][up], m[up][up]);
      const [x, y] = this.pixelOf(marker);
      const radius = (value) => Math.min(4000, value * enlarge * this.scale);
      c.beginPath();
      c.ellipse(x, y, radius(major), radius(minor), -angle, 0, 2 * Math.PI);
      c.fill();
      c.stroke();
    }
  }

  #drawMarkers() {
    const { context: c, palette } = this;
    const { colours } = markerColours(this.submap, this.choice.get("colour"), palette);
    const selected = this.choice.get("marker");
    const order = [...this.submap.markers.keys()].sort(
      (a, b) => this.submap.markers[a].rank - this.submap.markers[b].rank);
    for (const i of order) {
      const marker = this.submap.markers[i];
      const colour = `rgb(${colours[i].join(",")})`;
      this.#drawMarker(marker, colour);
    }
    const chosen = selected && this.model.marker(selected);
    if (chosen && chosen.submap === this.submap.index) {
      const [x, y] = this.pixelOf(chosen);
      c.strokeStyle = palette.of("accent");
      c.lineWidth = 2.5;
      c.beginPath();
      c.arc(x, y, Math.max(11, chosen.size_m * this.scale * 0.8), 0, 2 * Math.PI);
      c.stroke();
    }
  }

  /** Its outline to scale, never thinner than can be seen, and a tick along its normal. */
  #drawMarker(marker, colour) {
    const { context: c } = this;
    const corners = marker.corners.map((corner) => this.pixel(this.project(corner)));
    c.strokeStyle = colour;
    c.fillStyle = colour;
    c.lineJoin = "round";
    c.lineWidth = marker.verified ? 3 : 1.5;
    c.beginPath();
    corners.forEach(([x, y], i) => (i === 0 ? c.moveTo(x, y) : c.lineTo(x, y)));
    c.closePath();
    c.globalAlpha = 0.3;
    if (marker.verified) c.fill();
    c.globalAlpha = 1;
    c.stroke();
    if (!this.choice.get("normals")) return;
    c.lineWidth = 1.25;
    c.beginPath();
    c.moveTo(...this.pixelOf(marker));
    c.lineTo(...this.#normalTip(marker));
    c.stroke();
  }

  #drawLabels() {
    const { context: c, palette } = this;
    const chosen = this.choice.get("marker");
    const all = this.choice.get("ids");
    const anchors = [];
    for (const marker of this.submap.markers) {
      const must = marker.key === chosen || marker === this.hovered;
      if (!all && !must && marker.rank === 0) continue;
      const [x, y] = this.pixelOf(marker);
      if (x < -20 || y < -20 || x > this.size.width + 20 || y > this.size.height + 20) continue;
      const font = `${must || marker.rank > 1 ? 600 : 400} ${must ? 13 : 11}px ${this.family}`;
      c.font = font;
      anchors.push({
        x, y, font, must, text: marker.label,
        width: c.measureText(marker.label).width + 3,
        gap: Math.max(6, Math.min(40, marker.size_m * this.scale * 0.55) + 3),
        tick: this.#tick(marker),
        priority: (must ? 1e6 : 0) + marker.rank * 1e3 + marker.size_m,
        colour: palette.of(must ? "accent" : ["ink", "note", "warning", "error"][marker.rank]),
      });
    }
    drawLabels(c, placeLabels(anchors, this.#reserved(), 12, this.size), palette);
  }

  /** Where no label belongs: on markers and their normals, on scale bar and axes. */
  #reserved() {
    const { width, height } = this.size;
    const boxes = [[0, height - 34, 230, 34], [width - 96, height - 92, 96, 92]];
    for (const marker of this.submap.markers) {
      const points = marker.corners.map((corner) => this.pixel(this.project(corner)));
      if (this.choice.get("normals")) points.push(this.#normalTip(marker));
      const [xs, ys] = [points.map(([x]) => x), points.map(([, y]) => y)];
      const [left, top] = [Math.min(...xs), Math.min(...ys)];
      const box = [left - 1, top - 1, Math.max(...xs) - left + 2, Math.max(...ys) - top + 2];
      const inView = box[0] < width && box[1] < height && box[0] + box[2] > 0 && box[1] + box[3] > 0;
      // A marker that fills the view leaves room for labels within itself.
      if (inView && box[2] < 200 && box[3] < 200) boxes.push(box);
    }
    return boxes;
  }

  /** A marker's normal as it is drawn (CSS pixels). */
  #tick(marker) {
    const [nx, ny] = this.project(marker.normal);
    const reach = Math.max(7, marker.size_m * this.scale * 0.6);
    return [nx * reach, -ny * reach];
  }

  #normalTip(marker) {
    const [x, y] = this.pixelOf(marker);
    const [dx, dy] = this.#tick(marker);
    return [x + dx, y + dy];
  }

  #drawScaleBar() {
    const { context: c, palette } = this;
    const wanted = Math.min(140, this.size.width / 4) / this.scale;
    const step = roundStep(wanted);
    const length_m = step > wanted ? (roundStep(wanted / 2.01) || step) : step;
    const width = length_m * this.scale;
    const [x, y] = [16, this.size.height - 18];
    const name = length_m >= 1 ? `${fixed(length_m, 0)} m` : `${fixed(length_m * 100, length_m < 0.01 ? 1 : 0)} cm`;
    c.lineWidth = 5;
    c.strokeStyle = palette.of("paper", 0.85);
    for (const pass of [0, 1]) {
      c.beginPath();
      c.moveTo(x, y - 5);
      c.lineTo(x, y);
      c.lineTo(x + width, y);
      c.lineTo(x + width, y - 5);
      c.stroke();
      c.lineWidth = 1.5;
      c.strokeStyle = palette.of("ink");
      if (pass === 1) break;
    }
    this.#haloText(name, x + width + 8, y - 1, palette.of("ink"), "left");
  }

  /** The map's own axes, in the corner: they need not lie along the page. */
  #drawAxes() {
    const { context: c, palette } = this;
    const [x, y] = [this.size.width - 50, this.size.height - 42];
    this.submap.axes.forEach((axis, i) => {
      const [right, up] = this.project(axis);
      const length = Math.hypot(right, up);
      if (length < 0.2) return;  // looks at the reader
      const [tipX, tipY] = [x + right * 26, y - up * 26];
      c.strokeStyle = palette.of("ink");
      c.lineWidth = 1.5;
      c.beginPath();
      c.moveTo(x, y);
      c.lineTo(tipX, tipY);
      c.stroke();
      this.#haloText("xyz"[i], tipX + (right / length) * 9, tipY - (up / length) * 9,
        palette.of("ink"), "center");
    });
  }

  #haloText(text, x, y, colour, align) {
    const { context: c } = this;
    c.font = `600 12px ${this.family}`;
    c.textAlign = align;
    c.textBaseline = "middle";
    c.lineWidth = 3;
    c.strokeStyle = this.palette.of("paper", 0.9);
    c.strokeText(text, x, y);
    c.fillStyle = colour;
    c.fillText(text, x, y);
  }
}
