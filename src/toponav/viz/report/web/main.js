// The page: reads the address, shows what it asks for, and keeps it true.

import { el, fill } from "./dom.js";
import { EpisodeStage } from "./episode.js";
import { buildFilters, chooseRun, chosenRun, passing } from "./filters.js";
import { buildHelp, listen } from "./keys.js";
import { markRow, showList } from "./list.js";
import { routeOf } from "./moments.js";
import { currentRoute, goTo, hashOf, refineRoute } from "./route.js";
import { loadEpisode, readOverview } from "./store.js";
import { showTables } from "./tables.js";
import { nextTheme, startTheme } from "./theme.js";

const PARTS = ["filters", "count", "list", "results", "episode", "theme", "help", "keys"];

class Explorer {
  constructor() {
    this.overview = readOverview();
    this.part = Object.fromEntries(PARTS.map((id) => [id, document.getElementById(id)]));
    this.stage = null;
    this.shownKey = "";
    this.byKey = this.overview.runs.map(
      (run) => new Map(run.episodes.map((episode, k) => [keyOf(episode), k])),
    );
  }

  start() {
    const { filters, results, theme, help, keys } = this.part;
    buildFilters(filters, this.overview, () => this.listEpisodes());
    buildHelp(keys, help);
    showTables(results, this.overview);
    startTheme(theme, () => this.stage?.redraw());
    listen(this.actions(), filters.elements.text);
    addEventListener("hashchange", () => this.follow());
    this.listEpisodes();
    this.follow();
  }

  actions() {
    const { filters, theme, help } = this.part;
    return {
      ArrowLeft: () => this.stage?.step(-1),
      ArrowRight: () => this.stage?.step(1),
      Home: () => this.stage?.moveTo(0),
      End: () => this.stage?.moveTo(Infinity),
      j: () => this.neighbour(1),
      k: () => this.neighbour(-1),
      c: () => this.nextCompanion(),
      r: () => goTo({ view: "results" }),
      t: () => nextTheme(theme, () => this.stage?.redraw()),
      "/": () => filters.elements.text.focus(),
      "?": () => help.click(),
    };
  }

  /** Fill the list by the filters. */
  listEpisodes() {
    const { filters, list, count } = this.part;
    const run = chosenRun(filters);
    const { episodes } = this.overview.runs[run];
    this.kept = passing(filters, this.overview, (episode) => this.outcomes(episode));
    showList(list, count, episodes, this.kept, (episode) => hashOf(this.routeTo(run, episode)));
    this.mark();
  }

  /** Show what the address asks for. */
  async follow() {
    const route = currentRoute();
    this.choose(route.view);
    if (route.view !== "episode") return;
    const sources = this.sourcesOf(route);
    if (sources.length === 0) {
      this.nothing(route);
      return;
    }
    const key = sources.map(({ r, k }) => `${r}-${k}`).join("+");
    if (this.stage && key === this.shownKey) await this.stage.start(route);
    else await this.open(sources, route, key);
  }

  async open(sources, route, key) {
    this.shownKey = key;
    this.stage = null;
    const [first] = sources;
    if (chosenRun(this.part.filters) !== first.r) {
      chooseRun(this.part.filters, first.r);
      this.listEpisodes();
    }
    this.mark();
    const data = await Promise.all(sources.map(({ r, k }) => loadEpisode(r, k)));
    if (this.shownKey !== key) return;
    const loaded = sources.map((source, s) => ({ ...source, data: data[s] }));
    const base = this.routeTo(first.r, first.episode, sources[1]?.run.name);
    const arrive = (moment) => this.arriveAt({ ...base, ...routeOf(moment) });
    const companions = this.companionChoice(sources);
    this.stage = new EpisodeStage(this.part.episode, loaded, companions, arrive);
    await this.stage.start(route);
  }

  /** Note in the address where the slider stands; the tab leads back there. */
  arriveAt(route) {
    refineRoute(route);
    document.querySelector("[data-tab=episode]").href = hashOf(route);
  }

  nothing(route) {
    this.stage = null;
    this.shownKey = "";
    const unnamed = route.scene === undefined;
    const text = unnamed ? "Choose an episode from the list." : "This page holds no such episode.";
    fill(this.part.episode, el("p", { class: "empty" }, text));
  }

  /** The run that the address names and the one beside it, as far as they have the episode. */
  sourcesOf(route) {
    const { runs } = this.overview;
    const key = keyOf({ scene: route.scene, index: Number(route.index ?? 0) });
    const named = (name) => runs.findIndex((run) => run.name === name);
    const first = route.run === undefined ? 0 : named(route.run);
    const numbers = first < 0 ? [] : [...new Set([first, named(route.with)])];
    return numbers.filter((r) => r >= 0 && this.byKey[r].has(key)).map((r) => {
      const k = this.byKey[r].get(key);
      return { r, k, run: runs[r], episode: runs[r].episodes[k] };
    });
  }

  routeTo(run, episode, companion) {
    return {
      view: "episode",
      run: this.overview.runs[run].name,
      scene: episode.scene,
      index: String(episode.index),
      with: companion,
    };
  }

  /** The outcomes that an episode has in the runs: one if they agree, else two. */
  outcomes(episode) {
    const key = keyOf(episode);
    const everywhere = this.overview.runs.map((run, r) => run.episodes[this.byKey[r].get(key)]);
    return new Set(everywhere.filter(Boolean).map((one) => one.succeeded));
  }

  /** The names of the other runs that have the episode. */
  companionsOf({ r, episode }) {
    const key = keyOf(episode);
    const has = (run, other) => other !== r && this.byKey[other].has(key);
    return this.overview.runs.filter(has).map((run) => run.name);
  }

  companionChoice(sources) {
    const names = this.companionsOf(sources[0]);
    if (names.length === 0) return null;
    const chosen = sources[1]?.run.name ?? "";
    const options = ["", ...names].map((name) =>
      el("option", { value: name, selected: name === chosen }, name || "no other"),
    );
    const select = el("select", { "aria-label": "Side by side with" }, options);
    select.addEventListener("change", () => this.compareWith(select.value));
    return select;
  }

  compareWith(name) {
    goTo({ ...currentRoute(), with: name || undefined });
  }

  nextCompanion() {
    const route = currentRoute();
    const [first] = route.view === "episode" ? this.sourcesOf(route) : [];
    if (!first) return;
    const names = ["", ...this.companionsOf(first)];
    this.compareWith(names[(names.indexOf(route.with ?? "") + 1) % names.length]);
  }

  /** Open the next episode of the list, or the one before. */
  neighbour(by) {
    const at = this.kept.indexOf(this.currentNumber());
    const next = this.kept[at < 0 ? 0 : Math.min(Math.max(at + by, 0), this.kept.length - 1)];
    if (next === undefined) return;
    const run = chosenRun(this.part.filters);
    const companion = currentRoute().with;
    goTo(this.routeTo(run, this.overview.runs[run].episodes[next], companion));
  }

  currentNumber() {
    const route = currentRoute();
    const [first] = route.view === "episode" ? this.sourcesOf(route) : [];
    return first && first.r === chosenRun(this.part.filters) ? first.k : null;
  }

  mark() {
    markRow(this.part.list, this.currentNumber());
  }

  choose(view) {
    document.body.dataset.view = view;
    for (const tab of document.querySelectorAll("[data-tab]")) {
      tab.toggleAttribute("data-on", tab.dataset.tab === view);
    }
    this.mark();
  }
}

function keyOf({ scene, index }) {
  return JSON.stringify([scene, index]);
}

new Explorer().start();
