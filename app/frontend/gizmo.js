// Three rings on the chosen joint: dragging one turns the joint about its own axis.

import {plainList} from "./arrays.js"
import {VIEW_ANGLE} from "./orbit.js"
import {transformed} from "./skin.js"

const RING_COLORS = ["#e5484d", "#30a46c", "#3e83f8"]
const RING_RADIUS = 62
const RING_STEPS = 64
const SEND_EVERY = 70

export class Gizmo {
  // `turned(pose)` hears of each pose while a ring is dragged; `tell` sends to the server.
  constructor(overlay, renderer, {turned, tell, poseNow}) {
    Object.assign(this, {overlay, renderer, turned, tell, poseNow})
    this.svg = overlay.gizmo
    this.part = null
    this.rings = RING_COLORS.map((color, axis) => this.makeRing(color, axis))
    this.show(null)
  }

  makeRing(color, axis) {
    const make = (tag, className, parent) => {
      const element = document.createElementNS("http://www.w3.org/2000/svg", tag)
      element.setAttribute("class", className)
      parent.append(element)
      return element
    }
    const group = make("g", `axis-${"xyz"[axis]}`, this.svg)
    const paths = Object.fromEntries(["halo", "far", "near", "reach"].map((name) =>
      [name, make("path", ["far", "near"].includes(name) ? `ring ${name}` : name, group)]))
    for (const name of ["far", "near"]) { paths[name].setAttribute("stroke", color) }
    const dot = make("circle", "", group)
    dot.setAttribute("r", 9)
    dot.setAttribute("fill", color)
    const letter = make("text", "", group)
    letter.textContent = "XYZ"[axis]
    const {reach} = paths
    reach.addEventListener("pointerdown", (e) => this.take(e, axis, group))
    reach.addEventListener("pointermove", (e) => this.drag(e))
    for (const type of ["pointerup", "pointercancel"]) {
      reach.addEventListener(type, (e) => this.release(e))
    }
    return {group, paths, dot, letter}
  }

  // `part`: the joint, how many there are, where it is at rest, and which joints go along.
  show(part) {
    this.part = part && {...part, below: plainList(part.below), centre: plainList(part.centre)}
    if (this.held && this.held.joint !== this.part?.joint) { this.release() }
    this.svg.style.display = part ? "" : "none"
  }

  // Where the joint is now, and its own three axes.
  frame(pose) {
    const {joint, centre} = this.part
    if (!pose) { return {centre, axes: [[1, 0, 0], [0, 1, 0], [0, 0, 1]]} }
    const m = pose.subarray(16 * joint, 16 * joint + 12)
    const axes = [0, 1, 2].map((k) => {
      const v = [m[k], m[4 + k], m[8 + k]]
      const length = Math.hypot(...v) || 1
      return v.map((x) => x / length)
    })
    return {centre: transformed(centre, pose, joint), axes}
  }

  draw() {
    if (!this.part) { return }
    const {centre, axes} = this.frame(this.poseNow())
    const middle = this.renderer.project(centre)
    this.svg.style.visibility = middle ? "" : "hidden"
    if (!middle) { return }
    const eye = this.renderer.camera.getPosition()
    const toEye = eye.map((x, i) => x - centre[i])
    const [, , , height] = this.renderer.tiles[0]
    const world = RING_RADIUS * 2 * middle[2] * Math.tan(VIEW_ANGLE * Math.PI / 360) / height
    this.rings.forEach(({paths, dot, letter}, k) => {
      const [u, v] = [axes[(k + 1) % 3], axes[(k + 2) % 3]]
      const points = []
      for (let i = 0; i <= RING_STEPS; i++) {
        const angle = 2 * Math.PI * i / RING_STEPS
        const spoke = u.map((x, j) => Math.cos(angle) * x + Math.sin(angle) * v[j])
        const at = this.renderer.project(centre.map((x, j) => x + world * spoke[j]))
        if (!at) { continue }
        points.push({at, near: spoke.reduce((sum, x, j) => sum + x * toEye[j], 0) >= -1e-6})
      }
      const line = (keep) => {
        let [out, pen] = ["", false]
        for (let i = 0; i + 1 < points.length; i++) {
          const drawn = keep(points[i])
          if (drawn) {
            const [[ax, ay], [bx, by]] = [points[i].at, points[i + 1].at]
            out += (pen ? "" : `M${ax.toFixed(1)} ${ay.toFixed(1)}`)
              + `L${bx.toFixed(1)} ${by.toFixed(1)}`
          }
          pen = drawn
        }
        return out
      }
      const whole = line(() => true)
      paths.near.setAttribute("d", line((p) => p.near))
      paths.far.setAttribute("d", line((p) => !p.near))
      paths.halo.setAttribute("d", line((p) => p.near))
      paths.reach.setAttribute("d", whole)
      // Each letter moves to a different side, so that no two overlap.
      const [right, down] = [[-0.3, 1], [1, -0.2], [-0.6, -1]][k]
      const score = ({at: [x, y], near}) =>
        (near ? 1000 : 0) + right * (x - middle[0]) + down * (y - middle[1])
      const mark = points.reduce((a, b) => score(b) > score(a) ? b : a)
      dot.setAttribute("cx", mark.at[0])
      dot.setAttribute("cy", mark.at[1])
      letter.setAttribute("x", mark.at[0])
      letter.setAttribute("y", mark.at[1])
    })
  }

