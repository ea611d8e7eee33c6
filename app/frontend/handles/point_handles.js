// Points that features declare, each with a knob that moves it along the screen.

import {JointHandle} from "./joint_handle.js"

class PointHandle extends JointHandle {
  say(done) {
    this.tell({type: "move-point", name: this.part.joint, position: this.part.at, done})
  }
}

export class PointHandles {
  constructor(overlay, renderer, hears) {
    this.make = () => new PointHandle(overlay, renderer, hears)
    this.all = new Map()
  }

  // `points`: places in the scene, by their names.
  show(points) {
    const names = Object.keys(points ?? {})
    for (const [name, handle] of this.all) {
      if (!names.includes(name)) { handle.remove(); this.all.delete(name) }
    }
    for (const name of names) {
      if (!this.all.has(name)) { this.all.set(name, this.make()) }
      this.all.get(name).show({joint: name, at: points[name], mirror: null})
    }
  }

  draw() { for (const handle of this.all.values()) { handle.draw() } }

  remove() { this.show(null) }
}
