// The same triangles without WebGL2: filled one by one into the pixels of a canvas.

export function makeSoft(canvas) {
  const context = canvas.getContext("2d");
  const data = { place: new Float32Array(), moved: new Float32Array(), value: new Float32Array(), state: new Float32Array() };
  let table = new Uint8Array(1024);

  /** The color of a value at a pixel, as gl.js has it. */
  function shade(out, o, v, margin, none, x, y, { scale, paper, ink }) {
    const t = scale.at(v);
    const k = 4 * Math.round(255 * Math.min(1, Math.max(0, t)));
    let c = [table[k] / 255, table[k + 1] / 255, table[k + 2] / 255];
    if ((t < -1e-4 || t > 1.0001) && x % 7 < 2 && y % 7 < 2) {
      const light = 0.3 * c[0] + 0.59 * c[1] + 0.11 * c[2] > 0.5 ? 0 : 1;
      c = c.map((a) => 0.25 * a + 0.75 * light);
    }
    if (margin < 0 || none > 0) {
      c = none > 0 ? paper : c.map((a, i) => 0.28 * a + 0.72 * paper[i]);
      if ((((x - y) % 8) + 8) % 8 < 1) c = c.map((a, i) => 0.4 * a + 0.6 * ink[i]);
    }
    for (let i = 0; i < 3; ++i) out[o + i] = 255 * c[i];
    out[o + 3] = 255;
  }

  return {
    kind: "canvas",
    pixelRatio: () => 1,
    set: (which, values) => (data[which] = values),
    colors: (bytes) => (table = bytes),
    draw(view) {
      const { width, height } = canvas;
      const image = context.createImageData(width, height);
      const n = data.place.length / 6;
      const x = [0, 0, 0], y = [0, 0, 0];
      for (let t = 0; t < n; ++t) {
        for (let k = 0; k < 3; ++k) {
          const i = 6 * t + 2 * k;
          x[k] = width / 2 + (data.place[i] + view.deform * data.moved[i] - view.center[0]) * view.zoom;
          y[k] = height / 2 - (data.place[i + 1] + view.deform * data.moved[i + 1] - view.center[1]) * view.zoom;
        }
        const twice = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
        if (!(Math.abs(twice) > 0)) continue;
        const top = Math.max(0, Math.floor(Math.min(...y))), bottom = Math.min(height - 1, Math.ceil(Math.max(...y)));
        const left = Math.max(0, Math.floor(Math.min(...x))), right = Math.min(width - 1, Math.ceil(Math.max(...x)));
        for (let row = top; row <= bottom; ++row)
          for (let column = left; column <= right; ++column) {
            const px = column + 0.5, py = row + 0.5;
            const a = ((x[1] - px) * (y[2] - py) - (x[2] - px) * (y[1] - py)) / twice;
            const b = ((x[2] - px) * (y[0] - py) - (x[0] - px) * (y[2] - py)) / twice;
            const c = 1 - a - b;
            if (a < -1e-3 || b < -1e-3 || c < -1e-3) continue;
            const at = (values, width, k) =>
              a * values[3 * width * t + k] + b * values[3 * width * t + width + k] + c * values[3 * width * t + 2 * width + k];
            shade(image.data, 4 * (row * width + column), at(data.value, 1, 0), at(data.state, 2, 0), data.state[6 * t + 1],
                  column, row, view);
          }
      }
      context.putImageData(image, 0, 0);
    },
  };
}
