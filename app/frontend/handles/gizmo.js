// Three rings on the chosen joint: dragging one turns the joint about its own axis.

import {onPage, within} from "../common/elements.js"
import {DragHandle, line, make} from "./drag_handle.js"
import {transformed} from "../engine/skin.js"
import {along, dot, minus, rotated, unit} from "../common/vectors.js"

const RING_COLORS = ["#e5484d", "#30a46c", "#3e83f8"]
const RING_RADIUS = 62
const RING_STEPS = 64

export class Gizmo extends DragHandle {
  // `moved(pose)` hears of each pose while a ring is dragged; `tell` sends to the server.
  constructor(overlay, renderer, hears) {
    super("gizmo", 70, overlay, renderer, hears)
    this.poseNow = hears.poseNow
    this.part = null
    this.rings = RING_COLORS.map((color, axis) => this.makeRing(color, axis))
    this.show(null)
  }

  makeRing(color, axis) {
    const group = make("g", `axis-${"xyz"[axis]}`, this.svg)
    const paths = {
      halo: make("path", "halo", group),
      far: make("path", "ring far", group, {stroke: color}),
      near: make("path", "ring near", group, {stroke: color}),
      reach: make("path", "reach", group),
    }
    const knob = make("circle", "", group, {r: 9, fill: color})
    const letter = make("text", "", group)
    letter.textContent = "XYZ"[axis]
    this.grip(paths.reach, axis)
    return {group, paths, knob, letter}
  }

  // `part`: the joint, how many there are, where it is at rest, and which joints go along.
  /** @param {Rings | null} part */
  show(part) {
    this.part = part && {...part, below: [...part.below], centre: [...part.centre]}
    if (this.held && this.held.joint !== this.part?.joint) { this.drop() }
    this.svg.style.display = part ? "" : "none"
  }

  // Where the joint is now, and its own three axes.
  frame(pose) {
    const {joint, centre} = /** @type {NonNullable<typeof this.part>} */ (this.part)
    if (!pose) { return {centre, axes: [[1, 0, 0], [0, 1, 0], [0, 0, 1]]} }
    const m = pose.subarray(16 * joint, 16 * joint + 12)
    const axes = [0, 1, 2].map((k) => unit([m[k], m[4 + k], m[8 + k]]))
    return {centre: transformed(centre, pose, joint), axes}
  }

  draw() {
    if (!this.part) { return }
    const {centre, axes} = this.frame(this.poseNow())
    const middle = this.renderer.project(centre)
    this.svg.style.visibility = middle ? "" : "hidden"
    if (!middle) { return }
    const toEye = minus(this.renderer.camera.getPosition(), centre)
    this.rings.forEach(({paths, knob, letter}, k) => {
      const points = this.around(centre, axes, k, middle[2]).map((point) =>
        ({...point, near: dot(point.spoke, toEye) >= -1e-6}))
      const arcs = (near) => {
        const runs = []
        points.slice(1).forEach((point, i) => {
          if (points[i].near !== near) { return }
          if (points[i - 1]?.near !== near) { runs.push([points[i].at]) }
          runs.at(-1).push(point.at)
        })
        return runs.map(line).join("")
      }
      paths.near.setAttribute("d", arcs(true))
      paths.far.setAttribute("d", arcs(false))
      paths.halo.setAttribute("d", arcs(true))
      paths.reach.setAttribute("d", line(points.map(({at}) => at)))
      // Each letter moves to a different side, so that no two overlap.
      const [right, down] = [[-0.3, 1], [1, -0.2], [-0.6, -1]][k]
      const score = ({at, near}) =>
        (near ? 1000 : 0) + right * (at[0] - middle[0]) + down * (at[1] - middle[1])
      const mark = points.reduce((a, b) => score(b) > score(a) ? b : a)
      const [x, y] = mark.at
      for (const [name, value] of Object.entries({cx: x, cy: y})) { knob.setAttribute(name, value) }
      for (const [name, value] of Object.entries({x, y})) { letter.setAttribute(name, value) }
    })
  }

