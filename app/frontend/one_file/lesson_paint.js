// Vertices that a person has painted on a page without a server, and their agreement with others.

import {QUIET} from "../engine/colour.js"
import {minus} from "../common/vectors.js"

const PAINT = [224, 90, 0]

export class Painted {
  /** @param {{rest: Float32Array, triangles: Uint32Array}} body */
  constructor(body) {
    this.points = body.rest
    this.count = body.rest.length / 3
    this.place = welded(this.points, this.count)
    this.beside = neighbours(body.triangles, this.place)
    this.painted = new Uint8Array(this.count)
    this.before = this.painted
  }

  /**
   * Adds what a piece of a stroke touches: what is nearer than the radius, along the surface.
   * @param {{points?: number[], first?: boolean, mode?: string | null, cancelled?: boolean}} stroke
   */
  pass({points = [], first, mode, cancelled}, radius) {
    if (first) { this.before = this.painted.slice() }
    if (cancelled) { this.painted = this.before; return }
    for (let i = 0; i < points.length; i += 6) {
      const corners = points.slice(i, i + 3)
      const at = [0, 1, 2].map((axis) => corners.reduce(
        (sum, corner, k) => sum + points[i + 3 + k] * this.points[3 * corner + axis], 0))
      for (const place of this.around(corners, at, radius)) {
        this.painted[place] = Number(mode !== "subtract")
      }
    }
  }

  around(corners, at, radius) {
    const reached = new Set(corners.map((corner) => this.place[corner]))
    for (const place of reached) {
      for (const next of this.beside.get(place) ?? []) {
        const point = this.points.subarray(3 * next, 3 * next + 3)
        if (Math.hypot(...minus(at, point)) < radius) { reached.add(next) }
      }
    }
    return reached
  }

  isPainted(vertex) {
    return this.painted[this.place[vertex]]
  }

  get colors() {
    const colors = new Uint8Array(3 * this.count)
    for (let v = 0; v < this.count; v++) { colors.set(this.isPainted(v) ? PAINT : QUIET, 3 * v) }
    return colors
  }

  /** The vertices in both selections, of those in either. @param {ArrayLike<number>} right */
  score(right) {
    let [both, either] = [0, 0]
    for (let v = 0; v < this.count; v++) {
      both += Number(this.isPainted(v) && right[v])
      either += Number(this.isPainted(v) || right[v])
    }
    return both / Math.max(either, 1)
  }
}

// The first vertex at the position of each vertex.
function welded(points, count) {
  const first = new Map()
  return Uint32Array.from({length: count}, (_, v) => {
    const key = points.subarray(3 * v, 3 * v + 3).join()
    if (!first.has(key)) { first.set(key, v) }
    return first.get(key)
  })
}

function neighbours(triangles, place) {
  const beside = new Map()
  for (let i = 0; i < triangles.length; i++) {
    const corner = place[triangles[i]]
    if (!beside.has(corner)) { beside.set(corner, new Set()) }
    for (const k of [1, 2]) { beside.get(corner).add(place[triangles[i - i % 3 + (i + k) % 3]]) }
  }
  return beside
}
