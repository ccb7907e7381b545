// What stands over the colors: the boundary, cracks, supports and loads, marks, the place that is read.

import { format } from "./numbers.js";

const signs = { least: "▼", largest: "▲", holds: "✓", fails: "✗", unsaid: "?", tip: "" };

function lines(c, figure, pairs) {
  if (!pairs) return;
  const { deformed } = figure;
  c.beginPath();
  for (let i = 0; i < pairs.length; i += 2) {
    c.moveTo(...figure.toScreen(deformed[2 * pairs[i]], deformed[2 * pairs[i] + 1]));
    c.lineTo(...figure.toScreen(deformed[2 * pairs[i + 1]], deformed[2 * pairs[i + 1] + 1]));
  }
  c.stroke();
}

/** Where a place on the boundary goes with the nearest corner there. */
function carried(figure, x, y) {
  if (figure.deform === 0) return [x, y];
  const outline = figure.data.array("outline") || [];
  let best = -1, least = Infinity;
  for (const i of outline) {
    const d = (figure.points[2 * i] - x) ** 2 + (figure.points[2 * i + 1] - y) ** 2;
    if (d < least) [best, least] = [i, d];
  }
  return best < 0 ? [x, y] : [x + figure.deform * figure.u[2 * best], y + figure.deform * figure.u[2 * best + 1]];
}

function supports(c, figure, name, dash) {
  const parts = figure.data.array(name);
  if (!parts) return;
  c.setLineDash(dash);
  c.beginPath();
  for (let i = 0; i < parts.length; i += 4) {
    c.moveTo(...figure.toScreen(...carried(figure, parts[i], parts[i + 1])));
    c.lineTo(...figure.toScreen(...carried(figure, parts[i + 2], parts[i + 3])));
  }
  c.stroke();
  c.setLineDash([]);
}

/** Arrows: from, to, and which end lies on the boundary (0, 1). */
function arrows(c, figure) {
  const all = figure.data.array("arrows");
  if (!all) return;
  for (let i = 0; i < all.length; i += 4) {
    const from = [all[i], all[i + 1]], to = [all[i + 2], all[i + 3]];
    const shift = (() => {
      const near = carried(figure, ...to);
      return [near[0] - to[0], near[1] - to[1]];
    })();
    const a = figure.toScreen(from[0] + shift[0], from[1] + shift[1]), b = figure.toScreen(to[0] + shift[0], to[1] + shift[1]);
    const length = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1, ux = (b[0] - a[0]) / length, uy = (b[1] - a[1]) / length;
    const head = Math.min(7, 0.5 * length);
    c.beginPath();
    c.moveTo(...a);
    c.lineTo(b[0] - head * ux, b[1] - head * uy);
    c.stroke();
    c.beginPath();
    c.moveTo(...b);
    c.lineTo(b[0] - head * ux - 0.45 * head * uy, b[1] - head * uy + 0.45 * head * ux);
    c.lineTo(b[0] - head * ux + 0.45 * head * uy, b[1] - head * uy - 0.45 * head * ux);
    c.fill();
  }
}

/** Text with an edge in the color of the paper, so that it can be read on any color. */
function label(c, text, x, y, theme) {
  c.lineWidth = 4;
  c.lineJoin = "round";
  c.strokeStyle = theme.paper;
  c.strokeText(text, x, y);
  c.fillStyle = theme.ink;
  c.fillText(text, x, y);
}

