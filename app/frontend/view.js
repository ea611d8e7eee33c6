// The page's 3D view. The server describes the scene; turning it, picking bones
// and playing motions happen here.

import {Actor} from "./actor.js"
import {AddressBar} from "./address_bar.js"
import {Animation} from "./animation.js"
import {plain, plainList} from "./arrays.js"
import {Connection} from "./connection.js"
import {PaintBrush} from "./brush.js"
import {CutHandles} from "./cut_handles.js"
import {Gizmo} from "./gizmo.js"
import {Insets} from "./insets.js"
import {JointHandle} from "./joint_handle.js"
import {Keys} from "./keys.js"
import {Names} from "./names.js"
import {Orbit} from "./orbit.js"
import {Overlay} from "./overlay.js"
import {Pointer} from "./pointer.js"
import {PictureView} from "./picture_view.js"
import {probe} from "./probe.js"
import {Rendered} from "./rendered.js"
import {loadVtk, Renderer} from "./renderer.js"
import {Sheet} from "./sheet.js"
import {skipLink} from "./skip_link.js"
import {Clip} from "./skin.js"
import {recall, remember} from "./storage.js"
import {Transport} from "./transport.js"
import {acceptDrops, Uploader} from "./upload.js"

const CALM = 150  // milliseconds without a change, after which a slow machine draws in full

