// Lines and points whose width is fixed on the screen, or follows the scene: lines as shaded tubes,
// points as balls, squares or triangles. The card fetches the ends of each from a texture and makes
// its two triangles itself: vtk.js knows lines of one pixel, and copies their corners. (Instances
// would not do: software renderers draw each of them separately.)

import {Colours, PointTexture} from "./colour.js"
import {strokeProgram} from "./stroke_shaders.js"
import {projectionMatrix} from "./vtk_private.js"

const PLACE_UNIT = 12
const ENDS_UNIT = 11
const CORNERS = 6  // of two triangles, which share two of four places

export class Strokes {
  /** @param {Renderer} renderer @param {string} kind */
  constructor(renderer, kind) {
    this.renderer = renderer
    this.kind = kind
    this.gl = renderer.context
    this.form = "round"
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
    const isLine = this.each === 2
    const [inside, format] = isLine ? [gl.RG32UI, gl.RG_INTEGER] : [gl.R32UI, gl.RED_INTEGER]
    this.cells.put(cells, inside, format, gl.UNSIGNED_INT, this.each)
  }

  program(kind, how) {
    const name = JSON.stringify([kind, how])
    if (!this.programs.has(name)) { this.programs.set(name, strokeProgram(this.gl, kind, how)) }
    return this.programs.get(name)
  }

  // Draws all, or every nth, where vtk.js is about to draw; leaves the card as it was. `quick`
  // draws lines plainly, in a fifth of the time where there is no card.
  draw({color, opacity, width, thick, dash, coloured, cut, slab, every, quick}) {
    const {gl, renderer} = this
    if (!this.count) { return }
    const [, , wide, high] = gl.getParameter(gl.VIEWPORT)
    const before = {
      program: gl.getParameter(gl.CURRENT_PROGRAM), array: gl.getParameter(gl.VERTEX_ARRAY_BINDING),
      blend: gl.isEnabled(gl.BLEND),
      cull: gl.isEnabled(gl.CULL_FACE), mask: gl.getParameter(gl.DEPTH_WRITEMASK),
    }
    const by = coloured ? this.colours.by : ""
    const planes = cut ? cutPlanes(cut, slab) : []
    const kind = quick && this.kind === "lines" ? "plain" : this.kind
    const program = this.program(kind, {
      by, opened: planes.length > 0, dashed: dash > 0, form: this.form,
    })
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
    this.places.use(program, "places")
    this.cells.use(program, "cells")
    program.setUniformi("every", every)
    const {camera} = renderer
    const m = projectionMatrix(camera, wide / high)
    gl.uniformMatrix4fv(program.at("seen"), true, Float32Array.from(m))
    const ratio = renderer.size[0] / Math.max(renderer.element.clientWidth, 1)
    gl.uniform2f(program.at("size"), wide, high)
    gl.uniform1f(program.at("pixels"), width * ratio)
    gl.uniform1f(program.at("unit"), ratio)
    gl.uniform1f(program.at("thick"), thick)
    gl.uniform1f(program.at("scale"), high / (2 * Math.tan(camera.getViewAngle() * Math.PI / 360)))
    gl.uniform1f(program.at("opacity"), opacity)
    gl.uniform1f(program.at("dash"), dash)
    gl.uniform3f(program.at("color"), ...color)
    gl.uniform3f(program.at("haze"), ...renderer.haze)
    gl.uniform2f(program.at("depths"), ...renderer.nearAndFar)
    gl.uniform1i(program.at("cuts"), planes.length)
    planes.forEach((plane, i) => gl.uniform4f(program.at(`planes[${i}]`), ...plane))
    if (by) { this.colours.use(program) }
    const count = Math.floor((this.count - 1) / every) + 1
    if (kind === "plain") {
      gl.drawArrays(gl.LINES, 0, 2 * count)
    } else {
      renderer.corners.bind(count)
      gl.drawElements(gl.TRIANGLES, CORNERS * count, gl.UNSIGNED_INT, 0)
    }
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

// Which four places the two triangles of each stroke have: 0 1 2 and 2 1 3, alike for all strokes.
export class Corners {
  constructor(gl) {
    this.gl = gl
    this.count = 0
    this.buffer = gl.createBuffer()
  }

  // The array that is bound remembers them.
  bind(count) {
    const {gl} = this
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.buffer)
    if (count <= this.count) { return }
    this.count = count
    const order = [0, 1, 2, 2, 1, 3]
    const index = (_, i) => 4 * Math.floor(i / CORNERS) + order[i % CORNERS]
    const indices = Uint32Array.from({length: CORNERS * count}, index)
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, indices, gl.STATIC_DRAW)
  }

  remove() {
    this.gl.deleteBuffer(this.buffer)
  }
}

// What is kept lies where a plane's sum is positive: behind the cut, and before the slab's back.
function cutPlanes({origin, normal}, slab) {
  const level = origin[0] * normal[0] + origin[1] * normal[1] + origin[2] * normal[2]
  const planes = [[...normal.map((x) => -x), level]]
  if (slab > 0) { planes.push([...normal, slab - level]) }
  return planes
}
