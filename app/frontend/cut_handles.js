// The cutting plane's handles: its frame, a knob that moves it along its normal, and one that turns it.

import {plainList} from "./arrays.js"

const TELL_EVERY = 70
const ARROW = 54  // pixels from the knob that moves to the one that turns
const TURN = 0.008  // radians a pixel

export class CutHandles {
  // `moved(cut)` hears of each plane while it is dragged; `tell` sends to the server.
  constructor(overlay, renderer, {moved, tell}) {
    Object.assign(this, {overlay, renderer, moved, tell})
    const make = (tag, className, parent) => {
      const element = document.createElementNS("http://www.w3.org/2000/svg", tag)
      element.setAttribute("class", className)
      parent.append(element)
      return element
    }
    this.svg = make("svg", "cut-handles", overlay.root)
    this.svg.setAttribute("aria-hidden", "true")  // the sliders do the same by keys
    this.frame = make("path", "frame", this.svg)
    this.arrow = make("path", "arrow", this.svg)
    this.knobs = {move: make("circle", "knob move", this.svg), turn: make("circle", "knob turn", this.svg)}
    for (const [kind, knob] of Object.entries(this.knobs)) {
      knob.setAttribute("r", kind === "move" ? 9 : 6)
      make("title", "", knob).textContent = `Drag: ${kind} the plane`
      knob.addEventListener("pointerdown", (e) => this.take(e, kind))
      knob.addEventListener("pointermove", (e) => this.drag(e))
      for (const type of ["pointerup", "pointercancel"]) { knob.addEventListener(type, (e) => this.release(e)) }
    }
    this.show(null)
  }

  // `part`: the box that the plane crosses.
  show(part) {
    this.box = part && part.box.map(plainList)
    if (!part) { this.held = null }
    this.svg.style.display = part ? "" : "none"
  }

  put(cut) {
    if (this.held) { return }
    this.cut = cut && {origin: plainList(cut.origin), normal: plainList(cut.normal)}
  }

  // The plane's frame, as large as the box it crosses, and where its knobs are.
  draw() {
    if (!this.box || !this.cut || this.renderer.views.length > 1) { this.svg.style.visibility = "hidden"; return }
    const {origin, normal} = this.cut
    const [u, v] = spanned(normal)
    const [a, b] = [u, v].map((way) => 0.54 * this.reach(way))
    const corner = (s, t) => origin.map((x, i) => x + s * a * u[i] + t * b * v[i])
    const corners = [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([s, t]) => this.renderer.project(corner(s, t)))
    const seen = corners.every(Boolean)
    this.svg.style.visibility = seen ? "" : "hidden"
    if (!seen) { return }
    const line = (points) => `M${points.map(([x, y]) => `${x.toFixed(1)} ${y.toFixed(1)}`).join("L")}`
    this.frame.setAttribute("d", `${line(corners)}Z`)
    const {clientWidth: w, clientHeight: h} = this.overlay.canvas
    const inside = ([x, y]) => x > 24 && x < w - 24 && y > 24 && y < h - 24
    const middles = [[1, 0], [0, 1], [0, -1], [-1, 0]].map(([s, t]) => corner(s, t))
    const at = middles.find((place) => inside(this.renderer.project(place))) ?? origin
    const [x, y] = this.renderer.project(at)
    const [dx, dy] = this.along(at)
    const long = Math.hypot(dx, dy)
    const tip = [x + ARROW * dx / Math.max(long, 0.25 * this.unit), y + ARROW * dy / Math.max(long, 0.25 * this.unit)]
    if (Math.hypot(tip[0] - x, tip[1] - y) < 20) { tip[1] = y - 26 }
    this.arrow.setAttribute("d", line([[x, y], tip]))
    for (const [kind, [cx, cy]] of [["move", [x, y]], ["turn", tip]]) {
      this.knobs[kind].setAttribute("cx", cx)
      this.knobs[kind].setAttribute("cy", cy)
    }
    this.at = at
  }

