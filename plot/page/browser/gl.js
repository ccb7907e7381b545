// Triangles with a value at each corner, drawn by WebGL2. The camera looks at `center` with `zoom` pixels per unit.

const vertexShader = `#version 300 es
layout(location = 0) in vec2 place;
layout(location = 1) in vec2 moved;
layout(location = 2) in float value;
layout(location = 3) in vec2 state;  // margin of the mask, 1 where there is no value
uniform vec2 center, size;
uniform float zoom, deform;
out float v;
out vec2 s;
out vec3 corner;
void main() {
  gl_Position = vec4((place + deform * moved - center) * zoom * 2.0 / size, 0.0, 1.0);
  v = value;
  s = state;
  int k = gl_VertexID % 3;
  corner = vec3(k == 0, k == 1, k == 2);
}`;

const fragmentShader = `#version 300 es
precision highp float;
in float v;
in vec2 s;
in vec3 corner;
uniform sampler2D colors;
uniform float from, to, pixel;
uniform bool logarithmic, lines;
uniform vec3 paper, ink;
out vec4 color;
void main() {
  float t = ((logarithmic ? log(max(v, 1e-37)) : v) - from) / (to - from);
  vec3 c = texture(colors, vec2((clamp(t, 0.0, 1.0) * 255.0 + 0.5) / 256.0, 0.5)).rgb;
  vec2 at = gl_FragCoord.xy / pixel;
  if (t < -1e-4 || t > 1.0001) {  // beyond the ends of the scale: dots
    vec2 d = mod(at, 7.0) - 3.5;
    float light = dot(c, vec3(0.3, 0.59, 0.11));
    c = mix(c, light > 0.5 ? vec3(0.0) : vec3(1.0), 0.75 * (1.0 - smoothstep(0.9, 1.5, length(d))));
  }
  if (s.x < 0.0 || s.y > 0.0) {  // masked, or no value: hatched
    vec3 under = s.y > 0.0 ? paper : mix(c, paper, 0.72);
    float d = abs(mod(at.x + at.y, 8.0) - 4.0);
    c = mix(under, ink, 0.6 * (1.0 - smoothstep(0.45, 1.1, d)));
  }
  if (lines) {
    vec3 w = fwidth(corner);
    vec3 edge = smoothstep(vec3(0.0), w * 1.1, corner);
    c = mix(ink, c, 0.72 + 0.28 * min(min(edge.x, edge.y), edge.z));
  }
  color = vec4(c, 1.0);
}`;

function compile(gl, type, source) {
  const shader = gl.createShader(type);
  gl.shaderSource(shader, source);
  gl.compileShader(shader);
  if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
  return shader;
}

/** Whether WebGL2 is there and no imitation on the processor, which copies every picture back and says so. */
function hasGpu() {
  const gl = document.createElement("canvas").getContext("webgl2", { failIfMajorPerformanceCaveat: true });
  if (!gl) return false;
  const names = gl.getExtension("WEBGL_debug_renderer_info");
  const name = names ? gl.getParameter(names.UNMASKED_RENDERER_WEBGL) : gl.getParameter(gl.RENDERER);
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  return !/swiftshader|llvmpipe|software|basic render/i.test(String(name));
}

/** null where the browser has no WebGL2 on a GPU; `any`: an imitation will do. */
export function makeGl(canvas, any) {
  if (!any && !hasGpu()) return null;
  // Kept for printing and pictures of the page.
  const gl = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true, alpha: true });
  if (!gl) return null;
  const program = gl.createProgram();
  gl.attachShader(program, compile(gl, gl.VERTEX_SHADER, vertexShader));
  gl.attachShader(program, compile(gl, gl.FRAGMENT_SHADER, fragmentShader));
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) return null;
  gl.useProgram(program);
  const at = (name) => gl.getUniformLocation(program, name);
  const uniform = Object.fromEntries(
    ["center", "size", "zoom", "deform", "from", "to", "pixel", "logarithmic", "lines", "paper", "ink"].map((n) => [n, at(n)]));
  const buffers = [2, 2, 1, 2].map((width, location) => {
    const buffer = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.enableVertexAttribArray(location);
    gl.vertexAttribPointer(location, width, gl.FLOAT, false, 0, 0);
    return buffer;
  });
  const texture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, texture);
  for (const side of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, side, gl.CLAMP_TO_EDGE);
  for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, filter, gl.NEAREST);
  let count = 0;

  return {
    kind: "webgl",
    pixelRatio: () => Math.min(window.devicePixelRatio || 1, 2),
    /** place, moved: 2 per corner; value: 1; state: 2 (margin, none). Three corners after another are a triangle. */
    set(which, values) {
      const location = ["place", "moved", "value", "state"].indexOf(which);
      gl.bindBuffer(gl.ARRAY_BUFFER, buffers[location]);
      gl.bufferData(gl.ARRAY_BUFFER, values, gl.STATIC_DRAW);
      if (location === 0) count = values.length / 2;
    },
    colors(bytes) {
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, 256, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
    },
    draw({ center, zoom, deform, scale, lines, paper, ink }) {
      const pixel = this.pixelRatio();
      gl.viewport(0, 0, canvas.width, canvas.height);
      gl.clearColor(0, 0, 0, 0);
      gl.clear(gl.COLOR_BUFFER_BIT);
      gl.uniform2f(uniform.center, center[0], center[1]);
      gl.uniform2f(uniform.size, canvas.width, canvas.height);
      gl.uniform1f(uniform.zoom, zoom * pixel);
      gl.uniform1f(uniform.deform, deform);
      gl.uniform1f(uniform.from, scale.from);
      gl.uniform1f(uniform.to, scale.to);
      gl.uniform1f(uniform.pixel, pixel);
      gl.uniform1i(uniform.logarithmic, scale.log);
      gl.uniform1i(uniform.lines, lines);
      gl.uniform3fv(uniform.paper, paper);
      gl.uniform3fv(uniform.ink, ink);
      gl.drawArrays(gl.TRIANGLES, 0, count);
    },
  };
}
