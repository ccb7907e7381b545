// From values to colors: which part of a table of 256 colors a value takes, and where the scale ends.

import { ticks } from "./numbers.js";

/** 256 x 4 bytes from a string of hexadecimal RRGGBB. */
export function table(hex) {
  const out = new Uint8Array(1024);
  for (let i = 0; i < 256; ++i) {
    for (let k = 0; k < 3; ++k) out[4 * i + k] = parseInt(hex.substr(6 * i + 2 * k, 2), 16);
    out[4 * i + 3] = 255;
  }
  return out;
}

/**
 * Sorted values with the area that each stands for; cumulative, so that a share of the area is a value. Values that
 * are no numbers, and those that do not count (masked ones), are left out.
 */
export function distribution(values, weights, counts) {
  const order = [];
  for (let i = 0; i < values.length; ++i) if (Number.isFinite(values[i]) && weights[i] > 0 && counts(i)) order.push(i);
  order.sort((a, b) => values[a] - values[b]);
  const sorted = new Float64Array(order.length), sum = new Float64Array(order.length);
  let total = 0;
  order.forEach((i, k) => {
    sorted[k] = values[i];
    sum[k] = total += weights[i];
  });
  return { sorted, sum, total };
}

/** The value that this share of the area lies below. */
export function quantile({ sorted, sum, total }, share) {
  if (sorted.length === 0) return NaN;
  let low = 0, high = sorted.length - 1;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (sum[middle] > share * total) high = middle;
    else low = middle + 1;
  }
  return sorted[low];
}

/** The share of the area whose values lie below, and above. */
export function beyond({ sorted, sum, total }, low, high) {
  let below = 0, above = 0;
  for (let i = 0; i < sorted.length && sorted[i] < low; ++i) below = sum[i];
  for (let i = sorted.length - 1; i >= 0 && sorted[i] > high; --i) above = total - (i > 0 ? sum[i - 1] : 0);
  return total > 0 ? { below: below / total, above: above / total } : { below: 0, above: 0 };
}

/**
 * A scale. kind: linear | log | diverging; low, high: what the ends of the table stand for.
 * at(value): 0 to 1, beyond that outside.
 */
export function makeScale(kind, low, high) {
  if (!(high > low)) {
    const half = Math.abs(low) > 0 ? 0.5 * Math.abs(low) : 1;
    const middle = Number.isFinite(low) ? low : 0;
    [low, high] = [middle - half, middle + half];
  }
  if (kind === "log" && !(low > 0)) kind = "linear";
  const log = kind === "log";
  const from = log ? Math.log(low) : low, to = log ? Math.log(high) : high;
  const at = (v) => ((log ? Math.log(Math.max(v, 1e-300)) : v) - from) / (to - from);
  const value = (t) => (log ? Math.exp(from + t * (to - from)) : from + t * (to - from));
  return { kind, log, low, high, from, to, at, value, ticks: log ? logTicks(low, high) : ticks(low, high, 6) };
}

function logTicks(low, high) {
  const out = [];
  const decades = Math.log10(high / low);
  if (decades < 1.2) return ticks(low, high, 5);
  const step = Math.ceil(decades / 6);
  for (let p = Math.ceil(Math.log10(low) - 1e-9); p <= Math.log10(high) + 1e-9; ++p) if (p % step === 0) out.push(10 ** p);
  return out;
}

/**
 * Where the colors end at first: symmetric about zero for values of both signs; otherwise the least and the largest
 * value, unless few of them stand far above the rest (singular points): then what `clip` of the area lies beyond.
 */
export function firstLimits(spread, diverging, clip) {
  const n = spread.sorted.length;
  if (n === 0) return diverging ? [-1, 1] : [0, 1];
  let low = spread.sorted[0], high = spread.sorted[n - 1];
  const inner = [quantile(spread, clip), quantile(spread, 1 - clip)];
  const span = inner[1] - inner[0];
  if (inner[0] - low > 0.25 * span) low = inner[0];
  if (high - inner[1] > 0.25 * span) high = inner[1];
  if (!diverging) return [low, high];
  const reach = Math.max(Math.abs(low), Math.abs(high)) || 1;
  return [-reach, reach];
}
