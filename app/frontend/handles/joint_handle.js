// The handle of a joint at rest: a knob that moves it along the screen, and its partner with it.

import {DragHandle, line, make} from "./drag_handle.js"
import {across, along, reflected} from "../common/vectors.js"

export class JointHandle extends DragHandle {
  // `moved` hears that there is something to draw; `tell` sends to the server.
  constructor(overlay, renderer, hears) {
    super("joint-handle", 33, overlay, renderer, hears)
    this.tie = make("path", "tie", this.svg)
    this.partner = make("circle", "partner", this.svg, {r: 6})
    this.knob = make("g", "knob", this.svg)
    const reach = make("circle", "reach", this.knob, {r: 20})
    make("title", "", reach).textContent = "Drag to move"
    for (const name of ["halo", "arrows"]) { make("path", name, this.knob, {d: CROSS}) }
    make("circle", "dot", this.knob, {r: 6})
    this.grip(reach)
    this.show(null)
  }

  // `part`: the joint, where it is in the scene, and the plane that mirrors it to its partner: a
  // normal and a distance.
  show(part) {
    if (this.held && part?.joint === this.part.joint) { return }  // the hand is ahead of the server
    this.drop()
    const mirror = part?.mirror && [...part.mirror]
    this.part = part && {joint: part.joint, at: [...part.at], mirror}
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
    this.partner.setAttribute("cx", other[0].toFixed(1))
    this.partner.setAttribute("cy", other[1].toFixed(1))
    this.tie.setAttribute("d", line([this.seen, other]))
  }

  begin() {
    if (!this.seen) { return null }
    const pixel = this.renderer.pixel(this.seen[2])
    return {from: this.part.at, pixel, ...across(this.renderer.camera.getDirectionOfProjection())}
  }

  follow(dx, dy) {
    const {held} = this
    if (!held.moved && Math.hypot(dx, dy) <= 2) { return false }  // a click moves nothing
    this.part.at = along(held.from, [held.pixel * dx, held.right], [-held.pixel * dy, held.up])
    this.moved()
    return true
  }

  say(done) {
    this.tell({type: "move-joint", joint: this.part.joint, position: this.part.at, done})
  }
}

// Four arrows that point away from the middle.
const CROSS = [[1, 0], [0, 1], [-1, 0], [0, -1]].map(([c, s]) => {
  const at = (x, y) => `${c * x - s * y} ${s * x + c * y}`
  return `M${at(9, 0)}L${at(17, 0)}M${at(13.5, -3.5)}L${at(17, 0)}L${at(13.5, 3.5)}`
}).join("")
