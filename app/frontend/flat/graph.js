// The graph in a flat section: crossings, joined to corners of triangles. See `modes.js`.

import {CORNERS} from "./draw.js"
import {around, closer, CLICK_RADIUS} from "./part.js"
import {ties} from "./search.js"

export class Graph {
  constructor(scene) {
    this.scene = scene
    scene.tied = ties(scene.data)
    scene.joined = new Set()
    this.crossings = [...scene.tied.keys()]
    const {bones: [[x, y] = [0, 0]], nodes} = scene.data
    const away = this.crossings.map((node) => Math.hypot(nodes[node][0] - x, nodes[node][1] - y))
    scene.node = this.crossings[away.indexOf(Math.min(...away))] ?? -1
    scene.chosen = new Set()  // corners, while a step asks
    this.isNear = true
  }

  seen() {
    return around(this.scene, this.scene.node, this.isNear)
  }

  join() {
    const {joined, node} = this.scene
    if (node >= 0 && !joined.delete(node)) { joined.add(node) }
  }

  reveal() {
    if (this.scene.node >= 0) { this.scene.joined.add(this.scene.node) }
  }

  choose(corner) {
    const {chosen} = this.scene
    if (!chosen.delete(corner)) { chosen.add(corner) }
  }

  answer() {
    const {size} = this.scene.chosen
    if (size) {
      this.scene.answer(size === 1 ? "1 corner" : `${size} corners`)
    }
  }

  press(point, isNew) {
    if (!isNew) { return }
    const {asking, inset, pixel} = this.scene
    if (asking) {
      const [x, y] = pixel(point)
      const away = (inset ?? []).map(([cx, cy]) => Math.hypot(cx - x, cy - y))
      const corner = away.findIndex((one) => one < CLICK_RADIUS && one === Math.min(...away))
      if (corner >= 0) { this.choose(corner) }
      return
    }
    const node = this.scene.nearest(point, this.crossings, CLICK_RADIUS)
    if (node >= 0) {
      this.scene.node = node
      this.join()
    }
  }

  key(name) {
    const by = {ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1}[name]
    if (this.scene.asking) {
      if (name === "Enter") { this.answer() }
      return name === "Enter"
    }
    if (name === "Enter" || name === " ") { this.join(); return true }
    const {crossings, scene} = this
    if (!by || !crossings.length) { return false }
    const at = crossings.indexOf(scene.node) + by
    scene.node = crossings.at(at % crossings.length)
    return true
  }

  buttons() {
    const {joined, node, asking, chosen} = this.scene
    if (asking) {
      const corners = CORNERS.map((name, i) =>
        [`${chosen.has(i) ? "✓ " : ""}Corner ${name}`, () => this.choose(i)])
      return [...corners, ["Tie", () => this.answer()]]
    }
    const isAll = joined.size === this.crossings.length
    const all = () => { this.scene.joined = new Set(isAll ? [] : this.crossings) }
    return [[joined.has(node) ? "Separate" : "Join", () => this.join()],
      [isAll ? "Separate all" : "Join all", all], closer(this)]
  }

  say() {
    const {data: {lengths}, joined, node, tied, length, asking, chosen} = this.scene
    const {crossings} = this
    if (!crossings.length) { return "No ray crosses the surface in this plane." }
    if (asking) { return `Corners that are chosen: ${chosen.size}.` }
    const texts = tied.get(node).map(([, e]) => length(lengths[e]))
    const ended = joined.has(node) ? `joined to 3 corners of its triangle: ${texts.join(", ")}`
      : "not joined to the surface"
    return `Crossing ${crossings.indexOf(node) + 1} of ${crossings.length}: ${ended}. `
      + `Joined so far: ${joined.size}.`
  }
}
