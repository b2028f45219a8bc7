// What stands beside the map: what the decision rests on, and what is new.

import { el } from "./dom.js";
import { candidateList, frontierTable, termBars } from "./evidence.js";
import { counted, fixed } from "./numbers.js";
import { panoramaViews } from "./panorama.js";
import { definitions, folded } from "./parts.js";

/** The sections about one decision; `map` lights up what the pointer is on. */
export function factsOf(decision, strip, map) {
  if (!decision) return [el("p", { class: "muted" }, "Not decided yet.")];
  return [
    card("Panorama", panoramaViews(decision, strip)),
    card("The reasoner's answer", answer(decision)),
    card("What changed", changeList(decision.changes)),
    card("Frontiers, in the order of visits", frontierTable(decision.frontiers, map)),
    card("Affordance at the waypoint", termBars(decision.terms)),
    card("Candidates for the target", candidateList(decision.candidates)),
    card("What the reasoner was told", prompts(decision)),
  ];
}

/** The measures of an episode. */
export function episodeFigures(episode) {
  return definitions("figures", [
    ["SPL", fixed(episode.spl, 2)],
    ["steps", String(episode.steps)],
    ["path", fixed(episode.length, 1, "m")],
    ["shortest", fixed(episode.shortest, 1, "m")],
    ["to the target", fixed(episode.distance, 2, "m")],
    ["decisions", String(episode.decisions)],
    ["collisions", String(episode.collisions)],
  ]);
}

/** What ended the search, in words. */
export function endedBy({ ended }) {
  return ended.replace("step-limit", "step limit");
}

/** How the search went, from the truth that the agent never saw. */
export function endingOf(episode) {
  const at = (step) => (step === null ? "never" : `step ${step}`);
  const stages = [
    ["target first in view", at(episode.visible)],
    ["first detected", at(episode.detected)],
    ["first set out for", at(episode.approached)],
    ["end", `${endedBy(episode)}, step ${episode.steps}`],
  ];
  return card("How it ended", definitions("pairs", stages));
}

function card(title, content) {
  return content && el("section", { class: "fact" }, el("h3", {}, title), content);
}

function answer({ guidance, views }) {
  if (!guidance) return null;
  const said = [
    ["target in view", guidance.found ? "yes" : "no"],
    ["this room", guidance.room],
    ["go on around", `place ${guidance.node}`],
    views.length > 1 && ["look towards", `view ${guidance.direction}`],
  ];
  const reason = guidance.reason && el("blockquote", {}, guidance.reason);
  return el("div", {}, reason, definitions("pairs", said.filter(Boolean)));
}

function changeList(changes) {
  if (!changes || changes.length === 0) return null;
  return el("ul", { class: "plain" }, changes.map((line) => el("li", {}, line)));
}

/** The model's exchanges where one was asked, and the memory in words. */
function prompts({ exchanges = [], memoryText }) {
  if (exchanges.length === 0 && !memoryText) return null;
  const memory = memoryText && el("pre", {}, memoryText);
  return el(
    "div",
    {},
    exchanges.map(exchangeDetails),
    memory && folded("the memory, in words", memory, exchanges.length === 0),
  );
}

function exchangeDetails(exchange) {
  const failed = [...exchange.failures, exchange.failure].filter(Boolean);
  const pictures = `with ${counted(exchange.images, "picture")}`;
  return folded(`prompt: ${exchange.prompt}`, [
    el("p", { class: "muted" }, effortOf(exchange)),
    failed.length > 0 && el("p", { class: "warn" }, `failures: ${failed.join(", ")}`),
    el("pre", {}, exchange.text),
    exchange.images > 0 && el("p", { class: "muted" }, pictures),
    el("h4", {}, "its answer"),
    el("pre", {}, exchange.answer ?? "none that could be used"),
  ]);
}

function effortOf(exchange) {
  const parts = [
    exchange.model,
    exchange.cached ? "from the cache" : counted(exchange.requests, "request"),
    `${exchange.tokensIn} tokens in, ${exchange.tokensOut} out`,
    fixed(exchange.seconds, 1, "s"),
    `${fixed(exchange.cost, 4)} dollars`,
  ];
  return parts.join(", ");
}
