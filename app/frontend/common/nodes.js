// Widgets as trees of virtual nodes (Preact): what changed is changed in place, so that the focus,
// carets and scrolled lists stay where they are. Texts are texts, never HTML.

import {h, render} from "../vendor/preact.js"
import {element} from "./elements.js"

export {h}

/** @typedef {import("../vendor/preact.js").Node} VNode */

/**
 * A widget that is drawn, and drawn again whenever one of these parameters of its model changes.
 * @param {Model} model @param {string[]} names @param {() => HTMLStyleElement} styled
 * @param {() => VNode} draw
 */
export function drawn(model, names, styled, draw) {
  const root = element("div")
  const show = () => render(draw(), root)
  for (const name of names) { model.on(name, show) }
  show()
  return element("div", {}, styled(), root)
}

/** @param {Record<string, any>} about @param {...VNode} children */
export const button = (about, ...children) => h("button", {type: "button", ...about}, ...children)

/** @param {string} name @param {...VNode} children */
export const span = (name, ...children) => h("span", {class: name}, ...children)

/** A picture of 24 by 24 units. @param {string} drawing what its SVG holds */
export const icon = (drawing) => h("svg", {
  "viewBox": "0 0 24 24", "aria-hidden": "true", "dangerouslySetInnerHTML": {__html: drawing},
})

const TAIL = 7  // letters at the end of a name that are always seen

/**
 * A name that a narrow box shortens in the middle: joints often differ at the end.
 * @param {string} text @param {string | null} [title]
 */
export const nameOf = (text, title = null) => h("span", {class: "name", title},
  span("start", text.slice(0, -TAIL)), span("tail", text.slice(-TAIL)))

/**
 * A box for a number whose text follows a value, but not over what a person is writing.
 * @param {string} text @param {Record<string, any>} about
 */
export const numberBox = (text, about) => h("input", {...about, ref: (box) => {
  if (!box) { return }
  if (box.value === box.defaultValue && box.value !== text) {
    box.value = text
    if (box.matches(":focus")) { box.select() }
  }
  box.defaultValue = text
}})
