// The film of a field: all up to the front is coloured, and the front moves on.

class Film {
  constructor(view) {
    this.view = view
    this.front = null
    this.playing = null
  }

  set(front) {
    this.front = front
    for (const figure of this.view.stage.figures.values()) {
      if (figure.film) { figure.setFront(front) }
    }
    this.view.changed()
  }

  // As a part of the whole way.
  tell() {
    this.view.model.send_msg({type: "front", front: this.front / this.playing.end})
  }

  play(film) {
    cancelAnimationFrame(this.filming)
    if (this.playing && !film) { this.tell() }
    this.playing = film
    let last = null
    const step = (now) => {
      if (!this.playing || this.view.gone) { return }
      const moved = last === null ? 0 : Math.min(now - last, 100) / 1000 / film.seconds
      last = now
      const at = (this.front ?? film.end) + moved * film.end
      this.set(at >= film.end ? 0 : at)
      this.filming = requestAnimationFrame(step)
    }
    if (film) { this.filming = requestAnimationFrame(step) }
  }

  remove() {
    cancelAnimationFrame(this.filming)
  }
}
