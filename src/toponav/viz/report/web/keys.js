// The keyboard, and the page that tells of it.

import { el, fill } from "./dom.js";

const HELP = [
  ["← →", "the decision before, the next"],
  ["Home End", "the first decision, the end"],
  ["j k", "the next episode of the list, the one before"],
  ["c", "side by side with the next run, then alone again"],
  ["/", "filter by name"],
  ["r", "the results"],
  ["t", "light, dark, or as the system says"],
  ["?", "this page"],
];

/** Call `actions[key]` for keys that are not meant for a field. */
export function listen(actions, search) {
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === "Escape" && event.target === search) search.blur();
    const action = actions[event.key];
    if (!action || isField(event.target)) return;
    event.preventDefault();
    action();
  });
}

export function buildHelp(dialog, button) {
  const rows = HELP.map(([keys, text]) => {
    const caps = keys.split(" ").map((key) => el("kbd", {}, key));
    return el("tr", {}, el("th", {}, caps), el("td", {}, text));
  });
  const link = "The address names the run, the episode and the decision: send it as a link.";
  fill(
    dialog,
    el("h2", {}, "Keys"),
    el("table", {}, el("tbody", {}, rows)),
    el("p", { class: "muted" }, link),
    el("form", { method: "dialog" }, el("button", {}, "Close")),
  );
  button.addEventListener("click", () => dialog.showModal());
}

function isField(target) {
  const typed = target.tagName === "INPUT" && target.type !== "range" && target.type !== "checkbox";
  return typed || target.tagName === "SELECT" || target.tagName === "TEXTAREA";
}
