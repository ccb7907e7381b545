// A figure of the body: fields in colors on the triangles, the body deformed as far as a slider says; zoom, pan, values
// under the pointer or under a cross that keys move.

import { beyond, distribution, firstLimits, makeScale, quantile, table } from "./colors.js";
import { drawBar } from "./bar.js";
import { fieldValues } from "./data.js";
import { control, element, option, theme } from "./dom.js";
import { makeGl } from "./gl.js";
import { format } from "./numbers.js";
import { drawOverlay } from "./overlay.js";
import { makePick } from "./pick.js";
import { makeSoft } from "./soft.js";

/** The smallest and the largest coordinates. */
function boxOf(points) {
  const low = [Infinity, Infinity], high = [-Infinity, -Infinity];
  for (let i = 0; i < points.length; ++i) {
    if (!Number.isFinite(points[i])) continue;
    low[i % 2] = Math.min(low[i % 2], points[i]);
    high[i % 2] = Math.max(high[i % 2], points[i]);
  }
  return low[0] <= high[0] ? [low, high] : [[0, 0], [1, 1]];
}

const farthest = 20000;  // times the whole body

export class Figure {
  constructor(root, data, spec) {
    Object.assign(this, { root, data, spec });
    this.points = data.array("points");
    this.triangles = data.array("triangles");
    this.u = data.array("u") || new Float32Array(this.points.length);
    this.fields = spec.fields.filter((f) => data.array(data.fields[f].array));
    this.mesh = false;
    this.cross = null;
    this.measure();
    this.build();
    this.setDeform(spec.deform || 0);
    this.setField(this.fields[0]);
    this.fit();
    new ResizeObserver(() => this.resize()).observe(this.stage);
    for (const query of ["(prefers-color-scheme: dark)", "print"]) matchMedia(query).addEventListener("change", () => this.draw());
    root.addEventListener("kerf-theme", () => this.draw());
    window.addEventListener("beforeprint", () => this.draw());
  }

  /** The box of the body, areas at corners and of triangles, and the corners that do not move with a place. */
  measure() {
    const { points, triangles } = this;
    const [low, high] = boxOf(points);
    this.unit = Math.max(high[0] - low[0], high[1] - low[1]) || 1;
    this.middle = [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2];
    const n = points.length / 2;
    this.areaAt = new Float64Array(n);
    this.areaOf = new Float64Array(triangles.length / 3);
    for (let t = 0; t < this.areaOf.length; ++t) {
      const [a, b, c] = [0, 1, 2].map((k) => 2 * triangles[3 * t + k]);
      const twice = (points[b] - points[a]) * (points[c + 1] - points[a + 1]) - (points[c] - points[a]) * (points[b + 1] - points[a + 1]);
      this.areaOf[t] = Math.abs(twice) / 2;
      for (const i of [a, b, c]) this.areaAt[i / 2] += Math.abs(twice) / 6;
    }
    this.margin = this.data.array("margin");
    this.leftOut = this.data.array("left_out");
    this.near = this.data.array("near");
  }

  // The elements.

  build() {
    const { spec, root } = this;
    this.stage = root.querySelector(".stage");
    this.stage.textContent = "";
    this.canvas = element("canvas", { class: "field", "aria-hidden": "true" });
    this.front = element("canvas", {
      class: "front", tabindex: "0", role: "application", "aria-roledescription": "figure to explore",
      "aria-label": `${spec.alt} Keys: arrows move a cross that reads values, Shift and arrows move the body, plus and minus zoom, 0 shows all.`,
    });
    this.stage.append(this.canvas, this.front, this.buttons());
    this.renderer = (location.hash !== "#canvas" && this.tryGl(location.hash === "#webgl")) || makeSoft(this.canvas);
    root.dataset.renderer = this.renderer.kind;
    this.readout = element("output", { class: "readout", "aria-live": "off" });
    this.bar = element("canvas", { class: "bar", role: "img" });
    this.beyondText = element("p", { class: "beyond dim" });
    this.stage.after(this.readout, this.bar, this.beyondText);
    this.stage.before(this.controls());
    this.listen();
  }

  tryGl(any) {
    try {
      return makeGl(this.canvas, any);
    } catch {
      return null;
    }
  }

