// How much of the canvas the cards over it leave free, and how far away the eye must be for the
// character to be seen whole in it.

const SLIM = 700  // a canvas less wide than this has no room beside its cards
const NARROW_VIEW = 330  // a view less wide than this has none beside the tools
const UNDER_TOOLS = 56
const NARROW_FEET = 600  // in a view less wide than this the legend would cover feet
const LARGE = 300  // a card this wide has a part of the canvas for itself, whatever its width
const GAP = 6

class Room {
  constructor({overlay, stage, orbit, changed, rested}) {
    Object.assign(this, {overlay, stage, orbit, changed, rested})
    this.factor = 1  // how many times as far away as without cards
    this.observer = new ResizeObserver(() => this.make())
    for (const part of [overlay.canvas, overlay.legend, overlay.transport]) { this.observer.observe(part) }
  }

  // Panel puts what stands beside the canvas in the same place into wrappers beside its own.
  get cards() {
    const own = this.overlay.root.getRootNode().host?.parentNode
    const beside = [...own?.parentNode?.children || []].filter((one) => one !== own)
    return beside.map((wrapper) => wrapper.firstElementChild).filter(Boolean)
  }

  // Sees what is free, and fits the character into it.
  make() {
    const box = this.overlay.canvas.getBoundingClientRect()
    if (!box.height) { return }
    const {cards} = this
    for (const card of cards) { this.observer.observe(card) }
    const room = this.free(box, cards)
    const seen = JSON.stringify([room, box.width, box.height, this.stage.views.length])
    if (seen === this.seen) { return }
    this.seen = seen
    this.stage.room = room
    const fitted = this.fit(room)
    // A few pixels change nothing.
    if (this.fitted && Math.abs(fitted / this.fitted - 1) > 0.03) {
      this.orbit.scale(fitted / this.fitted)
      this.fits(fitted)
      this.rested()  // pictures are drawn from where this camera is
    }
    this.changed()
  }

  // What cards take, from each edge.
  free(box, cards) {
    const several = this.stage.views.length > 1
    const room = noCards(several)
    const slim = box.width < SLIM
    if (slim || (several && this.stage.tilesIn(room)[0][2] < NARROW_VIEW)) { room.top = UNDER_TOOLS }
    const {legend, transport} = this.overlay
    const take = (edge, pixels) => { room[edge] = Math.max(room[edge], pixels + GAP) }
    for (const card of cards) {
      const {left, right, top, bottom, width, height} = card.getBoundingClientRect()
      if (!width || !height) { continue }
      if (width > 0.6 * box.width || width > 2.5 * height) {
        const below = top + bottom > box.top + box.bottom
        if (below) { take("bottom", box.bottom - top) }
        // A notice does not push aside what has the whole of a wide canvas.
        else if (slim || several) { take("top", bottom - box.top) }
      } else if (width > Math.min(LARGE, 0.28 * box.width)) {
        const after = left + right > box.left + box.right
        if (after) { take("right", box.right - left) } else { take("left", right - box.left) }
      }
    }
    // In a wide canvas they stand beside one character, but before those of several narrow views.
    const narrow = several && this.stage.tilesIn(room)[0][2] < NARROW_FEET
    for (const part of slim || narrow ? [legend, transport] : []) {
      if (!part.hidden) { take("bottom", box.bottom - part.getBoundingClientRect().top) }
    }
    return room
  }

  // How far away the view that one begins with must be.
  fit(room) {
    const {yaw, pitch, target} = this.orbit.home
    const way = [Math.cos(pitch) * Math.sin(yaw), Math.sin(pitch), Math.cos(pitch) * Math.cos(yaw)]
    return this.stage.fitting(way, target, room)
  }

  fits(fitted) {
    this.fitted = fitted
    this.factor = fitted / this.fit(noCards(this.stage.views.length > 1))
  }

  // Begins to look from where the server says, from as far as this window needs; or, for now, from
  // somewhere else. What is told of cameras knows no cards.
  frame({position, focal_point: target, now}) {
    this.make()
    const offset = position.map((x, i) => x - target[i])
    const direction = offset.map((x) => x / Math.hypot(...offset))
    const distance = this.stage.fitting(direction, target, this.stage.room)
    this.orbit.setHome(direction.map((x, i) => target[i] + distance * x), target)
    this.fits(distance)
    if (now) {
      this.orbit.look(now.position, now.focal_point)
      this.orbit.distance *= this.factor
    }
    this.orbit.moving = false
  }

  // Where the eye would be without cards.
  get position() {
    const {position, target} = this.orbit
    return position.map((x, i) => target[i] + (x - target[i]) / this.factor)
  }

  remove() {
    this.observer.disconnect()
  }
}

// Views that stand side by side fill the canvas, and have captions of their own.
function noCards(several) {
  return several ? {left: 0, right: 0, top: 0, bottom: 0} : {left: 0, right: 0, top: 20, bottom: 20}
}
