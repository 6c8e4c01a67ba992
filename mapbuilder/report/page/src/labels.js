// Labels that don't lie on one another: the important ones first, each where there is room.

/** So many are tried at most: no canvas has room for more labels, and a frame must not take long. */
const MOST_TRIED = 1500;

/** Directions on the canvas in which a label may stand; diagonal ones are second choice. */
const SIDES = [-1, 0, 1].flatMap((x) => [-1, 0, 1].map((y) => [x, y])).filter(([x, y]) => x || y);

/** Offsets of a label's box from its anchor, the best first. */
function places({ gap, tick, width }, height) {
  const along = (side, vector) => (side[0] * vector[0] + side[1] * vector[1]) / Math.hypot(...side);
  const worth = (side) => -along(side, tick) - (side[0] && side[1] ? Math.hypot(...tick) + 1 : 0);
  return [...SIDES].sort((a, b) => worth(b) - worth(a)).map((side) => {
    const away = Math.max(gap, along(side, tick) + 3) / Math.hypot(...side);
    return [side[0] * away + ((side[0] - 1) * width) / 2, side[1] * away + ((side[1] - 1) * height) / 2];
  });
}

/**
 * Chooses which labels are shown, and where.
 * `anchors`: {x, y, text, priority, gap, width, must, tick}; those with `must` are shown whatever
 * they cover; `tick` is the drawn normal [x, y], behind which the label stands at best. `reserved`: boxes [x, y, width,
 * height] that stay free. Returns {anchor, x, y} with the left and the middle of the text.
 */
export function placeLabels(anchors, reserved, height, { width, height: canvasHeight }) {
  const cell = 48;
  const taken = new Map();
  const cells = (x, y, w, h) => {
    const keys = [];
    for (let i = Math.floor(x / cell); i <= Math.floor((x + w) / cell); ++i) {
      for (let j = Math.floor(y / cell); j <= Math.floor((y + h) / cell); ++j) keys.push(`${i},${j}`);
    }
    return keys;
  };
  const free = (x, y, w, h) =>
    x >= 0 && y >= 0 && x + w <= width && y + h <= canvasHeight &&
    cells(x, y, w, h).every((key) =>
      (taken.get(key) ?? []).every(
        (box) => x + w <= box[0] || x >= box[0] + box[2] || y + h <= box[1] || y >= box[1] + box[3]));
  const take = (x, y, w, h) => {
    for (const key of cells(x, y, w, h)) {
      if (!taken.has(key)) taken.set(key, []);
      taken.get(key).push([x, y, w, h]);
    }
  };
  for (const box of reserved) take(...box);
  const shown = [];
  const wanted = [...anchors].sort((a, b) => b.priority - a.priority).slice(0, MOST_TRIED);
  for (const anchor of wanted) {
    const offsets = places(anchor, height);
    const fits = offsets.find(([dx, dy]) => free(anchor.x + dx, anchor.y + dy, anchor.width, height));
    const place = fits ?? (anchor.must ? offsets[0] : null);
    if (place === null) continue;
    const [x, y] = [anchor.x + place[0], anchor.y + place[1]];
    take(x, y, anchor.width, height);
    shown.push({ anchor, x, y: y + height / 2 });
  }
  return shown;
}

/** Draws them: text over a halo of the paper's colour. */
export function drawLabels(context, shown, palette) {
  context.textBaseline = "middle";
  context.textAlign = "left";
  context.lineJoin = "round";
  for (const { anchor, x, y } of shown) {
    context.font = anchor.font;
    context.lineWidth = 3;
    context.strokeStyle = palette.of("paper", 0.9);
    context.strokeText(anchor.text, x, y);
    context.fillStyle = anchor.colour;
    context.fillText(anchor.text, x, y);
  }
}
