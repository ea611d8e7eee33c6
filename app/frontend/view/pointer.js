// The object under the pointer: described on hover, chosen with a click.

import {within} from "../common/elements.js"
import {pickBone, REACH, TOUCH} from "./pick.js"
import {hitLine, hitPoint, hitSurface, valueAt} from "./surface.js"

export class Pointer {
  /** @param {SceneView} view */
  constructor(view) {
    this.view = view
  }

  // What lies under the pointer: a bone if it is met well or nothing else is, else a vertex.
  under(x, y) {
    const {renderer, bones: all} = this.view
    const bones = renderer.actors.get("bones")?.visible ? all : null
    const pick = (reach) => pickBone(renderer, bones, this.view.currentPose, x, y, reach)
    const touched = pick(TOUCH)
    if (touched !== null) { return {joint: touched} }
    const hit = this.bodyAt(x, y)
    if (hit) { return hit }
    const near = pick(REACH)
    return near === null ? null : {joint: near}
  }

  /** @param {(name: string, actor: Actor) => boolean} [those] */
  bodyAt(x, y, those = (name) => name.startsWith("body")) {
    let best = null
    const view = this.view.renderer.viewAt(x, y)
    for (const [name, actor] of this.view.renderer.actors) {
      if (!those(name, actor) || !actor.standsIn(view)) { continue }
      const hit = hitSurface(this.view.renderer, actor, x, y, this.view.cut)
      if (hit && (!best || hit.far < best.far)) { best = {...hit, vertex: hit.point, actor} }
    }
    return best
  }

  // The node of the graph that lies under the pointer, as the actor that shows it tells.
  nodeAt(x, y) {
    let best = null
    for (const actor of this.view.renderer.actors.values()) {
      if (actor.kind !== "points" || !actor.visible || !actor.reading) { continue }
      const hit = hitPoint(this.view.renderer, actor, x, y)
      if (hit && (!best || hit.score < best.score)) { best = {...hit, actor} }
    }
    return best
  }

  clicked(e) {
    const at = within(this.view.overlay.canvas, e)
    const node = this.nodeAt(...at)
    if (node) {
      const numbers = node.actor.reading?.values
      if (numbers) { this.view.model.send_msg({type: "pick-node", node: numbers[node.point]}) }
      return
    }
    const target = this.under(...at)
    if (!target) { return }
    const {joint, vertex} = target
    const view = this.view.renderer.viewAt(...at)
    this.view.model.send_msg(
      joint === undefined ? {type: "pick-vertex", vertex, view} : {type: "pick", joint},
    )
  }

  // By keys: the point of the body in the middle, where the cross is, or the one nearest to it.
  chosen() {
    const {renderer} = this.view
    const [x, y] = renderer.target
    let vertex = this.bodyAt(x, y)?.vertex
    const points = vertex === undefined ? renderer.actors.get("body")?.posed() || [] : []
    const project = renderer.projection()
    for (let i = 0, least = Infinity; i < points.length; i += 3) {
      const at = project([points[i], points[i + 1], points[i + 2]])
      const far = at ? Math.hypot(at[0] - x, at[1] - y) : Infinity
      if (far < least) { [least, vertex] = [far, i / 3] }
    }
    const view = renderer.viewAt(x, y)
    if (vertex !== undefined) { this.view.model.send_msg({type: "pick-vertex", vertex, view}) }
  }

  /** By a key: a joint that is the strongest where the pointer, or the cross, is. */
  strongest() {
    const {model, renderer} = this.view
    const [x, y] = this.at ?? renderer.target
    const vertex = this.bodyAt(x, y)?.vertex
    if (vertex !== undefined) { model.send_msg({type: "pick-strongest", vertex}) }
  }

  hovered(e) {
    this.at = e && within(this.view.overlay.canvas, e)
    if (!e || this.view.playing) { this.view.overlay.showBone(null); return }
    const [x, y] = within(this.view.overlay.canvas, e)
    const node = this.nodeAt(x, y)
    if (node) {
      this.view.overlay.showBone(valueAt(node.actor, node.point), x, y)
      return
    }
    const target = this.view.brush.part ? null : this.under(x, y)
    if (target?.joint !== undefined) {
      this.view.overlay.showBone(this.view.bones?.names[target.joint] ?? null, x, y)
      return
    }
    const text = this.lineReading(x, y) ?? this.surfaceReading(x, y)
    this.view.overlay.showBone(text, x, y, false)
  }

  surfaceReading(x, y) {
    const hit = this.bodyAt(x, y, (_name, actor) => Boolean(actor.reading))
    return hit && valueAt(hit.actor, hit.point)
  }

  lineReading(x, y) {
    for (const actor of this.view.renderer.actors.values()) {
      if (actor.kind !== "lines" || !actor.reading) { continue }
      const cell = hitLine(this.view.renderer, actor, x, y, TOUCH)
      if (cell !== null) { return valueAt(actor, cell) }
    }
    return null
  }
}
