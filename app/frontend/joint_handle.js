// The handle of a joint at rest: a knob that moves it along the screen, and its partner's, which moves too.

import {plainList} from "./arrays.js"

const SEND_EVERY = 33

export class JointHandle {
  // `moved` hears that there is something to draw; `tell` sends to the server.
  constructor(overlay, renderer, {moved, tell}) {
    Object.assign(this, {overlay, renderer, moved, tell})
    const make = (tag, className, parent) => {
      const element = document.createElementNS("http://www.w3.org/2000/svg", tag)
      element.setAttribute("class", className)
      parent.append(element)
      return element
    }
    this.svg = make("svg", "joint-handle", overlay.root)
    this.svg.setAttribute("aria-hidden", "true")  // the numbers do the same by keys
    this.tie = make("path", "tie", this.svg)
    this.partner = make("circle", "partner", this.svg)
    this.partner.setAttribute("r", 6)
    this.knob = make("g", "knob", this.svg)
    const reach = make("circle", "reach", this.knob)
    reach.setAttribute("r", 20)
    make("title", "", reach).textContent = "Drag: move the joint"
    make("path", "halo", this.knob).setAttribute("d", CROSS)
    make("path", "arrows", this.knob).setAttribute("d", CROSS)
    make("circle", "dot", this.knob).setAttribute("r", 6)
    reach.addEventListener("pointerdown", (e) => this.take(e))
    reach.addEventListener("pointermove", (e) => this.drag(e))
    for (const type of ["pointerup", "pointercancel"]) { reach.addEventListener(type, (e) => this.release(e)) }
    this.show(null)
  }

  // `part`: the joint, where it is in the scene, and what its partner's place is of it: a normal and
  // a distance of the mirror's plane.
  show(part) {
    if (this.held && part?.joint === this.held.joint) { return }  // the hand is ahead of the server
    this.held = null
    this.svg.classList.remove("holding")
    this.part = part && {joint: part.joint, at: plainList(part.at), mirror: part.mirror && plainList(part.mirror)}
    this.svg.style.display = part ? "" : "none"
  }

  draw() {
    const {part} = this
    this.seen = part && this.renderer.views.length < 2 ? this.renderer.project(part.at) : undefined
    this.svg.style.visibility = this.seen ? "" : "hidden"
    if (!this.seen) { return }
    const [x, y] = this.seen.map((value) => Number(value.toFixed(1)))
    this.knob.setAttribute("transform", `translate(${x} ${y})`)
    const other = part.mirror && this.renderer.project(reflected(part.at, part.mirror))
    for (const element of [this.tie, this.partner]) { element.style.display = other ? "" : "none" }
    if (!other) { return }
    const [ox, oy] = other.map((value) => value.toFixed(1))
    this.partner.setAttribute("cx", ox)
    this.partner.setAttribute("cy", oy)
    this.tie.setAttribute("d", `M${x} ${y}L${ox} ${oy}`)
  }

  take(e) {
    if (!this.seen || e.button) { return }
    e.preventDefault()
    e.stopPropagation()
    e.target.setPointerCapture(e.pointerId)
    const pixel = this.renderer.pixel(this.seen[2])
    this.held = {
      joint: this.part.joint, from: this.part.at, x: e.clientX, y: e.clientY, pixel, pointer: e.pointerId,
      ...across(this.renderer.camera.getDirectionOfProjection()), sentAt: 0, far: false,
    }
    this.svg.classList.add("holding")
  }

  drag(e) {
    const {held} = this
    if (!held || e.pointerId !== held.pointer) { return }
    e.stopPropagation()
    const [dx, dy] = [held.pixel * (e.clientX - held.x), -held.pixel * (e.clientY - held.y)]
    held.far ||= Math.hypot(e.clientX - held.x, e.clientY - held.y) > 2  // a click moves nothing
    if (!held.far) { return }
    this.part.at = held.from.map((x, i) => x + dx * held.right[i] + dy * held.up[i])
    this.moved()
    const now = performance.now()
    clearTimeout(held.later)
    if (now - held.sentAt > SEND_EVERY) { this.say() } else { held.later = setTimeout(() => this.say(), SEND_EVERY) }
  }

  say(done = false) {
    const {held} = this
    if (!held) { return }
    held.sentAt = performance.now()
    this.tell({type: "joint", joint: held.joint, position: this.part.at, done})
  }

  release(e) {
    const {held} = this
    if (!held) { return }
    e.stopPropagation()
    clearTimeout(held.later)
    if (held.far) { this.say(true) }
    this.held = null
    this.svg.classList.remove("holding")
  }
}

// Four arrows that point away from the middle.
const CROSS = [[1, 0], [0, 1], [-1, 0], [0, -1]].map(([c, s]) => {
  const at = (x, y) => `${c * x - s * y} ${s * x + c * y}`
  return `M${at(9, 0)}L${at(17, 0)}M${at(13.5, -3.5)}L${at(17, 0)}L${at(13.5, 3.5)}`
}).join("")

// The directions to the right and up on the screen, of length 1.
export function across(ahead, above = [0, 1, 0]) {
  const cross = (a, b) => [0, 1, 2].map((k) => {
    const [i, j] = [(k + 1) % 3, (k + 2) % 3]
    return a[i] * b[j] - a[j] * b[i]
  })
  const unit = (v) => v.map((x) => x / Math.hypot(...v))
  const right = unit(cross(ahead, above))
  return {right, up: cross(right, unit(ahead))}
}

// A point on the other side of a plane: its normal, of length 1, and its distance from 0.
export function reflected(point, [a, b, c, distance]) {
  const away = point[0] * a + point[1] * b + point[2] * c - distance
  return [point[0] - 2 * away * a, point[1] - 2 * away * b, point[2] - 2 * away * c]
}
