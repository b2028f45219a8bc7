// Pieces that several views are made of.

import { el } from "./dom.js";

/** Names and values: [[name, value], ...]. */
export function definitions(kind, entries) {
  const pair = ([name, value]) => el("div", {}, el("dt", {}, name), el("dd", {}, value));
  return el("dl", { class: kind }, entries.map(pair));
}

/** A table of heads and rows of `tr` elements. */
export function smallTable(heads, rows) {
  const titles = heads.map((head) => el("th", {}, head));
  return el(
    "table",
    { class: "small" },
    el("thead", {}, el("tr", {}, titles)),
    el("tbody", {}, rows),
  );
}

/** A row of such a table. */
export function smallRow(cells, attributes = {}) {
  return el("tr", attributes, cells.map((cell) => el("td", {}, cell)));
}

/** A share as a short bar, and its figure. */
export function meter(share, text) {
  const bar = el("i");
  bar.style.width = percent(share);
  return el("span", { class: "meter" }, el("span", { class: "track" }, bar), el("span", {}, text));
}

/** What is folded away under a title. */
export function folded(title, content, open = false) {
  return el("details", { open }, el("summary", {}, title), content);
}

export function outcomeChip(episode) {
  const kind = episode.succeeded ? "chip good" : "chip bad";
  return el("span", { class: kind }, episode.succeeded ? "found" : episode.outcome);
}

export function percent(share) {
  return `${(100 * Math.min(Math.max(share, 0), 1)).toFixed(1)}%`;
}
