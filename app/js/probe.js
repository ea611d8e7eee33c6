// What tests and benchmarks ask of the view.

function probe(view) {
  const corner = () => {
    const {left, top} = view.overlay.canvas.getBoundingClientRect()
    return [left, top]
  }
  return {
    // Where on the page a joint's first bone is: its middle.
    bonePoint(joint) {
      const [left, top] = corner()
      const i = view.bones.joint.indexOf(joint)
      const [a, b] = boneEnds(view.stage, view.bones, view.currentPose, i)
      return [left + (a[0] + b[0]) / 2, top + (a[1] + b[1]) / 2]
    },

    // Where on the page a vertex of the body is.
    vertexPoint(vertex) {
      const [left, top] = corner()
      const p = view.stage.figures.get("body").posed()
      const [x, y] = view.stage.project([...p.slice(3 * vertex, 3 * vertex + 3)])
      return [left + x, top + y]
    },

    // Whether the server has nothing under way, once it has done what it was asked before.
    serverRests() {
      return new Promise((done) => {
        view.answered = done
        view.model.send_msg({type: "rests?"})
      })
    },

    report() {
      return {
        messages: view.messages, frames: view.stage.frames, posed: view.posed,
        cost: view.stage.smooth.cost, playing: Boolean(view.playing), time: view.time || 0,
        idle: !view.waiting && !view.stage.rough && !view.address,
        actors: Object.fromEntries([...view.stage.figures].map(([name, figure]) => [
          name, {visible: figure.visible, cells: figure.count, points: figure.rest.length / 3},
        ])),
        bones: view.bones ? view.bones.joint.length : 0,
        camera: view.orbit.position, front: view.film.front ?? null,
        filming: Boolean(view.film.playing),
      }
    },
  }
}
