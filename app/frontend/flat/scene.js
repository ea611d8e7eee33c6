// The flat scene over the canvas: a section of the character that is drawn and searched here, from
// data that was sent once (`viewers/flat.py`).
//
// `flatScene(host)` returns {root, show(now), remove()}; it knows no server. `show` takes
//   data    the section, or null while there is none
//   mode    "rays", "winding", "graph" or "search"; "" hides the scene
//   tau     the winding threshold
//   colors  by name, see `features/flat/overlay.py`
//   task    of a step of the lesson that asks for an act: "open" while nothing may give the answer
//           away, "done" when it is shown; else ""
// and the host has
//   answer(value)  what a person did where a step asks: a sum, a number of corners, a node
//   close()     the plane has gone into the body: show mode "" from now on
//   cards()     elements over the canvas that the drawing stays clear of
//   tools()     the toolbar over the canvas, or null
//   cover(on)   the scene covers the 3D view, or does not
//   project()   a function from points of the 3D scene to pixels of the canvas, or null

import {button, element, within} from "../common/elements.js"
import {FlatDrawing} from "./draw.js"
import {MODES} from "./modes.js"
import {FlatPlace} from "./place.js"
import {siblings} from "../common/panel.js"
import {stylesheet} from "../common/styles.js"
import {lengthText} from "../common/text.js"

const styled = await stylesheet("flat/scene.css")

const NAMES = {rays: "Rays", winding: "Winding numbers", graph: "Graph", search: "Search"}
const HELP = {
  rays: "Drag a ray, or use the arrow keys.",
  winding: "Drag a ray, or use the arrow keys.",
  graph: "Click a crossing, or use the arrow keys and Enter.",
  search: "Click a node to predict. Enter settles the next one, Space plays.",
}
const ASKED = {
  rays: "Drag the mark, or use the arrow keys. Enter answers.",
  winding: HELP.winding,
  graph: "Click corners of the triangle, or use the buttons. Enter answers.",
  search: "Click a node. Or choose one by the arrow keys, and press Enter.",
}
const KINDS = [["●", "mesh", "mesh"], ["■", "interior", "interior"], ["▲", "surface", "surface"]]
const NUMBERS = [["━", "negative", "−1"], ["━", "idle", "0"], ["━", "interior", "1"]]
const KEY = {graph: KINDS, search: KINDS, winding: NUMBERS}
const TILTING = 1100  // milliseconds
const WIDE = 700
const LOW = 420  // as a telephone on its side
const WIDE_IF_LOW = 400
const STAGED = 24 / 14  // letters of a presentation, of others
const QUEUED = 8

