// The moments of the slider: every decision of the panes, and the end.

/**
 * Moments in order: {step, round, decision: number of the first pane's, or null, end}.
 *
 * An agent may decide several times at one step, as when it has looked around and then thinks again:
 * `round` counts those from 0.
 */
export function momentsOf(panes) {
  const moments = new Map();
  panes.forEach((pane, p) => {
    const { decisions } = pane.data;
    decisions.forEach(({ step }, k) => {
      const round = roundOf(decisions, k);
      const key = `${step}/${round}`;
      const moment = moments.get(key) ?? { step, round, decision: null, end: false };
      if (p === 0) moment.decision = k;
      moments.set(key, moment);
    });
  });
  const ordered = [...moments.values()].sort((a, b) => a.step - b.step || a.round - b.round);
  const last = Math.max(...panes.map((pane) => pane.episode.steps));
  return [...ordered, { step: last, round: Infinity, decision: null, end: true }];
}

/** The number of a pane's last decision at a moment; -1 before its first. */
export function decisionAt({ decisions }, moment) {
  return decisions.findLastIndex(
    ({ step }, k) =>
      step < moment.step || (step === moment.step && roundOf(decisions, k) <= moment.round),
  );
}

/** How many decisions were made at the same step before decision `k`. */
function roundOf(decisions, k) {
  return k - decisions.findIndex(({ step }) => step === decisions[k].step);
}

/** The moment that an address names; the first where it names none. */
export function momentOf(moments, route) {
  if (route.decision === "end") return moments.length - 1;
  const byDecision = moments.findIndex((one) => one.decision === Number(route.decision) - 1);
  if (route.decision !== undefined && byDecision >= 0) return byDecision;
  if (route.step === undefined) return 0;
  return Math.max(0, moments.findLastIndex((one) => one.step <= Number(route.step)));
}

/** What an address says of a moment. */
export function routeOf(moment) {
  if (moment.end) return { decision: "end", step: undefined };
  if (moment.decision !== null) return { decision: String(moment.decision + 1), step: undefined };
  return { decision: undefined, step: String(moment.step) };
}
