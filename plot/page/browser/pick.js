// Which triangle a point lies in: triangles listed in the cells of a grid.

/** points: 2 per corner; triangles: 3 corners each. */
export function makePick(points, triangles) {
  let low = [Infinity, Infinity], high = [-Infinity, -Infinity];
  for (let i = 0; i < points.length; i += 2)
    for (let k = 0; k < 2; ++k) {
      low[k] = Math.min(low[k], points[i + k]);
      high[k] = Math.max(high[k], points[i + k]);
    }
  const count = triangles.length / 3;
  const across = Math.max(1, Math.min(400, Math.round(Math.sqrt(count / 2))));
  const cell = Math.max(high[0] - low[0], high[1] - low[1]) / across || 1;
  const columns = Math.floor((high[0] - low[0]) / cell) + 1, rows = Math.floor((high[1] - low[1]) / cell) + 1;
  const column = (x) => Math.min(columns - 1, Math.max(0, Math.floor((x - low[0]) / cell)));
  const row = (y) => Math.min(rows - 1, Math.max(0, Math.floor((y - low[1]) / cell)));
  const lists = new Map();
  for (let t = 0; t < count; ++t) {
    const x = [0, 1, 2].map((k) => points[2 * triangles[3 * t + k]]);
    const y = [0, 1, 2].map((k) => points[2 * triangles[3 * t + k] + 1]);
    for (let i = column(Math.min(...x)); i <= column(Math.max(...x)); ++i)
      for (let j = row(Math.min(...y)); j <= row(Math.max(...y)); ++j) {
        const at = j * columns + i;
        const list = lists.get(at);
        if (list) list.push(t);
        else lists.set(at, [t]);
      }
  }

  /** { triangle, corners, weights }, or null outside. */
  return (x, y) => {
    if (!(x >= low[0] && x <= high[0] && y >= low[1] && y <= high[1])) return null;
    for (const t of lists.get(row(y) * columns + column(x)) || []) {
      const c = [0, 1, 2].map((k) => triangles[3 * t + k]);
      const [ax, ay, bx, by, cx, cy] = c.flatMap((i) => [points[2 * i], points[2 * i + 1]]);
      const twice = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay);
      const wa = ((bx - x) * (cy - y) - (cx - x) * (by - y)) / twice;
      const wb = ((cx - x) * (ay - y) - (ax - x) * (cy - y)) / twice;
      const weights = [wa, wb, 1 - wa - wb];
      if (Math.min(...weights) >= -1e-6) return { triangle: t, corners: c, weights };
    }
    return null;
  };
}
