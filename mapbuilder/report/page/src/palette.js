// Colours of the present theme for what is drawn rather than styled.

const NAMES = ["paper", "ink", "muted", "faint", "line", "grid", "accent", "track", "truth", "error",
  "warning", "note", "sound", "sigma", "ramp0", "ramp1", "ramp2"];

function parse(text) {
  const value = text.trim().replace("#", "");
  return [0, 2, 4].map((at) => parseInt(value.slice(at, at + 2), 16));
}

export class Palette {
  #listeners = [];

  constructor() {
    this.#read();
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.refresh());
  }

  /** After the theme was changed. */
  refresh() {
    this.#read();
    for (const listener of this.#listeners) listener();
  }

  onChange(listener) {
    this.#listeners.push(listener);
  }

  /** A named colour, with an opacity from 0 to 1. */
  of(name, opacity = 1) {
    return `rgba(${this.rgb[name].join(",")},${opacity})`;
  }

  /** From low (0) to high (1). */
  ramp(share) {
    const at = Math.min(1, Math.max(0, share)) * 2;
    const [from, to] = at < 1 ? [this.rgb.ramp0, this.rgb.ramp1] : [this.rgb.ramp1, this.rgb.ramp2];
    const within = at < 1 ? at : at - 1;
    return from.map((value, i) => Math.round(value + (to[i] - value) * within));
  }

  #read() {
    const style = getComputedStyle(document.documentElement);
    this.rgb = Object.fromEntries(
      NAMES.map((name) => [name, parse(style.getPropertyValue(`--${name}`))]));
  }
}

/** [r, g, b] of each marker by what the reader wants to see; also what the colours mean. */
export function markerColours(submap, by, palette) {
  if (by === "findings") {
    const names = ["sound", "note", "warning", "error"];
    return { colours: submap.markers.map((marker) => palette.rgb[names[marker.rank]]), range: null };
  }
  const values = submap.markers.map((m) => (by === "residual" ? m.rms_px : m.sigma_position_m) ?? 0);
  const sorted = [...values].sort((a, b) => a - b);
  const at = (share) => sorted[Math.round(share * (sorted.length - 1))];
  // The ends of the scale leave the extreme twentieths out, lest one marker flatten all others.
  const [low, high] = [at(0.05), at(0.95)];
  const share = (value) => (high > low ? (value - low) / (high - low) : 0);
  return { colours: values.map((value) => palette.ramp(share(value))), range: [low, high] };
}
