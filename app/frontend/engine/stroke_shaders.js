// How lines and points are drawn on the card (strokes.js): as shaded strokes of two triangles
// each, or plainly. Pictures are drawn by the same rules (viewers/strokes.py).

const HAZE = 0.35  // share of the background in the colour of the farthest points

const PLACED = `
  uniform highp sampler2D places;
  uniform highp usampler2D cells;
  uniform int every;
  uniform mat4 seen;
  uniform vec2 depths;
  vec3 place(int i) { return texelFetch(places, ivec2(i % 2048, i / 2048), 0).xyz; }
  uvec2 ends_(int i) { return texelFetch(cells, ivec2(i % 2048, i / 2048), 0).xy; }
  float hazy(float depth) {
    return ${HAZE} * clamp((depth - depths.x) / max(depths.y - depths.x, 1e-9), 0.0, 1.0);
  }`

// Of the four corners of each, bit 0 tells along and bit 1 aside.
const WIDE = `
  uniform vec2 size;
  uniform float pixels, unit, thick, scale, dash;
  out float fade, gap;
  int which() { return gl_VertexID / 4 * every; }
  int corner() { return gl_VertexID % 4; }
  float reach(float w) {
    float spaced = thick * scale / w, thin = 0.5 * unit;
    fade = thick > 0.0 ? clamp(spaced / thin, 0.5, 1.0) : 1.0;
    gap = dash * scale / w > 3.0 * unit ? 0.55 : 2.0;
    return thick > 0.0 ? clamp(spaced, thin, 6.0 * pixels) : 0.5 * pixels + thin;
  }
  // A stroke in a surface is seen: it is as near as the front of that surface.
  void lift(vec3 centre, float wide) {
    vec3 ahead = vec3(seen[0][3], seen[1][3], seen[2][3]);
    vec4 front = seen * vec4(centre - wide * gl_Position.w / scale * ahead, 1.0);
    gl_Position.z = front.z / front.w * gl_Position.w;
  }`

const FETCHED = "texelFetch(points, ivec2(i % 2048, i / 2048), 0)"
const VALUES = {"colors": `${FETCHED}.rgb`, "values": `vec3(${FETCHED}.r)`, "": "vec3(0.0)"}
const COLOURED = (by) => `uniform highp sampler2D points;
  vec3 valueOf(int i) { return ${VALUES[by]}; }`

const HEAD = (by) => `#version 300 es
  precision highp float; precision highp int;
  ${PLACED}
  ${COLOURED(by)}`

const LINE = (by) => `${HEAD(by)}
  ${WIDE}
  out vec3 shown, at; out vec2 across; out float along, away;
  void main() {
    uvec2 ends = ends_(which());
    int k = corner();
    float end = float(k & 1), side = float(k >> 1) * 2.0 - 1.0;
    vec3 a = place(int(ends.x)), b = place(int(ends.y));
    vec4 p = seen * vec4(a, 1.0), q = seen * vec4(b, 1.0);
    float least = 1e-3 * max(abs(p.w), abs(q.w)) + 1e-6;
    float from = p.w < least && q.w > p.w ? (least - p.w) / (q.w - p.w) : 0.0;
    float to = q.w < least && p.w > q.w ? (p.w - least) / (p.w - q.w) : 1.0;
    float t = end < 0.5 ? from : to;
    vec4 start = mix(p, q, from), stop = mix(p, q, to);
    gl_Position = mix(p, q, t);
    vec2 run = (stop.xy / stop.w - start.xy / start.w) * size * 0.5;
    float far = length(run);
    vec2 way = far > 1e-4 ? run / far : vec2(1.0, 0.0);
    float wide = reach(gl_Position.w);
    vec2 aside = (vec2(-way.y, way.x) * side + way * (2.0 * end - 1.0) * 0.3) * wide;
    gl_Position.xy += aside / size * 2.0 * gl_Position.w;
    at = mix(a, b, t);
    if (dash == 0.0) { lift(at, wide); }
    shown = mix(valueOf(int(ends.x)), valueOf(int(ends.y)), t);
    along = length(b - a) * t; across = vec2(side, 0.0); away = hazy(gl_Position.w);
  }`

// A line of one pixel, for a machine that draws in software while something changes.
const PLAIN = (by) => `${HEAD(by)}
  out vec3 shown, at; out float away;
  void main() {
    uvec2 ends = ends_(gl_VertexID / 2 * every);
    int i = int(gl_VertexID % 2 == 0 ? ends.x : ends.y);
    at = place(i);
    gl_Position = seen * vec4(at, 1.0);
    shown = valueOf(i); away = hazy(gl_Position.w);
  }`