function marks(c, figure, theme) {
  for (const mark of figure.spec.marks) {
    if (mark.field && mark.field !== figure.id) continue;
    const [x, y] = figure.toScreen(...figure.moved(mark.x, mark.y));
    c.beginPath();
    if (mark.kind === "change") c.rect(x - 3, y - 3, 6, 6);
    else c.arc(x, y, mark.kind === "tip" ? 3 : 5.5, 0, 2 * Math.PI);
    c.fillStyle = mark.kind === "holds" ? theme.good : mark.kind === "fails" || mark.kind === "tip" ? theme.bad : theme.paper;
    c.fill();
    c.lineWidth = 1.6;
    c.strokeStyle = theme.ink;
    c.stroke();
    if (!signs[mark.kind]) continue;
    const beside = x > figure.box().width - 110;
    c.textAlign = beside ? "right" : "left";
    label(c, `${signs[mark.kind]} ${mark.short || ""}`.trim(), x + (beside ? -10 : 10), y + 4.5, theme);
  }
  c.textAlign = "left";
}

function place(c, figure, theme) {
  const found = figure.found;
  if (figure.cross) {
    const [x, y] = figure.cross;
    c.strokeStyle = theme.ink;
    c.lineWidth = 1;
    c.beginPath();
    c.moveTo(x - 12, y);
    c.lineTo(x + 12, y);
    c.moveTo(x, y - 12);
    c.lineTo(x, y + 12);
    c.stroke();
  }
  if (!found) return;
  const [x, y] = figure.toScreen(...figure.moved(found.x, found.y));
  for (const [width, color] of [[4, theme.paper], [1.8, theme.ink]]) {
    c.lineWidth = width;
    c.strokeStyle = color;
    c.beginPath();
    c.arc(x, y, found.corner === null ? 3 : 6, 0, 2 * Math.PI);
    c.stroke();
  }
  const text = Number.isFinite(found.value) ? format(found.value, 5) : "no value";
  const beside = x > figure.box().width - 130;
  c.textAlign = beside ? "right" : "left";
  label(c, found.masked ? `${text}, masked` : text, x + (beside ? -12 : 12), y - 10, theme);
  c.textAlign = "left";
}

/** A piece of round length, for scale. */
function ruler(c, figure, theme) {
  const { height } = figure.box(), per = figure.zoom / figure.unit;
  const power = 10 ** Math.floor(Math.log10(110 / per));
  const length = power * [5, 2, 1].find((k) => k * power * per <= 110);
  if (!(length > 0)) return;
  const x = 14, y = height - 14;
  for (const [width, color] of [[5, theme.paper], [2, theme.ink]]) {
    c.lineWidth = width;
    c.strokeStyle = color;
    c.beginPath();
    c.moveTo(x, y);
    c.lineTo(x + length * per, y);
    c.stroke();
  }
  label(c, `${format(length, 3)}${figure.data.units.length ? ` ${figure.data.units.length}` : ""}`, x, y - 7, theme);
}

export function drawOverlay(canvas, figure, theme) {
  const { width, height } = figure.box(), pixel = Math.min(2, window.devicePixelRatio || 1);
  if (canvas.width !== Math.round(width * pixel) || canvas.height !== Math.round(height * pixel)) {
    canvas.width = Math.round(width * pixel);
    canvas.height = Math.round(height * pixel);
  }
  const c = canvas.getContext("2d");
  c.setTransform(pixel, 0, 0, pixel, 0, 0);
  c.clearRect(0, 0, width, height);
  c.font = "600 13px system-ui, 'DejaVu Sans', sans-serif";
  c.lineCap = "round";
  const { data } = figure;
  c.strokeStyle = theme.ink;
  c.lineWidth = 1;
  lines(c, figure, data.array("outline"));
  c.globalAlpha = 0.7;
  lines(c, figure, data.array("interfaces"));
  c.globalAlpha = 1;
  c.strokeStyle = theme.bad;
  c.lineWidth = 2;
  lines(c, figure, data.array("cracks"));
  c.strokeStyle = theme.support;
  c.lineWidth = 4;
  supports(c, figure, "supports", []);
  supports(c, figure, "rollers", [2, 7]);
  c.strokeStyle = c.fillStyle = theme.load;
  c.lineWidth = 1.6;
  arrows(c, figure);
  marks(c, figure, theme);
  place(c, figure, theme);
  ruler(c, figure, theme);
}
