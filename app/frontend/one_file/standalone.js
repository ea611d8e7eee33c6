// A page in one file, without a server: plays the messages that a server would send, which were
// recorded for each joint (headless/interactive.py).

import {button, element} from "../common/elements.js"
import {render as inspector} from "../widgets/inspector.js"
import {Overlay} from "../view/overlay.js"
import {probe} from "../view/probe.js"
import {Player, standIn, unpack} from "./recorded.js"
import {along, dot, minus} from "../common/vectors.js"
import {SceneView} from "../view/scene_view.js"

const VIEWS = [["weights", "Weights"], ["distance", "Distance"], ["graph", "Graph"]]
const BLENDINGS = [["linear", "Linear"], ["dual", "Dual quaternions"]]
const AXES = ["Cut x", "Cut y", "Cut z"]
const LOW = 300  // pixels
const LEAST = 5e-3  // a weight that a card would show as 0.00

// Says something to the page that this one is a frame of; see notebook.js.
function post(message) {
  if (window.parent !== window) { window.parent.postMessage({cutcell: message}, "*") }
}

class Page {
  /** @type {HTMLButtonElement[]} */
  tabs = []
  joints = /** @type {any} */ (null)
  clips = /** @type {any} */ (null)
  blending = /** @type {any} */ (null)
  reset = /** @type {any} */ (null)
  axes = /** @type {any} */ (null)
  slider = /** @type {any} */ (null)

  constructor(scenes, read, vtk) {
    this.scenes = scenes
    this.read = read
    this.vertex = null
    this.clip = -1
    this.normal = [0, 0, 1]
    this.part = 0.5
    this.shown = scenes.view
    this.joint = scenes.joint
    this.vertices = read(scenes.vertices)
    this.dark = matchMedia("(prefers-color-scheme: dark)")
    const acts = {pick: ({joint}) => this.choose(joint), close: () => this.pick(null)}
    this.card = standIn(acts, {facts: null})
    const overlay = new Overlay()
    const main = element("main", {}, overlay.root, inspector({model: this.card}))
    document.body.append(this.makeControls(), main)
    this.view = new SceneView(standIn({
      "pick": ({joint}) => this.choose(joint),
      "pick-vertex": ({vertex}) => this.pick(vertex),
      "play": ({on}) => this.send({playing: on}),
      "move-cut": (cut) => this.follow(cut),
    }), vtk, overlay)
    this.player = new Player(this.view, read)
    window.__cutcell = Object.assign(this.view, probe(this.view))
  }

  makeControls() {
    const {joints, order, clips} = this.scenes
    const select = (label, options, choose) => {
      const on = {change: () => choose(Number(made.value))}
      const made = element("select", {aria: {label}, on},
        ...options.map(([value, text]) => element("option", {value}, text)))
      return made
    }
    /** @param {string[]} view */
    const tab = ([name, text]) => button({name, on: {click: () => this.show(name)}}, text)
    this.tabs = VIEWS.map(tab)
    const indented = ([joint, depth]) => [joint, "\u2007".repeat(depth) + joints[joint].name]
    const all = [[joints.length, "All joints"], ...order.map(indented)]
    this.joints = select("Joint", all, (joint) => this.choose(joint))
    const motions = [[-1, "No clip"], ...clips.map(({name}, i) => [i, name])]
    this.clips = select("Clip", motions, (clip) => this.move(clip))
    const blendings = BLENDINGS.map(([, text], i) => [i, text])
    this.blending = select("Blending", blendings, (i) => this.send({blending: BLENDINGS[i][0]}))
    this.reset = button({on: {click: () => this.move(-1)}}, "Reset pose")
    const normal = (axis) => AXES.map((_, i) => Number(i === axis))
    const axes = AXES.map((text, i) => [i, text])
    this.axes = select("Cut", axes, (axis) => this.cut(normal(axis), 0.5))
    this.slider = element("input", {
      type: "range", min: 0, max: 1, step: "any", aria: {label: "Position of the cut"},
      on: {input: () => this.cut(this.normal, Number(this.slider.value))},
    })
    const group = {className: "tabs", aria: {role: "group", label: "View"}}
    const views = element("div", group, ...this.tabs)
    const posing = [this.clips, this.blending, this.reset]
    return element("header", {}, views, this.joints, ...posing, this.axes, this.slider)
  }

  begin() {
    this.dark.addEventListener("change", () => this.present())
    this.send(this.read(this.scenes.first))
    this.show(this.shown)
    new ResizeObserver(() => this.fit()).observe(this.view.overlay.root)
    window.addEventListener("message", ({source, data}) => {
      if (source === window.parent && data?.cutcell) { this.select(data.cutcell) }
    })
    post("ready")
  }

  // Where there is little space, nothing is drawn over the character.
  fit() {
    const isLow = this.view.overlay.root.clientHeight < LOW
    if (isLow === this.isLow) { return }
    this.isLow = isLow
    this.present()
  }

  send(message) {
    this.player.send(message)
  }

