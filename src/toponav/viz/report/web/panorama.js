// The views that a decision rests on.

import { el } from "./dom.js";
import { counted, degrees, fixed } from "./numbers.js";

const FEW = 3; // so many views, or less, are shown large
const ARROWS = ["→", "↗", "↑", "↖", "←", "↙", "↓", "↘"];

/** A figure a view; `strip` is the picture that holds them side by side, or null. */
export function panoramaViews({ views, guidance }, strip) {
  if (views.length === 0) return null;
  const chosen = views.length > 1 ? guidance?.direction : undefined;
  const figures = views.map((view, k) =>
    figureOf(view, k, strip && cut(strip, k, views.length), k === chosen),
  );
  return el("div", { class: views.length <= FEW ? "views few" : "views" }, figures);
}

function figureOf(view, k, picture, chosen) {
  const names = [...new Set(view.seen.map(([label]) => label))].join(", ");
  const caption = [el("b", {}, String(k)), ` ${arrowOf(view.bearing)} `];
  return el(
    "figure",
    { class: chosen ? "chosen" : null, title: titleOf(view, k) },
    picture,
    el("figcaption", {}, caption, el("span", { class: "muted" }, names || "nothing detected")),
  );
}

function titleOf(view, k) {
  const parts = [
    `view ${k}: bearing ${degrees(view.bearing)}`,
    counted(view.frontiers, "frontier point"),
    `${fixed(view.floor, 1, "m²")} of floor`,
  ];
  const seen = view.seen.map(([label, score]) => `${label} ${fixed(score, 2)}`);
  return [parts.join(", "), ...seen].join("\n");
}

/** One view of a strip. */
function cut(strip, k, count) {
  const [width, height] = [Math.round(strip.naturalWidth / count), strip.naturalHeight];
  const canvas = el("canvas", { width, height });
  const left = (k * strip.naturalWidth) / count;
  canvas.getContext("2d").drawImage(strip, left, 0, width, height, 0, 0, width, height);
  return canvas;
}

/** As the view points on the map. */
function arrowOf(bearing) {
  const eighth = Math.round(bearing / (Math.PI / 4)) % ARROWS.length;
  return ARROWS[(eighth + ARROWS.length) % ARROWS.length];
}
