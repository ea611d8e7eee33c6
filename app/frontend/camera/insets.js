// How much of the canvas the cards over it leave free, and how far away the eye must be for the
// character to be seen whole in it.

import {Fit} from "./fit.js"
import {LegendPlace} from "./legend_place.js"
import {siblings} from "../common/panel.js"
import {noCards} from "./tiles.js"

const SLIM = 700  // a canvas less wide than this has no space beside its cards
const NARROW_VIEW = 330  // a view less wide than this has none beside the tools
const UNDER_TOOLS = 56
const NARROW_FEET = 600  // in a view less wide than this the legend would cover feet
const LARGE = 300  // a card this wide has a part of the canvas for itself, whatever its width
const LOW = 420  // a canvas less high than this, as of a telephone on its side, has none below
const GAP = 6

export class Insets {
  /** @param {{overlay: Overlay, renderer: Renderer, orbit: Orbit, [act: string]: any}} about */
  constructor({overlay, renderer, orbit, changed, rested}) {
    this.overlay = overlay
    this.renderer = renderer
    this.orbit = orbit
    this.changed = changed
    this.rested = rested
    this.legend = new LegendPlace(overlay, renderer, () => this.cards)
    this.fitting = new Fit(renderer)
    this.factor = 1  // how many times as far away as without cards
    this.observer = new ResizeObserver(() => this.make())
    this.watched = []
    this.rests = []
    this.framedRests = []
    const {canvas, legend, transport} = overlay
    for (const part of [canvas, legend, transport]) { this.observer.observe(part) }
  }

  get cards() {
    return siblings(this.overlay.root)
  }

  // Sees what is free, and fits the character into it.
  make() {
    const box = this.overlay.canvas.getBoundingClientRect()
    if (!box.height) { return }
    if (this.framesAnother()) {
      this.frame(this.framed)
      this.rested()
      return
    }
    const {cards} = this
    const gone = this.watched.filter((card) => !cards.includes(card))
    for (const card of gone) { this.observer.unobserve(card) }
    for (const card of cards) { this.observer.observe(card) }
    this.watched = cards
    if (!this.differs(box, cards)) { return }
    const insets = this.free(box, cards)
    const seen = JSON.stringify([insets, box.width, box.height, this.renderer.views.length])
    if (seen === this.seen) { return }
    this.seen = seen
    this.renderer.insets = insets
    this.overlay.showBone(null)  // something else is now where the pointer rests
    const fitted = this.fit(insets)
    // A few pixels change nothing.
    if (this.fitted && Math.abs(fitted / this.fitted - 1) > 0.03) {
      const unmoved = String(this.orbit.position) === this.left
      this.orbit.scale(fitted / this.fitted)
      if (unmoved) { this.left = String(this.orbit.position) }
      this.fits(fitted)
      this.rested()  // pictures are drawn from where this camera is
    }
    this.changed()
  }

  // Whether the character is another one than was framed: its camera may come before its body.
  framesAnother() {
    const rests = this.fitting.rests()
    const unmoved = String(this.orbit.position) === this.left
    return unmoved && rests.length && rests.some((rest, i) => rest !== this.framedRests[i])
  }

  // Whether anything that decides what is free has changed: to look at all points of the
  // character takes longer than to draw what a message brought.
  differs(box, cards) {
    const rests = this.fitting.rests()
    const places = [...cards, ...this.edges].map((part) => part.getBoundingClientRect())
    const {legend, orbit, renderer} = this
    const now = JSON.stringify([box, places, legend.shift, orbit.home, renderer.views.length])
    const same = now === this.placed && rests.length === this.rests.length
      && rests.every((rest, i) => rest === this.rests[i])
    this.placed = now
    this.rests = rests
    return !same
  }

  // What always stands over the canvas.
  get edges() {
    const {legend, transport, hint, root} = this.overlay
    return [legend, transport, hint, ...root.querySelectorAll(".tools")]
  }

