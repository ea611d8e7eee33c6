// The cutting plane's handles: its frame, a knob that moves it, and one that turns it.

import {DragHandle, line, make} from "./drag_handle.js"
import {across, along, dot, minus, rotated, spanned, unit} from "../common/vectors.js"

const ARROW = 54  // pixels from the knob that moves to the one that turns
const TURN = 0.008  // radians a pixel

export class CutHandles extends DragHandle {
  /** @type {any} */
  box = null
  /** @type {any} */
  cut = null
  unit = 1  // pixels that a step of one is worth

  // `moved(cut)` hears of each plane while it is dragged; `tell` sends to the server.
  constructor(overlay, renderer, hears) {
    super("cut-handles", 70, overlay, renderer, hears)
    this.frame = make("path", "frame", this.svg)
    this.arrow = make("path", "arrow", this.svg)
    this.knobs = Object.fromEntries([["move", 9], ["turn", 6]].map(([kind, r]) => {
      const knob = make("circle", `knob ${kind}`, this.svg, {r})
      make("title", "", knob).textContent = `Drag: ${kind} the plane`
      this.grip(knob, kind)
      return [kind, knob]
    }))
    this.show(null)
  }

  // `part`: the box that the plane crosses.
  show(part) {
    this.box = part && part.box.map((corner) => [...corner])
    if (!part) { this.drop() }
    this.svg.style.display = part ? "" : "none"
  }

  put(cut) {
    if (this.held) { return }
    this.cut = cut && {origin: [...cut.origin], normal: [...cut.normal]}
  }

  // The plane's frame, as large as the box it crosses, and where its knobs are.
  draw() {
    this.svg.style.visibility = "hidden"
    if (!this.box || !this.cut || this.renderer.views.length > 1) { return }
    const {origin, normal} = this.cut
    const [u, v] = spanned(normal)
    const [a, b] = [u, v].map((way) => 0.54 * this.reach(way))
    const corner = (s, t) => along(origin, [s * a, u], [t * b, v])
    const corners = [[-1, -1], [1, -1], [1, 1], [-1, 1]]
      .map(([s, t]) => this.renderer.project(corner(s, t)))
    if (!corners.every(Boolean)) { return }
    this.svg.style.visibility = ""
    this.frame.setAttribute("d", `${line(corners)}Z`)
    const {clientWidth: w, clientHeight: h} = this.overlay.canvas
    const inside = (at) => at[0] > 24 && at[0] < w - 24 && at[1] > 24 && at[1] < h - 24
    const middles = [[1, 0], [0, 1], [0, -1], [-1, 0]].map(([s, t]) => corner(s, t))
    const at = middles.find((place) => inside(this.renderer.project(place))) ?? origin
    const [x, y] = this.renderer.project(at) ?? origin
    const [dx, dy] = this.step(at)
    const long = Math.max(Math.hypot(dx, dy), 0.25 * this.unit)
    const tip = [x + ARROW * dx / long, y + ARROW * dy / long]
    if (Math.hypot(tip[0] - x, tip[1] - y) < 20) { tip[1] = y - 26 }
    this.arrow.setAttribute("d", line([[x, y], tip]))
    const put = (knob, at) => ["cx", "cy"].forEach((name, i) => knob.setAttribute(name, at[i]))
    put(this.knobs.move, [x, y])
    put(this.knobs.turn, tip)
    this.at = at
  }

  reach(way) {
    return dot(way.map(Math.abs), minus(this.box[1], this.box[0]))
  }

  // How many pixels a step of one along the normal is, from a place; how many one is worth at all.
  step(place) {
    const {renderer} = this
    const length = 0.01 * Math.max(...minus(this.box[1], this.box[0]))
    const ends = [place, along(place, [length, this.cut.normal])]
    const [from, to] = ends.map((end) => renderer.project(end) ?? [0, 0, 1])
    this.unit = 1 / renderer.pixel(from[2])
    return [(to[0] - from[0]) / length, (to[1] - from[1]) / length]
  }

  begin(_e, kind) {
    return {kind, cut: this.cut, way: this.step(this.at)}
  }

  follow(dx, dy) {
    const {held} = this
    this.cut = held.kind === "move" ? this.shifted(held, dx, dy) : this.turned(held, dx, dy)
    this.moved(this.cut)
    return true
  }

  // A plane that faces the eye comes nearer as it is dragged down.
  shifted({cut: {origin, normal}, way}, dx, dy) {
    const squared = way[0] ** 2 + way[1] ** 2
    const steep = squared > (0.15 * this.unit) ** 2
    const step = steep ? (dx * way[0] + dy * way[1]) / squared : dy / this.unit
    const half = this.reach(normal) / 2
    const middle = this.box[0].map((x, i) => (x + this.box[1][i]) / 2)
    const before = dot(normal, minus(origin, middle))
    const by = Math.min(Math.max(before + step, -half), half) - before
    return {origin: along(origin, [by, normal]), normal}
  }

  // About the eye's own upright and level axes.
  turned({cut: {origin, normal}}, dx, dy) {
    const {right, up} = across(this.renderer.camera.getDirectionOfProjection())
    const out = rotated(rotated(normal, up, TURN * dx), right, TURN * dy)
    return {origin, normal: unit(out)}
  }

  say() {
    this.tell({type: "move-cut", ...this.cut})
  }
}