  take(e, axis, group) {
    if (!this.part || this.held || e.button) { return }
    e.preventDefault()
    e.stopPropagation()
    e.target.setPointerCapture(e.pointerId)
    const now = this.poseNow()
    const base = now ? now.slice() : identities(this.part.joints)
    const {centre, axes} = this.frame(now)
    const box = this.overlay.canvas.getBoundingClientRect()
    const start = [e.clientX, e.clientY]
    const [x, y] = [e.clientX - box.left, e.clientY - box.top]
    this.held = {
      axis, group, base, centre, turnAxis: axes[axis], joint: this.part.joint, start,
      motion: this.motionAt(centre, axes, axis, x, y), degrees: 0, sentAt: 0, target: e.target,
      pointer: e.pointerId,
    }
    group.classList.add("held")
    this.svg.classList.add("holding")
    this.say(true)
  }

  // How far the ring's point under the pointer moves on the screen for one radian.
  motionAt(centre, axes, axis, x, y) {
    const [u, v] = [axes[(axis + 1) % 3], axes[(axis + 2) % 3]]
    const middle = this.renderer.project(centre)
    const [, , , height] = this.renderer.tiles[0]
    const world = RING_RADIUS * 2 * middle[2] * Math.tan(VIEW_ANGLE * Math.PI / 360) / height
    const at = (angle) => this.renderer.project(centre.map((c, j) =>
      c + world * (Math.cos(angle) * u[j] + Math.sin(angle) * v[j])))
    let best = null
    for (let i = 0; i < RING_STEPS; i++) {
      const angle = 2 * Math.PI * i / RING_STEPS
      const p = at(angle)
      if (!p) { continue }
      const away = Math.hypot(p[0] - x, p[1] - y)
      if (!best || away < best.away - 0.5) { best = {away, angle} }
    }
    const [a, b] = [at(best.angle - 0.02), at(best.angle + 0.02)]
    const motion = [(b[0] - a[0]) / 0.04, (b[1] - a[1]) / 0.04]
    const length = Math.hypot(...motion)
    // Where a ring is seen from its edge, its point hardly moves: let the hand do, still.
    const least = RING_RADIUS * 0.5
    return length < 1e-6 ? [least, 0] : motion.map((d) => d * Math.max(least, length) / length)
  }

  drag(e) {
    const {held} = this
    if (!held || e.pointerId !== held.pointer) { return }
    e.preventDefault()
    const [dx, dy] = [e.clientX - held.start[0], e.clientY - held.start[1]]
    const [wx, wy] = held.motion
    const radians = (dx * wx + dy * wy) / (wx * wx + wy * wy)
    held.degrees = Math.round(radians * 180 / Math.PI * (e.shiftKey ? 1 / 15 : 1))
      * (e.shiftKey ? 15 : 1)
    this.turned(this.poseAt(held.degrees))
    const now = performance.now()
    if (now - held.sentAt > SEND_EVERY) { this.say() }
    this.label(e)
  }

  // The pose when the ring is turned by some degrees from where it was taken hold of.
  poseAt(degrees) {
    const {base, centre: p, turnAxis: [x, y, z]} = this.held
    const [c, s] = [Math.cos(degrees * Math.PI / 180), Math.sin(degrees * Math.PI / 180)]
    const t = 1 - c
    const r = [
      t * x * x + c, t * x * y - s * z, t * x * z + s * y,
      t * x * y + s * z, t * y * y + c, t * y * z - s * x,
      t * x * z - s * y, t * y * z + s * x, t * z * z + c,
    ]
    const shift = [0, 1, 2].map((i) =>
      p[i] - r[3 * i] * p[0] - r[3 * i + 1] * p[1] - r[3 * i + 2] * p[2])
    const out = base.slice()
    for (const joint of this.part.below) {
      const at = 16 * joint
      for (let i = 0; i < 3; i++) {
        for (let k = 0; k < 4; k++) {
          out[at + 4 * i + k] = r[3 * i] * base[at + k] + r[3 * i + 1] * base[at + 4 + k]
            + r[3 * i + 2] * base[at + 8 + k] + (k === 3 ? shift[i] : 0)
        }
      }
    }
    return out
  }

  say(begin = false) {
    const {held} = this
    held.sentAt = performance.now()
    held.said = held.degrees
    const {joint, axis, degrees} = held
    this.tell({type: "turn", joint, axis, degrees, begin})
  }

  label(e) {
    const {angle} = this.overlay
    const box = this.overlay.canvas.getBoundingClientRect()
    angle.hidden = false
    angle.textContent = `${"XYZ"[this.held.axis]} ${this.held.degrees}°`
    angle.style.left = `${e.clientX - box.left}px`
    angle.style.top = `${e.clientY - box.top}px`
  }

  release() {
    const {held} = this
    if (!held) { return }
    if (held.said !== held.degrees) { this.say() }
    held.group.classList.remove("held")
    this.svg.classList.remove("holding")
    this.overlay.angle.hidden = true
    this.held = null
  }

  // Where a ring can be taken hold of, on the page: for tests.
  handle(axis) {
    const box = this.overlay.canvas.getBoundingClientRect()
    const {dot} = this.rings[axis]
    return [box.left + Number(dot.getAttribute("cx")), box.top + Number(dot.getAttribute("cy"))]
  }
}

function identities(count) {
  const out = new Float32Array(16 * count)
  for (let i = 0; i < count; i++) { for (let k = 0; k < 4; k++) { out[16 * i + 5 * k] = 1 } }
  return out
}
