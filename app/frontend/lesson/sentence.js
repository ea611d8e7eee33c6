// Numbers in a text that can be dragged.
//
// A text holds `{alpha}` or another choice by its name. `sliders` describes each (made by
// `learn/sliders.py`): {alpha: {value: 0.5, label: "Smoothness α", stops: [[0, "0"], ...]}}.
//
//   const {node, show} = sentence("Drag α to {alpha}.", sliders, (name, value) => ...)
//   show(sliders)       // when values change elsewhere; one that is being dragged stays
//
// `node` is a <p>. The function is called with each new value, at most every WAIT milliseconds.
// Rules: `sentence.css`, by `stylesheet("lesson/sentence.css")` in the same shadow root.
// Plots: `smallPlot(plot)` in `small_plot.js`, with `plot` by `learn/plots.py`.

import {element} from "../common/elements.js"

const WAIT = 80
const TRAVEL = 220  // pixels of a drag from the first stop to the last, at least
const STEP = 3  // pixels from a stop to the next, at least

/**
 * @typedef {{value: any, label: string, stops: [any, string][]}} Slider
 * @param {string} text @param {Record<string, Slider>} sliders
 * @param {(name: string, value: any) => void} set
 */
export function sentence(text, sliders, set) {
  const made = new Map()
  const part = (piece, i) => {
    if (i % 2 === 0) { return piece }
    if (!sliders[piece]) { return `{${piece}}` }
    const one = number(sliders[piece], (value) => set(piece, value))
    made.set(piece, one)
    return one.node
  }
  const node = element("p", {}, ...text.split(/\{(\w+)\}/).map(part))
  const show = (now) => made.forEach((one, name) => { if (now[name]) { one.show(now[name]) } })
  return {node, show}
}

/** The stop nearest to a value. @param {[any, string][]} stops */
export function stopOf(stops, value) {
  const exact = stops.findIndex(([one]) => one === value)
  if (exact >= 0 || typeof value !== "number") { return Math.max(exact, 0) }
  const away = stops.map(([one]) => typeof one === "number" ? Math.abs(one - value) : Infinity)
  return away.indexOf(Math.min(...away))
}

/** The stop that a key goes to, or undefined. */
export function stopAfter(key, at, count) {
  const page = Math.max(1, Math.round(count / 10))
  const to = {
    ArrowRight: at + 1, ArrowUp: at + 1, ArrowLeft: at - 1, ArrowDown: at - 1,
    PageUp: at + page, PageDown: at - page, Home: 0, End: count - 1,
  }[key]
  return to === undefined ? to : Math.min(Math.max(to, 0), count - 1)
}

function number({value, label, stops}, set) {
  let at = stopOf(stops, value)
  let held = null
  let later = 0
  let sentAt = 0
  const node = element("span", {
    className: "number", tabIndex: 0,
    aria: {role: "slider", label, valuemin: 0, valuemax: stops.length - 1},
  })
  const draw = () => {
    node.textContent = stops[at][1]
    node.setAttribute("aria-valuenow", String(at))
    node.setAttribute("aria-valuetext", stops[at][1])
  }
  const go = (to) => {
    if (to === at) { return }
    at = to
    draw()
    clearTimeout(later)
    const tell = () => { sentAt = performance.now(); set(stops[at][0]) }
    later = setTimeout(tell, Math.max(0, sentAt + WAIT - performance.now()))
  }
  const on = (type, act) => node.addEventListener(type, act)
  on("pointerdown", (e) => {
    if (e.button) { return }
    e.preventDefault()  // else the text is selected
    node.focus()
    node.setPointerCapture(e.pointerId)
    held = {x: e.clientX, at}
  })
  on("pointermove", (e) => {
    if (!held) { return }
    const step = Math.max(STEP, TRAVEL / stops.length)
    const to = held.at + Math.round((e.clientX - held.x) / step)
    go(Math.min(Math.max(to, 0), stops.length - 1))
  })
  for (const type of ["pointerup", "pointercancel"]) { on(type, () => { held = null }) }
  on("keydown", (e) => {
    const to = e.ctrlKey || e.metaKey || e.altKey ? undefined : stopAfter(e.key, at, stops.length)
    if (to === undefined) { return }
    e.preventDefault()
    e.stopPropagation()  // arrows also walk the steps
    go(to)
  })
  draw()
  const show = (now) => {
    if (held) { return }
    stops = now.stops
    at = stopOf(stops, now.value)
    draw()
  }
  return {node, show}
}
