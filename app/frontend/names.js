// Names for parts that the widget library leaves without one for screen readers.

import {SEARCH, focusSearch} from "./menus.js"

const UNNAMED = [
  [`${SEARCH}:not([aria-label])`, focusSearch],
  [".MuiMenu-list .MuiInputAdornment-root button:not([aria-label])", (part) => {
    part.setAttribute("aria-label", "Clear search and close")
  }],
  ["[role=progressbar]:not([aria-label])", (part) => part.setAttribute("aria-label", "Progress")],
  [".MuiInputAdornment-root button:not([aria-label])", (part) => {
    const both = [...part.closest(".MuiInputBase-root").querySelectorAll("button")]
    part.setAttribute("aria-label", both.indexOf(part) === 0 ? "More" : "Less")
  }],
  ["input.MuiInput-input:not([aria-label])", (part) => {
    const title = part.getRootNode().querySelector("label, .MuiFormLabel-root, .MuiTypography-root")
    part.setAttribute("aria-label", title?.textContent.replace(/:.*/, "") || "Value")
  }],
  // The name of an icon that is a switch stands on what surrounds its input.
  [".MuiCheckbox-root[aria-label]", (part) => {
    part.querySelector("input").setAttribute("aria-label", part.getAttribute("aria-label"))
    part.removeAttribute("aria-label")
  }],
  // The library calls what a list offers items of a menu, and so the list must be one.
  [".MuiMenu-list[role=listbox]", (part) => part.setAttribute("role", "menu")],
  ["[role=combobox][aria-haspopup=listbox]", (part) => part.setAttribute("aria-haspopup", "menu")],
  // The page's name is its first heading; empty headings are not headings.
  [".header .title:not([aria-level])", (part) => {
    part.setAttribute("role", "heading")
    part.setAttribute("aria-level", "1")
  }],
  [".MuiToolbar-root > h5:not([role])", (part) => part.setAttribute("role", "presentation")],
  ["[aria-label='Resize sidebar']:not([role])", (part) => {
    part.setAttribute("role", "separator")
    part.setAttribute("aria-orientation", "vertical")
  }],
]

export class Names {
  constructor(element) {
    this.seen = new WeakSet()
    this.observers = []
    // The page is the outermost element with a shadow tree.
    let root = element.getRootNode()
    while (root.host && root.host.getRootNode().host) { root = root.host.getRootNode() }
    this.watch(root.host ? root : document.body)
  }

  watch(root) {
    if (this.seen.has(root)) { return }
    this.seen.add(root)
    const observer = new MutationObserver(() => this.give(root))
    observer.observe(root, {childList: true, subtree: true})
    this.observers.push(observer)
    this.give(root)
  }

  give(root) {
    for (const [unnamed, give] of UNNAMED) {
      for (const part of root.querySelectorAll(unnamed)) { give(part) }
    }
    for (const part of root.querySelectorAll("*")) {
      if (part.shadowRoot) { this.watch(part.shadowRoot) }
    }
  }

  remove() {
    for (const observer of this.observers) { observer.disconnect() }
  }
}
