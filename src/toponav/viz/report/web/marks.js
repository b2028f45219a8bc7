// What is drawn over the layers of the map: paths, places, frontiers, candidates.

import { svg } from "./dom.js";
import { fixed, signed } from "./numbers.js";

const CENTI = 100; // positions of the path are whole centimetres
const NODE_PX = 9;
const ARROW = "M .26 0 L -.16 .17 L -.08 0 L -.16 -.17 Z";

/** The path so far, the plan, the waypoint and the start. */
export function pathMarks({ data, decision, moment }) {
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

export function agentMarks({ data: { steps }, moment }) {
  const k = steps.step.findLastIndex((step) => step <= moment.step);
  if (k < 0) return [];
  const turn = -(steps.yaw[k] / CENTI) * (180 / Math.PI);
  const place = `translate(${steps.x[k] / CENTI} ${-steps.y[k] / CENTI}) rotate(${turn})`;
  return [titled(svg("path", { transform: place, d: ARROW }), "agent")];
}

/** The memory of the decision or, where that is not recorded, that of the end. */
export function memoryOf({ data, decision }) {
  if (decision?.nodes) return { ...decision, current: decision.node };
  return data.memory ? { ...data.memory, floor: 0, current: null } : { nodes: [], edges: [], floor: 0 };
}

export function edgeMarks({ nodes, edges, floor }) {
  const here = new Map(nodes.filter((node) => node.floor === floor).map((node) => [node.id, node]));
  return edges
    .filter(([a, b]) => here.has(a) && here.has(b))
    .map(([a, b, length]) => {
      const [p, q] = [here.get(a).position, here.get(b).position];
      const line = svg("line", { x1: p[0], y1: -p[1], x2: q[0], y2: -q[1] });
      return titled(line, `${a} – ${b}: ${fixed(length, 1, "m")}`);
    });
}

export function nodeMarks({ nodes, floor, current }, placer) {
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

export function landmarkMarks(decision, placer) {
  if (!decision?.map) return [];
  return decision.map.landmarks.map(([category, x, y]) => {
    const name = decision.map.categories[category];
    const spot = placer.at(x, -y, name);
    return spot && svg("text", { x: spot[0], y: spot[1] }, name);
  });
}

/** Each weighed frontier with its place in the order of visits, larger the more it promises. */
export function frontierMarks(decision, placer) {
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
  const rank = one.rank === null ? "not ordered" : one.rank + 1;
  const likely = `likelihood ${fixed(one.likelihood, 2)} by ${one.speaks}`;
  return [
    `frontier ${rank}: promise ${fixed(one.promise, 3)}`,
    `${fixed(one.unknown_m2, 1, "m²")} unknown beyond, way ${fixed(one.path_cost, 1, "m")}`,
    one.speaks ? likely : "nothing telling near",
  ].join("\n");
}

export function candidateMarks(decision, placer) {
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
  const [left, right, top, bottom] = [x - arm, x + arm, y - arm, y + arm];
  return `M ${left} ${top} L ${right} ${bottom} M ${left} ${bottom} L ${right} ${top}`;
}

function titled(element, text) {
  element.prepend(svg("title", {}, text));
  return element;
}
