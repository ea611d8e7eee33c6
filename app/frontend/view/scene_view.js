// The 3D view where the browser draws it. The server describes the scene; turning it, picking bones
// and playing motions happen here.

import {within} from "../common/elements.js"
import {Actor} from "../engine/actor.js"
import {AddressBar} from "../page/address_bar.js"
import {Animation} from "./animation.js"
import {PaintBrush} from "../handles/brush.js"
import {copy} from "../common/clipboard.js"
import {CutHandles} from "../handles/cut_handles.js"
import {eachFrame} from "../common/frames.js"
import {Gizmo} from "../handles/gizmo.js"
import {Insets} from "../camera/insets.js"
import {JointHandle} from "../handles/joint_handle.js"
import {PointHandles} from "../handles/point_handles.js"
import {Orbit} from "../camera/orbit.js"
import {Lasso} from "../handles/lasso.js"
import {plain} from "../common/panel.js"
import {onPixelRatio} from "../common/pixel_ratio.js"
import {Pointer} from "./pointer.js"
import {Rendered} from "./rendered.js"
import {Renderer} from "../engine/renderer.js"
import {Clip} from "../engine/skin.js"
import {remember} from "../common/storage.js"
import {Transport} from "./transport.js"

const UNSEEN = new Set(["id", "address", "link", "able"])  // parts that no picture shows
const CALM = 150  // milliseconds without a change, after which a slow machine draws in full

export class SceneView {
  /** @param {Model} model @param {any} vtk @param {Overlay} overlay */
  constructor(model, vtk, overlay) {
    this.model = model
    this.overlay = overlay
    this.renderer = new Renderer(vtk, overlay.canvas)
    // Before the camera: what it takes of the pointer the camera does not hear of.
    this.brush = new PaintBrush(overlay, this.renderer, {
      bodyAt: (x, y) => this.playing ? null : this.pointer.bodyAt(x, y),
      handOver: (id, place) => this.orbit.join(id, place),
      changed: () => this.changed(),
      tell: (message) => model.send_msg(message),
    })
    this.lasso = new Lasso(overlay, this.renderer, {
      body: () => this.renderer.actors.get("body"),
      handOver: (id, place) => this.orbit.join(id, place),
      tell: (message) => model.send_msg(message),
    })
    this.orbit = new Orbit(overlay.canvas, {
      changed: () => this.changed(),
      rested: () => this.rested(),
      clicked: (e) => this.pointer.clicked(e),
      hovered: (e) => this.pointer.hovered(e),
      away: (e) => this.renderer.fromTarget(within(overlay.canvas, e)),
      chosen: () => this.brush.part ? this.brush.dab(this.renderer.target) : this.pointer.chosen(),
    })
    this.pointer = new Pointer(this)
    this.animation = new Animation(this)
    this.gizmo = new Gizmo(overlay, this.renderer, {
      moved: (pose) => { this.pose = pose; this.applyPose(); this.changed() },
      tell: (message) => model.send_msg(message),
      poseNow: () => this.currentPose,
    })
    this.handles = new CutHandles(overlay, this.renderer, {
      moved: (cut) => { this.setCut(cut); this.changed() },
      tell: (message) => model.send_msg(message),
    })
    const hears = {moved: () => this.changed(), tell: (message) => model.send_msg(message)}
    this.mover = new JointHandle(overlay, this.renderer, hears)
    this.points = new PointHandles(overlay, this.renderer, hears)
    this.transport = new Transport(overlay, {
      play: (on) => model.send_msg({type: "play", on}),
      seek: (time) => { this.seek(time); this.tellTime() },
    })
    this.rendered = new Rendered(overlay, model)
    this.addressBar = new AddressBar(window)
    this.forgetRatio = onPixelRatio(() => this.changed())
    this.idle = null
    this.stop = () => {}
    this.messages = 0
    this.posed = 0
    this.insets = new Insets({
      overlay, renderer: this.renderer, orbit: this.orbit,
      changed: () => this.changed(), rested: () => this.rested(),
    })
  }

