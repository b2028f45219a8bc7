// The stage with an episode on it: its head, the slider, and a pane for each run.

import { el, fill } from "./dom.js";
import { episodeFigures } from "./facts.js";
import { LAYERS, extentOf } from "./map.js";
import { momentOf, momentsOf } from "./moments.js";
import { Pane } from "./pane.js";
import { outcomeChip } from "./parts.js";

const SHOWN = Object.fromEntries(Object.keys(LAYERS).map((name) => [name, true]));
// Kept from episode to episode, for the reader set it.

export class EpisodeStage {
  /** `sources` are one or two runs of one episode; `onMoment` hears where the slider stands. */
  constructor(section, sources, companions, onMoment) {
    this.sources = sources;
    this.onMoment = onMoment;
    this.moments = momentsOf(sources);
    this.at = 0;
    const extent = extentOf(sources);
    const side = sources.length > 1;
    this.panes = sources.map((source) => new Pane(source, extent, SHOWN, side));
    this.build(section, companions, side);
  }

  async start(route) {
    await Promise.all(this.panes.map((pane) => pane.prepare()));
    await this.moveTo(momentOf(this.moments, route));
  }

  async moveTo(at) {
    this.at = Math.min(Math.max(at, 0), this.moments.length - 1);
    const moment = this.moments[this.at];
    this.slider.value = String(this.at);
    this.slider.setAttribute("aria-valuetext", momentText(moment));
    const count = moment.end ? "" : ` of ${this.sources[0].data.decisions.length}`;
    this.position.textContent = momentText(moment) + count;
    [...this.ticks.children].forEach((tick, k) => tick.classList.toggle("on", k === this.at));
    this.onMoment(moment);
    await Promise.all(this.panes.map((pane) => pane.show(moment)));
  }

  step(by) {
    return this.moveTo(this.at + by);
  }

  redraw() {
    this.panes.forEach((pane) => pane.redraw());
  }

  build(section, companions, side) {
    const elements = this.panes.map((pane) => pane.element);
    const panes = el("div", { class: side ? "panes two" : "panes" }, elements);
    fill(section, this.head(companions), this.timeline(), this.layerChips(), panes);
  }

  head(companions) {
    const { run, episode } = this.sources[0];
    const place = ` in ${episode.scene} #${episode.index}`;
    const alone = this.sources.length === 1; // else each pane has its own outcome and figures
    return el(
      "div",
      { class: "head" },
      el("h1", {}, episode.target, el("small", {}, place), " ", alone && outcomeChip(episode)),
      alone && episodeFigures(episode),
      companions && el("label", { class: "with" }, `${run.name} with `, companions),
    );
  }

  timeline() {
    const last = this.moments.length - 1;
    this.slider = el("input", {
      type: "range", min: 0, max: last, value: 0, step: 1, "aria-label": "Decision",
      oninput: () => this.moveTo(Number(this.slider.value)),
    });
    this.position = el("output", { class: "position" });
    const ticks = this.moments.map((moment, k) => this.tick(moment, k));
    this.ticks = el("div", { class: "ticks", "aria-hidden": "true" }, ticks);
    return el(
      "div",
      { class: "timeline" },
      this.stepButton("‹", "The decision before (←)", -1),
      el("div", { class: "track" }, this.slider, this.ticks),
      this.stepButton("›", "The next decision (→)", 1),
      this.position,
    );
  }

  stepButton(text, title, by) {
    const onclick = () => this.step(by);
    return el("button", { type: "button", title, "aria-label": title, onclick }, text);
  }

  tick(moment, k) {
    const decision = this.sources[0].data.decisions[moment.decision];
    const title = momentText(moment);
    return el("span", { class: tickKind(moment, decision), title, onclick: () => this.moveTo(k) });
  }

  layerChips() {
    const available = Object.entries(LAYERS).filter(([name]) => this.hasLayer(name));
    return el(
      "div",
      { class: "layers", role: "group", "aria-label": "Layers of the map" },
      available.map(([name, text]) => this.layerChip(name, text)),
    );
  }

  layerChip(name, text) {
    const box = el("input", { type: "checkbox", checked: SHOWN[name] });
    box.addEventListener("change", () => {
      SHOWN[name] = box.checked;
      this.redraw();
    });
    return el("label", { class: `layer ${name}` }, box, el("i"), text);
  }

  hasLayer(name) {
    return this.sources.some(({ data }) => {
      const { decisions } = data;
      if (name === "picture") return data.picture !== null;
      if (name === "heat") return decisions.some((one) => one.map?.heat);
      if (name === "objects" || name === "frontiers") return decisions.some((one) => one.map);
      if (name === "candidates") return decisions.some((one) => one.candidates?.length);
      if (name === "places") return data.memory !== null || decisions.some((one) => one.nodes?.length);
      return true;
    });
  }
}

function tickKind(moment, decision) {
  if (moment.end) return "end";
  if (!decision) return "other";
  return decision.phase === "exploration" ? "exploring" : "acquiring";
}

function momentText(moment) {
  if (moment.end) return "the end";
  return moment.decision === null ? `step ${moment.step}` : `decision ${moment.decision + 1}`;
}
