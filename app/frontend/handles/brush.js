// The brush that paints weights: a ring on the surface, and strokes that are sent to the server,
// which answers with the colours of what they touched.

import {onPage, within} from "../common/elements.js"
import {line, make} from "./drag_handle.js"
import {across, along, cross, dot, minus, reflected} from "../common/vectors.js"

const SIDES = 48  // of the ring
const NEAREST = 3  // pixels between two points of a stroke, at least
const PER_RADIUS = 4  // points of a stroke in a radius
const MOST = 60  // points from one event of the pointer

export class PaintBrush {
  /**
   * `bodyAt` tells what lies at a place of the canvas, `handOver` lets the camera have a pointer.
   * @param {Overlay} overlay @param {Renderer} renderer
   * @param {{tell: Tell, [act: string]: any}} hears
   */
  constructor(overlay, renderer, {bodyAt, handOver, changed, tell}) {
    this.overlay = overlay
    this.renderer = renderer
    this.bodyAt = bodyAt
    this.handOver = handOver
    this.changed = changed
    this.tell = tell
    /** @type {any} */
    this.stroke = null
    this.svg = make("svg", "handle brush-ring", overlay.root, {"aria-hidden": "true"})
    this.rings = ["halo", "ring", "ring other"].map((name) => make("path", name, this.svg))
    const on = (type, act) => overlay.canvas.addEventListener(type, (e) => act(e), {capture: true})
    on("pointerdown", (e) => this.take(e))
    on("pointermove", (e) => this.move(e))
    on("pointerup", (e) => this.release(e))
    on("pointercancel", (e) => this.cancel(e))
    on("pointerleave", () => this.aim(null))
    on("dblclick", (e) => { if (this.part && this.hitOf(e)) { e.stopImmediatePropagation() } })
    this.show(null)
  }

  // `part`: the radius in the scene, and the plane that mirrors it.
  show(part) {
    this.part = part && {radius: part.radius, mirror: part.mirror && [...part.mirror]}
    this.overlay.showPainting(Boolean(part))
    if (!part) {
      this.stroke = null
      this.aimed = null
    }
    this.draw()
  }

  get held() {
    return Boolean(this.stroke)
  }

  hitOf(e) {
    return this.bodyAt(...within(this.overlay.canvas, e))
  }

  take(e) {
    if (!this.part) { return }
    if (this.stroke) {  // a second finger: both move the camera
      const {pointer, x, y} = this.stroke
      this.cancel({pointerId: pointer})
      this.handOver(pointer, onPage(this.overlay.canvas, [x, y]))
      return
    }
    const hit = e.button || e.altKey ? null : this.hitOf(e)
    if (!hit) { return }
    e.stopImmediatePropagation()
    e.preventDefault()
    this.overlay.canvas.focus({preventScroll: true})
    this.overlay.canvas.setPointerCapture(e.pointerId)
    const [x, y] = within(this.overlay.canvas, e)
    const mode = e.shiftKey ? "smooth" : e.ctrlKey || e.metaKey ? "subtract" : null
    this.stroke = {pointer: e.pointerId, x, y, points: [], first: true, mode}
    this.overlay.showBone(null)
    this.aim(hit)
    this.pass(hit)
    this.say()
  }

  move(e) {
    const {stroke} = this
    if (!this.part) { return }
    if (!stroke) {
      this.aim(e.buttons ? null : this.hitOf(e))
      return
    }
    if (e.pointerId !== stroke.pointer) { return }
    e.stopImmediatePropagation()
    const [x, y] = within(this.overlay.canvas, e)
    let hit = null
    for (const [a, b] of between([stroke.x, stroke.y], [x, y], this.spacing)) {
      hit = this.bodyAt(a, b)
      if (hit) { this.pass(hit) }
    }
    [stroke.x, stroke.y] = [x, y]
    this.aim(hit || this.hitOf(e))
    this.say()
  }

  /** By keys: a stroke of one point, where the cross is. @param {number[]} at */
  dab([x, y]) {
    const hit = this.stroke ? null : this.bodyAt(x, y)
    if (!hit) { return }
    this.stroke = {points: [], first: true, mode: null}
    this.aim(hit)
    this.pass(hit)
    this.send(true)
    this.stroke = null
  }

  // Pixels between two points of a stroke: close enough that nothing is left out between them.
  get spacing() {
    const depth = this.aimed ? this.renderer.project(this.aimed.at)?.[2] : null
    if (!depth) { return NEAREST }
    return Math.max(NEAREST, this.part.radius / this.renderer.pixel(depth) / PER_RADIUS)
  }