export function flatScene(host) {
  const canvas = element("canvas", {tabIndex: 0, aria: {role: "application"}})
  const say = element("p", {id: "say", aria: {live: "polite"}})
  const help = element("p", {className: "help"})
  const bar = element("div", {className: "bar"})
  const queue = element("ol", {aria: {label: "Queue"}})
  const key = element("p", {className: "key"})
  const tau = element("input", {
    type: "range", min: 0.01, max: 0.99, step: 0.01, aria: {label: "τ in this plane"},
    on: {input: () => { scene.tau = Number(tau.value); refresh() }},
  })
  const label = element("label", {}, "τ ", tau)
  const tilt = button({on: {click: () => begin()}}, "Into the body")
  const panel = element("div", {className: "panel"}, say, key, label, bar, queue, help)
  const space = element("div", {className: "space"})
  const work = element("div", {className: "work"}, panel, space)
  const root = element("section", {className: "flat", hidden: true}, canvas, work)

  const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"))
  const place = new FlatPlace()
  const drawing = new FlatDrawing(context, place)
  let now = {}
  let mode = null
  let tilting = null
  /** @type {Record<string, any>} */
  const scene = {zoom: 1, pixel: (point) => place.pixel(point), nearest: (point, nodes, reach) => {
    let [best, least] = [-1, reach]
    const [x, y] = place.pixel(point)
    for (const node of nodes) {
      const [px, py] = place.pixel(scene.data.nodes[node])
      const away = Math.hypot(px - x, py - y)
      if (away < least) { [best, least] = [node, away] }
    }
    return best
  }}

  const show = (given) => {
    const isNew = !mode || given.data !== now.data || given.mode !== now.mode
    if (given.tau !== now.tau) { scene.tau = given.tau }
    const isDone = given.task === "done" && (isNew || now.task !== "done")
    scene.asking = given.task === "open"
    now = given
    root.hidden = !now.mode
    host.cover?.(!root.hidden)
    if (root.hidden) { mode = null; return }
    Object.assign(scene, {data: now.data, mode: now.mode, colors: now.colors})
    root.setAttribute("aria-label", `Flat scene: ${NAMES[now.mode]}`)
    root.classList.toggle("empty", !now.data)
    if (!now.data) { mode = null; say.textContent = "Computing the section …"; return }
    if (isNew) {
      scene.length = (length) => lengthText(now.data.size * length)
      mode = now.data.rays.length ? new MODES[now.mode](scene) : null
    }
    if (isDone) { mode?.reveal?.() }
    place.tilt = 0
    tilting = null
    root.style.removeProperty("--tilt")
    label.hidden = now.mode !== "winding"
    key.replaceChildren(...(KEY[now.mode] ?? []).map(([glyph, name, text]) =>
      element("span", {style: {color: now.colors[name]}}, glyph, element("i", {}, text))),
    label.hidden ? `lengths in ${now.data.unit}` : "")
    key.hidden = !KEY[now.mode]
    queue.hidden = now.mode !== "search" || scene.asking
    tau.value = String(scene.tau)
    help.textContent = helpOf()
    refresh()
  }

  // Buttons stay the same elements while their number does, so that they keep the focus.
  const refresh = () => {
    if (!mode) { say.textContent = "This plane misses the body."; return }
    const buttons = mode.buttons()
    if (bar.childElementCount !== buttons.length + 1) {
      bar.replaceChildren(...buttons.map((_, i) => button({on: {click: () => press(i)}})), tilt)
    }
    buttons.forEach(([text], i) => { bar.children[i].textContent = text })
    tilt.hidden = scene.asking
    const text = mode.say()
    if (text) { say.textContent = text }
    canvas.setAttribute("aria-label", `${NAMES[now.mode]}. ${helpOf()}`)
    canvas.setAttribute("aria-describedby", "say")
    const queued = mode.queued?.(QUEUED) ?? []
    const more = (scene.search?.queue.length ?? 0) - queued.length
    queue.replaceChildren(...queued.map((one) => element("li", {}, one)),
      ...queued.length && more > 0 ? [element("li", {className: "more"}, `${more} more`)] : [])
    layout()
  }
  const helpOf = () => (scene.asking ? ASKED : HELP)[now.mode]
  const press = (i) => { mode.buttons()[i][1](); refresh() }

  // Draws at the next frame, and again while anything runs.
  let frame = 0
  const request = () => { frame ||= requestAnimationFrame(draw) }
  const draw = (time) => {
    frame = 0
    if (root.hidden || !mode) { return }
    if (tilting) { lean(time) }
    const runs = mode?.tick?.(time)
    if (!mode || root.hidden) { return }
    drawing.draw(scene, canvas.clientWidth, canvas.clientHeight, devicePixelRatio)
    if (runs || mode.ran) { refresh() }  // also once after the end
    mode.ran = runs
    if (tilting) { request() }
  }

  const begin = () => {
    place.project = host.project?.()
    const isCalm = matchMedia("(prefers-reduced-motion: reduce)").matches
    if (isCalm || !place.project) { host.close(); return }
    host.cover?.(false)
    tilting = {}
    request()
  }
  const lean = (time) => {
    tilting.from ??= time
    const part = Math.min((time - tilting.from) / TILTING, 1)
    place.tilt = part * part * (3 - 2 * part)
    root.style.setProperty("--tilt", String(place.tilt))
    if (part === 1) { tilting = null; host.close() }
  }

  // Stays clear of the cards over the canvas.
  const layout = () => {
    const box = root.getBoundingClientRect()
    if (!box.width) { return }
    const inset = {left: 0, right: 0, top: 0, bottom: 0}
    const cards = host.cards?.() ?? siblings(root)
    for (const card of cards) {
      observer.observe(card)
      const {left, right, top, bottom, width, height} = card.getBoundingClientRect()
      const isView = width > 0.9 * box.width && height > 0.6 * box.height
      if (!width || !height || isView || root.contains(card)) { continue }
      if (width > 0.6 * box.width) {
        const isBelow = top + bottom > box.top + box.bottom
        const edge = isBelow ? "bottom" : "top"
        inset[edge] = Math.max(inset[edge], isBelow ? box.bottom - top : bottom - box.top)
      } else if (height > 90) {
        const isRight = left + right > box.left + box.right
        const edge = isRight ? "right" : "left"
        inset[edge] = Math.max(inset[edge], isRight ? box.right - left : right - box.left)
      }
    }
    const tools = host.tools?.()?.getBoundingClientRect()
    if (tools?.width && tools.left < box.right - inset.right && box.height >= LOW) {
      inset.top = Math.max(inset.top, tools.bottom - box.top)
    }
    for (const [edge, pixels] of Object.entries(inset)) { work.style[edge] = `${pixels}px` }
    const isLow = box.height < LOW
    root.classList.toggle("low", isLow)
    const free = box.width - inset.left - inset.right
    work.classList.toggle("wide", free >= (isLow ? WIDE_IF_LOW : WIDE))
    const isStaged = getComputedStyle(root).getPropertyValue("--card-text") !== ""
    scene.zoom = isStaged && free >= WIDE ? STAGED : 1
    root.classList.toggle("large", scene.zoom > 1)
    const [width, height] = [canvas.clientWidth, canvas.clientHeight]
      .map((length) => Math.round(length * devicePixelRatio))
    if (canvas.width !== width) { canvas.width = width }
    if (canvas.height !== height) { canvas.height = height }
    const {left, top, width: wide, height: high} = space.getBoundingClientRect()
    if (now.data) {
      place.frame = now.data.frame
      const seen = mode?.seen() ?? now.data.box
      place.fit(seen, new DOMRect(left - box.left, top - box.top, wide, high))
    }
    request()
  }
  const observer = new ResizeObserver(layout)
  for (const part of [root, space]) { observer.observe(part) }

  scene.answer = (value) => { if (scene.asking) { host.answer?.(value) } }
  const point = (e, isNew) => {
    if (!mode || tilting) { return }
    mode.press(place.at(within(canvas, e)), isNew)
    refresh()
  }
  let held = null
  const on = (type, act) => canvas.addEventListener(type, act)
  on("pointerdown", (e) => {
    if (e.button) { return }
    held = e.pointerId
    canvas.setPointerCapture(held)
    point(e, true)
  })
  on("pointermove", (e) => { if (e.pointerId === held) { point(e, false) } })
  for (const type of ["pointerup", "pointercancel"]) { on(type, () => { held = null }) }
  on("keydown", (e) => {
    if (e.ctrlKey || e.metaKey || e.altKey || !mode?.key(e.key)) { return }
    e.preventDefault()
    e.stopPropagation()  // arrows also turn the 3D view and walk the steps
    refresh()
  })
  const remove = () => {
    observer.disconnect()
    cancelAnimationFrame(frame)
  }
  const outer = element("div", {style: {display: "contents"}}, styled(), root)
  return {root: outer, show, remove}
}

/** @param {{model: Model}} widget */
export function render({model}) {
  const viewport = () =>
    siblings(scene.root).map((one) => one.shadowRoot?.querySelector(".viewport")).find(Boolean)
  const scene = flatScene({
    answer: (value) => model.send_msg({type: "answer", value}),
    cover: (on) => viewport()?.classList.toggle("covered", on),
    tools: () => viewport()?.querySelector(".tools"),
    close: () => { model.value = "" },
    project: () => window.__cutcell?.renderer?.projection() ?? null,
  })
  let data = {text: null, read: null}
  const show = () => {
    if (model.data !== data.text) {
      data = {text: model.data, read: model.data ? JSON.parse(model.data) : null}
    }
    const {value: mode, tau, colors, task} = model
    scene.show({data: data.read, mode, tau, colors, task})
  }
  for (const name of ["data", "value", "tau", "colors", "task"]) { model.on(name, show) }
  model.on("remove", scene.remove)
  show()
  return scene.root
}
