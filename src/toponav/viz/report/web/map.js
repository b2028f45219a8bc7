// The map of one episode at one moment, from above: x to the right, y up, in metres.

import { el, fill, svg } from "./dom.js";
import { LabelPlacer } from "./labels.js";
import {
  agentMarks, candidateMarks, edgeMarks, frontierMarks, landmarkMarks, memoryOf, nodeMarks, pathMarks,
} from "./marks.js";
import {
  floorLayer, frontierLayer, heatLayer, knownExtent, knownPicture, objectLayer, placeOf, wallLayer,
} from "./raster.js";

export const LAYERS = {
  picture: "Appearance",
  objects: "Objects",
  heat: "Affordance",
  frontiers: "Frontiers",
  places: "Places",
  path: "Path",
  candidates: "Candidates",
};

const MARGIN_M = 0.5;
const LEAST_SIDE_M = 4;
const ZOOM_STEP = 1.4;
const MOST_ZOOM = 12;
const SCALE_LENGTHS_M = [0.5, 1, 2, 5, 10, 20, 50];
const SCALE_PX = 110; // the scale's bar is at most so long
const CENTI = 100; // positions of the path are whole centimetres

/** What the panes' maps must show: [x0, y0, x1, y1] around all that the episodes got to know. */
export function extentOf(panes) {
  const boxes = panes.flatMap(({ data }) => [...mapExtents(data), pathExtent(data.steps)]);
  const known = boxes.filter(Boolean);
  if (known.length === 0) return [-2, -2, 2, 2];
  const low = [0, 1].map((axis) => Math.min(...known.map((box) => box[axis])) - MARGIN_M);
  const high = [2, 3].map((axis) => Math.max(...known.map((box) => box[axis])) + MARGIN_M);
  const grow = [0, 1].map((axis) => Math.max(0, LEAST_SIDE_M - (high[axis] - low[axis])) / 2);
  return [low[0] - grow[0], low[1] - grow[1], high[0] + grow[0], high[1] + grow[1]];
}

function mapExtents(data) {
  const lastOfFloor = new Map();
  for (const { floor, map } of data.decisions) {
    if (map) lastOfFloor.set(floor, map);
  }
  if (data.end) lastOfFloor.set("end", data.end);
  return [...lastOfFloor.values()].map(knownExtent);
}

function pathExtent({ x, y }) {
  if (x.length === 0) return null;
  return [Math.min(...x), Math.min(...y), Math.max(...x), Math.max(...y)].map((cm) => cm / CENTI);
}

/** A map that draws scenes: {data, decision, moment, picture, shown}. */
export class EpisodeMap {
  constructor(extent) {
    this.extent = extent;
    this.view = { x: 0, y: 0, zoom: 1 };
    this.scene = null;
    this.groups = ["raster", "edges", "path", "labels", "places", "frontiers", "candidates", "agent"];
    this.root = svg("svg", { class: "map", role: "img", "aria-label": "Map from above" });
    for (const name of this.groups) {
      this[name] = svg("g", { class: name });
      this.root.append(this[name]);
    }
    this.scale = el("div", { class: "scale" });
    this.element = el("div", { class: "mapframe" }, this.root, this.buttons(), this.scale);
    this.listenToDrags();
    new ResizeObserver(() => this.draw(this.scene)).observe(this.root);
  }

  draw(scene) {
    this.scene = scene;
    if (!scene || !this.root.isConnected) return;
    this.fitView();
    const { decision, shown } = scene;
    const placer = new LabelPlacer(this.unit, this.span);
    fill(this.raster, rasters(scene));
    fill(this.path, shown.path ? pathMarks(scene) : []);
    fill(this.frontiers, shown.frontiers ? frontierMarks(decision, placer) : []);
    fill(this.candidates, shown.candidates ? candidateMarks(decision, placer) : []);
    const memory = memoryOf(scene);
    fill(this.edges, shown.places ? edgeMarks(memory) : []);
    fill(this.places, shown.places ? nodeMarks(memory, placer) : []);
    fill(this.labels, shown.objects ? landmarkMarks(decision, placer) : []);
    fill(this.agent, agentMarks(scene));
  }

