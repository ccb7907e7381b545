// What the page carries: a JSON header, and arrays in base64, little-endian.

const types = { f32: Float32Array, u32: Uint32Array, u16: Uint16Array, u8: Uint8Array };

/** The typed array of a base64 text. */
export function decode(text, type) {
  const raw = atob(text.trim());
  const bytes = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; ++i) bytes[i] = raw.charCodeAt(i);
  return new types[type](bytes.buffer);
}

/** The header, and a function that gives the array of a name, or null; each is decoded when it is first asked for. */
export function load(root) {
  const header = root.getElementById("kerf-data");
  if (!header) return null;
  const known = new Map();
  const array = (name) => {
    if (!known.has(name)) {
      const element = root.querySelector(`script[data-array="${CSS.escape(name)}"]`);
      known.set(name, element ? decode(element.textContent, element.dataset.type) : null);
    }
    return known.get(name);
  };
  return { ...JSON.parse(header.textContent), array };
}

/** Values of a field at the corners, or of triangles (perTriangle). What is not in the file is computed from it. */
export function fieldValues(data, field) {
  const source = data.array(field.array);
  if (!source) return null;
  const width = field.width || 1, n = source.length / width;
  const out = new Float32Array(n);
  for (let i = 0; i < n; ++i) out[i] = reduce[field.kind || "component"](source, i * width, field.component || 0);
  return out;
}

const principal = (s, at, sign) => {
  const middle = 0.5 * (s[at] + s[at + 1]);
  return middle + sign * Math.hypot(0.5 * (s[at] - s[at + 1]), s[at + 2]);
};
const reduce = {
  component: (s, at, k) => s[at + k],
  length: (s, at) => Math.hypot(s[at], s[at + 1]),
  first: (s, at) => principal(s, at, 1),
  second: (s, at) => principal(s, at, -1),
};
