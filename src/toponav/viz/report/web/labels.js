// Spots for words on the map that hide neither each other nor what they name.

const CHARACTER = 6.2; // pixels of a letter at the map's size of type
const LINE = 14;

/**
 * Places labels one after the other; sizes are pixels, `unit` is metres a pixel, and `span` is what is
 * in view from left to right, metres.
 */
export class LabelPlacer {
  constructor(unit, span) {
    this.unit = unit;
    this.span = span;
    this.boxes = [];
  }

  /** Keep a round spot free. */
  reserve(x, y, radius) {
    const r = radius * this.unit;
    this.boxes.push([x - r, y - r, x + r, y + r]);
  }

  /** The middle of a label beside (x, y), or null where there is no room for it. */
  beside(x, y, text, gap) {
    const width = this.widthOf(text);
    const away = gap * this.unit + width / 2;
    const above = (gap + LINE / 2) * this.unit;
    const spots = [[x + away, y], [x - away, y], [x, y - above], [x, y + above]];
    return spots.find((spot) => this.take(spot, width)) ?? null;
  }

  /** A spot around (x, y) for a label, moved into sight at the edges, or null if it is taken. */
  at(x, y, text) {
    const width = this.widthOf(text);
    const [left, right] = this.span;
    const spot = [Math.min(Math.max(x, left + width / 2), right - width / 2), y];
    return this.take(spot, width) ? spot : null;
  }

  widthOf(text) {
    return text.length * CHARACTER * this.unit;
  }

  take([x, y], width) {
    const half = (LINE / 2) * this.unit;
    const box = [x - width / 2, y - half, x + width / 2, y + half];
    if (box[0] < this.span[0] || box[2] > this.span[1]) return false;
    if (this.boxes.some((other) => overlap(box, other))) return false;
    this.boxes.push(box);
    return true;
  }
}

function overlap(a, b) {
  return a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3];
}
