// The animation of a wavefront: all up to the front is coloured, and the front moves on.

export class Animation {
  constructor(view) {
    this.view = view
    this.front = null
    this.playing = null
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
    this.view.model.send_msg({type: "front", front: this.front / this.playing.end})
  }

  play(animation) {
    cancelAnimationFrame(this.ticking)
    if (this.playing && !animation) { this.tell() }
    this.playing = animation
    let last = null
    const step = (now) => {
      if (!this.playing || this.view.gone) { return }
      const moved = last === null ? 0 : Math.min(now - last, 100) / 1000 / animation.seconds
      last = now
      const at = (this.front ?? animation.end) + moved * animation.end
      this.set(at >= animation.end ? 0 : at)
      this.ticking = requestAnimationFrame(step)
    }
    if (animation) { this.ticking = requestAnimationFrame(step) }
  }

  remove() {
    cancelAnimationFrame(this.ticking)
  }
}
