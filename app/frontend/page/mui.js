// All that the scripts know of the widget library's DOM: names for parts that it leaves without one
// for screen readers, keys of its menus, and the sheet that its sidebar is in a narrow window.
// tests/app/test_browser_private.py names what a new version lacks.

import {pageRoot} from "../common/panel.js"

const NARROW = "(max-width: 599.95px)"
const HEIGHT = "46dvh"  // as app/shell/theme.py has it

export const PARTS = {
  list: ".MuiMenu-list",
  search: ".MuiMenu-list input[type=text]",
  item: "[role=menuitem], [role=option]",
  chosen: ".Mui-selected",
  select: "[role=combobox][aria-expanded]",
  field: ".MuiInputBase-root",
  adornment: ".MuiInputAdornment-root",
  number: "input.MuiInput-input",
  checkbox: ".MuiCheckbox-root",
  title: ".header .title",
  resizer: "[aria-label='Resize sidebar']",
  sheet: ".MuiDrawer-modal .MuiDrawer-paper",
  layer: "[data-pmui-layer]",
}
const {list, search, item, field, adornment} = PARTS
const CAN = ":not([aria-disabled=true])"
const UNLABELLED = ":not([aria-label])"
const OPENING = ["Enter", " ", "ArrowDown", "ArrowUp"]

const set = (attributes) => (part) => {
  for (const [name, value] of Object.entries(attributes)) { part.setAttribute(name, value) }
}
const label = (text) => set({"aria-label": text})

const UNNAMED = {
  [search + UNLABELLED]: focusSearch,
  [`${list} ${adornment} button${UNLABELLED}`]: label("Clear search and close"),
  [`[role=progressbar]${UNLABELLED}`]: label("Progress"),
  [PARTS.sheet + UNLABELLED]: label("Controls"),
  [`${adornment} button${UNLABELLED}`]: (part) => {
    const isFirst = part === part.closest(field).querySelector("button")
    label(isFirst ? "More" : "Less")(part)
  },
  [PARTS.number + UNLABELLED]: (part) => {
    const title = part.getRootNode().querySelector("label, .MuiFormLabel-root, .MuiTypography-root")
    label(title?.textContent.replace(/:.*/, "") || "Value")(part)
  },
  // The name of an icon that is a switch stands on what surrounds its input.
  [`${PARTS.checkbox}[aria-label]`]: (part) => {
    label(part.getAttribute("aria-label"))(part.querySelector("input"))
    part.removeAttribute("aria-label")
  },
  // The library calls what a list offers items of a menu, and so the list must be one.
  [`${list}[role=listbox]`]: set({role: "menu"}),
  "[role=combobox][aria-haspopup=listbox]": set({"aria-haspopup": "menu"}),
  // The page's name is its first heading.
  [`${PARTS.title}:not([aria-level])`]: set({"role": "heading", "aria-level": "1"}),
  [`${PARTS.resizer}:not([role])`]:
    set({"role": "separator", "aria-orientation": "vertical"}),
}

// A search field has the focus when its menu opens: the library gives it to an item a moment later.
function focusSearch(input) {
  label("Search")(input)
  input.focus({preventScroll: true})
  input.select()
  input.closest(list).addEventListener("focusin", refocus, {once: true})
}

function refocus(event) {
  event.currentTarget.querySelector("input").focus({preventScroll: true})
}

// Menus open by the pointer alone, and their search field keeps the keys that choose and close.
function press(event) {
  const target = event.composedPath()[0]
  if (event.ctrlKey || event.metaKey || event.altKey || !target.matches) { return }
  const isClosed = target.matches(`${PARTS.select}[aria-expanded=false]${CAN}`)
  const act = isClosed ? OPENING.includes(event.key) && (() => target.click())
    : target.matches(search) && ACTS[event.key]
  if (!act) { return }
  swallow(event)
  // Where the key is let go, the menu is open: the space would choose what has the focus there.
  if (event.key === " ") { addEventListener("keyup", swallow, {capture: true, once: true}) }
  act(target)
}

function swallow(event) {
  event.preventDefault()
  event.stopImmediatePropagation()
}

// What the search has found; the item that contains the search field is none to choose.
function match(input) {
  const all = [...input.closest(list).querySelectorAll(`:is(${item})${CAN}`)]
    .filter((one) => !one.contains(input))
  return input.value ? all.find((one) => one.dataset.matched === "true")
    : all.find((one) => one.matches(PARTS.chosen)) ?? all[0]
}

const ACTS = {
  Enter: (input) => match(input)?.click(),
  Escape: (input) => input.closest(field).querySelector("button").click(),
  ArrowDown: (input) => {
    input.closest(list).removeEventListener("focusin", refocus)
    match(input)?.focus()
  },
}

export class Mui {
  constructor(element) {
    this.seen = new WeakSet()
    this.observers = []
    this.fitted = () => this.fit()
    addEventListener("keydown", press, true)
    this.beginning = requestAnimationFrame(() => {
      this.root = pageRoot(element) ?? document.body
      this.root.addEventListener("transitionend", this.fitted, true)
      this.root.querySelector("main")?.setAttribute("aria-label", "Character")
      this.root.querySelector("nav")?.setAttribute("aria-label", "Controls")
      this.watch(this.root)
      this.fit()
    })
  }

  watch(root) {
    if (this.seen.has(root)) { return }
    this.seen.add(root)
    const observer = new MutationObserver((changes) => {
      // A clock's text changes with each frame, and leaves all as it is.
      const nodes = changes.flatMap((change) => [...change.addedNodes, ...change.removedNodes])
      if (!nodes.some((node) => node instanceof Element)) { return }
      this.give(root)
      if (root === this.root) { this.fit() }
    })
    observer.observe(root, {childList: true, subtree: true})
    this.observers.push(observer)
    this.give(root)
  }

  give(root) {
    for (const [unnamed, give] of Object.entries(UNNAMED)) {
      for (const part of root.querySelectorAll(unnamed)) { give(part) }
    }
    for (const part of root.querySelectorAll("*")) {
      if (part.shadowRoot) { this.watch(part.shadowRoot) }
    }
  }

  // In a narrow window the sidebar is a sheet at the bottom; the page above it is shorter by that.
  fit() {
    const sheet = this.root.querySelector(PARTS.sheet)
    const open = sheet && matchMedia(NARROW).matches
      && getComputedStyle(sheet).visibility !== "hidden"
    document.documentElement.style.setProperty("--sheet", open ? HEIGHT : "0px")
    if (!open) { return }
    // Its layer covers the whole window.
    for (let part = sheet.parentElement; part; part = part.parentElement) {
      part.style.pointerEvents = "none"
      if (part.matches(PARTS.layer)) { break }
    }
    // MUI hides the canvas from screen readers, as a background.
    for (const hidden of this.root.querySelectorAll(":scope > [aria-hidden=true]")) {
      hidden.removeAttribute("aria-hidden")
    }
  }

  remove() {
    cancelAnimationFrame(this.beginning)
    removeEventListener("keydown", press, true)
    for (const observer of this.observers) { observer.disconnect() }
    this.root?.removeEventListener("transitionend", this.fitted, true)
  }
}
