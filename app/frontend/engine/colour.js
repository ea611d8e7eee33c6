// Colours of an actor's points on the graphics card: a value or a colour of each point is in
// a texture. New ones are an upload of just these numbers; no buffer is built again.

import {replace} from "../common/shape.js"
import {FRAGMENT} from "./vtk_private.js"

const TABLE_UNIT = 13  // vtk.js takes the first units
const POINT_UNIT = 14
export const POINTS_WIDE = 2048
export const QUIET = [201, 206, 214]  // the body's own grey
export const ALL = 1e38

export class Colours {
  /** @param {GL} gl */
  constructor(gl) {
    this.gl = gl
    this.by = ""  // "values", "colors", or nothing
    this.front = ALL
    this.limits = [0, 1]
  }

  setValues(values, table, limits = this.limits) {
    this.by = "values"
    this.values = values
    this.limits = limits
    this.putPoints(values, this.gl.R32F, this.gl.RED, this.gl.FLOAT, 1)
    if (table) { this.putTable(table) }
  }

  setColors(colors) {
    this.by = "colors"
    this.colors = colors
    this.putPoints(colors, this.gl.RGB8, this.gl.RGB, this.gl.UNSIGNED_BYTE, 3)
  }

  /** Gives some points others. @param {Painted} painted */
  repaint({vertices, colors, scalars}) {
    const isColors = this.by === "colors"
    const [numbers, others, size] = isColors ? [this.colors, colors, 3] : [this.values, scalars, 1]
    if (!vertices || !others || !this.points) { return }
    replace(numbers, size, vertices, others)
    const rows = new Set(Array.from(vertices, (place) => Math.floor(place / POINTS_WIDE)))
    for (const row of rows) { this.points.putRow(row, numbers) }
  }

  putPoints(values, inside, format, type, size) {
    this.points = this.points ?? new PointTexture(this.gl, POINT_UNIT)
    this.points.put(values, inside, format, type, size)
  }

  putTable(table) {
    const {gl} = this
    const width = table.length / 3
    if (this.table?.width !== width) {
      this.table?.remove()
      this.table = new DataTexture(gl, TABLE_UNIT, gl.RGB8, width, 1, gl.LINEAR)
    }
    this.table.put(0, width, 1, gl.RGB, gl.UNSIGNED_BYTE, table)
  }

  // Called before the actor is drawn.
  use(program) {
    // Values that are computed from the pose are not read from a texture.
    if (program.isUniformUsed("points")) { this.points.use(program, "points") }
    if (this.by === "values" && program.isUniformUsed("colourTable")) {
      const [low, high] = this.limits
      this.table.bind()
      program.setUniformi("colourTable", TABLE_UNIT)
      program.setUniform3fArray("colourRange", [low, high > low ? high - low : 1, this.table.width])
      program.setUniformf("colourFront", this.front)
    }
    this.gl.activeTexture(this.gl.TEXTURE0)
  }

  remove() {
    this.points?.remove()
    this.table?.remove()
  }
}

// Some numbers of each point, in rows.
export class PointTexture {
  /** @type {any} */
  data = null
  /** @type {any} */
  how = null

  /** @param {GL} gl @param {number} unit */
  constructor(gl, unit) {
    this.gl = gl
    this.unit = unit
  }

  put(values, inside, format, type, size) {
    const {gl} = this
    const count = values.length / size
    const rows = Math.max(Math.ceil(count / POINTS_WIDE), 1)
    if (String([inside, rows]) !== this.shape) {
      this.data?.remove()
      this.data = new DataTexture(gl, this.unit, inside, POINTS_WIDE, rows, gl.NEAREST)
      this.shape = String([inside, rows])
    }
    this.how = {count, format, type, size}
    const whole = Math.floor(count / POINTS_WIDE)
    const split = whole * POINTS_WIDE * size
    this.data.put(0, POINTS_WIDE, whole, format, type, values.subarray(0, split))
    this.putRow(whole, values)
  }

  // One row of the same numbers as before, some of which are others now.
  putRow(row, values) {
    const {count, format, type, size} = this.how
    const first = row * POINTS_WIDE
    const end = Math.min(first + POINTS_WIDE, count)
    const numbers = values.subarray(first * size, end * size)
    this.data.put(row, end - first, 1, format, type, numbers)
  }

  // Lets a program read it, by the name of its uniform.
  use(program, name) {
    this.data.bind()
    program.setUniformi(name, this.unit)
  }

  remove() {
    this.data?.remove()
  }
}

// A texture of plain numbers, of a fixed size, on one unit.
class DataTexture {
  /** @param {GL} gl */
  constructor(gl, unit, inside, width, height, filter) {
    this.gl = gl
    this.unit = unit
    this.width = width
    this.texture = gl.createTexture()
    this.bind()
    gl.texStorage2D(gl.TEXTURE_2D, 1, inside, width, height)
    for (const name of ["MIN_FILTER", "MAG_FILTER"]) {
      gl.texParameteri(gl.TEXTURE_2D, gl[`TEXTURE_${name}`], filter)
    }
    for (const name of ["WRAP_S", "WRAP_T"]) {
      gl.texParameteri(gl.TEXTURE_2D, gl[`TEXTURE_${name}`], gl.CLAMP_TO_EDGE)
    }
  }

  put(row, width, height, format, type, values) {
    if (!width || !height) { return }
    const {gl} = this
    this.bind()
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1)
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, row, width, height, format, type, values)
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 4)
    gl.activeTexture(gl.TEXTURE0)
  }

  bind() {
    const {gl} = this
    gl.activeTexture(gl.TEXTURE0 + this.unit)
    gl.bindTexture(gl.TEXTURE_2D, this.texture)
  }

  remove() {
    this.gl.deleteTexture(this.texture)
  }
}

// Which point a corner is, for the card: vtk.js draws corners, not points.
export function pointIds(count) {
  return Float32Array.from({length: count}, (_, i) => i)
}

// Additions to the shaders of vtk.js. `apart`: values are computed from the pose, see skin.js.
export function colourShader(by, apart) {
  if (!by) { return {declared: "", main: "", fragment: []} }
  const fetched = "texelFetch(points, ivec2(place % width, place / width), 0)"
  const given = by === "colors" ? `shownColor = ${fetched}.rgb;` : `shownValue = ${fetched}.r;`
  const carried = by === "colors" ? "varying vec3 shownColor;" : "varying float shownValue;"
  const grey = QUIET.map((x) => (x / 255).toFixed(5)).join(", ")
  const looked = by === "colors" ? "vec3 shown = shownColor;" : `
    float along = clamp((shownValue - colourRange.x) / colourRange.y, 0.0, 1.0);
    float texel = (along * (colourRange.z - 1.0) + 0.5) / colourRange.z;
    vec3 shown = shownValue > colourFront ? vec3(${grey})
      : texture2D(colourTable, vec2(texel, 0.5)).rgb;`
  return {
    declared: `attribute float pointIdMC;
      uniform highp sampler2D points;
      ${carried}`,
    main: apart ? "shownValue = apart;" : `int place = int(pointIdMC + 0.5);
      const int width = ${POINTS_WIDE};
      ${given}`,
    fragment: [
      [FRAGMENT.main, `${carried}
        uniform highp sampler2D colourTable;
        uniform vec3 colourRange;
        uniform float colourFront;
        void main()\n{`],
      [FRAGMENT.ambient, `${looked}
  ambientColor = ambient < 0.9 ? shown : 0.45 * shown;`],
      [FRAGMENT.diffuse, "  diffuseColor = shown;"],
    ],
  }
}
