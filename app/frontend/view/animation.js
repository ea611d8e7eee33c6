// The animation of a wavefront: all up to the front is coloured, and the front moves on.

import {eachFrame} from "../common/frames.js"

export class Animation {
  /** @param {SceneView} view */
  constructor(view) {
    this.view = view
    this.front = null
    this.playing = null
    this.stop = () => {}
  }

  set(front) {
    this.front = front
    for (const actor of this.view.renderer.actors.values()) {
      if (actor.animation) { actor.setFront(front) }
    }
    this.view.changed()
  }

  // As a part of the greatest distance.
  tell() {
    this.view.model.send_msg({type: "halt-wave", front: this.front / this.playing.end})
  }

  play(animation) {
    this.stop()
    if (this.playing && !animation) { this.tell() }
    this.playing = animation
    if (!animation) { return }
    const {end, seconds} = animation
    this.stop = eachFrame((passed) => {
      const at = (this.front ?? end) + passed / seconds * end
      this.set(at >= end ? 0 : at)
    })
  }

  remove() {
    this.stop()
  }
}