  controls() {
    const { spec, data } = this;
    this.select = element("select", {}, this.fields.map((f) => option(f, data.fields[f].label)));
    this.select.addEventListener("change", () => this.setField(this.select.value));
    this.kind = element("select", {}, [option("linear", "linear"), option("log", "logarithmic")]);
    this.kind.addEventListener("change", () => this.setScale(this.kind.value));
    this.clip = element("select", {}, [option("", "as set"), ...[0, 0.001, 0.005, 0.01, 0.02, 0.05, 0.1].map((c) => option(c, c ? `${100 * c} % of the area` : "nothing"))]);
    this.clip.addEventListener("change", () => this.clip.value !== "" && this.clipTo(Number(this.clip.value)));
    this.from = element("input", { type: "number", step: "any" });
    this.to = element("input", { type: "number", step: "any" });
    for (const input of [this.from, this.to]) input.addEventListener("change", () => this.setLimits(Number(this.from.value), Number(this.to.value)));
    const bar = element("div", { class: "controls" }, [
      control("field", this.select), control("scale", this.kind), control("leave beyond each end", this.clip),
      control("colors from", this.from), control("to", this.to)]);
    if (spec.most > 0) {
      this.slider = element("input", { type: "range", min: "0", max: "100", step: "1" });
      this.slider.addEventListener("input", () => this.setDeform((this.slider.value / 100) * spec.most));
      this.times = element("output", { class: "times" });
      bar.append(control("displacements", this.slider, this.times));
    }
    const lines = element("input", { type: "checkbox" });
    lines.addEventListener("change", () => ((this.mesh = lines.checked), this.draw()));
    bar.append(control("mesh", lines));
    return bar;
  }

  buttons() {
    const all = [["+", "zoom in", () => this.zoomBy(1.5)], ["−", "zoom out", () => this.zoomBy(1 / 1.5)], ["all", "show the whole body", () => (this.fit(), this.draw())]];
    return element("span", { class: "buttons" }, all.map(([text, label, act]) => {
      const button = element("button", { type: "button", "aria-label": label, title: label }, [text]);
      button.addEventListener("click", act);
      return button;
    }));
  }

  // What is shown.

  setField(id) {
    this.id = id;
    this.field = this.data.fields[id];
    this.select.value = id;
    this.values = fieldValues(this.data, this.field);
    this.flat = this.values.length !== this.points.length / 2;
    const weights = this.flat ? this.areaOf : this.areaAt;
    const counts = this.field.mask && this.leftOut && !this.flat ? (i) => this.leftOut[i] === 0 : () => true;
    this.spread = distribution(this.values, weights, counts);
    if (this.spread.sorted.length === 0) this.spread = distribution(this.values, weights, () => true);
    const { sorted } = this.spread;
    const both = sorted.length > 0 && sorted[0] < 0 && sorted[sorted.length - 1] > 0;
    this.diverging = both;
    this.kind.options[1].disabled = !(sorted.length > 0 && sorted[0] > 0);
    this.kind.value = "linear";
    this.renderer.colors((this.colors = table(both ? this.data.colors.diverging : this.data.colors.linear)));
    this.upload();
    this.limits = firstLimits(this.spread, both, 0.005);
    this.clip.value = "";
    this.setScale("linear");
  }

  setScale(kind) {
    this.scale = makeScale(this.diverging ? "diverging" : kind, ...this.limits);
    this.from.value = Number(this.scale.low.toPrecision(6));
    this.to.value = Number(this.scale.high.toPrecision(6));
    this.draw();
  }

  setLimits(low, high) {
    if (!(high > low)) return this.setScale(this.kind.value);
    this.limits = [low, high];
    this.clip.value = "";
    this.setScale(this.kind.value);
  }

  clipTo(share) {
    let low = quantile(this.spread, share), high = quantile(this.spread, 1 - share);
    if (this.diverging) [low, high] = [-Math.max(Math.abs(low), Math.abs(high)), Math.max(Math.abs(low), Math.abs(high))];
    this.limits = [low, high];
    this.setScale(this.kind.value);
  }

