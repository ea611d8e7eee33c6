// A document for tests of widgets without a browser (happy-dom), and models as Panel gives them.
// Import it before any widget.

import {readFileSync} from "node:fs"
import {createRequire} from "node:module"

const installed = createRequire(new URL("../../../.venv/package.json", import.meta.url))
const window = new (installed("happy-dom").Window)()
const {document, Event, KeyboardEvent, MouseEvent, Node} = window
const requestAnimationFrame = window.requestAnimationFrame.bind(window)
Object.assign(globalThis, {document, Event, KeyboardEvent, MouseEvent, Node, requestAnimationFrame})
globalThis.fetch = async (file) => ({ok: true, text: () => readFileSync(file, "utf8")})

// A model with values, which notes the messages that are sent.
export function modelOf(values) {
  const acts = {}
  return {
    ...values,
    sent: [],
    send_msg(message) { this.sent.push(message) },
    on(name, act) { (acts[name] ??= []).push(act) },
    change(changed) {
      Object.assign(this, changed)
      for (const name of Object.keys(changed)) { acts[name]?.forEach((act) => act()) }
    },
  }
}

// What a widget renders, in the document.
export function shown(render, model) {
  const root = render({model})
  document.body.replaceChildren(root)
  return root
}

export const click = (element, about = {}) =>
  element.dispatchEvent(new MouseEvent("click", {bubbles: true, ...about}))

export const press = (element, key, about = {}) =>
  element.dispatchEvent(new KeyboardEvent("keydown", {key, bubbles: true, ...about}))
