// The report's data as the views want it: everything in the plan frame (x right, y up the page, z up).

import { add, median, roundStep, rotated, rotatedCovariance, scaled } from "./geometry.js";

const RANKS = { error: 3, warning: 2, note: 1 };

function markerOf(marker, submap, scene, covariance, findings) {
  const q = scene.plan_from_world_xyzw;
  const turn = (vector) => rotated(q, rotated(marker.quaternion_xyzw, vector));
  const centre = rotated(q, marker.position_m);
  const half = marker.size_m / 2;
  const right = scaled(turn([1, 0, 0]), half);
  const up = scaled(turn([0, 1, 0]), half);
  const corner = (x, y) => add(centre, add(scaled(right, x), scaled(up, y)));
  const own = findings.filter(
    (finding) =>
      finding.markers.includes(marker.id) && (finding.submap === null || finding.submap === submap));
  return {
    ...marker,
    key: `${submap}/${marker.id}`,
    label: String(marker.id),
    submap,
    centre,
    right,
    up,
    normal: turn([0, 0, 1]),
    corners: [corner(-1, 1), corner(1, 1), corner(1, -1), corner(-1, -1)],
    covariance: covariance ? rotatedCovariance(q, covariance) : null,
    findings: own,
    rank: Math.max(0, ...own.map((finding) => RANKS[finding.severity])),
  };
}

/** Pieces of a track without its gaps: there the rig was not localized. */
function pieces(poses, q) {
  const points = poses.map(([t, ...position]) => ({ t, position: rotated(q, position) }));
  const steps = points.slice(1).map((point, i) => point.t - points[i].t);
  const longest = Math.max(1, 10 * median(steps));
  const result = [];
  points.forEach((point, i) => {
    if (i === 0 || point.t - points[i - 1].t > longest) result.push([]);
    result.at(-1).push(point.position);
  });
  return result;
}

function boundsOf(points) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (const point of points) {
    for (let i = 0; i < 3; ++i) {
      low[i] = Math.min(low[i], point[i]);
      high[i] = Math.max(high[i], point[i]);
    }
  }
  return { low, high };
}

/** So many times the ellipsoids are enlarged that the usual one is half a marker long. */
function usualEnlargement(markers) {
  const sigmas = markers.filter((m) => m.sigma_position_m > 0).map((m) => m.sigma_position_m);
  if (sigmas.length === 0) return 1;
  const wanted = (0.5 * median(markers.map((m) => m.size_m))) / median(sigmas);
  return Math.max(1, roundStep(wanted / 2));
}

function submapOf(submap, index, scene, findings) {
  const covariances = scene.position_covariances_m2;
  const markers = submap.markers.map((marker, i) =>
    markerOf(marker, index, scene, covariances[i], findings));
  const q = scene.plan_from_world_xyzw;
  const tracks = scene.tracks.map((track, i) => ({
    ...submap.tracks[i],
    pieces: pieces(track.poses, q),
    truePieces: pieces(track.true_poses, q),
  }));
  const points = [
    ...markers.flatMap((marker) => marker.corners),
    ...tracks.flatMap((track) => track.pieces.flat()),
  ];
  return {
    ...submap,
    index,
    markers,
    tracks,
    planFromWorld: q,
    zIsUp: scene.z_is_up,
    origin: [0, 0, 0],
    axes: [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map((axis) => rotated(q, axis)),
    bounds: boundsOf(points),
    enlargement: usualEnlargement(markers),
    hasTruth: tracks.some((track) => track.truePieces.length > 0),
    hasTracks: tracks.some((track) => track.pieces.length > 0),
    typicalSize: median(markers.map((marker) => marker.size_m)),
  };
}

export function makeModel({ summary, scene, image_grids }) {
  const findings = summary.findings
    .map((finding, i) => ({ ...finding, i }))
    .sort((a, b) => RANKS[b.severity] - RANKS[a.severity] || a.i - b.i);
  const submaps = summary.submaps.map((submap, i) => submapOf(submap, i, scene[i], findings));
  const byKey = new Map(submaps.flatMap((s) => s.markers.map((marker) => [marker.key, marker])));
  return {
    summary,
    cameras: summary.residuals.by_camera.map((camera, i) => ({ ...camera, grid: image_grids[i] })),
    findings,
    submaps,
    marker: (key) => byKey.get(key) ?? null,
    /** Markers of an id: one per sub-map that holds it. */
    markersOfId: (id) => submaps.flatMap((s) => s.markers.filter((m) => m.id === id)),
  };
}
