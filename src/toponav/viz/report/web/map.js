// The map of one episode at one moment, from above: x to the right, y up, in metres.

import { el, fill, svg } from "./dom.js";
import { LabelPlacer } from "./labels.js";
import { fixed, signed } from "./numbers.js";
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
const NODE_PX = 9;
const ZOOM_STEP = 1.4;
const MOST_ZOOM = 12;
const CENTI = 100;

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
  for (const decision of data.decisions) if (decision.map) lastOfFloor.set(decision.floor, decision.map);
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
    this.groups = ["raster", "edges", "path", "labels", "frontiers", "candidates", "places", "agent"];
    this.root = svg("svg", { class: "map", role: "img", "aria-label": "Map from above" });
    for (const name of this.groups) {
      this[name] = svg("g", { class: name });
      this.root.append(this[name]);
    }
    this.element = el("div", { class: "mapframe" }, this.root, this.buttons());
    this.listenToDrags();
    new ResizeObserver(() => this.draw(this.scene)).observe(this.root);
  }

  draw(scene) {
    this.scene = scene;
    if (!scene || !this.root.isConnected) return;
    this.fitView();
    const { decision, shown } = scene;
    const placer = new LabelPlacer(this.unit);
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

/** The path so far, the plan, the waypoint and the start. */
function pathMarks({ data, decision, moment }) {
  const walked = walkedUntil(data.steps, moment);
  const plan = moment.end ? [] : (decision?.path ?? []);
  const goal = moment.end ? null : decision?.waypoint;
  return [
    walked.length > 0 && svg("polyline", { class: "walked", points: pointList(walked) }),
    plan.length > 0 && svg("polyline", { class: "plan", points: pointList(plan) }),
    walked.length > 0 && svg("circle", { class: "start", cx: walked[0][0], cy: -walked[0][1] }),
    goal && titled(svg("path", { class: "waypoint", d: crossAt(goal[0], -goal[1]) }), "waypoint"),
  ];
}

function walkedUntil({ step, x, y }, moment) {
  const count = step.filter((one) => one <= moment.step).length;
  return x.slice(0, count).map((cm, k) => [cm / CENTI, y[k] / CENTI]);
}

function agentMarks({ data: { steps }, moment }) {
  const k = steps.step.findLastIndex((step) => step <= moment.step);
  if (k < 0) return [];
  const turn = -(steps.yaw[k] / CENTI) * (180 / Math.PI);
  const place = `translate(${steps.x[k] / CENTI} ${-steps.y[k] / CENTI}) rotate(${turn})`;
  return [titled(svg("path", { transform: place, d: "M .26 0 L -.16 .17 L -.08 0 L -.16 -.17 Z" }), "agent")];
}

/** The memory of the decision or, where that is not recorded, that of the end. */
function memoryOf({ data, decision }) {
  if (decision?.nodes) return { ...decision, current: decision.node };
  return data.memory ? { ...data.memory, floor: 0, current: null } : { nodes: [], edges: [], floor: 0 };
}

function edgeMarks({ nodes, edges, floor }) {
  const here = new Map(nodes.filter((node) => node.floor === floor).map((node) => [node.id, node]));
  return edges
    .filter(([a, b]) => here.has(a) && here.has(b))
    .map(([a, b, length]) => {
      const [p, q] = [here.get(a).position, here.get(b).position];
      const line = svg("line", { x1: p[0], y1: -p[1], x2: q[0], y2: -q[1] });
      return titled(line, `${a} – ${b}: ${fixed(length, 1, "m")}`);
    });
}

function nodeMarks({ nodes, floor, current }, placer) {
  const here = nodes.filter((node) => node.floor === floor);
  for (const { position } of here) placer.reserve(position[0], -position[1], NODE_PX);
  return here.map((node) => {
    const [x, y] = [node.position[0], -node.position[1]];
    const room = node.room_type === "unknown" ? "" : node.room_type;
    const spot = room && placer.beside(x, y, room, NODE_PX + 3);
    return titled(
      svg(
        "g",
        { class: node.id === current ? "node current" : "node" },
        svg("circle", { cx: x, cy: y }),
        svg("text", { x, y, class: "id" }, String(node.id)),
        spot && svg("text", { x: spot[0], y: spot[1], class: "room" }, room),
      ),
      `place ${node.id}${room && `, ${room}`}\n${node.objects.join(", ") || "no objects"}\n` +
        `${node.frontier_count} frontier points, ${node.visits} visits`,
    );
  });
}

function landmarkMarks(decision, placer) {
  if (!decision?.map) return [];
  return decision.map.landmarks.map(([category, x, y]) => {
    const name = decision.map.categories[category];
    return placer.at(x, -y, name) && svg("text", { x, y: -y }, name);
  });
}

/** Each weighed frontier with its place in the order of visits, larger the more it promises. */
function frontierMarks(decision, placer) {
  const frontiers = decision?.frontiers ?? [];
  const most = Math.max(...frontiers.map((one) => one.promise), 1e-9);
  return frontiers.map((one) => {
    const [x, y] = [one.at[0], -one.at[1]];
    const share = one.promise / most;
    placer.reserve(x, y, NODE_PX);
    const mark = svg(
      "g",
      { class: one.rank === 0 ? "frontier first" : "frontier", "data-rank": one.rank ?? "" },
      svg("circle", { cx: x, cy: y, "fill-opacity": 0.35 + 0.65 * share }),
      one.rank !== null && svg("text", { x, y, class: "id" }, String(one.rank + 1)),
    );
    return titled(mark, frontierTitle(one));
  });
}

function frontierTitle(one) {
  const why = one.speaks ? `likelihood ${fixed(one.likelihood, 2)} by ${one.speaks}` : "nothing telling near";
  return `frontier ${one.rank === null ? "not ordered" : one.rank + 1}: promise ${fixed(one.promise, 3)}\n` +
    `${fixed(one.unknown_m2, 1, "m²")} unknown beyond, way ${fixed(one.path_cost, 1, "m")}\n${why}`;
}

function candidateMarks(decision, placer) {
  return (decision?.candidates ?? []).map((one, k) => {
    const [x, y] = [one.low[0], -one.high[1]];
    const [width, height] = [one.high[0] - one.low[0], one.high[1] - one.low[1]];
    const text = `${k + 1}: ${signed(one.log_odds)}`;
    const spot = placer.beside(x + width / 2, y + height / 2, text, 8);
    return titled(
      svg(
        "g",
        { class: one.chosen ? "candidate chosen" : "candidate" },
        svg("rect", { x, y, width, height }),
        spot && svg("text", { x: spot[0], y: spot[1] }, text),
      ),
      `candidate ${k + 1}: log-odds ${signed(one.log_odds)}`,
    );
  });
}

function pointList(points) {
  return points.map(([x, y]) => `${x},${-y}`).join(" ");
}

function crossAt(x, y, arm = 0.13) {
  return `M ${x - arm} ${y - arm} L ${x + arm} ${y + arm} M ${x - arm} ${y + arm} L ${x + arm} ${y - arm}`;
}

function titled(element, text) {
  element.prepend(svg("title", {}, text));
  return element;
}