  // What cards take, from each edge.
  free(box, cards) {
    const several = this.renderer.views.length > 1
    const insets = noCards(several)
    const slim = box.width < SLIM
    const narrow = slim || (several && this.renderer.tilesIn(insets)[0][2] < NARROW_VIEW)
    if (narrow && this.overlay.root.querySelector(".tools")) { insets.top = UNDER_TOOLS }
    const {legend, transport} = this.overlay
    const take = (edge, pixels, of = insets) => { of[edge] = Math.max(of[edge], pixels + GAP) }
    const beside = {left: 0, right: 0, top: 0, bottom: 0}
    const {edges} = this
    for (const card of cards) {
      const {left, right, top, bottom, width, height} = card.getBoundingClientRect()
      if (!width || !height) { continue }
      const isFlat = width > 2.5 * height && box.height >= LOW
      if (width > 0.6 * box.width || isFlat) {
        const below = top + bottom > box.top + box.bottom
        if (below) {
          take("bottom", box.bottom - top)
        } else if (slim || several) {
          take("top", bottom - box.top)
        } else {
          edges.push(card)
        }
      } else {
        const of = slim || several || width > LARGE ? insets : beside
        const isRight = left + right > box.left + box.right
        take(isRight ? "right" : "left", isRight ? box.right - left : right - box.left, of)
      }
    }
    if (!slim && !several) { return this.clear(insets, box, beside, edges) }
    const small = several && this.renderer.tilesIn(insets)[0][2] < NARROW_FEET
    // There they always need space, whatever is behind them and however it is turned.
    for (const part of slim || small ? [legend, transport] : []) {
      if (part.hidden) { continue }
      const {right, top} = this.boxOf(part)
      // A telephone on its side is too low for the legend to be below the character.
      if (part === legend && (several ? box.height < LOW : box.width > box.height)) {
        take("left", right - box.left)
      } else {
        take("bottom", box.bottom - top)
      }
    }
    return insets
  }

  // The legend is treated as in its corner, wherever it is now.
  boxOf(part) {
    const moves = part === this.overlay.legend && !part.hidden
    return moves ? this.legend.home : part.getBoundingClientRect()
  }

  // A wide canvas has space around one character, which then moves no more than it must.
  clear(insets, box, beside, edges) {
    let cleared = this.stepAside(insets, beside)
    for (let times = 0; times < 2; times++) {  // where it goes something else may be
      cleared = this.stepAside(this.rise(cleared, box, edges), beside)
    }
    return cleared
  }

  stepAside(insets, beside) {
    const {clientWidth: width} = this.renderer.element
    const [left, right] = ["left", "right"].map((edge) => Math.max(insets[edge], beside[edge]))
    let half = GAP
    this.eachPixel(insets, (aside) => { half = Math.max(half, Math.abs(aside) + GAP) })
    if (left + 2 * half + right > width) { return {...insets, left, right} }
    const middle = (insets.left + width - insets.right) / 2
    const shift = 2 * (Math.min(Math.max(middle, left + half), width - right - half) - middle)
    const grown = (edge, by) => insets[edge] + Math.max(by, 0)
    return {...insets, left: grown("left", shift), right: grown("right", -shift)}
  }

  // Cards at an edge need space only where the character would be behind them.
  rise(insets, box, edges) {
    const x = (box.width + insets.left - insets.right) / 2
    const y = (box.height + insets.top - insets.bottom) / 2
    const parts = edges.map((part) => this.boxOf(part)).filter(({width}) => width)
      .map(({left, right, top, bottom}) => ({
        left: left - box.left - GAP - x, right: right - box.left + GAP - x,
        ...top + bottom < box.top + box.bottom
          ? {edge: "top", sign: -1, above: y, pixels: bottom - box.top + GAP}
          : {edge: "bottom", sign: 1, above: box.height - y, pixels: box.bottom - top + GAP},
      }))
    const risen = {...insets}
    this.eachPixel(insets, (aside, up) => {
      for (const {left, right, edge, sign, above, pixels} of parts) {
        if (above + sign * up < pixels && aside > left && aside < right && pixels > risen[edge]) {
          risen[edge] = pixels
        }
      }
    })
    return risen
  }

  // Positions of the character's points on the screen at first.
  eachPixel(insets, see) {
    this.fitting.eachPixel(this.direction, this.orbit.home.target, this.fit(insets), see)
  }

  // Where one looks from at the beginning.
  get direction() {
    const {yaw, pitch} = this.orbit.home
    return [Math.cos(pitch) * Math.sin(yaw), Math.sin(pitch), Math.cos(pitch) * Math.cos(yaw)]
  }

  // How far away the view that one begins with must be.
  fit(insets) {
    return this.fitting.distance(this.direction, this.orbit.home.target, insets)
  }

  fits(fitted) {
    this.fitted = fitted
    this.factor = fitted / this.fit(noCards(this.renderer.views.length > 1))
  }

  // Begins to look from where the server says, from as far as this window needs; or, for now, from
  // somewhere else. Reported cameras ignore cards.
  frame(camera) {
    const {position, focal_point: target, now} = camera
    this.framed = camera
    this.framedRests = this.fitting.rests()
    this.left = null
    this.orbit.setHome(position, target)
    this.fitted = null
    this.make()
    const distance = this.fit(this.renderer.insets)
    this.orbit.setHome(this.direction.map((x, i) => target[i] + distance * x), target)
    this.fits(distance)
    if (now) {
      this.orbit.look(now.position, now.focal_point)
      this.orbit.distance *= this.factor
    }
    this.orbit.moving = false
    this.left = String(this.orbit.position)
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
