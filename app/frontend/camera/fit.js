// How far away the eye must be for the character to be seen whole in what cards leave free, and
// where on the canvas each point of it is then seen.

import {isCharacter} from "../common/shape.js"
import {VIEW_ANGLE} from "./orbit.js"

const FITTED = 20000  // points of an actor that are looked at to see all of it
const AIR = 1.05  // a little more is seen than must be
const SLOPE = Math.tan(VIEW_ANGLE * Math.PI / 360)

export class Fit {
  /** @param {Renderer} renderer */
  constructor(renderer) {
    this.renderer = renderer
    this.of = []  // what the points below were projected from
    this.points = new Float64Array(0)
  }

  // How far the eye must be from the target, along a direction.
  distance(direction, target, insets) {
    const {renderer} = this
    const [, , w, h] = renderer.tilesIn(insets).reduce((a, b) => a[2] / a[3] < b[2] / b[3] ? a : b)
    const taken = renderer.taken(insets, w)
    const high = Math.max(h - taken.top - taken.bottom, h / 4, 1)
    const wide = Math.max(w - taken.left - taken.right, w / 4, 1)
    let distance = 0
    this.eachPoint(direction, target, (aside, up, near) => {
      const needed = Math.max(Math.abs(up) / high, Math.abs(aside) / wide) * h / SLOPE
      distance = Math.max(distance, needed + near)
    })
    return AIR * (distance || Math.hypot(...target) || 4)
  }

  // Pixels to the right of the target and above it, in a single view from this far away.
  eachPixel(direction, target, distance, see) {
    const scale = this.renderer.element.clientHeight / (2 * SLOPE)
    this.eachPoint(direction, target, (aside, up, near) => {
      const pixels = scale / Math.max(distance - near, 1e-9)
      see(aside * pixels, up * pixels)
    })
  }

  // How far to the right of the target each point is, above it, and nearer than it.
  eachPoint(direction, target, see) {
    const rests = this.rests()
    const of = [...direction, ...target, ...rests]
    if (of.length !== this.of.length || of.some((one, i) => one !== this.of[i])) {
      this.of = of
      this.points = project(rests, direction, target)
    }
    const {points} = this
    for (let i = 0; i < points.length; i += 3) { see(points[i], points[i + 1], points[i + 2]) }
  }

  // What a first look must see: the character.
  rests() {
    const seen = (actor) => actor.kind === "surface" && actor.rest?.length && isCharacter(actor)
    return [...this.renderer.actors.values()].filter(seen).map(({rest}) => rest)
  }
}

// All points, or a good part of them, as they are seen along a direction.
function project(rests, direction, target) {
  const flat = Math.hypot(direction[0], direction[2]) || 1
  const right = [direction[2] / flat, 0, -direction[0] / flat]
  const up = [0, 1, 2].map((k) => {
    const [i, j] = [(k + 1) % 3, (k + 2) % 3]
    return direction[i] * right[j] - direction[j] * right[i]
  })
  const seen = []
  for (const rest of rests) {
    const step = 3 * Math.max(1, Math.floor(rest.length / 3 / FITTED))
    for (let i = 0; i < rest.length; i += step) {
      const [x, y, z] = target.map((c, k) => rest[i + k] - c)
      for (const [a, b, c] of [right, up, direction]) { seen.push(x * a + y * b + z * c) }
    }
  }
  return Float64Array.from(seen)
}