const POINT = (by) => `${HEAD(by)}
  ${WIDE}
  out vec3 shown, at; out vec2 across; out float along, away;
  void main() {
    int ends = int(ends_(which()).x), k = corner();
    across = vec2(k & 1, k >> 1) * 2.0 - 1.0;
    at = place(ends);
    gl_Position = seen * vec4(at, 1.0);
    away = hazy(gl_Position.w);
    float wide = reach(gl_Position.w);
    gl_Position.xy += across * wide / size * 2.0 * gl_Position.w;
    lift(at, wide);
    shown = valueOf(ends); along = 0.0;
  }`

const FORMS = {
  round: `float rim = length(across); if (rim > 1.0) { discard; }
    float light = sqrt(1.0 - rim * rim);`,
  square: "float rim = max(abs(across.x), abs(across.y)); float light = rim > 0.68 ? 0.25 : 1.0;",
  triangle: `float rim = max(-across.y * 1.25 - 0.1, abs(across.x) * 1.25 + across.y * 0.62);
    if (rim > 0.72) { discard; } float light = rim > 0.5 ? 0.25 : 1.0;`,
}

// How light a stroke is where. What throws nothing away is seldom drawn where something hides it.
const LIGHT = {
  plain: () => "const float light = 0.7;",
  lines: ({dashed}) => `${dashed ? "if (fract(along / dash) > gap) { discard; }" : ""}
    float light = sqrt(max(1.0 - across.x * across.x, 0.0));`,
  points: ({form}) => FORMS[form],
}

const OPENED = `
    for (int i = 0; i < 2; i++) {
      if (i < cuts && dot(planes[i].xyz, at) + planes[i].w < 0.0) { discard; }
    }`

// The colour of a stroke by values, beyond the front grey, by colours of its points, or one of all.
const OWN = {
  "values": `shown.x > colourFront ? vec3(0.79, 0.81, 0.84)
      : texture(colourTable, vec2((clamp((shown.x - colourRange.x) / colourRange.y, 0.0, 1.0)
        * (colourRange.z - 1.0) + 0.5) / colourRange.z, 0.5)).rgb`,
  "colors": "shown", "": "color",
}

const FRAGMENT = (kind, {by, opened, ...how}) => `#version 300 es
  precision highp float;
  uniform vec4 planes[2];
  uniform int cuts;
  uniform vec3 color, haze, colourRange;
  uniform float opacity, dash, colourFront;
  uniform highp sampler2D colourTable;
  in vec3 shown, at; in float away;
  ${kind === "plain" ? "const float fade = 1.0;" : "in vec2 across; in float along, fade, gap;"}
  out vec4 painted;
  void main() {
    ${opened ? OPENED : ""}
    ${LIGHT[kind](how)}
    vec3 own = ${OWN[by]};
    painted = vec4(mix(haze, mix(own * (0.62 + 0.38 * light), haze, away), fade), opacity);
  }`

const VERTEX = {lines: LINE, plain: PLAIN, points: POINT}

// `how`: what the colours are `by`, whether a cut has `opened` it, whether lines are `dashed`, and
// the `form` of points.
export function strokeProgram(gl, kind, how) {
  return new Program(gl, VERTEX[kind](how.by), FRAGMENT(kind, how))
}

// A program with the names that `Colours` knows from vtk.js.
class Program {
  constructor(gl, vertex, fragment) {
    this.gl = gl
    this.made = gl.createProgram()
    for (const [type, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(type)
      gl.shaderSource(shader, text)
      gl.compileShader(shader)
      gl.attachShader(this.made, shader)
      gl.deleteShader(shader)
    }
    gl.linkProgram(this.made)
    if (!gl.getProgramParameter(this.made, gl.LINK_STATUS)) {
      throw new Error(`lines cannot be drawn: ${gl.getProgramInfoLog(this.made)}`)
    }
    this.known = new Map()
  }

  at(name) {
    if (!this.known.has(name)) { this.known.set(name, this.gl.getUniformLocation(this.made, name)) }
    return this.known.get(name)
  }

  isUniformUsed(name) { return this.at(name) !== null }
  setUniformi(name, value) { this.gl.uniform1i(this.at(name), value) }
  setUniformf(name, value) { this.gl.uniform1f(this.at(name), value) }
  setUniform3fArray(name, value) { this.gl.uniform3fv(this.at(name), value) }
}