  reach(way) {
    const [low, high] = this.box
    return way.reduce((sum, x, i) => sum + Math.abs(x) * (high[i] - low[i]), 0)
  }

  // How many pixels a step of one along the normal is, from a place; and how many one is worth at all.
  along(place) {
    const {renderer, cut: {normal}} = this
    const step = 0.01 * Math.max(...[0, 1, 2].map((i) => this.box[1][i] - this.box[0][i]))
    const from = renderer.project(place)
    const to = renderer.project(place.map((x, i) => x + step * normal[i]))
    this.unit = this.overlay.canvas.clientHeight / (2 * from[2] * Math.tan(renderer.camera.getViewAngle() * Math.PI / 360))
    return [(to[0] - from[0]) / step, (to[1] - from[1]) / step]
  }

  take(e, kind) {
    e.preventDefault()
    e.stopPropagation()
    this.knobs[kind].setPointerCapture(e.pointerId)
    this.held = {kind, x: e.clientX, y: e.clientY, cut: this.cut, way: this.along(this.at)}
    this.svg.classList.add("holding")
  }

  drag(e) {
    const {held} = this
    if (!held) { return }
    e.stopPropagation()
    const [dx, dy] = [e.clientX - held.x, e.clientY - held.y]
    this.cut = held.kind === "move" ? this.shifted(held, dx, dy) : this.turned(held, dx, dy)
    this.moved(this.cut)
    const now = performance.now()
    if (now - (this.toldAt || 0) > TELL_EVERY) { this.toldAt = now; this.tell({type: "cut", ...this.cut}) }
  }

  // A plane that faces the eye comes nearer as it is dragged down.
  shifted({cut: {origin, normal}, way}, dx, dy) {
    const squared = way[0] ** 2 + way[1] ** 2
    const steep = squared > (0.15 * this.unit) ** 2
    const step = steep ? (dx * way[0] + dy * way[1]) / squared : dy / this.unit
    const half = this.reach(normal) / 2
    const middle = this.box[0].map((x, i) => (x + this.box[1][i]) / 2)
    const before = normal.reduce((sum, n, i) => sum + n * (origin[i] - middle[i]), 0)
    const by = Math.min(Math.max(before + step, -half), half) - before
    return {origin: origin.map((x, i) => x + by * normal[i]), normal}
  }

  // About the eye's own upright and level axes.
  turned({cut: {origin, normal}}, dx, dy) {
    const {camera} = this.renderer
    const ahead = camera.getDirectionOfProjection()
    const right = unit(cross(ahead, [0, 1, 0]))
    const up = cross(right, ahead)
    const out = rotated(rotated(normal, up, TURN * dx), right, TURN * dy)
    return {origin, normal: unit(out)}
  }

  release(e) {
    if (!this.held) { return }
    e.stopPropagation()
    this.held = null
    this.svg.classList.remove("holding")
    this.tell({type: "cut", ...this.cut})
  }
}

const cross = (a, b) => [0, 1, 2].map((k) => {
  const [i, j] = [(k + 1) % 3, (k + 2) % 3]
  return a[i] * b[j] - a[j] * b[i]
})
const unit = (v) => v.map((x) => x / Math.hypot(...v))

// Two directions in a plane, at right angles; level and upright where that can be.
export function spanned(normal) {
  const u = unit(Math.abs(normal[1]) > 0.99 ? [1, 0, 0] : cross([0, 1, 0], normal))
  return [u, cross(normal, u)]
}

// A direction, turned about an axis of length 1 (Rodrigues).
export function rotated(v, axis, angle) {
  const [c, s] = [Math.cos(angle), Math.sin(angle)]
  const dot = v.reduce((sum, x, i) => sum + x * axis[i], 0)
  return cross(axis, v).map((x, i) => v[i] * c + x * s + axis[i] * dot * (1 - c))
}