  setDeform(times) {
    this.deform = times;
    this.deformed = this.points;
    if (times !== 0) {
      this.deformed = new Float32Array(this.points.length);
      for (let i = 0; i < this.points.length; ++i) this.deformed[i] = this.points[i] + times * this.u[i];
    }
    this.pick = null;  // made when it is asked
    if (this.slider) {
      this.slider.value = this.spec.most > 0 ? (100 * times) / this.spec.most : 0;
      this.times.value = times === 0 ? "not drawn" : `${format(times, 3)} times`;
      this.slider.setAttribute("aria-valuetext", this.times.value);
    }
    this.draw();
  }

  /** Everything three times over: the corners of a triangle may belong to a value of the triangle alone. */
  upload() {
    const { points, triangles, u, middle, unit, renderer } = this;
    const n = triangles.length;
    if (!this.sent) {
      const place = new Float32Array(2 * n), moved = new Float32Array(2 * n);
      for (let i = 0; i < n; ++i)
        for (let k = 0; k < 2; ++k) {
          place[2 * i + k] = (points[2 * triangles[i] + k] - middle[k]) / unit;
          moved[2 * i + k] = u[2 * triangles[i] + k] / unit;
        }
      renderer.set("place", place);
      renderer.set("moved", moved);
      this.sent = true;
    }
    const value = new Float32Array(n), state = new Float32Array(2 * n);
    const masked = this.field.mask && this.margin;
    for (let t = 0; t < n / 3; ++t) {
      const own = [0, 1, 2].map((k) => this.values[this.flat ? t : triangles[3 * t + k]]);
      const none = own.some((v) => !Number.isFinite(v)) ? 1 : 0;
      for (let k = 0; k < 3; ++k) {
        value[3 * t + k] = none ? 0 : own[k];
        state[2 * (3 * t + k)] = masked ? this.margin[triangles[3 * t + k]] : 1;
        state[2 * (3 * t + k) + 1] = none;
      }
    }
    renderer.set("value", value);
    renderer.set("state", state);
  }

  // The camera: in the units of the body, relative to its middle.

  fit() {
    const { width, height } = this.box();
    const [low, high] = boxOf([...this.deformed, ...(this.data.array("arrows") || [])]);
    const size = [0, 1].map((k) => Math.max(1e-3, (high[k] - low[k]) / this.unit));
    this.center = [0, 1].map((k) => ((low[k] + high[k]) / 2 - this.middle[k]) / this.unit);
    this.whole = 0.84 * Math.min(width / size[0], height / size[1]);
    this.zoom = this.whole;
    this.fitted = [width, height];
  }
  box() {
    return { width: this.stage.clientWidth || 300, height: this.stage.clientHeight || 200 };
  }
  resize() {
    const before = this.zoom / this.whole, center = this.center;
    this.fit();
    this.zoom = this.whole * before;
    if (before !== 1) this.center = center;
    this.draw();
  }
  /** By a factor, about a place of the stage that stays where it is. */
  zoomBy(factor, at) {
    const { width, height } = this.box();
    at = at || [width / 2, height / 2];
    const zoom = Math.min(farthest * this.whole, Math.max(0.5 * this.whole, this.zoom * factor));
    if (zoom === this.zoom) return false;
    const k = 1 / this.zoom - 1 / zoom;
    this.center = [this.center[0] + (at[0] - width / 2) * k, this.center[1] - (at[1] - height / 2) * k];
    this.zoom = zoom;
    this.draw();
    return true;
  }
  pan(dx, dy) {
    this.center = [this.center[0] - dx / this.zoom, this.center[1] + dy / this.zoom];
    this.draw();
  }
  toScreen(x, y) {
    const { width, height } = this.box();
    return [width / 2 + ((x - this.middle[0]) / this.unit - this.center[0]) * this.zoom,
            height / 2 - ((y - this.middle[1]) / this.unit - this.center[1]) * this.zoom];
  }
  toBody(px, py) {
    const { width, height } = this.box();
    return [this.middle[0] + this.unit * (this.center[0] + (px - width / 2) / this.zoom),
            this.middle[1] + this.unit * (this.center[1] - (py - height / 2) / this.zoom)];
  }
  /** Where a place of the body as drawn has gone. */
  moved(x, y) {
    if (this.deform === 0) return [x, y];
    this.pickRest = this.pickRest || makePick(this.points, this.triangles);
    const found = this.pickRest(x, y);
    if (!found) return [x, y];
    const add = (k) => found.corners.reduce((sum, c, i) => sum + found.weights[i] * this.u[2 * c + k], 0);
    return [x + this.deform * add(0), y + this.deform * add(1)];
  }

