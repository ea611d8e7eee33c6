// The view of a browser without WebGL: the server draws each picture, coarsely while it turns.

import {Keys} from "./keys.js"
import {Orbit} from "./orbit.js"
import {Rendered} from "./rendered.js"
import {tiles} from "./tiles.js"

const SHAPE = 0.75  // width over height of a character, about

export class PictureView {
  constructor(model, overlay) {
    Object.assign(this, {model, overlay, captions: []})
    overlay.hint.textContent = "drag to turn · right-drag to move · scroll to zoom · drawn by the server"
    this.rendered = new Rendered(overlay, model)
    this.orbit = new Orbit(overlay.canvas, {
      changed: () => this.ask(false), rested: () => this.rested(),
      clicked: () => {}, hovered: () => {}, chosen: () => {},
    })
    this.keys = new Keys(overlay, {
      act: (act) => model.send_msg({type: "act", act}), painting: () => false,
      turnable: () => overlay.canvas.matches(":focus") && !this.orbit.byMouse,
    })
    this.resized = new ResizeObserver(() => this.ask(true))
    this.resized.observe(overlay.canvas)
  }

  get tiles() {
    const {clientWidth, clientHeight} = this.overlay.canvas
    return tiles(Math.max(this.captions.length, 1), clientWidth, clientHeight, SHAPE)
  }

  receive(message) {
    if (message.frame) {
      this.waiting = false
      this.rendered.receive(message.frame)
      if (this.again !== undefined) { this.ask(this.again) }
    }
    if (!message.id) { return }
    if (message.theme) { this.overlay.theme(message.theme) }
    if ("legend" in message) { this.overlay.showLegend(message.legend) }
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
    const {clientWidth, clientHeight} = this.overlay.canvas
    this.model.send_msg({
      type: "camera", home: this.orbit.atHome, position: this.orbit.position, focal_point: this.orbit.target,
      aspect: clientWidth / Math.max(clientHeight, 1),
    })
  }

  remove() {
    this.keys.remove()
    this.resized.disconnect()
    this.rendered.remove()
  }
}
