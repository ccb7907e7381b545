// Numbers as text, and round numbers for axes.

/** Significant digits, a proper minus, a power of ten where the number is far from one. */
export function format(value, digits = 6) {
  if (value === null || !Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  let text = size >= 1e6 || size < 1e-4 ? value.toExponential(digits - 1) : value.toPrecision(digits);
  let [mantissa, power] = text.split("e");
  if (mantissa.includes(".")) mantissa = mantissa.replace(/\.?0+$/, "");
  text = mantissa.replace("-", "−");
  if (!power) return text;
  const ten = `10${superscript(power.replace("+", ""))}`;
  return text === "1" ? ten : text === "−1" ? `−${ten}` : `${text}×${ten}`;
}

const raised = { "-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹" };
const superscript = (text) => [...text].map((c) => raised[c]).join("");

/** As few digits as tell these apart, and no fewer than four. */
export function formatAll(values) {
  for (let digits = 4; ; ++digits) {
    const out = values.map((v) => (v === null ? "" : format(v, digits)));
    const said = out.filter((text) => text !== "");
    if (digits === 12 || new Set(said).size === said.length) return out;
  }
}

/** Round numbers in [low, high], about `count` of them. */
export function ticks(low, high, count) {
  if (!(high > low)) return [];
  const power = 10 ** Math.floor(Math.log10((high - low) / count));
  const step = power * [1, 2, 5, 10].find((k) => (high - low) / (k * power) <= count);
  const out = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k) out.push(k * step);
  return out;
}
