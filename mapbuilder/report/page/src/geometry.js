// The little linear algebra that the views need; vectors are [x, y, z].

export const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const scaled = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

/** Rotates a vector by a unit quaternion [x, y, z, w]. */
export function rotated([x, y, z, w], [a, b, c]) {
  const t = [2 * (y * c - z * b), 2 * (z * a - x * c), 2 * (x * b - y * a)];
  return [
    a + w * t[0] + y * t[2] - z * t[1],
    b + w * t[1] + z * t[0] - x * t[2],
    c + w * t[2] + x * t[1] - y * t[0],
  ];
}

/** The symmetric 3×3 whose upper triangle is given row by row, turned by a quaternion. */
export function rotatedCovariance(q, [xx, xy, xz, yy, yz, zz]) {
  const m = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
  // R M Rᵀ: the columns of R M are turned columns of M, its rows are turned once more.
  const turned = m.map((column) => rotated(q, column));
  const rows = [0, 1, 2].map((i) => rotated(q, turned.map((column) => column[i])));
  return rows;
}

/** Half axes of the ellipse of a symmetric 2×2: lengths, and the angle of the longer one. */
export function ellipse(a, b, c) {
  const mean = (a + c) / 2;
  const spread = Math.hypot((a - c) / 2, b);
  return {
    major: Math.sqrt(Math.max(0, mean + spread)),
    minor: Math.sqrt(Math.max(0, mean - spread)),
    angle: 0.5 * Math.atan2(2 * b, a - c),
  };
}

/** Half axes of the ellipsoid of a symmetric 3×3 as columns (Jacobi's rotations). */
export function ellipsoidAxes(covariance) {
  const m = covariance.map((row) => [...row]);
  const v = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
  for (let sweep = 0; sweep < 12; ++sweep) {
    for (const [p, q] of [[0, 1], [0, 2], [1, 2]]) {
      if (m[p][q] === 0) continue;
      const angle = 0.5 * Math.atan2(2 * m[p][q], m[q][q] - m[p][p]);
      const c = Math.cos(angle);
      const s = Math.sin(angle);
      for (let k = 0; k < 3; ++k) [m[k][p], m[k][q]] = [c * m[k][p] - s * m[k][q], s * m[k][p] + c * m[k][q]];
      for (let k = 0; k < 3; ++k) [m[p][k], m[q][k]] = [c * m[p][k] - s * m[q][k], s * m[p][k] + c * m[q][k]];
      for (let k = 0; k < 3; ++k) [v[k][p], v[k][q]] = [c * v[k][p] - s * v[k][q], s * v[k][p] + c * v[k][q]];
    }
  }
  return [0, 1, 2].map((i) =>
    [v[0][i], v[1][i], v[2][i]].map((value) => value * Math.sqrt(Math.max(0, m[i][i]))));
}

export function median(values) {
  if (values.length === 0) return 0;
  const sorted = [...values].sort((a, b) => a - b);
  return sorted[sorted.length >> 1];
}

/** 1, 2 or 5 times a power of ten, at least `value`. */
export function roundStep(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  const factor = [1, 2, 5, 10].find((f) => f * power >= value * (1 - 1e-9));
  return factor * power;
}
