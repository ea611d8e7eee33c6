// Lines and points of a fixed width on the screen, thicker from near: lines as shaded tubes,
// points as balls, squares or triangles. The card fetches the ends of each from a texture, and makes
// its two triangles itself: vtk.js knows lines of one pixel, and copies their corners. (Not by
// instances: software that stands in for a card draws each of them by itself.)

import {Colours, PointTexture} from "./colour.js"

const PLACE_UNIT = 12
const ENDS_UNIT = 11
const CORNERS = 6  // of two triangles
const HAZE = 0.55  // how much of the background lies over what is farthest

const PLACED = `
  uniform highp sampler2D places;
  uniform highp usampler2D cells;
  uniform int every;
  uniform mat4 seen;
  uniform vec2 size;
  uniform float pixels, thick, scale;
  vec3 place(int i) { return texelFetch(places, ivec2(i % 2048, i / 2048), 0).xyz; }
  int which() { return gl_VertexID / 6 * every; }
  // Two triangles: corners 0 1 2 and 2 1 3, bit 0 along, bit 1 aside.
  int corner() { int k = gl_VertexID % 6; return k < 3 ? k : k == 3 ? 2 : k == 4 ? 1 : 3; }
  uvec2 ends_() { int i = which(); return texelFetch(cells, ivec2(i % 2048, i / 2048), 0).xy; }
  float reach(float w) { return clamp(thick * scale / w, 0.5 * pixels, 6.0 * pixels); }`

const COLOURED = (by) => by === "colors"
  ? "uniform highp sampler2D points;\nvec3 told(int i) { return texelFetch(points, ivec2(i % 2048, i / 2048), 0).rgb; }"
  : by === "values"
    ? "uniform highp sampler2D points;\nvec3 told(int i) { return vec3(texelFetch(points, ivec2(i % 2048, i / 2048), 0).r); }"
    : "vec3 told(int i) { return vec3(0.0); }"

const LINE = (by) => `#version 300 es
  precision highp float; precision highp int;
  ${PLACED}
  ${COLOURED(by)}
  out vec3 shown, at; out vec2 across; out float along, depth;
  void main() {
    uvec2 ends = ends_();
    int k = corner();
    float end = float(k & 1), side = float(k >> 1) * 2.0 - 1.0;
    vec3 a = place(int(ends.x)), b = place(int(ends.y));
    vec4 p = seen * vec4(a, 1.0), q = seen * vec4(b, 1.0);
    float least = 1e-3 * max(abs(p.w), abs(q.w)) + 1e-6;
    float from = p.w < least && q.w > p.w ? (least - p.w) / (q.w - p.w) : 0.0;
    float to = q.w < least && p.w > q.w ? (p.w - least) / (p.w - q.w) : 1.0;
    float t = end < 0.5 ? from : to;
    vec4 here = mix(p, q, t), start = mix(p, q, from), stop = mix(p, q, to);
    vec2 run = (stop.xy / stop.w - start.xy / start.w) * size * 0.5;
    float far = length(run);
    vec2 way = far > 1e-4 ? run / far : vec2(1.0, 0.0);
    float half_ = reach(here.w) + 0.5;
    vec2 shift = (vec2(-way.y, way.x) * side + way * (2.0 * end - 1.0) * 0.3) * half_;
    here.xy += shift / size * 2.0 * here.w;
    gl_Position = here;
    shown = mix(told(int(ends.x)), told(int(ends.y)), t);
    at = mix(a, b, t); along = length(b - a) * t; across = vec2(side, half_); depth = here.w;
  }`

const POINT = (by) => `#version 300 es
  precision highp float; precision highp int;
  ${PLACED}
  ${COLOURED(by)}
  out vec3 shown, at; out vec2 across; out float along, depth;
  void main() {
    int ends = int(ends_().x), k = corner();
    vec2 aside = vec2(k & 1, k >> 1) * 2.0 - 1.0;
    at = place(ends);
    gl_Position = seen * vec4(at, 1.0);
    depth = gl_Position.w;
    gl_Position.xy += aside * (reach(depth) + 0.5) / size * 2.0 * depth;
    gl_Position.z -= 2e-4 * depth;
    shown = told(ends); across = aside; along = 0.0;
  }`

const FORMS = {
  round: "float rim = length(across); if (rim > 1.0) { discard; } float light = sqrt(1.0 - rim * rim);",
  square: "float rim = max(abs(across.x), abs(across.y)); float light = rim > 0.68 ? 0.25 : 1.0;",
  triangle: `float rim = max(-across.y * 1.25 - 0.1, abs(across.x) * 1.25 + across.y * 0.62);
    if (rim > 0.72) { discard; } float light = rim > 0.5 ? 0.25 : 1.0;`,
}

const FRAGMENT = (kind, by, form) => `#version 300 es
  precision highp float;
  uniform vec4 planes[2];
  uniform int cuts;
  uniform vec3 color, haze, colourRange;
  uniform vec2 depths;
  uniform float opacity, dash, colourFront;
  uniform highp sampler2D colourTable;
  in vec3 shown, at; in vec2 across; in float along, depth;
  out vec4 painted;
  void main() {
    for (int i = 0; i < 2; i++) {
      if (i < cuts && dot(planes[i].xyz, at) + planes[i].w < 0.0) { discard; }
    }
    ${kind === "lines" ? `
    if (dash > 0.0 && fract(along / dash) > 0.55) { discard; }
    float rim = abs(across.x);
    float light = sqrt(max(1.0 - rim * rim, 0.0));` : FORMS[form]}
    vec3 own = ${by === "colors" ? "shown" : by === "values" ? `shown.x > colourFront ? vec3(0.79, 0.81, 0.84)
      : texture(colourTable, vec2((clamp((shown.x - colourRange.x) / colourRange.y, 0.0, 1.0)
        * (colourRange.z - 1.0) + 0.5) / colourRange.z, 0.5)).rgb` : "color"};
    own *= 0.62 + 0.38 * light;
    float away = clamp((depth - depths.x) / max(depths.y - depths.x, 1e-9), 0.0, 1.0);
    painted = vec4(mix(own, haze, ${HAZE} * away), opacity);
  }`

