// The scale of the colors.

import { format, formatAll } from "./numbers.js";

/** `canvas` as wide as its style says; the table between the ends, ticks below, arrows where values may lie beyond. */
export function drawBar(canvas, { scale, colors, field, theme }) {
  const width = canvas.clientWidth || 300, height = 58, pixel = Math.min(2, window.devicePixelRatio || 1);
  canvas.width = width * pixel;
  canvas.height = height * pixel;
  canvas.style.height = `${height}px`;
  const c = canvas.getContext("2d");
  c.scale(pixel, pixel);
  const left = 30, right = width - 30, top = 22, thick = 14;
  const color = (k) => `rgb(${colors[4 * k]},${colors[4 * k + 1]},${colors[4 * k + 2]})`;
  const run = c.createLinearGradient(left, 0, right, 0);
  for (let k = 0; k < 256; k += 5) run.addColorStop(k / 255, color(k));
  c.fillStyle = run;
  c.fillRect(left, top, right - left, thick);
  for (const [at, side, k] of [[left, -1, 0], [right, 1, 255]]) {
    c.fillStyle = color(k);
    c.beginPath();
    c.moveTo(at, top);
    c.lineTo(at + side * 10, top + thick / 2);
    c.lineTo(at, top + thick);
    c.fill();
  }
  c.font = "13px system-ui, 'DejaVu Sans', sans-serif";
  c.fillStyle = c.strokeStyle = theme.ink;
  c.textAlign = "left";
  const name = `${field.label}${field.unit ? ` in ${field.unit}` : ""}`;
  c.fillText(name, left, 14, width - 2 * left);
  c.textAlign = "center";
  let free = -Infinity;
  const texts = formatAll(scale.ticks);
  for (const [i, value] of scale.ticks.entries()) {
    const x = left + scale.at(value) * (right - left), text = texts[i], half = c.measureText(text).width / 2;
    c.beginPath();
    c.moveTo(x, top + thick);
    c.lineTo(x, top + thick + 4);
    c.stroke();
    if (x - half < free) continue;
    c.fillText(text, Math.min(width - half, Math.max(half, x)), top + thick + 17);
    free = x + half + 10;
  }
  canvas.setAttribute("aria-label", `Colors: ${name} from ${format(scale.low)} to ${format(scale.high)}${scale.log ? ", logarithmic" : ""}.`);
}
