// What an inverse problem found, over what is true and where it began.

import { element, theme } from "./dom.js";

// By kind: start, true, found, uncertainty, the body.
const looks = [
  { color: "dim", width: 2, dash: [6, 5] }, { color: "good", width: 8, alpha: 0.45 }, { color: "support", width: 2.5 }, { color: "load", width: 2 }, { color: "ink", width: 1.2 },
];

export function found(root, data) {
  const points = data.array("found.points"), lines = data.array("found.lines");
  const stage = root?.querySelector(".stage");
  if (!stage || !points || !lines) return;
  stage.textContent = "";
  const canvas = element("canvas", { class: "field", role: "img", "aria-label": root.querySelector("figcaption").textContent });
  stage.append(canvas);
  const all = [];
  const low = [Infinity, Infinity], high = [-Infinity, -Infinity];
  for (let i = 0, at = 0; i < lines.length; i += 2) {
    const line = points.subarray(2 * at, 2 * (at + lines[i + 1]));
    all.push({ kind: lines[i], line });
    at += lines[i + 1];
    line.forEach((v, k) => {
      low[k % 2] = Math.min(low[k % 2], v);
      high[k % 2] = Math.max(high[k % 2], v);
    });
  }
  const draw = () => {
    const colors = theme(root), width = stage.clientWidth, height = stage.clientHeight, pixel = Math.min(2, window.devicePixelRatio || 1);
    canvas.width = width * pixel;
    canvas.height = height * pixel;
    const c = canvas.getContext("2d");
    c.scale(pixel, pixel);
    const zoom = 0.92 * Math.min(width / (high[0] - low[0] || 1), height / (high[1] - low[1] || 1));
    for (const kind of [4, 0, 1, 2, 3])
      for (const one of all.filter((a) => a.kind === kind)) {
        const look = looks[kind];
        c.beginPath();
        for (let i = 0; i < one.line.length; i += 2)
          (i ? c.lineTo : c.moveTo).call(c, width / 2 + (one.line[i] - (low[0] + high[0]) / 2) * zoom, height / 2 - (one.line[i + 1] - (low[1] + high[1]) / 2) * zoom);
        c.strokeStyle = colors[look.color];
        c.globalAlpha = look.alpha || 1;
        c.lineWidth = look.width;
        c.setLineDash(look.dash || []);
        c.stroke();
      }
    root.dataset.drawn = "1";
  };
  new ResizeObserver(draw).observe(stage);
  for (const query of ["(prefers-color-scheme: dark)", "print"]) matchMedia(query).addEventListener("change", draw);
  root.addEventListener("kerf-theme", draw);
}
