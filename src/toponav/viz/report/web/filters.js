// Which episodes are listed.

import { el, fill } from "./dom.js";

const ALL = "";
const ORDERS = {
  "by scene": null,
  "worst SPL first": (a, b) => a.spl - b.spl,
  "longest first": (a, b) => b.steps - a.steps,
  "most decisions first": (a, b) => b.decisions - a.decisions,
};

/** Build the form; `onChange` is called with every change. */
export function buildFilters(form, overview, onChange) {
  const { runs } = overview;
  const episodes = runs.flatMap((run) => run.episodes);
  const results = ["found", "not found", ...(runs.length > 1 ? ["runs disagree"] : [])];
  const failures = overview.outcomes.slice(1).filter((name) => has(episodes, "outcome", name));
  fill(
    form,
    el("input", {
      type: "search", name: "text", placeholder: "Filter by name  ( / )",
      "aria-label": "Filter by name", autocomplete: "off",
    }),
    runs.length > 1 && choice("run", "Run", runs.map((run, k) => [k, runTitle(run)])),
    choice("result", "Outcome", [[ALL, "any outcome"], ...same(results)]),
    choice("failure", "Failure", [[ALL, "any failure"], ...same(failures)]),
    choice("category", "Category", [[ALL, "any category"], ...same(distinct(episodes, "target"))]),
    choice("scene", "Scene", [[ALL, "any scene"], ...same(distinct(episodes, "scene"))]),
    choice("order", "Order", same(Object.keys(ORDERS))),
  );
  form.addEventListener("input", onChange);
  form.addEventListener("submit", (event) => event.preventDefault());
}

/** The run whose episodes are listed, by number. */
export function chosenRun(form) {
  return Number(form.elements.run?.value ?? 0);
}

/** List the episodes of another run from now on. */
export function chooseRun(form, run) {
  if (form.elements.run) form.elements.run.value = run;
}

/** The numbers of the chosen run's episodes that pass, in the order asked for. */
export function passing(form, overview, outcomesElsewhere) {
  const wanted = Object.fromEntries(new FormData(form));
  const episodes = overview.runs[chosenRun(form)].episodes;
  const kept = episodes
    .map((episode, k) => k)
    .filter((k) => passes(episodes[k], wanted, outcomesElsewhere));
  const order = ORDERS[wanted.order];
  return order ? kept.sort((a, b) => order(episodes[a], episodes[b]) || a - b) : kept;
}

function passes(episode, wanted, outcomesElsewhere) {
  if (wanted.category && episode.target !== wanted.category) return false;
  if (wanted.scene && episode.scene !== wanted.scene) return false;
  if (wanted.failure && episode.outcome !== wanted.failure) return false;
  if (wanted.result === "found" && !episode.succeeded) return false;
  if (wanted.result === "not found" && episode.succeeded) return false;
  if (wanted.result === "runs disagree" && outcomesElsewhere(episode).size < 2) return false;
  return namesOf(episode).includes(wanted.text.trim().toLowerCase());
}

function namesOf(episode) {
  return `${episode.target} ${episode.scene} #${episode.index} ${episode.outcome}`.toLowerCase();
}

function choice(name, label, options) {
  const items = options.map(([value, text]) => el("option", { value }, text));
  return el("select", { name, "aria-label": label }, items);
}

function runTitle(run) {
  return run.name === run.method ? run.name : `${run.name} (${run.method})`;
}

function same(names) {
  return names.map((name) => [name, name]);
}

function distinct(episodes, key) {
  return [...new Set(episodes.map((episode) => episode[key]))].sort();
}

function has(episodes, key, value) {
  return episodes.some((episode) => episode[key] === value);
}
