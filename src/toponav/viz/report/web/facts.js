// What stands beside the map: what the decision rests on, and what is new.

import { el, fill } from "./dom.js";
import { counted, degrees, fixed, signed } from "./numbers.js";

const MOST_ODDS = 5; // the bars of the evidence end there
const ARROWS = ["→", "↗", "↑", "↖", "←", "↙", "↓", "↘"];

/** The sections about one decision; `map` lights up what the pointer is on. */
export function factsOf(decision, panorama, map) {
  if (!decision) return [el("p", { class: "muted" }, "Not decided yet.")];
  return [
    card("Panorama", panoramaViews(decision, panorama)),
    card("The reasoner's answer", answer(decision)),
    card("What changed", changeList(decision.changes)),
    card("Frontiers, in the order of visits", frontierTable(decision.frontiers, map)),
    card("Affordance at the waypoint", termBars(decision.terms)),
    card("Candidates for the target", candidateList(decision.candidates)),
    card("What the reasoner was told", prompts(decision)),
  ].filter(Boolean);
}

/** How the search went, from the truth that the agent never saw. */
export function endingOf(episode) {
  const at = (step) => (step === null ? "never" : `step ${step}`);
  return card("How it ended", pairs([
    ["target first in view", at(episode.visible)],
    ["first detected", at(episode.detected)],
    ["first set out for", at(episode.approached)],
    ["end", `${episode.ended}, step ${episode.steps}`],
  ]));
}

function card(title, content) {
  if (!content) return null;
  return el("section", { class: "fact" }, el("h3", {}, title), content);
}

function panoramaViews(decision, strip) {
  const { views, guidance } = decision;
  if (views.length === 0) return null;
  const kind = views.length <= 3 ? "views few" : "views";
  return el("div", { class: kind }, views.map((view, k) => figureOf(view, k, views.length, strip, guidance)));
}

function figureOf(view, k, count, strip, guidance) {
  const chosen = count > 1 && guidance?.direction === k;
  const names = [...new Set(view.seen.map(([label]) => label))];
  const caption = [
    el("b", {}, `${k}`),
    ` ${arrowOf(view.bearing)} `,
    el("span", { class: "muted" }, names.join(", ") || "nothing known"),
  ];
  const title = `view ${k}: bearing ${degrees(view.bearing)}, ${counted(view.frontiers, "frontier point")}, ` +
    `${fixed(view.floor, 1, "m²")} of floor\n` +
    view.seen.map(([label, score]) => `${label} ${fixed(score, 2)}`).join("\n");
  return el(
    "figure",
    { class: chosen ? "chosen" : null, title },
    strip && cut(strip, k, count),
    el("figcaption", {}, caption),
  );
}

/** One view of a strip that holds them side by side. */
function cut(strip, k, count) {
  const width = strip.naturalWidth / count;
  const canvas = el("canvas", { width: Math.round(width), height: strip.naturalHeight });
  canvas.getContext("2d").drawImage(strip, k * width, 0, width, strip.naturalHeight, 0, 0, canvas.width, canvas.height);
  return canvas;
}

/** As the view points on the map. */
function arrowOf(bearing) {
  return ARROWS[((Math.round(bearing / (Math.PI / 4)) % 8) + 8) % 8];
}

function answer({ guidance, views }) {
  if (!guidance) return null;
  const said = [
    ["target in view", guidance.found ? "yes" : "no"],
    ["this room", guidance.room],
    ["go on around", `place ${guidance.node}`],
    views.length > 1 && ["look towards", `view ${guidance.direction}`],
  ].filter(Boolean);
  return el("div", {}, guidance.reason && el("blockquote", {}, guidance.reason), pairs(said));
}

function pairs(entries) {
  return el("dl", { class: "pairs" }, entries.map(([key, value]) => el("div", {}, el("dt", {}, key), el("dd", {}, value))));
}

function changeList(changes) {
  if (!changes || changes.length === 0) return null;
  return el("ul", { class: "plain" }, changes.map((line) => el("li", {}, line)));
}

function frontierTable(frontiers, map) {
  if (!frontiers || frontiers.length === 0) return null;
  const most = Math.max(...frontiers.map((one) => one.promise), 1e-9);
  const heads = ["", "promise", "unknown", "likely", "way", "why"];
  const rows = frontiers.map((one) =>
    el(
      "tr",
      {
        class: one.rank === 0 ? "first" : null,
        onpointerenter: () => map.highlight(one.rank),
        onpointerleave: () => map.highlight(null),
      },
      el("td", {}, one.rank === null ? "–" : String(one.rank + 1)),
      el("td", {}, meter(one.promise / most, fixed(one.promise, 3))),
      el("td", {}, fixed(one.unknown_m2, 1, "m²")),
      el("td", {}, fixed(one.likelihood, 2)),
      el("td", {}, fixed(one.path_cost, 1, "m")),
      el("td", { class: "muted" }, reasonsFor(one)),
    ),
  );
  return el(
    "div",
    { class: "scroll" },
    el("table", { class: "small" }, el("thead", {}, el("tr", {}, heads.map((head) => el("th", {}, head)))), el("tbody", {}, rows)),
  );
}

