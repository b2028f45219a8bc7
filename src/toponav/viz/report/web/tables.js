// The results: the tables of the runs, as `toponav table` has them.

import { el, fill } from "./dom.js";
import { percent } from "./parts.js";

export function showTables(section, overview) {
  fill(section, el("h1", {}, titleOf(overview.runs)), overview.tables.map(tableCard));
}

function titleOf(runs) {
  return runs.length === 1 ? runs[0].name : `${runs.length} runs`;
}

function tableCard(table) {
  const notes = el("ul", { class: "notes" }, table.notes.map((note) => el("li", {}, note)));
  return el(
    "article",
    { class: "card" },
    el("h2", {}, table.title),
    table.panels.map((panel) => el("div", { class: "scroll" }, gridOf(panel))),
    table.notes.length > 0 && notes,
  );
}

function gridOf({ columns, rows: cells }) {
  const heads = columns.map((column) => el("th", sideOf(column), column.title));
  const rows = cells.map((row) =>
    el("tr", {}, row.map((cell, k) => el("td", sideOf(columns[k]), cellContent(cell, columns[k])))),
  );
  return el("table", {}, el("thead", {}, el("tr", {}, heads)), el("tbody", {}, rows));
}

function sideOf(column) {
  return { class: column.label ? "label" : "number" };
}

function cellContent([figure, interval], { title }) {
  const rate = title.endsWith("[%]") && figure !== "" && Number.isFinite(Number(figure));
  const share = rate && shareBar(figure / 100);
  return [figure, share, interval && el("small", {}, interval)];
}

/** A rate at a glance; differences, which have a sign, get none. */
function shareBar(share) {
  const bar = el("i");
  bar.style.width = percent(share);
  return el("span", { class: "share", "aria-hidden": "true" }, bar);
}
