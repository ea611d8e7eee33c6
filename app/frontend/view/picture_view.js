// The view of a browser without WebGL: the server draws each picture, coarsely while it turns.

import {copy, copyLink} from "../common/clipboard.js"
import {Keys} from "../page/keys.js"
import {Orbit} from "../camera/orbit.js"
import {VIEWING} from "./overlay.js"
import {onPixelRatio} from "../common/pixel_ratio.js"
import {Rendered} from "./rendered.js"
import {tiles} from "../camera/tiles.js"

const SHAPE = 0.75  // width over height of a character, about

export class PictureView {
  /** @param {Model} model @param {Overlay} overlay */
  constructor(model, overlay) {
    this.model = model
    this.overlay = overlay
    this.captions = []
    overlay.hint.textContent = `${VIEWING} · drawn by the server`
    this.rendered = new Rendered(overlay, model)
    this.orbit = new Orbit(overlay.canvas, {
      changed: () => this.ask(false), rested: () => this.rested(),
      clicked: () => {}, hovered: () => {}, chosen: () => {},
    })
    this.keys = new Keys(overlay, {
      act: (act) => model.send_msg({type: "act", act}), painting: () => false,
      link: () => copyLink(overlay, this.link),
      turnable: () => overlay.canvas.matches(":focus") && !this.orbit.byMouse,
    })
    this.forgetRatio = onPixelRatio(() => this.ask(true))
    this.resized = new ResizeObserver(() => this.ask(true))
    this.resized.observe(overlay.canvas)
  }

  get tiles() {
    const {clientWidth, clientHeight} = this.overlay.canvas
    return tiles(Math.max(this.captions.length, 1), clientWidth, clientHeight, SHAPE)
  }

  /** @param {ToBrowser} message */
  receive(message) {
    if (message.copy) { copy(this.overlay, message.copy.text, message.copy.what) }
    if (message.frame) {
      this.waiting = false
      this.rendered.receive(message.frame)
      if (this.again !== undefined) { this.ask(this.again) }
    }
    if (!message.id) { return }
    if (message.link) { this.link = message.link }
    if (message.theme) { this.overlay.theme(message.theme) }
    if (message.legend !== undefined) { this.overlay.showLegend(message.legend) }
    if (message.views) {
      this.captions = message.views
      this.overlay.showViews(this.captions, this.captions.length > 1 ? this.tiles : [])
    }
    if (message.camera) {
      const {position, focal_point: target, now} = message.camera
      this.orbit.setHome(position, target)
      if (now) { this.orbit.look(now.position, now.focal_point) }
      this.rested()
    }
    if (message.home) { this.orbit.reset() }
    this.ask(true)
  }

  // One picture at a time: what is asked for meanwhile comes after it.
  ask(fine) {
    if (!this.overlay.canvas.clientWidth) { return }
    this.again = this.waiting ? fine : undefined
    if (this.waiting) { return }
    this.waiting = true
    this.overlay.waiting.hidden = true
    const {position, target} = this.orbit
    this.rendered.ask({position, focal_point: target, centre: [0, 0], tiles: this.tiles}, fine)
  }

  rested() {
    this.ask(true)
    const {atHome: home, position, target: focal_point} = this.orbit
    const {clientWidth, clientHeight} = this.overlay.canvas
    this.model.send_msg({
      type: "camera-moved", home, position, focal_point,
      aspect: clientWidth / Math.max(clientHeight, 1),
    })
  }

  remove() {
    for (const part of [this.keys, this.orbit, this.rendered]) { part.remove() }
    this.forgetRatio()
    this.resized.disconnect()
  }
}