  // A page without a server has no surroundings.
  join(surroundings) {
    this.surroundings = surroundings
  }

  /** @param {ToBrowser} message */
  receive(message) {
    const {renderer} = this
    if (message.download) { save(message.download) }
    if (message.copy) { copy(this.overlay, message.copy.text, message.copy.what) }
    if (message.frame) { this.rendered.receive(message.frame) }
    if (message.idle) { this.idle?.(message.idle) }
    if ("time" in message) { this.seek(message.time) }
    if (message.painted) { this.brush.painted(message.painted, renderer.actors.get("body")) }
    if (!message.id) { return }
    for (const name of message.remove || []) {
      renderer.actors.get(name)?.remove()
      renderer.actors.delete(name)
    }
    if (message.lights) { renderer.light(message.lights) }
    if (message.theme) {
      this.overlay.theme(message.theme)
      renderer.fadeInto(message.theme)
    }
    if ("dark" in message) { remember("cutcell dark", message.dark ? "1" : "0") }
    if (message.legend !== undefined) { this.overlay.showLegend(message.legend) }
    if ("rendered" in message) {
      this.rendered.turn(message.rendered)
      this.surroundings.keys.press("rendered", message.rendered)
    }
    if ("cut" in message) {
      this.handles.put(message.cut)
      // While the plane is dragged the hand is ahead of the server.
      if (!this.handles.held) { this.setCut(message.cut) }
    }
    if ("brush" in message) { this.brush.show(message.brush) }
    if ("lasso" in message) { this.lasso.show(message.lasso) }
    this.orbit.painting = Boolean(this.brush.part || this.lasso.part)
    if ("mover" in message) { this.mover.show(message.mover) }
    if ("points" in message) { this.points.show(message.points) }
    if ("handles" in message) { this.handles.show(message.handles) }
    if (message.views) {
      this.views = message.views
      renderer.divide(this.views)
    }
    if ("images" in message) { renderer.images.set(message.images) }
    if (message.actors) { this.overlay.waiting.hidden = true }
    for (const [name, part] of Object.entries(message.actors ?? {})) {
      const actor = renderer.actors.get(name) ?? new Actor(renderer)
      renderer.actors.set(name, actor)
      actor.update(part, this.cut)
      if ("animation" in part) { actor.setFront(this.animation.front) }
    }
    if (message.bones) {
      const {start, end, joint, names} = message.bones
      this.bones = {start: [...start], end: [...end], joint: [...joint], names}
    }
    if (message.gizmo !== undefined) { this.gizmo.show(message.gizmo) }
    // While a ring is dragged the hand is ahead of the server.
    if ("pose" in message && !this.gizmo.held) { this.pose = message.pose && plain(message.pose) }
    if ("blending" in message) { this.blending = message.blending }
    if ("clip" in message) { this.clip = message.clip && new Clip(message.clip) }
    if ("playing" in message) { this.play(message.playing) }
    if ("clip" in message || "playing" in message) {
      this.transport.show(this.clip, this.playing)
      if (this.clip) { this.transport.tick(this.clip, this.time || 0) }
    }
    if ("pose" in message || "clip" in message || "blending" in message) { this.applyPose() }
    if ("front" in message && !this.animation.playing) { this.animation.set(message.front) }
    if ("animation" in message) { this.animation.play(message.animation) }
    this.insets.make()
    if (message.camera) { this.insets.frame(message.camera); this.rested() }
    if (message.home) { this.orbit.reset(); this.rested() }
    if (message.link) { this.link = message.link }
    if (message.address) {
      this.address = message.address
      this.surroundings.keys.able(message.able)
    }
    this.messages = message.id
    const isSeen = Object.keys(message).some((name) => !UNSEEN.has(name))
    if (isSeen) { this.changed() } else if (!this.waiting) { this.putAddress() }
  }

  setCut(cut) {
    this.cut = cut
    for (const actor of this.renderer.actors.values()) { actor.cut(cut) }
  }