  show(view) {
    this.shown = view
    this.present()
    if (view !== "graph") { this.send({cut: null, handles: null}); return }
    this.move(-1)  // the graph stands still
    this.send({handles: {box: this.scenes.box}})
    this.cut(this.normal, this.part)
  }

  choose(joint) {
    this.select({joint})
    post({joint: joint < this.scenes.joints.length ? joint : null})
  }

  pick(vertex) {
    this.select({vertex})
    post({vertex})
  }

  // Shows another joint, null for all of them, or another vertex, or both.
  /** @param {{joint?: number | null, vertex?: number | null}} chosen */
  select({joint, vertex}) {
    if (joint !== undefined) { this.joint = joint ?? this.scenes.joints.length }
    if (vertex !== undefined) { this.vertex = vertex }
    this.present()
    if (vertex === undefined) { return }
    this.card.set("facts", vertex === null ? null : this.facts(vertex))
  }

  // Plays a clip; -1 goes back to rest.
  move(clip) {
    this.clip = clip
    const calm = matchMedia("(prefers-reduced-motion: reduce)").matches
    const part = this.read(this.scenes.clips[clip]?.clip ?? null)
    this.view.time = 0
    this.present()
    this.send({pose: null, clip: part, playing: Boolean(part) && !calm})
  }

  // The middle of the box, and how far it reaches from there along the plane's normal.
  get across() {
    const [low, high] = this.scenes.box
    const half = dot(this.normal.map(Math.abs), minus(high, low)) / 2
    return {middle: low.map((x, i) => (x + high[i]) / 2), half}
  }

  // Puts the plane at a part of the box: 0 cuts all of it away.
  cut(normal, part) {
    this.normal = normal
    this.part = part
    const {middle, half} = this.across
    this.send({cut: {origin: along(middle, [(2 * part - 1) * half, normal]), normal}})
    this.label()
  }

  // The plane was dragged.
  follow({origin, normal}) {
    this.normal = normal
    const {middle, half} = this.across
    this.part = (dot(normal, minus(origin, middle)) / half + 1) / 2
    this.label()
  }

  label() {
    this.slider.valueAsNumber = this.part
    this.axes.selectedIndex = this.normal.findIndex((x) => x > 0.999)
  }

  // Shows the view, joint, vertex and theme that are chosen.
  present() {
    const {scenes, shown, joint, clip} = this
    const [isGraph, theme] = [shown === "graph", Number(this.dark.matches)]
    const one = Math.min(joint, scenes.joints.length - 1)
    const scene = scenes[shown][{weights: joint, distance: one, graph: theme}[shown]]
    for (const tab of this.tabs) { tab.setAttribute("aria-pressed", String(tab.name === shown)) }
    this.joints.value = shown === "weights" ? joint : one
    this.joints.options[0].disabled = shown !== "weights"
    this.clips.value = String(clip)
    this.joints.hidden = this.blending.hidden = isGraph
    this.clips.hidden = isGraph || !scenes.clips.length
    this.reset.hidden = isGraph || clip >= 0
    this.axes.hidden = this.slider.hidden = !isGraph
    const turns = this.joints.value < scenes.joints.length && !isGraph && clip < 0 && !this.isLow
    const gizmo = turns ? scenes.rings[one] : null
    const overlays = this.read({legend: this.isLow ? null : scene.legend ?? null, gizmo})
    this.player.show({...scene.actors, ...this.mark}, {theme: scenes.themes[theme], ...overlays})
  }

  // The chosen vertex, which moves with the body.
  get mark() {
    const {vertex, view, scenes} = this
    if (vertex === null) { return {} }
    const {rest, skin: {joints, weights, count}} = /** @type {any} */ (
      view.renderer.actors.get("body"))
    const row = (values, size) => values.slice(size * vertex, size * (vertex + 1))
    const skin = {joints: row(joints, count), weights: row(weights, count), count}
    return {vertex: {...scenes.mark.actors.vertex, points: row(rest, 3), skin}}
  }

  // As `vertex_facts` of the server.
  facts(vertex) {
    const {joints, sizes, reasons, unit} = this.scenes
    const {heavy, weights, near, distances, finite, component, fallback} = this.vertices
    const [most, nearest] = [heavy, near].map(({length}) => length / fallback.length)
    const row = (ids, values, size, name) => Array.from({length: size}, (_, k) =>
      ({...joints[ids[size * vertex + k]], [name]: values[size * vertex + k]}))
    const part = component[vertex]
    return {
      vertex, unit, computed: true,
      weights: row(heavy, weights, most, "ours").filter(({ours}) => ours > LEAST),
      distances: row(near, distances, nearest, "distance").slice(0, finite[vertex]),
      component: {number: part + 1, of: sizes.length, vertices: sizes[part]},
      reached: fallback[vertex] === 0, reason: reasons[fallback[vertex]],
    }
  }
}

export const open = () => unpack((scenes, read, vtk) => new Page(scenes, read, vtk).begin())