  // Values.

  /** What there is at a pixel of the stage: of a mark or a corner of the mesh where one is near, else interpolated. */
  at(px, py) {
    for (const mark of this.spec.marks) {
      if (mark.field && mark.field !== this.id) continue;
      const [mx, my] = this.toScreen(...this.moved(mark.x, mark.y));
      if (Math.hypot(mx - px, my - py) > 9) continue;
      const found = this.valueAt(...this.moved(mark.x, mark.y)) || this.valueAt(...this.toBody(px, py));
      if (Number.isFinite(mark.value)) return { ...found, x: mark.x, y: mark.y, value: mark.value, mark };
      if (found) return { ...found, mark };
    }
    return this.valueAt(...this.toBody(px, py), 5 / this.zoom * this.unit);
  }

  valueAt(x, y, reach = 0) {
    this.pick = this.pick || makePick(this.deformed, this.triangles);
    const found = this.pick(x, y);
    if (!found) return null;
    let { corners, weights, triangle } = found;
    for (const c of corners)
      if (Math.hypot(this.deformed[2 * c] - x, this.deformed[2 * c + 1] - y) < reach) [corners, weights] = [[c], [1]];
    const mean = (values) => corners.reduce((sum, c, i) => sum + weights[i] * values[c], 0);
    const out = { corner: corners.length === 1 ? corners[0] : null, triangle };
    out.x = corners.reduce((sum, c, i) => sum + weights[i] * this.points[2 * c], 0);
    out.y = corners.reduce((sum, c, i) => sum + weights[i] * this.points[2 * c + 1], 0);
    out.value = this.flat ? this.values[triangle] : mean(this.values);
    if (this.field.mask) {
      const [lower, upper] = ["lower", "upper"].map((n) => this.data.array(n));
      if (lower && upper) Object.assign(out, { lower: mean(lower), upper: mean(upper) });
      const nearest = corners[weights.indexOf(Math.max(...weights))];
      if (this.margin && mean(this.margin) < 0)
        out.masked = { distance: mean(this.margin) + this.data.mask.clear, near: this.data.mask.near[this.near ? this.near[nearest] : 0], second: this.near && this.near[nearest] === 5 };
      out.singular = this.leftOut && this.leftOut[nearest] === 2;
    }
    return out;
  }

  show(found) {
    this.found = found;
    const { readout, data, field } = this;
    delete readout.dataset.x;
    if (!found) return void (readout.value = "Point at the body, or use the arrow keys, to read values.");
    const length = data.units.length ? ` ${data.units.length}` : "", unit = field.unit ? ` ${field.unit}` : "";
    let text = `x ${format(found.x, 7)}, y ${format(found.y, 7)}${length}: `;
    text += Number.isFinite(found.value) ? `${field.symbol || field.label} = ${format(found.value, 7)}${unit}` : "no value";
    if (Number.isFinite(found.lower) && Number.isFinite(found.upper)) text += `, error bar ${format(found.lower, 5)} to ${format(found.upper, 5)}`;
    if (found.mark) text += `; ${found.mark.text}`;
    if (found.masked?.second) text += `; masked: ${found.masked.near} is more than 5 % of the first at radius ${format(data.mask.clear / data.mask.radii, 3)}`;
    else if (found.masked) text += `; masked: ${format(Math.max(0, found.masked.distance), 3)} from ${found.masked.near}, nearer than ${data.mask.radii} radii (${format(data.mask.clear, 3)})`;
    else if (found.singular) text += "; near a singular point: left out of least and largest";
    readout.value = text;
    Object.assign(readout.dataset, { x: found.x, y: found.y, value: found.value, corner: found.corner ?? "" });
  }

  // Pointers, wheel, keys.

