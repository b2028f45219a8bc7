// How numbers are written.

const NOTHING = "–";
const Z = 1.959963984540054; // the normal distribution's 97.5 % point

export function fixed(value, digits = 1, unit = "") {
  if (value === null || value === undefined) return NOTHING;
  return `${value.toFixed(digits)}${unit && `\u202f${unit}`}`;
}

export function signed(value, digits = 1) {
  return `${value < 0 ? "−" : "+"}${Math.abs(value).toFixed(digits)}`;
}

export function degrees(radians) {
  return `${Math.round((radians * 180) / Math.PI)}°`;
}

export function counted(count, thing) {
  return `${count} ${thing}${count === 1 ? "" : "s"}`;
}

/** Wilson's 95 % interval of a rate: [low, high]. */
export function wilson(successes, n) {
  const rate = successes / n;
  const spread = Z * Math.sqrt((rate * (1 - rate)) / n + (Z * Z) / (4 * n * n));
  const middle = rate + (Z * Z) / (2 * n);
  const scale = 1 + (Z * Z) / n;
  return [Math.max(0, (middle - spread) / scale), Math.min(1, (middle + spread) / scale)];
}
