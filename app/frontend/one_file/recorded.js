// Messages that were recorded for a page in one file (headless/packed.py).

import {element} from "../common/elements.js"

const TYPES = {f4: Float32Array, u4: Uint32Array, i4: Int32Array, u2: Uint16Array, u1: Uint8Array}
// Entries that are read at once.
const TOGETHER = [["scalars", "table", "limits"], ["clipped", "slab"]]

// The bytes of an element of the page.
function unpacked(id) {
  const text = atob(document.getElementById(id)?.textContent ?? "")
  const bytes = new Uint8Array(text.length)
  // Uint8Array.from takes half a second.
  for (let i = 0; i < text.length; i++) { bytes[i] = text.charCodeAt(i) }
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip")))
}

// An object with other values.
function mapped(object, change) {
  return Object.fromEntries(Object.entries(object).map(([name, one]) => [name, change(one, name)]))
}

// A message with its arrays, as a server sends it; see headless/packed.py.
function reader(buffer) {
  return function read(value) {
    if (Array.isArray(value)) { return value.map(read) }
    if (!value || typeof value !== "object" || ArrayBuffer.isView(value)) { return value }
    if (!value.$) { return mapped(value, read) }
    const [type, at, length, unit] = value.$
    const array = new TYPES[type](buffer, at, length)
    return unit === 1 ? array : Float32Array.from(array, (x) => x * unit)
  }
}

// The entries of an actor's part that are not as before.
function fresh(part, before) {
  const now = {...before.reading && {reading: null}, ...part}
  const differs = (name) => JSON.stringify(now[name]) !== JSON.stringify(before[name])
  const group = (name) => TOGETHER.find((all) => all.includes(name)) ?? [name]
  const names = Object.keys(now).filter((name) => group(name).some(differs))
  return Object.fromEntries(names.map((name) => [name, now[name]]))
}

/**
 * What a widget of the page hears of its server.
 * @param {{[T in FromBrowser["type"]]?: (message: Extract<FromBrowser, {type: T}>) => void}} acts
 */
export function standIn(acts, rest = {}) {
  const listeners = {}
  return {
    ...rest,
    on(name, act) { listeners[name] = act },
    set(name, value) { this[name] = value; listeners[name]?.() },
    send_msg(message) { /** @type {any} */ (acts)[message.type]?.(message) },
  }
}

/** A view that plays a recording: it reads each array once. */
export class Player {
  constructor(view, read) {
    this.view = view
    this.read = read
    this.sent = {}
    this.id = 0
  }

  send(message) {
    this.id += 1
    this.view.receive({id: this.id, ...message})
  }

  // Shows other actors, with the rest of a message.
  show(actors, rest) {
    const {sent} = this
    this.sent = actors
    // An entry that an actor no longer has cannot be taken back from it.
    const isOther = (name) => !actors[name] || Object.keys(sent[name]).some((key) =>
      key !== "reading" && !(key in actors[name]))
    const remove = Object.keys(sent).filter(isOther)
    const before = (name) => remove.includes(name) ? {} : sent[name] ?? {}
    const changes = mapped(actors, (part, name) => fresh(part, before(name)))
    this.send({remove, actors: this.read(changes), ...rest})
  }
}

/** Unpacks what a page holds, and opens it. */
export async function unpack(open) {
  const note = /** @type {HTMLElement} */ (document.querySelector("p"))
  try {
    const trial = document.createElement("canvas").getContext("webgl2")
    if (!trial) { throw new Error("it offers no WebGL 2") }
    const [script, arrays, scenes] = await Promise.all(
      [unpacked("vtk").text(), unpacked("arrays").arrayBuffer(), unpacked("scenes").json()])
    document.head.append(element("script", {textContent: script}))
    open(scenes, reader(arrays), window.vtk)
    note.remove()
  } catch (error) {
    const {message} = /** @type {Error} */ (error)
    note.textContent = `This browser cannot show the character: ${message}.`
    document.body.replaceChildren(note)
    throw error
  }
}