export class Strokes {
  constructor(renderer, kind) {
    Object.assign(this, {renderer, kind, gl: renderer.context, form: "round"})
    this.colours = new Colours(this.gl)
    this.places = new PointTexture(this.gl, PLACE_UNIT)
    this.programs = new Map()
    this.array = this.gl.createVertexArray()
    this.cells = new PointTexture(this.gl, ENDS_UNIT)
    this.count = 0
  }

  setPoints(points) {
    const {gl} = this
    this.places.put(points, gl.RGB32F, gl.RGB, gl.FLOAT, 3)
  }

  setCells(cells) {
    const {gl} = this
    this.each = this.kind === "lines" ? 2 : 1
    this.count = cells.length / this.each
    const [inside, format] = this.each === 2 ? [gl.RG32UI, gl.RG_INTEGER] : [gl.R32UI, gl.RED_INTEGER]
    this.cells.put(cells, inside, format, gl.UNSIGNED_INT, this.each)
  }

  program(by) {
    const name = `${by} ${this.form}`
    if (!this.programs.has(name)) {
      const vertex = this.kind === "lines" ? LINE(by) : POINT(by)
      this.programs.set(name, new Program(this.gl, vertex, FRAGMENT(this.kind, by, this.form)))
    }
    return this.programs.get(name)
  }

  // Draws all, or every nth, where vtk.js is about to draw; leaves the card as it was.
  draw({color, opacity, width, thick, dash, coloured, cut, slab, every}) {
    const {gl, renderer} = this
    if (!this.count) { return }
    const [, , wide, high] = gl.getParameter(gl.VIEWPORT)
    const before = {
      program: gl.getParameter(gl.CURRENT_PROGRAM), array: gl.getParameter(gl.VERTEX_ARRAY_BINDING),
      blend: gl.isEnabled(gl.BLEND),
      cull: gl.isEnabled(gl.CULL_FACE), mask: gl.getParameter(gl.DEPTH_WRITEMASK),
    }
    const by = coloured ? this.colours.by : ""
    const program = this.program(by)
    gl.useProgram(program.made)
    gl.bindVertexArray(this.array)
    gl.disable(gl.CULL_FACE)
    gl.depthMask(opacity === 1)
    if (opacity < 1) {
      gl.enable(gl.BLEND)
      gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE_MINUS_SRC_ALPHA)
    } else {
      gl.disable(gl.BLEND)
    }
    this.places.bind()
    program.setUniformi("places", PLACE_UNIT)
    this.cells.bind()
    program.setUniformi("cells", ENDS_UNIT)
    program.setUniformi("every", every)
    const {camera} = renderer
    const m = camera.getCompositeProjectionMatrix(wide / high, -1, 1)
    gl.uniformMatrix4fv(program.at("seen"), true, Float32Array.from(m))
    const ratio = renderer.size[0] / Math.max(renderer.element.clientWidth, 1)
    gl.uniform2f(program.at("size"), wide, high)
    gl.uniform1f(program.at("pixels"), width * ratio)
    gl.uniform1f(program.at("thick"), thick)
    gl.uniform1f(program.at("scale"), high / (2 * Math.tan(camera.getViewAngle() * Math.PI / 360)))
    gl.uniform1f(program.at("opacity"), opacity)
    gl.uniform1f(program.at("dash"), dash)
    gl.uniform3f(program.at("color"), ...color)
    gl.uniform3f(program.at("haze"), ...renderer.haze)
    gl.uniform2f(program.at("depths"), ...renderer.nearAndFar)
    const planes = cut ? cutPlanes(cut, slab) : []
    gl.uniform1i(program.at("cuts"), planes.length)
    planes.forEach((plane, i) => gl.uniform4f(program.at(`planes[${i}]`), ...plane))
    if (by) { this.colours.use(program) }
    gl.drawArrays(gl.TRIANGLES, 0, CORNERS * (Math.floor((this.count - 1) / every) + 1))
    gl.activeTexture(gl.TEXTURE0)
    gl.useProgram(before.program)
    gl.bindVertexArray(before.array)
    gl.depthMask(before.mask)
    for (const [what, on] of [[gl.BLEND, before.blend], [gl.CULL_FACE, before.cull]]) {
      if (on) { gl.enable(what) } else { gl.disable(what) }
    }
  }

  remove() {
    const {gl} = this
    this.colours.remove()
    this.places.remove()
    this.cells.remove()
    for (const {made} of this.programs.values()) { gl.deleteProgram(made) }
    gl.deleteVertexArray(this.array)
  }
}

// What is kept lies where a plane's sum is positive: behind the cut, and before the slab's back.
function cutPlanes({origin, normal}, slab) {
  const level = origin[0] * normal[0] + origin[1] * normal[1] + origin[2] * normal[2]
  const planes = [[...normal.map((x) => -x), level]]
  if (slab > 0) { planes.push([...normal, slab - level]) }
  return planes
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
