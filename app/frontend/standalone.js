// A page in one file, without a server: plays the messages that a server would send, which were
// recorded for each joint (standalone/page.py).

import {button, element} from "./elements.js"
import {render as inspector} from "./inspector.js"
import {Overlay} from "./overlay.js"
import {probe} from "./probe.js"
import {along, dot, minus} from "./vectors.js"
import {View} from "./view.js"

const TYPES = {f4: Float32Array, u4: Uint32Array, i4: Int32Array, u2: Uint16Array, u1: Uint8Array}
const VIEWS = [["weights", "Weights"], ["distance", "Distance"], ["graph", "Graph"]]
const AXES = ["Cut x", "Cut y", "Cut z"]
const TOGETHER = [["scalars", "table", "limits"], ["clipped", "slab"]]  // entries that are read at once
const LOW = 300  // pixels
const LEAST = 5e-3  // a weight that a card would show as 0.00

// The bytes of an element of the page.
function unpacked(id) {
  const text = atob(document.getElementById(id).textContent)
  const bytes = new Uint8Array(text.length)
  for (let i = 0; i < text.length; i++) { bytes[i] = text.charCodeAt(i) }  // Uint8Array.from takes half a second
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip")))
}

// A message with its arrays, as a server sends it; see standalone/packed.py.
function reader(buffer) {
  return function read(value) {
    if (Array.isArray(value)) { return value.map(read) }
    if (!value || typeof value !== "object" || ArrayBuffer.isView(value)) { return value }
    if (!value.$) { return Object.fromEntries(Object.entries(value).map(([name, one]) => [name, read(one)])) }
    const [type, at, length, unit] = value.$
    const array = new TYPES[type](buffer, at, length)
    return unit === 1 ? array : Float32Array.from(array, (x) => x * unit)
  }
}

// The entries of an actor's part that are not as before.
function fresh(part, before) {
  const now = {...before.reading && {reading: null}, ...part}
  const differs = (name) => JSON.stringify(now[name]) !== JSON.stringify(before[name])
  const names = Object.keys(now).filter((name) => (TOGETHER.find((all) => all.includes(name)) ?? [name]).some(differs))
  return Object.fromEntries(names.map((name) => [name, now[name]]))
}

// What a widget of the page hears of its server.
function standIn(acts, rest = {}) {
  const listeners = {}
  return {
    ...rest,
    on(name, act) { listeners[name] = act },
    set(name, value) { this[name] = value; listeners[name]?.() },
    send_msg(message) { acts[message.type]?.(message) },
  }
}

// Says something to the page that this one is a frame of; see notebook.js.
function post(message) {
  if (window.parent !== window) { window.parent.postMessage({cutcell: message}, "*") }
}

class Page {
  constructor(scenes, read, vtk) {
    Object.assign(this, {scenes, read, sent: {}, id: 0, vertex: null, clip: -1, normal: [0, 0, 1], part: 0.5})
    const {view, joint} = scenes
    Object.assign(this, {shown: view, joint, vertices: read(scenes.vertices)})
    this.dark = matchMedia("(prefers-color-scheme: dark)")
    this.card = standIn({bone: ({joint}) => this.choose(joint), close: () => this.pick(null)}, {facts: null})
    const overlay = new Overlay()
    document.body.append(this.makeControls(), element("main", {}, overlay.root, inspector({model: this.card})))
    this.view = new View(standIn({
      pick: ({joint}) => this.choose(joint),
      "pick-vertex": ({vertex}) => this.pick(vertex),
      play: ({on}) => this.send({playing: on}),
      cut: (cut) => this.follow(cut),
    }), vtk, overlay)
    window.__cutcell = Object.assign(this.view, probe(this.view))
  }

