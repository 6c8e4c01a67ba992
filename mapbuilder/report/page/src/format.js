// Numbers for people: unit chosen by size, as many digits as mean something.

const MINUS = "\u2212";
const NONE = "\u2013";

/** Fixed digits with a true minus sign; a dash for what is unknown. */
export function fixed(value, digits) {
  if (value === null || value === undefined || !Number.isFinite(value)) return NONE;
  const text = value.toFixed(digits);
  return (Number(text) === 0 ? text.replace("-", "") : text).replace("-", MINUS);
}

function significant(value, digits) {
  if (value === 0) return "0";
  const decimals = Math.max(0, digits - 1 - Math.floor(Math.log10(Math.abs(value))));
  return fixed(value, Math.min(6, decimals));
}

/** Lengths below 1 m in mm, below 0.1 mm in \u00b5m. */
export function length(value_m, digits = 3) {
  if (value_m === null || value_m === undefined) return NONE;
  const size = Math.abs(value_m);
  if (size === 0 || (size >= 1e-4 && size < 1)) return `${significant(value_m * 1e3, digits)} mm`;
  if (size < 1e-4) return `${significant(value_m * 1e6, digits)} \u00b5m`;
  return `${significant(value_m, digits + 1)} m`;
}

export function pixels(value) {
  return value === null || value === undefined ? NONE : `${fixed(value, 3)} px`;
}

export function degrees(value) {
  return value === null || value === undefined ? NONE : `${significant(value, 3)}\u00b0`;
}

export function coordinates(vector_m) {
  return vector_m.map((value) => fixed(value, 3)).join("  ");
}

export function count(value) {
  return value.toLocaleString("en-US").replaceAll(",", "\u2009");
}

export function plural(value, one, many) {
  return `${count(value)} ${value === 1 ? one : many}`;
}

/** What a finding is about: "rig displaced". */
export const causeName = (finding) => finding.cause.replaceAll("_", " ");

/** A finding's figure: "0.125 \u00b1 0.001 m". */
export function figure({ value, unit, sigma }) {
  const decimals = (number) =>
    Number.isInteger(number) ? 0 : Math.max(0, 2 - Math.floor(Math.log10(Math.abs(number))));
  const digits = Math.min(6, sigma ? decimals(sigma) - 1 : decimals(value));
  const spread = sigma ? ` \u00b1 ${fixed(sigma, Math.max(0, digits))}` : "";
  const gap = unit === "" || unit === "\u00b0" ? "" : " ";
  return `${fixed(value, Math.max(0, digits))}${spread}${gap}${unit}`;
}
