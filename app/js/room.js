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
    this.fitting = new Fit(stage)
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
    this.overlay.showBone(null)  // something else is now where the pointer rests
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
    const take = (edge, pixels, of = room) => { of[edge] = Math.max(of[edge], pixels + GAP) }
    const beside = {left: 0, right: 0}
    const edges = [legend, transport, this.overlay.hint, this.overlay.root.querySelector(".tools")]
    for (const card of cards) {
      const {left, right, top, bottom, width, height} = card.getBoundingClientRect()
      if (!width || !height) { continue }
      if (width > 0.6 * box.width || width > 2.5 * height) {
        const below = top + bottom > box.top + box.bottom
        if (below) { take("bottom", box.bottom - top) }
        else if (slim || several) { take("top", bottom - box.top) }
        else { edges.push(card) }
      } else {
        const of = slim || several || width > LARGE ? room : beside
        const after = left + right > box.left + box.right
        if (after) { take("right", box.right - left, of) } else { take("left", right - box.left, of) }
      }
    }
    if (!slim && !several) { return this.clear(room, box, beside, edges) }
    const narrow = several && this.stage.tilesIn(room)[0][2] < NARROW_FEET
    // There they take room whatever stands behind them, and whichever way it is turned.
    for (const part of slim || narrow ? [legend, transport] : []) {
      if (!part.hidden) { take("bottom", box.bottom - part.getBoundingClientRect().top) }
    }
    return room
  }

  // A wide canvas has room around one character, which then makes no more room than it must.
  clear(room, box, beside, edges) {
    let cleared = this.stepAside(room, beside)
    for (let times = 0; times < 2; times++) {  // where it goes something else may be
      cleared = this.stepAside(this.rise(cleared, box, edges), beside)
    }
    return cleared
  }

  stepAside(room, beside) {
    const {clientWidth: width} = this.stage.element
    const [left, right] = ["left", "right"].map((edge) => Math.max(room[edge], beside[edge]))
    let half = GAP
    this.eachPixel(room, (aside) => { half = Math.max(half, Math.abs(aside) + GAP) })
    if (left + 2 * half + right > width) { return {...room, left, right} }
    const middle = (room.left + width - room.right) / 2
    const shift = 2 * (Math.min(Math.max(middle, left + half), width - right - half) - middle)
    return {...room, left: room.left + Math.max(shift, 0), right: room.right + Math.max(-shift, 0)}
  }

  // What is at an edge takes room only where the character would be behind it.
  rise(room, box, edges) {
    const x = (box.width + room.left - room.right) / 2
    const y = (box.height + room.top - room.bottom) / 2
    const parts = edges.map((part) => part.getBoundingClientRect()).filter(({width}) => width)
      .map(({left, right, top, bottom}) => ({
        left: left - box.left - GAP - x, right: right - box.left + GAP - x,
        ...top + bottom < box.top + box.bottom
          ? {edge: "top", way: -1, above: y, pixels: bottom - box.top + GAP}
          : {edge: "bottom", way: 1, above: box.height - y, pixels: box.bottom - top + GAP},
      }))
    const risen = {...room}
    this.eachPixel(room, (aside, up) => {
      for (const {left, right, edge, way, above, pixels} of parts) {
        if (above + way * up < pixels && aside > left && aside < right && pixels > risen[edge]) {
          risen[edge] = pixels
        }
      }
    })
    return risen
  }

  // Where the points of the character are seen by whoever begins to look.
  eachPixel(room, see) {
    this.fitting.eachPixel(this.way, this.orbit.home.target, this.fit(room), see)
  }

  // Where one looks from at the beginning.
  get way() {
    const {yaw, pitch} = this.orbit.home
    return [Math.cos(pitch) * Math.sin(yaw), Math.sin(pitch), Math.cos(pitch) * Math.cos(yaw)]
  }

  // How far away the view that one begins with must be.
  fit(room) {
    return this.fitting.distance(this.way, this.orbit.home.target, room)
  }

  fits(fitted) {
    this.fitted = fitted
    this.factor = fitted / this.fit(noCards(this.stage.views.length > 1))
  }

  // Begins to look from where the server says, from as far as this window needs; or, for now, from
  // somewhere else. What is told of cameras knows no cards.
  frame({position, focal_point: target, now}) {
    this.orbit.setHome(position, target)
    this.fitted = null
    this.make()
    const distance = this.fit(this.stage.room)
    this.orbit.setHome(this.way.map((x, i) => target[i] + distance * x), target)
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