  makeControls() {
    const {joints, order, clips} = this.scenes
    const select = (label, options, choose) => {
      const made = element("select", {aria: {label}, on: {change: () => choose(Number(made.value))}},
        ...options.map(([value, text]) => element("option", {value}, text)))
      return made
    }
    this.tabs = VIEWS.map(([name, text]) => button({name, on: {click: () => this.show(name)}}, text))
    const indented = order.map(([joint, depth]) => [joint, "\u2007".repeat(depth) + joints[joint].name])
    this.joints = select("Joint", [[joints.length, "All joints"], ...indented], (joint) => this.choose(joint))
    this.clips = select("Clip", [[-1, "No clip"], ...clips.map(({name}, i) => [i, name])], (clip) => this.move(clip))
    this.reset = button({on: {click: () => this.move(-1)}}, "Reset pose")
    this.axes = select("Cut", AXES.map((text, i) => [i, text]), (axis) => this.cut(AXES.map((_, i) => Number(i === axis)), 0.5))
    this.slider = element("input", {
      type: "range", min: 0, max: 1, step: "any", aria: {label: "Position of the cut"},
      on: {input: () => this.cut(this.normal, Number(this.slider.value))},
    })
    const views = element("div", {className: "tabs", aria: {role: "group", label: "View"}}, ...this.tabs)
    return element("header", {}, views, this.joints, this.clips, this.reset, this.axes, this.slider)
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
    this.id += 1
    this.view.receive({id: this.id, ...message})
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
  select({joint, vertex}) {
    if (joint !== undefined) { this.joint = joint ?? this.scenes.joints.length }
    if (vertex !== undefined) { this.vertex = vertex }
    this.present()
    if (vertex !== undefined) { this.card.set("facts", vertex === null ? null : this.facts(vertex)) }
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
    return {middle: low.map((x, i) => (x + high[i]) / 2), half: dot(this.normal.map(Math.abs), minus(high, low)) / 2}
  }

  // Puts the plane at a part of the box: 0 cuts all of it away.
  cut(normal, part) {
    Object.assign(this, {normal, part})
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
    this.slider.value = this.part
    this.axes.value = this.normal.findIndex((x) => x > 0.999)
  }

  // Shows the view, joint, vertex and theme that are chosen.
  present() {
    const {scenes, shown, joint, clip} = this
    const [isGraph, theme] = [shown === "graph", Number(this.dark.matches)]
    const one = Math.min(joint, scenes.joints.length - 1)
    const scene = {weights: scenes.weights[joint], distance: scenes.distance[one], graph: scenes.graph[theme]}[shown]
    for (const tab of this.tabs) { tab.setAttribute("aria-pressed", tab.name === shown) }
    this.joints.value = shown === "weights" ? joint : one
    this.joints.options[0].disabled = shown !== "weights"
    this.clips.value = clip
    this.joints.hidden = isGraph
    this.clips.hidden = isGraph || !scenes.clips.length
    this.reset.hidden = isGraph || clip >= 0
    this.axes.hidden = this.slider.hidden = !isGraph
    const turns = this.joints.value < scenes.joints.length && !isGraph && clip < 0 && !this.isLow
    const gizmo = turns ? scenes.rings[one] : null
    const overlays = this.read({legend: this.isLow ? null : scene.legend ?? null, gizmo})
    this.send({theme: scenes.themes[theme], ...this.changes({...scene.actors, ...this.mark}), ...overlays})
  }

  // What differs from the actors that are there; nothing else has to be read.
  changes(actors) {
    const {sent} = this
    this.sent = actors
    return {
      remove: Object.keys(sent).filter((name) => !actors[name]),
      actors: this.read(Object.fromEntries(
        Object.entries(actors).map(([name, part]) => [name, fresh(part, sent[name] ?? {})]))),
    }
  }

  // The chosen vertex, which moves with the body.
  get mark() {
    const {vertex, view, scenes} = this
    if (vertex === null) { return {} }
    const {rest, skin: {joints, weights, count}} = view.renderer.actors.get("body")
    const row = (values, size) => values.slice(size * vertex, size * (vertex + 1))
    const skin = {joints: row(joints, count), weights: row(weights, count), count}
    return {vertex: {...scenes.mark.actors.vertex, points: row(rest, 3), skin}}
  }

  // As `vertex_facts` of the server.
  facts(vertex) {
    const {joints, sizes, reasons} = this.scenes
    const {heavy, weights, near, distances, finite, component, fallback} = this.vertices
    const [most, nearest] = [heavy, near].map(({length}) => length / fallback.length)
    const row = (ids, values, size, name) => Array.from({length: size}, (_, k) =>
      ({...joints[ids[size * vertex + k]], [name]: values[size * vertex + k]}))
    const part = component[vertex]
    return {
      vertex, computed: true,
      weights: row(heavy, weights, most, "ours").filter(({ours}) => ours > LEAST),
      distances: row(near, distances, nearest, "distance").slice(0, finite[vertex]),
      component: {number: part + 1, of: sizes.length, vertices: sizes[part]},
      reached: fallback[vertex] === 0, reason: reasons[fallback[vertex]],
    }
  }
}

export async function open() {
  const note = document.querySelector("p")
  try {
    if (!document.createElement("canvas").getContext("webgl2")) { throw new Error("it offers no WebGL 2") }
    const [script, arrays, scenes] = await Promise.all(
      [unpacked("vtk").text(), unpacked("arrays").arrayBuffer(), unpacked("scenes").json()])
    document.head.append(element("script", {textContent: script}))
    new Page(scenes, reader(arrays), window.vtk).begin()
    note.remove()
  } catch (error) {
    document.body.replaceChildren(note)
    note.textContent = `This browser cannot show the character: ${error.message}.`
    throw error
  }
}
