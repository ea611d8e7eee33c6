// What the keys do anywhere on the page, the buttons for it, and the card that lists them.

import {button, element, elementsWithKey} from "../common/elements.js"
import {stylesheet} from "../common/styles.js"

const KEYS = [
  ["Space", "play or pause the motion"],
  ["← →", "previous, next bone"],
  ["↑ ↓", "parent, child bone"],
  ["F", "frame the chosen bone; in the lesson: present it"],
  ["Shift F", "frame the chosen bone, also in the lesson"],
  ["L", "copy the link to this view"],
  ["Ctrl Z", "undo a choice"],
  ["Ctrl Shift Z", "redo"],
  ["PgDn PgUp", "in the lesson: forward, back"],
  ["?", "show or hide this card"],
  ["Esc", "close it"],
]
const CANVAS_KEYS = [
  ["Tab", "to the canvas; then the arrows turn the view"],
  ["+ −", "zoom in, out"],
  ["Shift ← →", "with Shift the arrows move it"],
  ["Home", "reset the view"],
  ["Enter", "choose the point of the body at the cross"],
]

const BRUSH_KEYS = [
  ["B", "activate or deactivate the brush"],
  ["[ ]", "smaller, larger"],
  ["{ }", "weaker, stronger"],
  ["Enter", "in the canvas: paint at the cross"],
  ["Esc", "deactivate it"],
]
const SELECTION_KEYS = [
  ["S", "choose the strongest bone under the pointer"],
  ["Q", "activate or deactivate the lasso"],
  ["A", "select all vertices"],
  ["Shift A", "select none"],
  ["> <", "grow, shrink the selection"],
  ["I", "isolate the selection, or show all"],
  ["M", "move its weight to the chosen bone"],
  ["W", "fill it with the amount"],
  ["U", "smooth it"],
  ["C", "copy its weights"],
  ["V", "paste them by the nearest point"],
]
const SELECTION_ACTS = {
  "s": "strongest", "q": "lasso", "a": "select all", "Shift a": "select none", ">": "grow",
  "<": "shrink", "i": "isolate", "m": "move weight", "w": "fill", "u": "smooth", "c": "copy",
  "v": "paste",
}
const LASSO_POINTER = [
  ["drag", "select", "drag"],
  ["Shift drag", "add"],
  ["Ctrl drag", "subtract"],
  ["right-drag", "turn (or Alt and drag)", "two fingers"],
]

const BRUSH_POINTER = [
  ["drag over the body", "paint", "drag over the body"],
  ["Shift drag", "smooth"],
  ["Ctrl drag", "subtract"],
  ["drag beside it", "turn (or right-drag)", "drag beside it"],
  ["Shift right-drag", "move (or the middle button)", "two fingers"],
]

const POINTER = [
  ["drag", "turn", "drag"],
  ["right-drag", "move (or Shift and drag)", "two fingers"],
  ["wheel", "zoom", "pinch"],
  ["click", "choose a bone, or a point of the body", "tap"],
  ["double click", "reset the view", "double tap"],
]

const styled = await stylesheet("page/keys.css")

const TOOLS = [
  ["undo", "Undo", '<path d="M9 14L4 9l5-5M4 9h10a6 6 0 0 1 0 12h-3"/>'],
  ["redo", "Redo", '<path d="M15 14l5-5-5-5M20 9H10a6 6 0 0 0 0 12h3"/>'],
  ["reset", "Reset all choices", '<path d="M4 4v5h5M4.6 9A8 8 0 1 1 4 13"/>'],
  ["link", "Copy the link to this view",
    '<path d="M10 14a4 4 0 0 0 6 0l3-3a4 4 0 0 0-6-6l-1 1"/>'
    + '<path d="M14 10a4 4 0 0 0-6 0l-3 3a4 4 0 0 0 6 6l1-1"/>'],
  ["step", "Add this view as a step of a lesson", '<path d="M5 4h14v16H5zM12 8.5v7M8.500 12h7"/>'],
  ["rendered", "Rendered by PyVista, with soft shadows, when the view rests",
    '<circle cx="12" cy="12" r="8"/>'
    + '<path d="M12 4a8 8 0 0 1 0 16c3-4.500 3-11.500 0-16z" fill="currentColor"/>'],
  ["keys", "Help: mouse, touch and keys",
    '<path d="M9.2 9.3a2.9 2.9 0 1 1 4.4 2.5c-1 .6-1.6 1.2-1.6 2.3M12 17.6v.1"/>'],
]

// Elements that take letters, brackets and Escape; sliders, switches and closed lists do not.
const WRITTEN = "input:not([type=range], [type=checkbox], [type=radio]), textarea, select, "
  + "[contenteditable], [role=listbox], [role=menu], [role=tree], dialog"
// Those that take arrows and the space bar.
const MOVED = "input, [role=combobox], [role=slider], [role=spinbutton], [role=tab]"
const BOX = "input[type=text]:not([role])"
const PRESSED = "button, a, summary, [role=button], [role=switch], [role=checkbox]"

export class Keys {
  /** @type {Record<string, HTMLButtonElement>} */
  tools = {}
  /** @type {any} */
  card = null

