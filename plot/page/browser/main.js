// Draws the page: figures of the body, curves, the design. Without this the page has its words and tables.

import { curve, finite, positive } from "./curves.js";
import { load } from "./data.js";
import { element } from "./dom.js";
import { Figure } from "./figure.js";
import { found } from "./found.js";
import { shots } from "./shots.js";

/** Light or dark as the reader has it, or as the button says. */
function themes() {
  const button = document.getElementById("theme");
  if (!button) return;
  button.hidden = false;
  const dark = () => (document.documentElement.dataset.theme || (matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light")) === "dark";
  const say = () => (button.textContent = dark() ? "light" : "dark");
  button.addEventListener("click", () => {
    document.documentElement.dataset.theme = dark() ? "light" : "dark";
    say();
    for (const figure of document.querySelectorAll("figure")) figure.dispatchEvent(new Event("kerf-theme"));
  });
  say();
}

/** On paper everything is open, and the page is light. */
function printing() {
  let closed = [], theme;
  window.addEventListener("beforeprint", () => {
    theme = document.documentElement.dataset.theme;
    document.documentElement.dataset.theme = "light";
    closed = [...document.querySelectorAll("details:not([open])")];
    for (const part of closed) part.open = true;
    for (const figure of document.querySelectorAll("figure")) figure.dispatchEvent(new Event("kerf-theme"));
    for (const figure of figures) figure.drawNow();
  });
  window.addEventListener("afterprint", () => {
    for (const part of closed) part.open = false;
    if (theme) document.documentElement.dataset.theme = theme;
    else delete document.documentElement.dataset.theme;
    for (const figure of document.querySelectorAll("figure")) figure.dispatchEvent(new Event("kerf-theme"));
  });
}

const column = (values, width, k) => finite(Array.from({ length: values.length / width }, (_, i) => values[i * width + k]));

function cracks(data) {
  data.cracks.forEach((crack, i) => {
    const rows = data.array(`crack.${i}`);
    if (!rows) return;
    const width = 6, s = column(rows, width, 0), shaded = column(rows, width, 5);
    for (const part of crack.curves) {
      const root = document.getElementById(`crack-${i}-${part.id}`);
      if (!root) continue;
      curve(root, { x: crack.x, y: part.label, alt: part.alt, shaded,
                    data: [s, ...part.columns.map((k) => column(rows, width, k))], series: part.names.map((label) => ({ label })) });
    }
  });
}

function validation(data) {
  const root = document.getElementById("validation-curves");
  if (!root || !data.validation) return;
  const radii = [...new Set(data.validation.points.flatMap((p) => p.radius))].sort((a, b) => a - b);
  const on = (p, values) => positive(radii.map((r) => Math.abs(values[p.radius.indexOf(r)] ?? NaN)));
  const series = [], columns = [];
  data.validation.points.forEach((p) => {
    series.push({ label: `remainder at ${p.name}` });
    columns.push(on(p, p.remainder));
  });
  if (data.validation.points.length <= 2)
    data.validation.points.forEach((p) => {
      series.push({ label: `difference at ${p.name}`, dash: 1 });
      columns.push(on(p, p.difference));
    });
  curve(root, { x: data.validation.x, y: data.validation.y, alt: data.validation.alt, logX: true, logY: true, data: [radii, ...columns], series });
}

function history(data) {
  for (const part of data.history || []) {
    const root = document.getElementById(`history-${part.id}`);
    if (root) curve(root, { x: part.x, y: part.label, alt: part.alt, logY: part.log, span: part.id === "volume" ? 0.1 : 0,
                            data: [part.places, ...part.values.map((v) => (part.log ? positive(v) : finite(v.map((a) => a ?? NaN))))],
                            series: part.names.map((label, i) => ({ label, dash: part.dashed.includes(i) ? 1 : 0 })) });
  }
}

const figures = [];

function start() {
  themes();
  const data = load(document);
  if (!data) return;
  printing();
  for (const spec of data.figures) {
    const root = document.getElementById(spec.id);
    if (root && data.array("points")) figures.push(new Figure(root, data, spec));
  }
  for (const of of ["design", "growth"])
    if (data[of]) shots(document.getElementById(of), data, of);
  found(document.getElementById("found"), data);
  cracks(data);
  validation(data);
  history(data);
  window.kerf = { figures, data };
  document.documentElement.dataset.ready = "1";
}

start();