  listen() {
    const { front } = this;
    const pointers = new Map();
    const place = (e) => {
      const r = front.getBoundingClientRect();
      return [e.clientX - r.left, e.clientY - r.top];
    };
    front.addEventListener("pointerdown", (e) => {
      pointers.set(e.pointerId, place(e));
      front.setPointerCapture(e.pointerId);
    });
    for (const end of ["pointerup", "pointercancel"]) front.addEventListener(end, (e) => pointers.delete(e.pointerId));
    front.addEventListener("pointerleave", () => (pointers.size === 0 && !this.cross ? (this.show(null), this.drawFront()) : 0));
    front.addEventListener("pointermove", (e) => {
      const now = place(e), before = pointers.get(e.pointerId);
      if (before && pointers.size === 1) this.pan(now[0] - before[0], now[1] - before[1]);
      if (before && pointers.size === 2) {
        const other = [...pointers.entries()].find(([id]) => id !== e.pointerId)[1];
        const spread = (p) => Math.max(1, Math.hypot(p[0] - other[0], p[1] - other[1]));
        this.zoomBy(spread(now) / spread(before), [(now[0] + other[0]) / 2, (now[1] + other[1]) / 2]);
        this.pan((now[0] - before[0]) / 2, (now[1] - before[1]) / 2);
      }
      if (before) pointers.set(e.pointerId, now);
      this.cross = null;
      this.show(this.at(...now));
      this.drawFront();
    });
    front.addEventListener("wheel", (e) => {
      if (this.zoomBy(Math.exp(-0.0015 * Math.max(-300, Math.min(300, e.deltaY * (e.deltaMode ? 30 : 1)))), place(e))) e.preventDefault();
    }, { passive: false });
    front.addEventListener("dblclick", (e) => this.zoomBy(2, place(e)));
    front.addEventListener("keydown", (e) => this.key(e));
    this.show(null);
  }

  key(e) {
    const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[e.key];
    if (step && !e.ctrlKey && !e.altKey) {
      if (e.shiftKey) {
        this.pan(-40 * step[0], -40 * step[1]);
      } else {
        const { width, height } = this.box();
        const c = this.cross || [width / 2, height / 2];
        this.cross = [Math.min(width - 1, Math.max(0, c[0] + 10 * step[0])), Math.min(height - 1, Math.max(0, c[1] + 10 * step[1]))];
      }
    } else if (e.key === "+" || e.key === "=") this.zoomBy(1.4, this.cross);
    else if (e.key === "-") this.zoomBy(1 / 1.4, this.cross);
    else if (e.key === "0" || e.key === "Home") (this.fit(), this.draw());
    else if (e.key === "Escape") this.cross = null;
    else return;
    e.preventDefault();
    this.readout.setAttribute("aria-live", "polite");
    this.show(this.cross ? this.at(...this.cross) : null);
    this.drawFront();
  }

  // Drawing, at most once per frame.

  draw() {
    if (this.waiting || !this.scale || !this.zoom) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.drawNow();
    });
  }

  drawNow() {
    const { width, height } = this.box(), pixel = this.renderer.pixelRatio();
    const { canvas } = this;
    if (width !== this.fitted[0] || height !== this.fitted[1]) this.resize();
    if (canvas.width !== Math.round(width * pixel) || canvas.height !== Math.round(height * pixel)) {
      canvas.width = Math.round(width * pixel);
      canvas.height = Math.round(height * pixel);
    }
    const colors = theme(this.root);
    this.renderer.draw({ center: this.center, zoom: this.zoom, deform: this.deform, scale: this.scale, lines: this.mesh, paper: colors.paperRgb, ink: colors.inkRgb });
    this.drawFront();
    drawBar(this.bar, { scale: this.scale, colors: this.colors, field: this.field, theme: colors });
    const { below, above } = beyond(this.spread, this.scale.low * (1 - 1e-12), this.scale.high);
    this.sayBeyond(below, above);
    this.root.dataset.drawn = String(Number(this.root.dataset.drawn || 0) + 1);
    this.front.style.touchAction = this.zoom > 1.01 * this.whole ? "none" : "pan-y";
  }

  sayBeyond(below, above) {
    const { sorted } = this.spread, percent = (share) => `${format(100 * share, 2)} %`;
    const parts = [];
    if (sorted.length === 0) parts.push("There are no values to draw.");
    else {
      parts.push(`Values from ${format(sorted[0])} to ${format(sorted[sorted.length - 1])}.`);
      if (below > 0) parts.push(`${percent(below)} of the area lies below the colors (dotted).`);
      if (above > 0) parts.push(`${percent(above)} of the area lies above the colors (dotted).`);
    }
    this.beyondText.textContent = parts.join(" ");
  }

  drawFront() {
    drawOverlay(this.front, this, theme(this.root));
  }
}
