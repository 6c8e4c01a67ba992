// The map in three dimensions: markers with their fronts, normals, ellipsoids and tracks.

import {
  BufferGeometry, Color, DoubleSide, DynamicDrawUsage, Float32BufferAttribute, GridHelper,
  InstancedMesh, LineBasicMaterial, LineSegments, Matrix4, Mesh, MeshBasicMaterial,
  PerspectiveCamera, PlaneGeometry, Raycaster, RingGeometry, Scene, SphereGeometry, Vector2, Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { LineMaterial } from "three/examples/jsm/lines/LineMaterial.js";
import { LineSegments2 } from "three/examples/jsm/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/examples/jsm/lines/LineSegmentsGeometry.js";
import { ellipsoidAxes, roundStep } from "./geometry.js";
import { drawLabels, placeLabels } from "./labels.js";
import { markerColours } from "./palette.js";

const MIN_MARKER_SHARE = 0.006;  // of the scene: smaller markers are drawn larger, to be seen

export class SceneView {
  /** Throws where the browser has no WebGL. `overlay` is a canvas for the ids, above `canvas`. */
  constructor(canvas, overlay, model, choice, palette) {
    Object.assign(this, { canvas, overlay, model, choice, palette });
    this.renderer = new WebGLRenderer({ canvas, antialias: true });
    this.camera = new PerspectiveCamera(45, 1, 0.01, 1000);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableZoom = false;
    this.controls.addEventListener("change", () => this.redraw());
    canvas.style.touchAction = "pan-y";
    this.family = getComputedStyle(document.body).fontFamily;
    this.size = { width: 0, height: 0 };
    this.#listen();
    this.#build();
    new ResizeObserver(() => this.#resize()).observe(canvas.parentElement);
    this.#resize();
  }

  get submap() {
    return this.model.submaps[this.choice.get("submap")];
  }

  /** Shows everything, from above and aside. */
  fit() {
    const { low, high } = this.submap.bounds;
    const centre = new Vector3().addVectors(new Vector3(...low), new Vector3(...high)).divideScalar(2);
    const radius = Math.max(0.2, new Vector3(...high).sub(new Vector3(...low)).length() / 2);
    const narrow = Math.min(1, this.camera.aspect);
    const distance = radius / Math.sin((this.camera.fov * Math.PI) / 360) / narrow;
    this.camera.position.copy(new Vector3(-0.32, -0.75, 0.72).normalize().multiplyScalar(distance)).add(centre);
    this.camera.near = distance / 500;
    this.camera.far = distance * 20;
    this.controls.target.copy(centre);
    this.#fill();
    this.controls.update();
    this.redraw();
  }

  /** Moves sideways and nearer until what is there fills the view. */
  #fill() {
    const { low, high } = this.submap.bounds;
    const corners = [0, 1, 2, 3, 4, 5, 6, 7].map((i) =>
      new Vector3(...[0, 1, 2].map((axis) => ((i >> axis) & 1 ? high : low)[axis])));
    const margin = 1 - 44 / Math.max(120, Math.min(this.size.width, this.size.height));
    for (let round = 0; round < 6; ++round) {
      this.camera.lookAt(this.controls.target);
      this.camera.updateProjectionMatrix();
      this.camera.updateMatrixWorld();
      const seen = corners.map((corner) => corner.clone().project(this.camera));
      const [xs, ys] = [seen.map((p) => p.x), seen.map((p) => p.y)];
      const middle = [xs, ys].map((values) => (Math.min(...values) + Math.max(...values)) / 2);
      const extent = Math.max(...[xs, ys].map((values) => (Math.max(...values) - Math.min(...values)) / 2));
      const away = this.camera.position.clone().sub(this.controls.target);
      const half = away.length() * Math.tan((this.camera.fov * Math.PI) / 360);
      const step = new Vector3().setFromMatrixColumn(this.camera.matrixWorld, 0)
        .multiplyScalar(middle[0] * half * this.camera.aspect)
        .addScaledVector(new Vector3().setFromMatrixColumn(this.camera.matrixWorld, 1), middle[1] * half);
      this.controls.target.add(step);
      this.camera.position.copy(this.controls.target).addScaledVector(away, Math.max(0.3, extent / margin));
    }
  }

  /** Where a marker is drawn (CSS pixels within the canvas). */
  pixelOf(marker) {
    const at = new Vector3(...marker.centre).project(this.camera);
    return [((at.x + 1) / 2) * this.size.width, ((1 - at.y) / 2) * this.size.height, at.z];
  }

  /** Turns about a marker from where the reader is. */
  show(marker) {
    const target = new Vector3(...marker.centre);
    const away = this.camera.position.clone().sub(this.controls.target);
    this.controls.target.copy(target);
    this.camera.position.copy(target).add(away.setLength(Math.min(away.length(), marker.size_m * 25)));
    this.controls.update();
    this.redraw();
  }

  redraw() {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => {
      this.pending = false;
      this.renderer.render(this.scene, this.camera);
      this.#drawIds();
    });
  }

  #listen() {
    const { canvas, choice, palette } = this;
    choice.on(["submap"], () => { this.#build(); this.fit(); });
    choice.on(["colour", "enlarge", "normals", "track", "truth"], () => this.#build());
    choice.on(["marker"], () => this.#mark());
    choice.on(["ids"], () => this.redraw());
    palette.onChange(() => this.#build());
    canvas.addEventListener("focus", () => { this.controls.enableZoom = true; });
    canvas.addEventListener("blur", () => { this.controls.enableZoom = false; });
    canvas.addEventListener("webglcontextrestored", () => this.redraw());
    let from = null;
    canvas.addEventListener("pointerdown", (event) => {
      canvas.focus({ preventScroll: true });
      from = [event.offsetX, event.offsetY];
    });
    canvas.addEventListener("pointerup", (event) => {
      const moved = !from || Math.hypot(event.offsetX - from[0], event.offsetY - from[1]) > 5;
      if (!moved) this.#pick(event.offsetX, event.offsetY, event.pointerType === "touch" ? 22 : 10);
    });
    canvas.addEventListener("keydown", (event) => this.#key(event));
  }

  #key(event) {
    const turn = 0.12;
    const actions = {
      ArrowLeft: () => this.#orbit(turn, 0),
      ArrowRight: () => this.#orbit(-turn, 0),
      ArrowUp: () => this.#orbit(0, -turn),
      ArrowDown: () => this.#orbit(0, turn),
      "+": () => this.zoom(1.25),
      "=": () => this.zoom(1.25),
      "-": () => this.zoom(1 / 1.25),
      0: () => this.fit(),
      Escape: () => this.choice.set("marker", null),
    };
    const action = event.ctrlKey || event.metaKey || event.altKey ? null : actions[event.key];
    if (!action) return;
    event.preventDefault();
    action();
  }

  zoom(factor) {
    const away = this.camera.position.clone().sub(this.controls.target).divideScalar(factor);
    this.camera.position.copy(this.controls.target).add(away);
    this.controls.update();
    this.redraw();
  }

  #orbit(around, upward) {
    const away = this.camera.position.clone().sub(this.controls.target);
    const radius = away.length();
    const azimuth = Math.atan2(away.y, away.x) + around;
    const polar = Math.min(3.1, Math.max(0.04, Math.acos(away.z / radius) + upward));
    away.set(Math.sin(polar) * Math.cos(azimuth), Math.sin(polar) * Math.sin(azimuth), Math.cos(polar));
    this.camera.position.copy(this.controls.target).add(away.multiplyScalar(radius));
    this.controls.update();
    this.redraw();
  }

  /** The marker under the pointer: what its ray meets first, else the nearest centre. */
  #pick(x, y, reach) {
    const ray = new Raycaster();
    ray.setFromCamera(
      new Vector2((x / this.size.width) * 2 - 1, 1 - (y / this.size.height) * 2), this.camera);
    const hit = ray.intersectObject(this.plates)[0];
    let best = hit ? this.submap.markers[hit.instanceId] : null;
    let nearest = reach;
    for (const marker of hit ? [] : this.submap.markers) {
      const [mx, my, depth] = this.pixelOf(marker);
      const distance = Math.hypot(mx - x, my - y);
      if (depth < 1 && distance < nearest) [best, nearest] = [marker, distance];
    }
    this.choice.set("marker", best ? best.key : null);
  }

  #build() {
    this.scene?.traverse((object) => {
      object.geometry?.dispose();
      object.material?.dispose?.();
    });
    const { low, high } = this.submap.bounds;
    this.extent = Math.max(0.2, ...[0, 1, 2].map((i) => high[i] - low[i]));
    this.scene = new Scene();
    this.scene.background = this.#colour("paper");
    this.scene.add(this.#ground());
    this.scene.add(...this.#markers());
    if (this.choice.get("normals")) this.scene.add(this.#normals());
    if (this.choice.get("enlarge") > 0) this.scene.add(this.#ellipsoids());
    if (this.choice.get("truth")) this.scene.add(...this.#tracks("truePieces", "truth", 5));
    if (this.choice.get("track")) this.scene.add(...this.#tracks("pieces", "track", 2));
    this.ring = new Mesh(
      new RingGeometry(0.92, 1.08, 48),
      new MeshBasicMaterial({ color: this.#colour("accent"), side: DoubleSide, depthTest: false }));
    this.ring.renderOrder = 2;
    this.scene.add(this.ring);
    this.#mark();
  }

  #colour(name) {
    return new Color(this.palette.of(name).replace(/,1\)$/, ")").replace("rgba", "rgb"));
  }

  #ground() {
    const { low, high } = this.submap.bounds;
    const cell = roundStep(this.extent / 12);
    const cells = Math.ceil((1.3 * Math.max(high[0] - low[0], high[1] - low[1], cell)) / cell);
    const grid = new GridHelper(cells * cell, cells, this.#colour("line"), this.#colour("grid"));
    grid.rotation.x = Math.PI / 2;
    grid.position.set((low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]);
    return grid;
  }

  #shownSize(marker) {
    return Math.max(marker.size_m, this.extent * MIN_MARKER_SHARE);
  }

  /** Fronts in the marker's colour with a white field inside; backs grey. */
  #markers() {
    const { markers } = this.submap;
    const { colours } = markerColours(this.submap, this.choice.get("colour"), this.palette);
    const plate = (side, share, colourOf, lift) => {
      const mesh = new InstancedMesh(
        new PlaneGeometry(share, share), new MeshBasicMaterial({ side }), markers.length);
      mesh.instanceMatrix.setUsage(DynamicDrawUsage);
      markers.forEach((marker, i) => {
        const size = this.#shownSize(marker);
        const right = new Vector3(...marker.right).setLength(size);
        const up = new Vector3(...marker.up).setLength(size);
        const normal = new Vector3(...marker.normal);
        const at = new Vector3(...marker.centre).addScaledVector(normal, lift * size);
        mesh.setMatrixAt(i, new Matrix4().makeBasis(right, up, normal).setPosition(at));
        mesh.setColorAt(i, colourOf(marker, i));
      });
      return mesh;
    };
    const own = (marker, i) => new Color(`rgb(${colours[i].join(",")})`);
    const paper = this.#colour("paper");
    this.plates = plate(DoubleSide, 1, own, 0);
    const window = plate(0, 0.56, (marker) => (marker.verified ? paper.clone().lerp(this.#colour("muted"), 0.25) : paper), 0.02);
    return [this.plates, window];
  }

  #lines(points, material) {
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new Float32BufferAttribute(points.flat(), 3));
    return new LineSegments(geometry, material);
  }

  #normals() {
    const points = this.submap.markers.flatMap((marker) => {
      const reach = this.#shownSize(marker) * 0.8;
      return [marker.centre, marker.centre.map((value, i) => value + marker.normal[i] * reach)];
    });
    return this.#lines(points, new LineBasicMaterial({ color: this.#colour("muted") }));
  }

  #ellipsoids() {
    const known = this.submap.markers.filter((marker) => marker.covariance);
    const mesh = new InstancedMesh(
      // Of thousands none is large on the screen.
      known.length > 1000 ? new SphereGeometry(1, 8, 6) : new SphereGeometry(1, 20, 14),
      new MeshBasicMaterial({ color: this.#colour("sigma"), transparent: true, opacity: 0.28, depthWrite: false }),
      known.length);
    const enlarge = this.choice.get("enlarge");
    known.forEach((marker, i) => {
      const axes = ellipsoidAxes(marker.covariance).map((axis) => {
        const vector = new Vector3(...axis).multiplyScalar(enlarge);
        return vector.length() > 0 ? vector : vector.set(1e-9, 0, 0);
      });
      mesh.setMatrixAt(i, new Matrix4().makeBasis(...axes).setPosition(...marker.centre));
    });
    return mesh;
  }

  /** Lines of a width in pixels; the truth as a broad band, which shows where the estimate leaves it. */
  #tracks(which, colour, width) {
    return this.submap.tracks.map((track) => {
      const points = track[which].flatMap((piece) =>
        piece.slice(1).flatMap((point, i) => [...piece[i], ...point]));
      const band = width > 3;
      const color = this.#colour(colour);
      if (band) color.lerp(this.#colour("paper"), 0.4);
      const material = new LineMaterial({ color, linewidth: width, depthWrite: !band });
      const line = new LineSegments2(new LineSegmentsGeometry().setPositions(points), material);
      line.renderOrder = band ? -1 : 0;
      return line;
    });
  }

  /** The ring about the chosen marker. */
  #mark() {
    const marker = this.model.marker(this.choice.get("marker"));
    this.ring.visible = Boolean(marker) && marker.submap === this.submap.index;
    if (this.ring.visible) {
      const size = this.#shownSize(marker);
      const axes = [marker.right, marker.up].map((axis) => new Vector3(...axis).setLength(size));
      this.ring.matrixAutoUpdate = false;
      this.ring.matrix.makeBasis(...axes, new Vector3(...marker.normal)).setPosition(...marker.centre);
    }
    this.redraw();
  }

  #drawIds() {
    const c = this.overlay.getContext("2d");
    c.clearRect(0, 0, this.size.width, this.size.height);
    const chosen = this.choice.get("marker");
    const eye = this.camera.position;
    const anchors = [];
    const plates = [];
    for (const marker of this.submap.markers) {
      const must = marker.key === chosen;
      const [x, y, depth] = this.pixelOf(marker);
      plates.push([x - 4, y - 4, 8, 8]);
      if (!must && marker.rank === 0 && !this.choice.get("ids")) continue;
      if (depth >= 1 || x < 0 || y < 0 || x > this.size.width || y > this.size.height) continue;
      const font = `${must || marker.rank > 1 ? 600 : 400} ${must ? 13 : 11}px ${this.family}`;
      c.font = font;
      anchors.push({
        x, y, font, must, text: marker.label, gap: 7,
        width: c.measureText(marker.label).width + 3,
        tick: [0, 2],
        priority: (must ? 1e6 : 0) + marker.rank * 1e3 - eye.distanceTo(new Vector3(...marker.centre)),
        colour: this.palette.of(must ? "accent" : ["ink", "note", "warning", "error"][marker.rank]),
      });
    }
    drawLabels(c, placeLabels(anchors, plates, 12, this.size), this.palette);
  }

  #resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
    if (width === 0 || (width === this.size.width && height === this.size.height)) return;
    const first = this.size.width === 0;
    this.size = { width, height };
    const ratio = Math.min(2, window.devicePixelRatio || 1);
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, height, false);
    this.overlay.width = Math.round(width * ratio);
    this.overlay.height = Math.round(height * ratio);
    this.overlay.getContext("2d").setTransform(ratio, 0, 0, ratio, 0, 0);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    if (first) this.fit();
    else this.redraw();
  }
}