function reasonsFor(one) {
  return [one.speaks, one.guided && "reasoner's place", one.on_stairs && "stairs"].filter(Boolean).join(", ");
}

function termBars(terms) {
  if (!terms || terms.length === 0) return null;
  return el("dl", { class: "bars" }, terms.map(([name, value]) => el("div", {}, el("dt", {}, `A_${name}`), el("dd", {}, meter(value, fixed(value, 2))))));
}

function meter(share, text) {
  const bar = el("i");
  bar.style.width = `${(100 * Math.min(Math.max(share, 0), 1)).toFixed(1)}%`;
  return el("span", { class: "meter" }, el("span", { class: "track" }, bar), el("span", {}, text));
}

function candidateList(candidates) {
  if (!candidates || candidates.length === 0) return null;
  return el("ol", { class: "candidates" }, candidates.map(candidateItem));
}

function candidateItem(one) {
  const size = one.high.map((high, axis) => fixed(high - one.low[axis], 1)).join(" × ");
  const notes = [
    one.chosen && "gone to",
    one.returns > 0 && `looked at again ${counted(one.returns, "time")}`,
    one.verdict !== 0 && `verdict ${signed(one.verdict)}`,
    `${size} m`,
  ].filter(Boolean);
  return el(
    "li",
    { class: one.chosen ? "chosen" : null },
    el("div", { class: "head" }, el("b", {}, `log-odds ${signed(one.log_odds)}`), el("span", { class: "muted" }, notes.join(", "))),
    oddsBar(one.log_odds),
    one.sides.length > 0 && el("details", {}, el("summary", {}, `seen from ${counted(one.sides.length, "side")}`), sideTable(one.sides)),
  );
}

/** From the middle to the right what speaks for it, to the left what speaks against it. */
function oddsBar(odds) {
  const bar = el("i", { class: odds < 0 ? "against" : "for" });
  bar.style.width = `${(50 * Math.min(Math.abs(odds) / MOST_ODDS, 1)).toFixed(1)}%`;
  return el("div", { class: "odds" }, bar);
}

function sideTable(sides) {
  const heads = ["side", "range", "frames", "detected", "other", "says"];
  const rows = sides.map((side) =>
    [side.side, side.near ? "near" : "far", side.frames, side.hits, side.others, signed(side.log_odds)].map((cell) => el("td", {}, String(cell))),
  );
  return el(
    "table",
    { class: "small" },
    el("thead", {}, el("tr", {}, heads.map((head) => el("th", {}, head)))),
    el("tbody", {}, rows.map((cells) => el("tr", {}, cells))),
  );
}

/** The model's exchanges where one was asked, and the memory in words. */
function prompts(decision) {
  const exchanges = (decision.exchanges ?? []).map(exchangeDetails);
  const memory = decision.memoryText && details("the memory, in words", el("pre", {}, decision.memoryText), exchanges.length === 0);
  if (exchanges.length === 0 && !memory) return null;
  return fill(el("div"), exchanges, memory);
}

function exchangeDetails(exchange) {
  const from = exchange.cached ? "from the cache" : counted(exchange.requests, "request");
  const took = `${exchange.model}, ${from}, ${exchange.tokensIn} tokens in, ${exchange.tokensOut} out, ` +
    `${fixed(exchange.seconds, 1, "s")}, ${fixed(exchange.cost, 4)} dollars`;
  const failed = [...exchange.failures, exchange.failure].filter(Boolean);
  return details(
    `prompt: ${exchange.prompt}`,
    [
      el("p", { class: "muted" }, took),
      failed.length > 0 && el("p", { class: "warn" }, `failures: ${failed.join(", ")}`),
      el("pre", {}, exchange.text),
      exchange.images > 0 && el("p", { class: "muted" }, `with ${counted(exchange.images, "image")}`),
      el("h4", {}, "its answer"),
      el("pre", {}, exchange.answer ?? "none that could be used"),
    ],
    false,
  );
}

function details(title, content, open) {
  return el("details", { open }, el("summary", {}, title), content);
}
