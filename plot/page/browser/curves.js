// Curves: cracks along their arc length, validations, histories. uPlot draws them.

import { element, theme } from "./dom.js";
import { format, formatAll } from "./numbers.js";

const dashes = [undefined, [8, 4], [2, 4], [10, 4, 2, 4]];

function axes(colors, spec) {
  const common = { stroke: colors.ink, grid: { stroke: colors.rule, width: 1 }, ticks: { stroke: colors.rule, width: 1 }, font: "13px system-ui, sans-serif", labelFont: "600 13px system-ui, sans-serif" };
  const values = (u, splits) => formatAll(splits);
  const of = (log, more) => {
    // Of a logarithmic axis only the powers of ten, unless there are too few of them.
    const few = (u, splits) => {
      const tens = splits.map((v) => (v !== null && Math.abs(Math.log10(v) - Math.round(Math.log10(v))) < 1e-9 ? v : null));
      return tens.filter((v) => v !== null).length > 2 ? tens : splits;
    };
    const only = log ? { filter: few } : {};
    return { ...common, ...more, values, grid: { ...common.grid, ...only }, ticks: { ...common.ticks, ...only } };
  };
  return [of(spec.logX, { label: spec.x, labelSize: 24, space: 52 }), of(spec.logY, { label: spec.y, size: 76, labelSize: 24 })];
}

/** Stretches where `on` is 1, from half way to half way between their neighbors. */
function stretches(x, on) {
  const out = [];
  for (let i = 0; i < x.length; ++i) {
    if (!on[i]) continue;
    let end = i;
    while (end + 1 < x.length && on[end + 1]) ++end;
    out.push([i === 0 ? x[0] : (x[i - 1] + x[i]) / 2, end + 1 === x.length ? x[end] : (x[end] + x[end + 1]) / 2]);
    i = end;
  }
  return out;
}

function shade(u, spec, colors) {
  if (!spec.shaded) return;
  const c = u.ctx;
  c.save();
  c.fillStyle = colors.rule;
  c.globalAlpha = 0.55;
  for (const [from, to] of stretches(spec.data[0], spec.shaded)) {
    const a = Math.max(u.bbox.left, u.valToPos(from, "x", true)), b = Math.min(u.bbox.left + u.bbox.width, u.valToPos(to, "x", true));
    if (b > a) c.fillRect(a, u.bbox.top, b - a, u.bbox.height);
  }
  c.restore();
}

/** A range about the values that is no narrower than `span`: rounding is not to look like a change. */
const atLeast = (span) => (u, low, high) => {
  const half = Math.max(span / 2, 0.55 * (high - low)), middle = (low + high) / 2;
  return [middle - half, middle + half];
};

/**
 * Draws into `root`, and once more when its width or the theme changes.
 * spec: { x, y, data: [x, ...], series: [{ label, dash }], logX, logY, span, shaded, alt }.
 */
export function curve(root, spec) {
  const stage = root.querySelector(".plot");
  if (!stage) return;
  if (!spec.data.slice(1).some((values) => values.some((v) => Number.isFinite(v)))) {
    stage.textContent = "There are no values to draw.";
    return;
  }
  let plot = null, width = 0;
  const make = () => {
    const colors = theme(root);
    plot?.destroy();
    width = Math.max(240, stage.clientWidth);
    const options = {
      width, height: Math.round(Math.min(320, Math.max(210, 0.42 * width))),
      scales: { x: { time: false, distr: spec.logX ? 3 : 1, ...(spec.logX ? { range: (u, low, high) => [low / 1.25, high * 1.25] } : {}) }, y: { distr: spec.logY ? 3 : 1, ...(spec.span ? { range: atLeast(spec.span) } : {}) } },
      axes: axes(colors, spec),
      cursor: { drag: { x: true, y: false }, points: { size: 7 } },
      legend: { live: true },
      hooks: { drawClear: [(u) => shade(u, spec, colors)] },
      series: [{ label: spec.x, value: (u, v) => format(v) },
        ...spec.series.map((s, i) => ({
          label: s.label, stroke: colors.lines[i % 4], width: 2, dash: dashes[s.dash ?? Math.floor(i / 4) % 4], spanGaps: false,
          points: { show: spec.data[0].length < 40, size: 6 }, value: (u, v) => format(v) }))],
    };
    plot = new uPlot(options, spec.data, stage);
    stage.querySelector(".u-wrap").setAttribute("role", "img");
    stage.querySelector(".u-wrap").setAttribute("aria-label", spec.alt);
    root.dataset.drawn = "1";
  };
  make();
  new ResizeObserver(() => Math.abs(stage.clientWidth - width) > 4 && make()).observe(stage);
  for (const query of ["(prefers-color-scheme: dark)", "print"]) matchMedia(query).addEventListener("change", make);
  root.addEventListener("kerf-theme", make);
}

/** No logarithm of what is not positive. */
export const positive = (values) => values.map((v) => (v > 0 ? v : null));
export const finite = (values) => Array.from(values, (v) => (Number.isFinite(v) ? v : null));
