// The address: which view, run, episode and decision; the one place where that is kept.

const KEYS = ["view", "run", "scene", "index", "decision", "step", "with"];

/** What the address asks for; what it does not name is undefined. */
export function currentRoute() {
  const asked = new URLSearchParams(location.hash.slice(1));
  const route = {};
  for (const key of KEYS) if (asked.has(key)) route[key] = asked.get(key);
  route.view ??= route.scene !== undefined ? "episode" : "results";
  return route;
}

/** Go there; the back button leads to where one was. */
export function goTo(route) {
  const hash = hashOf(route);
  if (hash !== location.hash) location.hash = hash;
}

/** The same place in other words: no new entry in the history. */
export function refineRoute(route) {
  history.replaceState(null, "", hashOf(route));
}

export function hashOf(route) {
  const asked = new URLSearchParams();
  for (const key of KEYS) {
    const implied = key === "view" && route.view === "episode" && route.scene !== undefined;
    if (route[key] !== undefined && route[key] !== "" && !implied) asked.set(key, route[key]);
  }
  return `#${asked}`;
}
