// The list of episodes beside the stage.

import { el, fill } from "./dom.js";
import { counted, fixed, wilson } from "./numbers.js";

/** Show episodes `kept` (numbers) of a run; `linkOf` gives an episode's address. */
export function showList(list, count, episodes, kept, linkOf) {
  fill(list, kept.map((k) => row(episodes[k], k, linkOf(episodes[k]))));
  count.textContent = summary(kept.map((k) => episodes[k]), episodes.length);
}

/** Mark one row as the one on the stage, and bring it into sight. */
export function markRow(list, k) {
  list.querySelector("[aria-current]")?.removeAttribute("aria-current");
  const chosen = k === null ? null : list.querySelector(`[data-k="${k}"]`);
  chosen?.setAttribute("aria-current", "true");
  chosen?.scrollIntoView({ block: "nearest" });
}

function row(episode, k, href) {
  const state = episode.succeeded ? "good" : "bad";
  return el(
    "li",
    {},
    el(
      "a",
      { class: "row", href, "data-k": k, title: episode.outcome },
      el("span", { class: `dot ${state}`, "aria-label": episode.outcome }),
      el("b", {}, episode.target),
      el("span", { class: "scene" }, episode.scene),
      el("span", { class: "number" }, `#${episode.index}`),
      el("span", { class: "figure" }, `${episode.steps}`),
      el("span", { class: "figure" }, fixed(episode.spl, 2)),
    ),
  );
}

function summary(episodes, total) {
  const n = episodes.length;
  if (n === 0) return `none of ${counted(total, "episode")}`;
  const found = episodes.filter((episode) => episode.succeeded).length;
  const [low, high] = wilson(found, n).map((rate) => (100 * rate).toFixed(0));
  const spl = episodes.reduce((sum, episode) => sum + episode.spl, 0) / n;
  const rate = ((100 * found) / n).toFixed(1);
  const count = n === total ? counted(n, "episode") : `${n} of ${counted(total, "episode")}`;
  return `${count}: SR ${rate} % [${low}, ${high}], SPL ${spl.toFixed(3)}`;
}