  pass({actor, triangle, at}) {
    this.stroke.points.push(...corners(actor.triangles, actor.posed(), triangle, at))
  }

  // One message at a time: a slow server gets longer pieces of the stroke, not more of them.
  say() {
    const {stroke} = this
    if (stroke?.points.length && !this.awaited) { this.send(false) }
  }

  send(done) {
    const {points, first, mode} = this.stroke
    this.tell({type: "paint", points, first, mode, done})
    this.awaited = true
    Object.assign(this.stroke, {points: [], first: false})
  }

  // The server's answer: colours of the vertices that were touched, and what they follow in a pose.
  painted(answer, actor) {
    this.awaited = false
    if (answer.gone) { this.stroke = null }
    if (answer.vertices && actor) {
      actor.repaint(answer)
      this.changed()
    }
    this.say()
  }

  release(e) {
    const {stroke} = this
    if (!stroke || e.pointerId !== stroke.pointer) { return }
    e.stopImmediatePropagation()
    this.send(true)
    this.stroke = null
  }

  cancel(e) {
    if (!this.stroke || e.pointerId !== this.stroke.pointer) { return }
    if (!this.stroke.first) { this.tell({type: "paint", cancelled: true}) }
    this.stroke = null
  }

  aim(hit) {
    const normal = (of) => normalOf(of.actor.triangles, of.actor.posed(), of.triangle)
    this.aimed = hit && {at: hit.at, normal: normal(hit)}
    this.draw()  // the ring alone: the scene is as it was
  }

  draw() {
    const {part, aimed} = this
    const seen = part && aimed
    this.svg.style.display = seen ? "" : "none"
    if (!seen) { return }
    const ring = circle(aimed.at, aimed.normal, part.radius)
    const outline = (points) => {
      const pixels = points.map(this.renderer.projection())
      return pixels.every(Boolean) ? `${line(pixels)}Z` : ""
    }
    const [halo, own, other] = this.rings
    for (const path of [halo, own]) { path.setAttribute("d", outline(ring)) }
    const mirrored = part.mirror ? ring.map((point) => reflected(point, part.mirror)) : null
    other.setAttribute("d", mirrored ? outline(mirrored) : "")
  }
}

const pointAt = (points, i) => [points[3 * i], points[3 * i + 1], points[3 * i + 2]]

// The corners around a point of a triangle, and what each counts for.
export function corners(triangles, points, triangle, at) {
  const ids = [0, 1, 2].map((c) => triangles[3 * triangle + c])
  const [a, b, c] = ids.map((i) => pointAt(points, i))
  const [u, v, w] = [minus(b, a), minus(c, a), minus(at, a)]
  const [uu, uv, vv, wu, wv] = [dot(u, u), dot(u, v), dot(v, v), dot(w, u), dot(w, v)]
  const area = uu * vv - uv * uv
  if (!(area > 0)) { return [...ids, 1, 0, 0] }
  const clamp = (x) => Math.min(Math.max(x, 0), 1)
  const g = clamp((wu * vv - wv * uv) / area)
  const h = Math.min(clamp((wv * uu - wu * uv) / area), 1 - g)
  return [...ids, 1 - g - h, g, h]
}

export function normalOf(triangles, points, triangle) {
  const [a, b, c] = [0, 1, 2].map((k) => pointAt(points, triangles[3 * triangle + k]))
  const n = cross(minus(b, a), minus(c, a))
  const length = Math.hypot(...n)
  return length > 0 ? n.map((x) => x / length) : [0, 1, 0]
}

// Points on a circle around a place, across a direction.
export function circle(at, normal, radius) {
  // Two directions across it; what it is nearly parallel to would leave none.
  const {right, up} = across(normal, Math.abs(normal[1]) > 0.9 ? [1, 0, 0] : [0, 1, 0])
  return Array.from({length: SIDES}, (_, i) => {
    const [c, s] = [Math.cos(2 * Math.PI * i / SIDES), Math.sin(2 * Math.PI * i / SIDES)]
    return along(at, [radius * c, right], [radius * s, up])
  })
}

// Places on the way from one pixel to another, without the first, no farther apart than a spacing.
export function between([x, y], [u, v], spacing) {
  const count = Math.min(Math.max(Math.ceil(Math.hypot(u - x, v - y) / spacing), 1), MOST)
  return Array.from({length: count}, (_, i) => {
    const t = (i + 1) / count
    return [x + t * (u - x), y + t * (v - y)]
  })
}
