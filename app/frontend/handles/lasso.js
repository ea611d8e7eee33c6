// The lasso: a line drawn around vertices selects those that are seen inside it, or all of them.

import {onPage, within} from "../common/elements.js"
import {line, make} from "./drag_handle.js"

const NEAREST = 3  // pixels between two corners of the line, at least
const CELLS = 360  // of the depths of the surface, along the longer side of the line's box

export class Lasso {
  /**
   * `body` is the actor whose vertices are selected, `handOver` lets the camera have a pointer.
   * @param {Overlay} overlay @param {Renderer} renderer
   * @param {{tell: Tell, [act: string]: any}} hears
   */
  constructor(overlay, renderer, {body, handOver, tell}) {
    this.overlay = overlay
    this.renderer = renderer
    this.body = body
    this.handOver = handOver
    this.tell = tell
    this.svg = make("svg", "handle lasso", overlay.root, {"aria-hidden": "true"})
    this.paths = ["halo", "ring"].map((name) => make("path", name, this.svg))
    const on = (type, act) => overlay.canvas.addEventListener(type, act, {capture: true})
    on("pointerdown", (e) => this.take(e))
    on("pointermove", (e) => this.move(e))
    on("pointerup", (e) => this.release(e))
    on("pointercancel", () => this.cancel())
    this.show(null)
  }

  // `part`: whether hidden vertices are selected as well.
  show(part) {
    this.part = part
    this.overlay.root.classList.toggle("lassoing", Boolean(part))
    this.cancel()
  }

  take(e) {
    if (!this.part || e.button || e.altKey) { return }
    if (this.drawn) {  // a second finger: both move the camera
      const {pointer, points} = this.drawn
      this.cancel()
      this.handOver(pointer, onPage(this.overlay.canvas, points[points.length - 1]))
      return
    }
    e.stopImmediatePropagation()
    e.preventDefault()
    this.overlay.canvas.focus({preventScroll: true})
    this.overlay.canvas.setPointerCapture(e.pointerId)
    const mode = e.shiftKey ? "add" : e.ctrlKey || e.metaKey ? "subtract" : "replace"
    this.drawn = {pointer: e.pointerId, mode, points: [within(this.overlay.canvas, e)]}
    this.overlay.showBone(null)
  }

  move(e) {
    const {drawn} = this
    if (!drawn || e.pointerId !== drawn.pointer) { return }
    e.stopImmediatePropagation()
    const [x, y] = within(this.overlay.canvas, e)
    const [u, v] = drawn.points[drawn.points.length - 1]
    if (Math.hypot(x - u, y - v) >= NEAREST) { drawn.points.push([x, y]) }
    this.draw()
  }

  release(e) {
    const {drawn} = this
    if (!drawn || e.pointerId !== drawn.pointer) { return }
    e.stopImmediatePropagation()
    const actor = this.body()
    this.cancel()
    if (drawn.points.length < 3 || !actor?.triangles) { return }
    const view = this.renderer.viewAt(...drawn.points[0])
    const vertices = inside(drawn.points, actor.posed(), this.renderer.projection(view),
      this.part.through ? null : actor.triangles)
    this.tell({type: "lasso", vertices, mode: drawn.mode})
  }

  cancel() {
    this.drawn = null
    this.draw()
  }

  draw() {
    const path = this.drawn ? `${line(this.drawn.points)}Z` : ""
    for (const one of this.paths) { one.setAttribute("d", path) }
  }
}

/**
 * The points inside a polygon of the canvas; with triangles only those that no triangle hides.
 * @param {number[][]} polygon @param {Float32Array} points
 * @param {(point: any) => number[] | null} project @param {Uint32Array | null} triangles
 */
export function inside(polygon, points, project, triangles) {
  const pixels = Array.from({length: points.length / 3}, (_, i) =>
    project([points[3 * i], points[3 * i + 1], points[3 * i + 2]]))
  const depths = triangles && new Depths(polygon, pixels, triangles)
  const chosen = []
  pixels.forEach((pixel, i) => {
    if (pixel && contains(polygon, pixel) && !depths?.hides(pixel)) { chosen.push(i) }
  })
  return chosen
}

/** @param {number[][]} polygon @param {number[]} pixel */
function contains(polygon, [x, y]) {
  let is = false
  for (let i = 0, j = polygon.length - 1; i < polygon.length; j = i++) {
    const [a, b] = polygon[i], [c, d] = polygon[j]
    if ((b > y) !== (d > y) && x < a + (y - b) / (d - b) * (c - a)) { is = !is }
  }
  return is
}

// Depths of the nearest surface in a grid over the box of a polygon.
class Depths {
  constructor(polygon, pixels, triangles) {
    const [xs, ys] = [0, 1].map((k) => polygon.map((corner) => corner[k]))
    this.low = [Math.min(...xs), Math.min(...ys)]
    const size = [Math.max(...xs) - this.low[0], Math.max(...ys) - this.low[1]]
    this.cell = Math.max(...size, 1) / CELLS
    this.counts = size.map((length) => Math.ceil(length / this.cell) + 1)
    this.depth = new Float64Array(this.counts[0] * this.counts[1]).fill(Infinity)
    for (let t = 0; t < triangles.length; t += 3) {
      const corners = [0, 1, 2].map((k) => pixels[triangles[t + k]])
      if (corners.every(Boolean)) { this.fill(corners) }
    }
  }

  at([x, y]) {
    return [(x - this.low[0]) / this.cell, (y - this.low[1]) / this.cell]
  }

  // Write the depths of a triangle where it covers the middles of cells and is nearest.
  fill(corners) {
    const [[ax, ay], [bx, by], [cx, cy]] = corners.map((corner) => this.at(corner))
    const [wide, high] = this.counts
    const [left, right] = [Math.max(Math.ceil(Math.min(ax, bx, cx)), 0),
      Math.min(Math.floor(Math.max(ax, bx, cx)), wide - 1)]
    const [top, bottom] = [Math.max(Math.ceil(Math.min(ay, by, cy)), 0),
      Math.min(Math.floor(Math.max(ay, by, cy)), high - 1)]
    const area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
    if (!area) { return }
    const inverse = corners.map((corner) => 1 / corner[2])  // it is linear over the screen
    for (let y = top; y <= bottom; y++) {
      for (let x = left; x <= right; x++) {
        const v = ((x - ax) * (cy - ay) - (cx - ax) * (y - ay)) / area
        const w = ((bx - ax) * (y - ay) - (x - ax) * (by - ay)) / area
        if (v < 0 || w < 0 || v + w > 1) { continue }
        const depth = 1 / ((1 - v - w) * inverse[0] + v * inverse[1] + w * inverse[2])
        const at = y * wide + x
        if (depth < this.depth[at]) { this.depth[at] = depth }
      }
    }
  }

  // A point is hidden where the surface is nearer in all cells around it, whatever its slope.
  hides(pixel) {
    const [x, y] = this.at(pixel).map(Math.round)
    let farthest = 0
    for (let v = y - 1; v <= y + 1; v++) {
      for (let u = x - 1; u <= x + 1; u++) {
        const is = u >= 0 && v >= 0 && u < this.counts[0] && v < this.counts[1]
        if (is) { farthest = Math.max(farthest, this.depth[v * this.counts[0] + u]) }
      }
    }
    return pixel[2] > farthest * (1 + 1e-4)
  }
}