export class View {
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
    this.orbit = new Orbit(overlay.canvas, {
      changed: () => this.changed(),
      rested: () => this.rested(),
      clicked: (e) => this.pointer.clicked(e),
      hovered: (e) => this.pointer.hovered(e),
      away: (e) => this.renderer.fromTarget(e),
      chosen: () => this.brush.part ? this.brush.dab(this.renderer.target) : this.pointer.chosen(),
    })
    this.pointer = new Pointer(this)
    this.animation = new Animation(this)
    this.gizmo = new Gizmo(overlay, this.renderer, {
      turned: (pose) => { this.pose = pose; this.applyPose(); this.changed() },
      tell: (message) => model.send_msg(message),
      poseNow: () => this.currentPose,
    })
    this.handles = new CutHandles(overlay, this.renderer, {
      moved: (cut) => { this.setCut(cut); this.changed() },
      tell: (message) => model.send_msg(message),
    })
    this.mover = new JointHandle(overlay, this.renderer, {
      moved: () => this.changed(),
      tell: (message) => model.send_msg(message),
    })
    this.transport = new Transport(overlay, {
      play: (on) => model.send_msg({type: "play", on}),
      seek: (time) => { this.time = time; this.applyPose(); this.changed(); this.tellTime() },
    })
    this.rendered = new Rendered(overlay, model)
    this.addressBar = new AddressBar(window)
    this.renderer.context.canvas.addEventListener("webglcontextlost", (e) => this.lost(e))
    this.messages = 0
    this.posed = 0
    this.insets = new Insets({
      overlay, renderer: this.renderer, orbit: this.orbit,
      changed: () => this.changed(), rested: () => this.rested(),
    })
  }

  // The rest of the page around the canvas; a page without a server has none.
  join() {
    const {model, overlay} = this
    const uploader = new Uploader(model, {
      started: (files) => overlay.say(`Sending ${files.map((f) => f.name).join(", ")}`, () => uploader.cancel()),
      moved: () => {},
      ended: () => overlay.say(null),
    })
    const over = (hanging) => overlay.say(hanging ? "Drop the character here" : null)
    acceptDrops(overlay.root, over, (files) => uploader.send(files))
    this.keys = new Keys(overlay, {
      act: (act) => model.send_msg({type: "act", act}),
      painting: () => Boolean(this.brush.part),
      turnable: () => document.activeElement && overlay.canvas.matches(":focus") && !this.orbit.byMouse,
    })
    this.wentBack = () => {
      this.addressBar.stop()
      model.send_msg({type: "visit", query: location.search})
    }
    window.addEventListener("popstate", this.wentBack)
    this.connection = new Connection(overlay)
    this.names = new Names(overlay.root)
    this.sheet = new Sheet(overlay.root)
  }

  receive(message) {
    const {renderer} = this
    if (message.download) { save(message.download) }
    if (message.frame) { this.rendered.receive(message.frame) }
    if ("rests" in message) { this.answered?.(message.rests) }
    if (message.painted) { this.brush.painted(message.painted, renderer.actors.get("body")) }
    if (!message.id) { return }
    for (const name of message.remove || []) {
      renderer.actors.get(name)?.remove()
      renderer.actors.delete(name)
    }
    if (message.lights) { renderer.light(message.lights) }
    if (message.theme) {
      this.overlay.theme(message.theme)
      renderer.haze = between(message.theme.top, message.theme.bottom)
    }
    if ("dark" in message) { remember("cutcell dark", message.dark ? "1" : "0") }
    if ("legend" in message) { this.overlay.showLegend(message.legend) }
    if ("rendered" in message) {
      this.rendered.turn(message.rendered)
      this.keys.press("rendered", message.rendered)
    }
    if ("cut" in message) {
      this.handles.put(message.cut)
      // While the plane is dragged the hand is ahead of the server.
      if (!this.handles.held) { this.setCut(message.cut) }
    }
    if ("brush" in message) {
      this.brush.show(message.brush)
      this.orbit.painting = Boolean(message.brush)
    }
    if ("mover" in message) { this.mover.show(message.mover) }
    if ("handles" in message) { this.handles.show(message.handles) }
    if (message.views) {
      this.views = message.views
      renderer.divide(this.views)
    }
    if ("images" in message) { renderer.images.set(message.images) }
    if (message.actors) { this.overlay.waiting.hidden = true }
    for (const [name, part] of entries(message.actors)) {
      if (!renderer.actors.has(name)) {
        renderer.actors.set(name, new Actor(renderer))
      }
      const actor = renderer.actors.get(name)
      actor.update(part, this.cut)
      if ("animation" in part) { actor.setFront(this.animation.front) }
    }
    if (message.bones) {
      const {start, end, joint, names} = message.bones
      this.bones = {
        start: plainList(start), end: plainList(end), joint: plainList(joint), names,
      }
    }
    if ("gizmo" in message) { this.gizmo.show(message.gizmo) }
    // While a ring is dragged the hand is ahead of the server.
    if ("pose" in message && !this.gizmo.held) { this.pose = message.pose && plain(message.pose) }
    if ("clip" in message) { this.clip = message.clip && new Clip(message.clip) }
    if ("playing" in message) { this.play(message.playing) }
    if ("clip" in message || "playing" in message) {
      this.transport.show(this.clip, this.playing)
      if (this.clip) { this.transport.tick(this.clip, this.time || 0) }
    }
    if ("pose" in message || "clip" in message) { this.applyPose() }
    if ("front" in message && !this.animation.playing) { this.animation.set(message.front) }
    if ("animation" in message) { this.animation.play(message.animation) }
    this.insets.make()
    if (message.camera) { this.insets.frame(message.camera); this.rested() }
    if (message.home) { this.orbit.reset(); this.rested() }
    if (message.address) {
      this.address = message.address
      this.keys.able(message.able)
    }
    this.messages = message.id
    this.changed()
  }

  setCut(cut) {
    this.cut = cut
    for (const actor of this.renderer.actors.values()) { actor.cut(cut) }
  }

  get currentPose() {
    return this.clip ? this.clip.at(this.time || 0) : this.pose
  }

  applyPose() {
    this.renderer.setPose(this.currentPose)
    if (this.clip) { this.transport.tick(this.clip, this.time || 0) }
    this.posed += 1
  }

  play(playing) {
    if (this.playing && !playing) { this.tellTime() }
    this.playing = playing
    this.last = null
    if (playing) { this.tick() }
  }

  tick() {
    cancelAnimationFrame(this.ticking)
    this.ticking = requestAnimationFrame((now) => {
      if (!this.playing || !this.clip || this.gone) { return }
      this.time = (this.time || 0) + (this.last === null ? 0 : this.transport.speed * Math.min(now - this.last, 100) / 1000)
      this.last = now
      this.applyPose()
      this.draw()
      this.tick()
      if (now - (this.hasAddressAt || 0) > 300) { this.hasAddressAt = now; this.tellTime() }
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
      [this.divided, this.captioned] = [String(tiles), this.views]
      this.overlay.showViews(this.views || [], tiles)
    }
    this.renderer.draw(moving, resting)
    this.gizmo.draw()
    this.handles.draw()
    this.mover.draw()
    this.brush.draw()
    this.overlay.showTarget(this.renderer.target)
    this.overlay.root.classList.toggle("elsewhere", !this.orbit.atHome)
    if (this.placing && !moving) {
      this.placing = false
      this.insets.legend.put()
    }
    if (this.address) { setTimeout(() => this.putAddress()) }
    if (!moving) { this.rendered.rest(() => this.frame) }
    if (this.renderer.rough && !moving) { this.calming = setTimeout(() => this.draw(true), CALM) }
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

  // The graphics card was reset, as on a phone that was put away: all that it had is gone.
  lost(e) {
    if (this.gone) { return }
    e.preventDefault()  // else it is never restored
    this.overlay.say("The graphics card was reset. The page is loaded again when it is ready\u00a0…")
    e.target.addEventListener("webglcontextrestored", () => location.reload(), {once: true})
  }

  rested() {
    this.changed()
    this.placing = true
    this.model.send_msg({
      type: "camera", home: this.orbit.atHome, position: this.insets.position, focal_point: this.orbit.target,
      aspect: this.overlay.canvas.clientWidth / Math.max(this.overlay.canvas.clientHeight, 1),
      height: this.overlay.canvas.clientHeight,
    })
  }

  remove() {
    this.gone = true
    this.playing = false
    window.removeEventListener("popstate", this.wentBack)
    this.keys?.remove()
    this.connection?.remove()
    this.addressBar.stop()
    this.names?.remove()
    this.sheet?.remove()
    this.insets.remove()
    clearTimeout(this.calming)
    cancelAnimationFrame(this.waiting)
    cancelAnimationFrame(this.ticking)
    this.animation.remove()
    this.rendered.remove()
    this.renderer.remove()
  }
}

function save({name, content}) {
  const link = document.createElement("a")
  link.download = name
  link.href = URL.createObjectURL(new Blob([content]))
  link.click()
  setTimeout(() => URL.revokeObjectURL(link.href), 60000)
}

// Halfway between two colours as a style sheet writes them, from 0 to 1.
function between(a, b) {
  return [1, 3, 5].map((i) => (parseInt(a.slice(i, i + 2), 16) + parseInt(b.slice(i, i + 2), 16)) / 510)
}

function entries(map) {
  if (!map) { return [] }
  return map instanceof Map ? [...map] : Object.entries(map)
}

export function render({model}) {
  const overlay = new Overlay()
  let view = null
  const begin = (made, pictures) => {
    view = made
    model.on("msg:custom", (message) => view.receive(message))
    // What was chosen here before, else what the system prefers.
    const system = matchMedia("(prefers-color-scheme: dark)").matches ? "1" : null
    const dark = recall("cutcell dark") ?? system
    const calm = matchMedia("(prefers-reduced-motion: reduce)").matches
    model.send_msg({type: "ready", width: window.innerWidth, dark, calm, pictures})
  }
  loadVtk(model.vtk_url).then((vtk) => {
    const trial = document.createElement("canvas").getContext("webgl2")
    if (!trial) { throw new Error("this browser offers no WebGL 2") }
    trial.getExtension("WEBGL_lose_context")?.loseContext()
    const made = new View(model, vtk, overlay)
    made.join()
    begin(made, false)
    window.__cutcell = Object.assign(view, probe(view))
  }).catch((error) => {
    console.info(`The server draws the 3D view: ${error.message}.`)
    begin(new PictureView(model, overlay), true)
  })
  const link = skipLink(overlay.canvas)
  model.on("remove", () => { view?.remove(); link.remove() })
  return overlay.root
}