  /**
   * Where the points of a ring are seen, and in which direction from the centre they lie.
   * @returns {{spoke: number[], at: any}[]}
   */
  around(centre, axes, axis, depth) {
    const radius = RING_RADIUS * this.renderer.pixel(depth)
    const [u, v] = [axes[(axis + 1) % 3], axes[(axis + 2) % 3]]
    return Array.from({length: RING_STEPS + 1}, (_, i) => {
      const angle = 2 * Math.PI * i / RING_STEPS
      const spoke = along([0, 0, 0], [Math.cos(angle), u], [Math.sin(angle), v])
      return {spoke, at: this.renderer.project(along(centre, [radius, spoke]))}
    }).filter(({at}) => at)
  }

  begin(e, axis) {
    if (!this.part) { return null }
    const now = this.poseNow()
    const base = now ? now.slice() : identities(this.part.joints)
    const {centre, axes} = this.frame(now)
    const motion = this.motionAt(centre, axes, axis, ...within(this.overlay.canvas, e))
    const {joint} = this.part
    this.rings[axis].group.classList.add("held")
    this.tell({type: "turn", joint, axis, degrees: 0, begin: true})
    return {axis, base, centre, turnAxis: axes[axis], joint, motion, degrees: 0, said: 0}
  }

  // How far the ring's point under the pointer moves on the screen for one radian.
  motionAt(centre, axes, axis, x, y) {
    const points = this.around(centre, axes, axis, this.renderer.project(centre)?.[2] ?? 1)
    const away = ({at}) => Math.hypot(at[0] - x, at[1] - y)
    const best = points.reduce((a, b, i) => away(b) < away(points[a]) - 0.5 ? i : a, 0)
    const count = points.length - 1
    const [a, b] = [-1, 1].map((side) => points[(best + side + count) % count].at)
    const radians = 4 * Math.PI / RING_STEPS
    const motion = [(b[0] - a[0]) / radians, (b[1] - a[1]) / radians]
    const length = Math.hypot(...motion)
    // Where a ring is seen from its edge, its point hardly moves: let the hand do, still.
    const least = RING_RADIUS * 0.5
    return length < 1e-6 ? [least, 0] : motion.map((d) => d * Math.max(least, length) / length)
  }

  follow(dx, dy, e) {
    const {held} = this
    const [wx, wy] = held.motion
    const radians = (dx * wx + dy * wy) / (wx * wx + wy * wy)
    held.degrees = Math.round(radians * 180 / Math.PI * (e.shiftKey ? 1 / 15 : 1))
      * (e.shiftKey ? 15 : 1)
    this.moved(this.poseAt(held.degrees))
    this.label(e)
    return true
  }

  // The pose when the ring is turned by some degrees from where it was taken hold of.
  poseAt(degrees) {
    const {base, centre, turnAxis} = this.held
    const turn = (v) => rotated(v, turnAxis, degrees * Math.PI / 180)
    const out = base.slice()
    for (const joint of this.part?.below ?? []) {
      for (let k = 0; k < 4; k++) {
        const rows = [0, 4, 8].map((row) => 16 * joint + row + k)
        const column = rows.map((at) => base[at])
        const turned = k < 3 ? turn(column) : along(centre, [1, turn(minus(column, centre))])
        rows.forEach((at, i) => { out[at] = turned[i] })
      }
    }
    return out
  }

  say() {
    const {joint, axis, degrees, said} = this.held
    if (degrees === said) { return }
    this.held.said = degrees
    this.tell({type: "turn", joint, axis, degrees, begin: false})
  }

  label(e) {
    const {angle} = this.overlay
    const [x, y] = within(this.overlay.canvas, e)
    angle.hidden = false
    angle.textContent = `${"XYZ"[this.held.axis]} ${this.held.degrees}°`
    Object.assign(angle.style, {left: `${x}px`, top: `${y}px`})
  }

  drop() {
    super.drop()
    this.overlay.angle.hidden = true
    for (const {group} of this.rings) { group.classList.remove("held") }
  }

  // Where a ring can be taken hold of, on the page: for tests.
  handle(axis) {
    const {knob} = this.rings[axis]
    return onPage(this.overlay.canvas, ["cx", "cy"].map((name) => Number(knob.getAttribute(name))))
  }
}

function identities(count) {
  const out = new Float32Array(16 * count)
  for (let i = 0; i < count; i++) { for (let k = 0; k < 4; k++) { out[16 * i + 5 * k] = 1 } }
  return out
}
