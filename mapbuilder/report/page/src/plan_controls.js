// Pointer, wheel and keys of the plan.

const CLICK_REACH_PX = { mouse: 10, pen: 12, touch: 22 };
const STILL_PX = 5;

export class PlanControls {
  #pointers = new Map();
  #moved = false;

  constructor(plan) {
    this.plan = plan;
    const { canvas } = plan;
    canvas.addEventListener("pointerdown", (event) => this.#down(event));
    canvas.addEventListener("pointermove", (event) => this.#move(event));
    canvas.addEventListener("pointerup", (event) => this.#up(event));
    canvas.addEventListener("pointercancel", (event) => this.#pointers.delete(event.pointerId));
    canvas.addEventListener("pointerleave", () => plan.hover(null));
    // A wheel over the plan scrolls the page until the plan was clicked: nobody gets stuck in it.
    canvas.addEventListener("wheel", (event) => this.#wheel(event), { passive: false });
    canvas.addEventListener("dblclick", (event) => plan.zoom(2, [event.offsetX, event.offsetY]));
    canvas.addEventListener("keydown", (event) => this.#key(event));
  }

  #down(event) {
    this.plan.canvas.focus({ preventScroll: true });
    this.plan.canvas.setPointerCapture(event.pointerId);
    this.#pointers.set(event.pointerId, { from: [event.offsetX, event.offsetY], at: [event.offsetX, event.offsetY] });
    this.#moved = this.#pointers.size > 1;
  }

  #move(event) {
    const { plan } = this;
    const pointer = this.#pointers.get(event.pointerId);
    const at = [event.offsetX, event.offsetY];
    if (!pointer) {
      if (event.pointerType === "mouse") plan.hover(plan.markerAt(...at, CLICK_REACH_PX.mouse));
      return;
    }
    const before = this.#spread();
    if (Math.hypot(at[0] - pointer.from[0], at[1] - pointer.from[1]) > STILL_PX) this.#moved = true;
    const step = [at[0] - pointer.at[0], at[1] - pointer.at[1]];
    pointer.at = at;
    if (!this.#moved) return;
    const share = 1 / this.#pointers.size;
    plan.pan(step[0] * share, step[1] * share);
    const after = this.#spread();
    if (before && after) plan.zoom(after.distance / before.distance, after.middle);
  }

  #up(event) {
    const { plan } = this;
    if (!this.#pointers.delete(event.pointerId) || this.#moved) return;
    const reach = CLICK_REACH_PX[event.pointerType] ?? CLICK_REACH_PX.mouse;
    const marker = plan.markerAt(event.offsetX, event.offsetY, reach);
    plan.choice.set("marker", marker ? marker.key : null);
  }

  /** Distance and middle of two fingers. */
  #spread() {
    if (this.#pointers.size !== 2) return null;
    const [a, b] = [...this.#pointers.values()].map((pointer) => pointer.at);
    return {
      distance: Math.max(1, Math.hypot(a[0] - b[0], a[1] - b[1])),
      middle: [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2],
    };
  }

  #wheel(event) {
    const { plan } = this;
    if (document.activeElement !== plan.canvas && !event.ctrlKey && !event.metaKey) return;
    event.preventDefault();
    plan.zoom(Math.exp(-event.deltaY * (event.deltaMode === 1 ? 0.05 : 0.0015)), [event.offsetX, event.offsetY]);
  }

  #key(event) {
    const { plan } = this;
    const step = 60;
    const actions = {
      ArrowLeft: () => plan.pan(step, 0),
      ArrowRight: () => plan.pan(-step, 0),
      ArrowUp: () => plan.pan(0, step),
      ArrowDown: () => plan.pan(0, -step),
      "+": () => plan.zoom(1.4),
      "=": () => plan.zoom(1.4),
      "-": () => plan.zoom(1 / 1.4),
      0: () => plan.fit(),
      n: () => this.#next(1),
      p: () => this.#next(-1),
      Escape: () => plan.choice.set("marker", null),
    };
    const action = event.ctrlKey || event.metaKey || event.altKey ? null : actions[event.key];
    if (!action) return;
    event.preventDefault();
    action();
  }

  /** The next marker by id, brought into view. */
  #next(direction) {
    const { plan } = this;
    const { markers } = plan.submap;
    const now = markers.findIndex((marker) => marker.key === plan.choice.get("marker"));
    const from = now < 0 && direction < 0 ? 0 : now;
    const marker = markers[(from + direction + markers.length) % markers.length];
    plan.choice.set("marker", marker.key);
    const [x, y] = plan.pixelOf(marker);
    if (x < 0 || y < 0 || x > plan.size.width || y > plan.size.height) plan.show(marker);
  }
}
