// What tests and benchmarks ask of the view.

import {boneEnds} from "./pick.js"

export function probe(view) {
  const corner = () => {
    const {left, top} = view.overlay.canvas.getBoundingClientRect()
    return [left, top]
  }
  return {
    // Where on the page a joint's first bone is: its middle.
    bonePoint(joint) {
      const [left, top] = corner()
      const i = view.bones.joint.indexOf(joint)
      const [a, b] = boneEnds(view.renderer.projection(), view.bones, view.currentPose, i)
      return [left + (a[0] + b[0]) / 2, top + (a[1] + b[1]) / 2]
    },

    // Where on the page the handle of the chosen joint is; undefined where there is none.
    jointHandle() {
      const [left, top] = corner()
      const at = view.mover.seen
      return at && [left + at[0], top + at[1]]
    },

    // Where on the page a vertex of the body is.
    vertexPoint(vertex) {
      const [left, top] = corner()
      const p = view.renderer.actors.get("body").posed()
      const [x, y] = view.renderer.project(p.slice(3 * vertex, 3 * vertex + 3))
      return [left + x, top + y]
    },

    // Whether the server is idle, once it has finished earlier requests.
    serverRests() {
      return new Promise((done) => {
        view.answered = done
        view.model.send_msg({type: "rests?"})
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
