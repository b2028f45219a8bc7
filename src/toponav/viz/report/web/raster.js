// Layers of the map as small pictures: one pixel a cell.

import { color } from "./theme.js";

const FREE = 1;
const OBSTACLE = 2;
const FRONTIER = 3;
const MASKED = 1;
const FIRST_LEVEL = 2;
const HEAT_STOPS = [[68, 1, 84], [49, 104, 142], [53, 183, 121], [253, 231, 37]]; // viridis
const HEAT_ALPHA = 190;
const MASKED_RGBA = [128, 128, 128, 70];
const OBJECT_ALPHA = 150;
const TARGET_ALPHA = 220;

/** The values of run-length pairs, in raster order. */
export function valuesOf(runs, size) {
  const values = new Uint16Array(size);
  let at = 0;
  for (let k = 0; k < runs.length; k += 2) {
    values.fill(runs[k], at, at + runs[k + 1]);
    at += runs[k + 1];
  }
  return values;
}

/** Free floor and obstacles. */
export function floorLayer(map) {
  const free = rgba("map-free");
  const paint = { [FREE]: free, [FRONTIER]: free, [OBSTACLE]: rgba("map-wall") };
  return painted(map, map.cells, (value) => paint[value]);
}

/** Obstacles alone, to go over the picture of the floor. */
export function wallLayer(map) {
  const wall = rgba("map-wall", 90);
  return painted(map, map.cells, (value) => (value === OBSTACLE ? wall : undefined));
}

export function frontierLayer(map) {
  const paint = rgba("frontier");
  return painted(map, map.cells, (value) => (value === FRONTIER ? paint : undefined));
}

/** Where objects lie; `targetOnly` leaves out all but the target. */
export function objectLayer(map, target, targetOnly) {
  const paint = map.categories.map((name, k) => {
    if (name === target) return rgba("target", TARGET_ALPHA);
    return targetOnly ? undefined : tint(k);
  });
  return painted(map, map.objects, (value) => (value > 0 ? paint[value - 1] : undefined));
}

/** The affordance from nothing (dark) to its maximum (bright); grey where it is not safe. */
export function heatLayer(map) {
  const top = map.heat.reduce((most, value, k) => (k % 2 ? most : Math.max(most, value)), 0);
  return painted(map, map.heat, (value) => {
    if (value === MASKED) return MASKED_RGBA;
    if (value < FIRST_LEVEL) return undefined;
    return heatColor((value - FIRST_LEVEL) / Math.max(1, top - FIRST_LEVEL));
  });
}

/** The floor's picture, only as far as it is known at this decision. */
export function knownPicture(picture, image, map) {
  const canvas = sized(image.naturalWidth, image.naturalHeight);
  const context = canvas.getContext("2d");
  const known = canvasOf(map, map.cells, (value) => (value > 0 ? [0, 0, 0, 255] : undefined));
  const [x, y, width, height] = placeOf(map);
  const scaleX = canvas.width / (picture.high[0] - picture.low[0]);
  const scaleY = canvas.height / (picture.high[1] - picture.low[1]);
  context.imageSmoothingEnabled = false;
  context.drawImage(
    known,
    (x - picture.low[0]) * scaleX,
    (y + picture.high[1]) * scaleY,
    width * scaleX,
    height * scaleY,
  );
  context.globalCompositeOperation = "source-in";
  context.drawImage(image, 0, 0);
  return canvas.toDataURL();
}

/** Where a map's layers lie in the drawing, whose y points down: [x, y, width, height]. */
export function placeOf(map) {
  const [width, height] = map.shape.map((cells) => cells * map.resolution);
  return [map.origin[0], -(map.origin[1] + height), width, height];
}

/** Lower and upper corner of what a map knows: [x0, y0, x1, y1], y up; null for an empty one. */
export function knownExtent(map) {
  const [nx, ny] = map.shape;
  const cells = valuesOf(map.cells, nx * ny);
  let [i0, j0, i1, j1] = [nx, ny, -1, -1];
  for (let k = 0; k < cells.length; k += 1) {
    if (cells[k] === 0) continue;
    const i = Math.floor(k / ny);
    const j = k % ny;
    [i0, j0, i1, j1] = [Math.min(i0, i), Math.min(j0, j), Math.max(i1, i), Math.max(j1, j)];
  }
  if (i1 < 0) return null;
  const at = (index, axis) => map.origin[axis] + index * map.resolution;
  return [at(i0, 0), at(j0, 1), at(i1 + 1, 0), at(j1 + 1, 1)];
}

export function heatColor(share) {
  const at = Math.min(Math.max(share, 0), 1) * (HEAT_STOPS.length - 1);
  const k = Math.min(Math.floor(at), HEAT_STOPS.length - 2);
  const [from, to] = [HEAT_STOPS[k], HEAT_STOPS[k + 1]];
  return [...from.map((channel, c) => Math.round(channel + (to[c] - channel) * (at - k))), HEAT_ALPHA];
}

function painted(map, runs, colorOf) {
  return canvasOf(map, runs, colorOf).toDataURL();
}

function canvasOf(map, runs, colorOf) {
  const [nx, ny] = map.shape;
  const canvas = sized(Math.max(1, nx), Math.max(1, ny));
  const context = canvas.getContext("2d");
  const image = context.createImageData(canvas.width, canvas.height);
  const values = valuesOf(runs, nx * ny);
  for (let k = 0; k < values.length; k += 1) {
    const paint = colorOf(values[k]);
    if (paint) image.data.set(paint, 4 * ((ny - 1 - (k % ny)) * nx + Math.floor(k / ny)));
  }
  context.putImageData(image, 0, 0);
  return canvas;
}

function sized(width, height) {
  const canvas = document.createElement("canvas");
  canvas.width = width;
  canvas.height = height;
  return canvas;
}

function rgba(name, alpha = 255) {
  return [...color(name), alpha];
}

/** A muted colour of its own for each category: hues a golden angle apart. */
function tint(k) {
  const hue = (k * 137.5) % 360;
  const channel = (n) => {
    const at = (n + hue / 30) % 12;
    return Math.round(255 * (0.58 - 0.22 * Math.max(-1, Math.min(at - 3, 9 - at, 1))));
  };
  return [channel(0), channel(8), channel(4), OBJECT_ALPHA];
}