  get currentPose() {
    return this.clip ? this.clip.at(this.time || 0) : this.pose
  }

  applyPose() {
    this.renderer.setPose(this.currentPose, this.blending === "dual")
    if (this.clip) { this.transport.tick(this.clip, this.time || 0) }
    this.posed += 1
  }

  seek(time) {
    this.time = time
    this.applyPose()
    this.changed()
  }

  play(playing) {
    if (this.playing && !playing) { this.tellTime() }
    this.playing = playing
    this.stop()
    if (!playing) { return }
    let since = 0  // seconds since the server has had the time
    this.stop = eachFrame((passed) => {
      if (!this.clip) { return }
      this.time = (this.time || 0) + this.transport.speed * passed
      this.applyPose()
      this.draw()
      since += passed
      if (since > 0.3) { since = 0; this.tellTime() }
    })
  }

  tellTime() {
    this.model.send_msg({type: "time", time: this.time || 0})
  }

  changed() {
    if (this.waiting || this.gone) { return }
    this.waiting = requestAnimationFrame(() => {
      this.waiting = null
      if (!this.playing) { this.draw() }
    })
  }

  draw(resting = false) {
    if (this.gone || !this.overlay.canvas.clientWidth) { return }
    clearTimeout(this.calming)
    this.rendered.hide()
    const moving = this.orbit.moving || Boolean(this.playing)
    this.renderer.look(this.orbit)
    const tiles = this.views?.length ? this.renderer.tiles : []
    if (String(tiles) !== this.divided || this.captioned !== this.views) {
      this.divided = String(tiles)
      this.captioned = this.views
      this.overlay.showViews(this.views || [], tiles)
    }
    this.renderer.draw(moving, resting)
    this.gizmo.draw()
    this.handles.draw()
    this.mover.draw()
    this.points.draw()
    this.brush.draw()
    this.overlay.showTarget(this.renderer.target)
    this.overlay.root.classList.toggle("elsewhere", !this.orbit.atHome)
    if (this.placing && !moving) {
      this.placing = false
      this.insets.legend.put()
    }
    if (this.address) { setTimeout(() => this.putAddress()) }
    if (!moving) { this.rendered.rest(() => this.frame) }
    if (this.renderer.rough && !moving) { this.calmDown() }
  }

  // During a stroke the next colours would wait for the picture in full.
  calmDown() {
    this.calming = setTimeout(() => this.brush.held ? this.calmDown() : this.draw(true), CALM)
  }

  // The camera and the tiles of what is seen.
  get frame() {
    const {orbit: {position, target}, renderer: {middle, tiles}} = this
    return {position, focal_point: target, centre: middle, tiles}
  }

  // The address waits for the picture: to change it takes some browsers longer than to draw.
  putAddress() {
    if (this.address) { this.addressBar.put(this.address) }
    this.address = null
  }

  rested() {
    this.changed()
    this.placing = true
    const {atHome: home, target: focal_point} = this.orbit
    const {clientWidth, clientHeight: height} = this.overlay.canvas
    const aspect = clientWidth / Math.max(height, 1)
    const {position} = this.insets
    this.model.send_msg({type: "camera-moved", home, position, focal_point, aspect, height})
  }

  remove() {
    this.gone = true
    this.playing = false
    clearTimeout(this.calming)
    cancelAnimationFrame(this.waiting)
    this.stop()
    this.forgetRatio()
    this.surroundings?.remove()
    const {addressBar, animation, gizmo, handles, insets, mover, points} = this
    const parts = [addressBar, animation, gizmo, handles, insets, mover, points]
    for (const part of [...parts, this.orbit, this.rendered, this.renderer]) { part.remove() }
  }
}

function save({name, content}) {
  const link = document.createElement("a")
  link.download = name
  link.href = URL.createObjectURL(new Blob([content]))
  link.click()
  setTimeout(() => URL.revokeObjectURL(link.href), 60000)
}
