// How a body changed, a design or cracks that grow: one step at a time, under a slider.

import { element, theme } from "./dom.js";

/** Loops of the boundary and lines of cracks of every kept step of "design" or "growth". */
function read(data, of) {
  const points = data.array(`${of}.points`), lines = data.array(`${of}.lines`);
  if (!points || !lines) return [];
  const shots = data[of].shots.map((s) => ({ ...s, boundary: [], cracks: [] }));
  let at = 0;
  for (let i = 0; i < lines.length; i += 3) {  // shot, 0: boundary or 1: crack, number of points
    const line = points.subarray(2 * at, 2 * (at + lines[i + 2]));
    shots[lines[i]][lines[i + 1] ? "cracks" : "boundary"].push(line);
    at += lines[i + 2];
  }
  return shots;
}

export function shots(root, data, of) {
  const shots = read(data, of), name = data[of].slider;
  const stage = root?.querySelector(".stage");
  if (!stage || shots.length === 0) return;
  stage.textContent = "";
  let low = [Infinity, Infinity], high = [-Infinity, -Infinity];
  for (const shot of shots)
    for (const line of [...shot.boundary, ...shot.cracks])
      for (let i = 0; i < line.length; ++i) {
        low[i % 2] = Math.min(low[i % 2], line[i]);
        high[i % 2] = Math.max(high[i % 2], line[i]);
      }
  const canvas = element("canvas", { class: "field", role: "img" });
  stage.append(canvas);
  const slider = element("input", { type: "range", min: "0", max: String(shots.length - 1), step: "1", value: String(shots.length - 1), id: name });
  const play = element("button", { type: "button" }, ["play"]);
  const said = element("output", { class: "readout" });
  if (shots.length > 1) stage.before(element("div", { class: "controls" }, [
    element("span", { class: "control wide" }, [element("label", { for: name }, [name]), slider]), play]));
  stage.after(said);

  const path = (c, line, to, close) => {
    for (let i = 0; i < line.length; i += 2) (i ? c.lineTo : c.moveTo).call(c, ...to(line[i], line[i + 1]));
    if (close) c.closePath();
  };
  const draw = () => {
    const shot = shots[Number(slider.value)], colors = theme(root);
    const width = stage.clientWidth, height = stage.clientHeight, pixel = Math.min(2, window.devicePixelRatio || 1);
    canvas.width = width * pixel;
    canvas.height = height * pixel;
    const c = canvas.getContext("2d");
    c.scale(pixel, pixel);
    const zoom = 0.94 * Math.min(width / (high[0] - low[0] || 1), height / (high[1] - low[1] || 1));
    const to = (x, y) => [width / 2 + (x - (low[0] + high[0]) / 2) * zoom, height / 2 - (y - (low[1] + high[1]) / 2) * zoom];
    c.beginPath();
    for (const line of shot.boundary) path(c, line, to, true);
    c.fillStyle = colors.lines[0];
    c.globalAlpha = 0.85;
    c.fill("evenodd");
    c.globalAlpha = 1;
    c.strokeStyle = colors.ink;
    c.lineWidth = 1.2;
    c.stroke();
    c.beginPath();
    for (const line of shot.cracks) path(c, line, to, false);
    c.strokeStyle = colors.bad;
    c.lineWidth = 2.5;
    c.stroke();
    c.beginPath();
    for (const line of shots[0].boundary) path(c, line, to, true);
    c.strokeStyle = colors.dim;
    c.lineWidth = 1;
    c.setLineDash([4, 4]);
    c.stroke();
    c.setLineDash([]);
    const { text } = shot;
    said.value = text;
    slider.setAttribute("aria-valuetext", text);
    canvas.setAttribute("aria-label", `The body at ${text}.`);
    root.dataset.drawn = String(slider.value);
  };
  slider.addEventListener("input", draw);
  let timer = null;
  const stop = () => {
    clearInterval(timer);
    timer = null;
    play.textContent = "play";
  };
  play.addEventListener("click", () => {
    if (timer) return stop();
    if (Number(slider.value) === shots.length - 1) slider.value = "0";
    play.textContent = "stop";
    draw();
    timer = setInterval(() => {
      slider.value = String(Number(slider.value) + 1);
      draw();
      if (Number(slider.value) >= shots.length - 1) stop();
    }, 250);
  });
  new ResizeObserver(draw).observe(stage);
  for (const query of ["(prefers-color-scheme: dark)", "print"]) matchMedia(query).addEventListener("change", draw);
  root.addEventListener("kerf-theme", draw);
}
