// One run's side of an episode: its map and its facts.

import { el, fill } from "./dom.js";
import { endedBy, endingOf, episodeFigures, factsOf } from "./facts.js";
import { EpisodeMap } from "./map.js";
import { decisionAt } from "./moments.js";
import { counted, fixed } from "./numbers.js";
import { outcomeChip } from "./parts.js";
import { loadPicture } from "./store.js";

const NO_RECORDS = "Nothing was recorded of this episode.";
const NO_MAPS =
  "No maps were recorded: toponav eval --explain does. The places are those of the end.";

export class Pane {
  /** `source` has the run, the episode's line and its data; `shown` says which layers are on. */
  constructor(source, extent, shown, titled) {
    this.source = source;
    this.shown = shown;
    this.moment = null;
    this.picture = null;
    this.map = new EpisodeMap(extent);
    this.caption = el("p", { class: "caption" });
    this.facts = el("div", { class: "facts" });
    this.element = el(
      "div",
      { class: "pane" },
      titled && el("h2", {}, source.run.name, " ", outcomeChip(source.episode)),
      titled && episodeFigures(source.episode),
      el("div", { class: "look" }, this.map.element, this.caption),
      this.facts,
    );
  }

  /** Decode what the whole episode needs. */
  async prepare() {
    this.picture = await loadPicture(this.source.data.picture?.image);
  }

  async show(moment) {
    this.moment = moment;
    const { data, episode } = this.source;
    const k = decisionAt(data, moment);
    const decision = data.decisions[k] ?? null;
    this.redraw();
    fill(this.caption, captionOf(decision, k, moment, episode));
    const strip = await loadPicture(decision?.panorama);
    if (this.moment !== moment) return;
    const end = moment.end && [endingOf(episode), decision && lastDecision(decision, k)];
    fill(this.facts, this.note(), end, factsOf(decision, strip, this.map));
  }

  /** The map anew, as after a change of colours or layers. */
  redraw() {
    const { data } = this.source;
    const { moment, picture, shown } = this;
    if (!moment) return;
    const last = data.decisions[decisionAt(data, moment)];
    const atEnd = moment.end && data.end && last;
    const decision = atEnd ? { ...last, map: data.end, frontiers: [] } : last;
    this.map.draw({ data, moment, picture, shown, decision });
  }

  /** What was not recorded, if anything. */
  note() {
    const { decisions } = this.source.data;
    if (decisions.some((decision) => decision.map)) return null;
    const text = decisions.length === 0 ? NO_RECORDS : NO_MAPS;
    return el("p", { class: "muted note" }, text);
  }
}

function captionOf(decision, k, moment, episode) {
  if (moment.end) {
    const steps = counted(episode.steps, "step");
    return [el("b", {}, "The end"), `: ${endedBy(episode)} after ${steps}, ${distanceText(episode)}.`];
  }
  if (!decision) return "Before the first decision.";
  return [
    el("b", {}, `Decision ${k + 1}`),
    ` at step ${decision.step}, ${decision.phase}: ${intent(decision)}`,
  ];
}

/** What follows the ending is not of the end. */
function lastDecision(decision, k) {
  return el("h2", { class: "between" }, `The last decision, ${k + 1}, at step ${decision.step}`);
}

function distanceText(episode) {
  if (episode.distance === null) return "no path to the target";
  return `${fixed(episode.distance, 2, "m")} from the target`;
}

/** Where it goes, in a few words. */
function intent(decision) {
  if (!decision.waypoint) return "nothing left to go to.";
  const chosen = (decision.candidates ?? []).findIndex((one) => one.chosen);
  if (decision.phase !== "exploration" && chosen >= 0) return `to candidate ${chosen + 1}.`;
  if (decision.phase !== "exploration") return "to the target.";
  const count = decision.frontiers?.length ?? 0;
  if (count > 0) return `to the first of ${counted(count, "frontier")}.`;
  return decision.map?.heat ? "to the highest affordance." : "to the waypoint.";
}
