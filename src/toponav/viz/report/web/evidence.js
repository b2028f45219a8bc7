// What was weighed: frontiers, the terms of the affordance, candidates for the target.

import { el } from "./dom.js";
import { counted, fixed, signed } from "./numbers.js";
import { definitions, folded, meter, percent, smallRow, smallTable } from "./parts.js";

const MOST_ODDS = 5; // the bars of the evidence end there

/** The weighed frontiers; the one under the pointer is lit up on the map. */
export function frontierTable(frontiers, map) {
  if (!frontiers || frontiers.length === 0) return null;
  const most = Math.max(...frontiers.map((one) => one.promise), Number.MIN_VALUE);
  const heads = ["", "promise", "unknown", "likely", "way", "why"];
  const rows = frontiers.map((one) => smallRow(frontierCells(one, most), {
    class: one.rank === 0 ? "first" : null,
    onpointerenter: () => map.highlight(one.rank),
    onpointerleave: () => map.highlight(null),
  }));
  return el("div", { class: "scroll" }, smallTable(heads, rows));
}

function frontierCells(one, most) {
  const why = [one.speaks, one.guided && "reasoner's place", one.on_stairs && "stairs"];
  return [
    one.rank === null ? "–" : String(one.rank + 1),
    meter(one.promise / most, fixed(one.promise, 3)),
    fixed(one.unknown_m2, 1, "m²"),
    fixed(one.likelihood, 2),
    fixed(one.path_cost, 1, "m"),
    why.filter(Boolean).join(", "),
  ];
}

/** Each term of the affordance where the agent goes. */
export function termBars(terms) {
  if (!terms || terms.length === 0) return null;
  const bars = terms.map(([name, value]) => [`A_${name}`, meter(value, fixed(value, 2))]);
  return definitions("bars", bars);
}

export function candidateList(candidates) {
  if (!candidates || candidates.length === 0) return null;
  return el("ol", { class: "candidates" }, candidates.map(candidateItem));
}

function candidateItem(one, k) {
  const sides = `seen from ${counted(one.sides.length, "side")}`;
  return el(
    "li",
    { class: one.chosen ? "chosen" : null },
    el("b", {}, `${k + 1}: log-odds ${signed(one.log_odds)}`),
    el("span", { class: "muted" }, ` ${candidateNotes(one)}`),
    oddsBar(one.log_odds),
    one.sides.length > 0 && folded(sides, sideTable(one.sides)),
  );
}

function candidateNotes(one) {
  const size = one.high.map((high, axis) => fixed(high - one.low[axis], 1)).join(" × ");
  const notes = [
    one.chosen && "gone to",
    one.returns > 0 && `looked at again ${counted(one.returns, "time")}`,
    one.verdict !== 0 && `verdict ${signed(one.verdict)}`,
    `${size} m`,
  ];
  return notes.filter(Boolean).join(", ");
}

/** From the middle to the right what speaks for it, to the left what speaks against it. */
function oddsBar(odds) {
  const bar = el("i", { class: odds < 0 ? "against" : "for" });
  bar.style.width = percent(Math.min(Math.abs(odds) / MOST_ODDS, 1) / 2);
  return el("div", { class: "odds" }, bar);
}

function sideTable(sides) {
  const heads = ["side", "range", "frames", "detected", "other", "says"];
  const rows = sides.map((side) => {
    const range = side.near ? "near" : "far";
    const counts = [side.frames, side.hits, side.others].map(String);
    return smallRow([String(side.side), range, ...counts, signed(side.log_odds)]);
  });
  return smallTable(heads, rows);
}
