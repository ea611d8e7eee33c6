// Where a ray from the eye meets a surface, and what the scene tells of that place.

import {toSegment} from "./pick.js"
import {projectionMatrix} from "../engine/vtk_private.js"

// The triangle of an actor that is first met under a place of the canvas; null beside it.
export function hitSurface(renderer, actor, x, y, cut) {
  if (!actor.visible || actor.kind !== "surface" || !actor.triangles) { return null }
  const {origin, direction} = renderer.ray(x, y)
  const isLeft = cut && actor.clipped ? (at) => keeps(cut, actor.slab, at) : undefined
  return actor.tree.firstHit(origin, direction, isLeft)
}

function keeps({origin, normal}, slab, at) {
  let before = 0
  for (let k = 0; k < 3; k++) { before += (at[k] - origin[k]) * normal[k] }
  return before <= 0 && !(slab > 0 && before < -slab)
}

// The line of an actor nearest to a place of the canvas, within reach.
export function hitLine(renderer, actor, x, y, reach) {
  if (!actor.visible || actor.kind !== "lines" || !actor.pairs) { return null }
  const p = actor.rest
  const project = renderer.projection(renderer.viewAt(x, y))
  const at = (i) => project([p[3 * i], p[3 * i + 1], p[3 * i + 2]])
  let best = null
  for (let i = 0; i < actor.pairs.length; i += 2) {
    const a = at(actor.pairs[i]), b = at(actor.pairs[i + 1])
    if (!a || !b) { continue }
    const [distance] = toSegment(x, y, a, b)
    if (distance <= reach && (!best || distance < best.distance)) { best = {distance, cell: i / 2} }
  }
  return best && best.cell
}

// The point of an actor at a place of the canvas: of those that are met, the nearest to the eye.
export function hitPoint(renderer, actor, x, y, reach = 7) {
  const p = actor.rest
  const [left, top, w, h] = renderer.tiles[0]
  const m = projectionMatrix(renderer.camera, w / h)
  let best = null
  for (let i = 0; i < p.length; i += 3) {
    const depth = m[12] * p[i] + m[13] * p[i + 1] + m[14] * p[i + 2] + m[15]
    if (depth <= 0) { continue }
    const along = (m[0] * p[i] + m[1] * p[i + 1] + m[2] * p[i + 2] + m[3]) / depth
    const away = Math.abs(left + (along + 1) / 2 * w - x)
    if (away > reach) { continue }
    const up = (m[4] * p[i] + m[5] * p[i + 1] + m[6] * p[i + 2] + m[7]) / depth
    const far = Math.hypot(away, top + (1 - up) / 2 * h - y)
    if (far > reach) { continue }
    if (actor.plane && !keeps(actor.plane, actor.slab, [p[i], p[i + 1], p[i + 2]])) { continue }
    const score = far / reach + 8 * depth / renderer.camera.getDistance()
    if (!best || score < best.score) { best = {point: i / 3, score} }
  }
  return best
}

export function valueAt(actor, index) {
  const {text, values, names, percent, unit} = actor.reading
  const value = (values || actor.values)?.[index]
  if (value === undefined || Number.isNaN(value)) { return null }
  if (names?.length) { return text + names[value] }
  if (percent) { return `${text}${Math.round(100 * value)}%` }
  return text + (Number.isInteger(value) ? value * unit : Number((value * unit).toPrecision(3)))
}
