// Light or dark: as the system says, until the reader says otherwise.

import { el, fill } from "./dom.js";

const CHOICES = ["auto", "light", "dark"];
const KEY = "toponav-theme";

let choice = "auto";

/** Show the theme of the last visit, and call `redraw` whenever colours change. */
export function startTheme(button, redraw) {
  show(button, remembered());
  button.addEventListener("click", () => nextTheme(button, redraw));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
}

export function nextTheme(button, redraw) {
  show(button, CHOICES[(CHOICES.indexOf(choice) + 1) % CHOICES.length]);
  try {
    localStorage.setItem(KEY, choice);
  } catch {
    // a page from a file may not be allowed to remember
  }
  redraw();
}

/** The colour that the style gives a name in the present theme: [red, green, blue]. */
export function color(name) {
  const probe = document.createElement("i");
  probe.style.color = `var(--${name})`;
  document.body.append(probe);
  const { color: resolved } = getComputedStyle(probe);
  probe.remove();
  return resolved.match(/\d+/g).slice(0, 3).map(Number);
}

function show(button, next) {
  choice = next;
  if (choice === "auto") delete document.documentElement.dataset.theme;
  else document.documentElement.dataset.theme = choice;
  fill(button, el("span", { class: "wide" }, "Theme: "), choice);
}

function remembered() {
  try {
    const kept = localStorage.getItem(KEY);
    return CHOICES.includes(kept) ? kept : "auto";
  } catch {
    return "auto";
  }
}
