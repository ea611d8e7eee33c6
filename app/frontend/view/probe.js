// What tests and benchmarks ask of the view.

import {onPage} from "../common/elements.js"
import {boneEnds} from "./pick.js"

export function probe(view) {
  let asked = 0
  return {
    // Where on the page a joint's first bone is: its middle.
    bonePoint(joint) {
      const i = view.bones.joint.indexOf(joint)
      const [a, b] = boneEnds(view.renderer.projection(), view.bones, view.currentPose, i)
      return onPage(view.overlay.canvas, [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2])
    },

    // Where on the page the handle of the chosen joint is; undefined where there is none.
    jointHandle() {
      return view.mover.seen && onPage(view.overlay.canvas, view.mover.seen)
    },

    // Where on the page a vertex of the body is.
    vertexPoint(vertex) {
      const p = view.renderer.actors.get("body").posed()
      return onPage(view.overlay.canvas, view.renderer.project(p.slice(3 * vertex, 3 * vertex + 3)))
    },

    // Fulfilled when the server has finished all earlier requests and has no work left.
    serverIdle() {
      const number = asked += 1
      return new Promise((done) => {
        view.idle = (answered) => answered === number && done(true)
        view.model.send_msg({type: "ask-idle", number})
      })
    },

    report() {
      return {
        messages: view.messages, frames: view.renderer.frames, posed: view.posed,
        cost: view.renderer.smooth.cost, playing: Boolean(view.playing), time: view.time || 0,
        idle: !view.waiting && !view.renderer.rough && !view.address,
        actors: Object.fromEntries([...view.renderer.actors].map(([name, actor]) => [
          name, {visible: actor.visible, cells: actor.count, points: actor.rest.length / 3},
        ])),
        bones: view.bones ? view.bones.joint.length : 0,
        camera: view.orbit.position, front: view.animation.front ?? null,
        animating: Boolean(view.animation.playing),
      }
    },
  }
}
