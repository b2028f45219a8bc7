// The moments of the slider: every decision of the panes, and the end.

/** Moments in order of steps: {step, decision: number of the first pane's, or null, end}. */
export function momentsOf(panes) {
  const bySteps = new Map();
  panes.forEach((pane, p) => {
    pane.data.decisions.forEach((decision, k) => {
      const moment = bySteps.get(decision.step) ?? { step: decision.step, decision: null, end: false };
      if (p === 0) moment.decision = k;
      bySteps.set(decision.step, moment);
    });
  });
  const moments = [...bySteps.values()].sort((a, b) => a.step - b.step);
  const last = Math.max(...panes.map((pane) => pane.episode.steps));
  moments.push({ step: last, decision: null, end: true });
  return moments;
}

/** The number of a pane's last decision at a moment; -1 before its first. */
export function decisionAt(data, moment) {
  return data.decisions.findLastIndex((decision) => decision.step <= moment.step);
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