  /** Point out the frontier of a rank; null for none. */
  highlight(rank) {
    for (const mark of this.frontiers.children) {
      mark.classList.toggle("lit", mark.dataset.rank === String(rank));
    }
  }

  /** Set the part of the world in view, and what a pixel is in metres. */
  fitView() {
    const [x0, y0, x1, y1] = this.extent;
    const { zoom, x, y } = this.view;
    const [width, height] = [(x1 - x0) / zoom, (y1 - y0) / zoom];
    const [left, top] = [(x0 + x1) / 2 + x - width / 2, -(y0 + y1) / 2 + y - height / 2];
    this.root.setAttribute("viewBox", `${left} ${top} ${width} ${height}`);
    const { clientWidth, clientHeight } = this.root;
    this.unit = Math.max(width / Math.max(clientWidth, 1), height / Math.max(clientHeight, 1));
    this.root.style.setProperty("--px", String(this.unit));
    const middle = left + width / 2;
    this.span = [middle - (clientWidth / 2) * this.unit, middle + (clientWidth / 2) * this.unit];
    this.showScale();
  }

  /** A bar of a round length, to judge distances by. */
  showScale() {
    const most = SCALE_PX * this.unit;
    const length = SCALE_LENGTHS_M.findLast((one) => one <= most) ?? SCALE_LENGTHS_M[0];
    this.scale.textContent = `${length}\u202fm`;
    this.scale.style.width = `${length / this.unit}px`;
  }

  zoomBy(factor) {
    this.view.zoom = Math.min(Math.max(this.view.zoom * factor, 1), MOST_ZOOM);
    if (this.view.zoom === 1) this.view = { x: 0, y: 0, zoom: 1 };
    this.draw(this.scene);
  }

  buttons() {
    const button = (text, title, onclick) => el("button", { type: "button", title, onclick }, text);
    return el(
      "div",
      { class: "zoom" },
      button("+", "Zoom in (Ctrl + wheel)", () => this.zoomBy(ZOOM_STEP)),
      button("−", "Zoom out", () => this.zoomBy(1 / ZOOM_STEP)),
    );
  }

  listenToDrags() {
    let from = null;
    this.root.addEventListener("pointerdown", (event) => {
      if (this.view.zoom === 1) return;
      from = { x: event.clientX, y: event.clientY, view: { ...this.view } };
      this.root.setPointerCapture(event.pointerId);
    });
    this.root.addEventListener("pointermove", (event) => {
      if (!from) return;
      this.view.x = from.view.x - (event.clientX - from.x) * this.unit;
      this.view.y = from.view.y - (event.clientY - from.y) * this.unit;
      this.fitView();
    });
    this.root.addEventListener("pointerup", () => (from = null));
    this.root.addEventListener("wheel", (event) => {
      if (!event.ctrlKey) return;
      event.preventDefault();
      this.zoomBy(event.deltaY < 0 ? ZOOM_STEP : 1 / ZOOM_STEP);
    }, { passive: false });
  }
}

function rasters({ data, decision, picture, shown }) {
  const map = decision?.map;
  if (!map) return [];
  const images = [image(floorLayer(map), placeOf(map))];
  const pictured = shown.picture && picture && data.picture.floor === decision.floor;
  if (pictured) {
    const { low, high } = data.picture;
    const place = [low[0], -high[1], high[0] - low[0], high[1] - low[1]];
    images.push(image(knownPicture(data.picture, picture, map), place, "smooth"));
    images.push(image(wallLayer(map), placeOf(map)));
  }
  if (shown.objects) images.push(image(objectLayer(map, data.target, pictured), placeOf(map)));
  if (shown.heat && map.heat) images.push(image(heatLayer(map), placeOf(map)));
  if (shown.frontiers) images.push(image(frontierLayer(map), placeOf(map)));
  return images;
}

function image(href, [x, y, width, height], kind = "cells") {
  return svg("image", { href, x, y, width, height, class: kind, preserveAspectRatio: "none" });
}
