// The canvas as PyVista draws it on the server: asked for when the view rests, hidden as soon as
// anything moves.

import {element} from "../common/elements.js"

const REST = 250  // milliseconds without a change
const MOVING_RATIO = 0.5  // pixels of a frame while the view moves, where the server draws them all

export class Rendered {
  /** @param {Overlay} overlay @param {Model} model */
  constructor(overlay, model) {
    this.overlay = overlay
    this.model = model
    this.count = 0
    this.image = element("img", {className: "frame", alt: "", draggable: false})
    overlay.canvas.append(this.image)
  }

  turn(on) {
    this.on = on
    if (!on) { this.hide() }
  }

  hide() {
    this.count += 1
    clearTimeout(this.timer)
    this.overlay.canvas.classList.remove("rendered")
  }

  // What is seen now has come to rest: `frame()` returns its camera and tiles.
  rest(frame) {
    clearTimeout(this.timer)
    if (this.on) { this.timer = setTimeout(() => this.ask(frame()), REST) }
  }

  /** @param {Frame} frame @param {boolean} [fine] */
  ask(frame, fine = true) {
    const {clientWidth, clientHeight} = this.overlay.canvas
    const size = /** @type {[number, number]} */ ([clientWidth, clientHeight])
    const ratio = fine ? Math.min(window.devicePixelRatio || 1, 2) : MOVING_RATIO
    this.model.send_msg({type: "draw-frame", count: this.count, size, ratio, fine, ...frame})
  }

  async receive({count, picture}) {
    if (count !== this.count) { return }
    const url = URL.createObjectURL(new Blob([picture], {type: "image/png"}))
    this.image.src = url
    await this.image.decode().catch(() => {})
    URL.revokeObjectURL(url)
    if (count === this.count) { this.overlay.canvas.classList.add("rendered") }
  }

  remove() {
    clearTimeout(this.timer)
  }
}