  /** @param {Overlay} overlay */
  constructor(overlay, {act, link, turnable, painting}) {
    this.overlay = overlay
    this.act = act
    this.link = link
    this.turnable = turnable
    this.painting = painting
    overlay.root.append(styled(), this.makeTools(), this.makeCard())
    this.listener = (e) => this.pressed(e)
    document.addEventListener("keydown", this.listener)
  }

  makeTools() {
    this.tools = Object.fromEntries(TOOLS.map(([name, title, icon]) => {
      const click = () => this.do(name)
      return [name, button({title, icon, aria: {label: title}, on: {click}})]
    }))
    const aria = {role: "toolbar", label: "Undo, reset, help"}
    const bar = element("div", {className: "tools", aria}, ...Object.values(this.tools))
    this.able([false, false])
    return bar
  }

  makeCard() {
    const click = (e) => { if (e.target === card) { card.close() } }
    const keydown = (e) => {
      if (e.key === "?") { e.preventDefault(); e.stopPropagation(); card.close() }
    }
    const aria = {labelledby: "keys-title"}
    const card = element("dialog", {className: "keys", aria, on: {click, keydown}})
    const touch = matchMedia("(pointer: coarse)").matches
    const whole = (words) => words.replaceAll(" ", "\u00a0")
    const pointer = (ways) => ways.filter(([, , fingers]) => fingers || !touch).map(
      ([mouse, what, fingers]) =>
        touch ? [whole(fingers), what.replace(/ \(.*/, "")] : [whole(mouse), what])
    const list = (keys) => element("dl", {}, ...keys.flatMap(([key, what]) => [
      element("dt", {}, ...key.split(" ").map((one) => element("kbd", {}, one))),
      element("dd", {}, what)]))
    // Devices with fingers alone have no keys.
    const keys = matchMedia("(any-hover: none)").matches ? []
      : [["Keys of the brush", BRUSH_KEYS], ["Keys of selections", SELECTION_KEYS],
          ["Keys", KEYS], ["Keys in the canvas", CANVAS_KEYS]]
    const hands = [["In the canvas", POINTER], ["With the brush", BRUSH_POINTER],
      ["With the lasso", LASSO_POINTER]]
      .map(([title, ways]) => [title, pointer(ways)])
    const sections = [...hands, ...keys].map(([title, all]) =>
      element("section", {}, element("h3", {}, title), list(all)))
    card.append(element("h2", {id: "keys-title"}, "Controls"), element("div", {}, ...sections),
      button({on: {click: () => card.close()}}, "Close"))
    this.card = card
    return card
  }

  able([undo, redo]) {
    this.tools.undo.disabled = !undo
    this.tools.redo.disabled = !redo
  }

  press(name, on) {
    this.tools[name].setAttribute("aria-pressed", on)
  }

  toggle() {
    if (this.card.open) { this.card.close() } else { this.card.showModal() }
  }

  pressed(e) {
    if (e.defaultPrevented) { return }
    const over = elementsWithKey(e)
    // A number that was entered is done with: its box would not take another one otherwise.
    if (e.key === "Enter") { setTimeout(() => over.find((part) => part.matches(BOX))?.blur()) }
    const goesTo = (elements) => over.some((part) => part.matches(elements))
    if (goesTo(WRITTEN)) { return }
    const brush = this.brushAct(e)
    if (brush) {
      e.preventDefault()
      this.act(brush)
      return
    }
    if (e.altKey) { return }
    const control = e.ctrlKey || e.metaKey
    const name = e.key.toLowerCase()
    // Some keyboards need Shift for signs.
    const selecting = e.shiftKey && /[a-z]/.test(name) ? `Shift ${name}` : name
    let act = null
    if (control) {
      act = {z: e.shiftKey ? "redo" : "undo", y: "redo"}[name]
    } else if (e.key === "?") {
      act = "keys"
    } else if (name === "l") {
      act = "link"
    } else if (name === "f") {
      act = "frame"
    } else if (SELECTION_ACTS[selecting]) {
      act = SELECTION_ACTS[selecting]
    } else if (goesTo(MOVED)) {
      return
    } else if (e.key === " ") {
      act = goesTo(PRESSED) ? null : "play"
    } else if (!e.shiftKey && !this.turnable()) {
      act = {
        ArrowLeft: "previous", ArrowRight: "next", ArrowUp: "parent", ArrowDown: "child",
      }[e.key]
    }
    if (!act) { return }
    e.preventDefault()
    this.do(act)
  }

  // What a key or a button says: here, or on the server.
  do(act) {
    const own = {keys: () => this.toggle(), link: this.link}[act]
    if (own) { own() } else { this.act(act) }
  }

  // Some keyboards have brackets on a third level only, so Alt and Ctrl say nothing.
  brushAct(e) {
    if (e.key === "b" && !e.ctrlKey && !e.metaKey && !e.altKey) { return "brush" }
    if (!this.painting()) { return null }
    return {
      "[": "brush smaller", "]": "brush larger", "{": "brush weaker", "}": "brush stronger",
      "Escape": "brush away",
    }[e.key]
  }

  remove() {
    document.removeEventListener("keydown", this.listener)
  }
}
