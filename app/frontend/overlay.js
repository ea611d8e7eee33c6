// What is written over the canvas: the legend, the name of a bone, and hints.

import {plain} from "./arrays.js"
import {button, element} from "./elements.js"
import {stylesheet} from "./styles.js"

const styled = await stylesheet("overlay.css")

export class Overlay {
  constructor() {
    const make = (tag, className, parent, hidden = true) => {
      const made = element(tag, {className, hidden})
      parent?.append(made)
      return made
    }
    this.root = make("div", "viewport", null, false)
      this.root.append(styled())
    this.canvas = make("div", "canvas", this.root, false)
    this.canvas.tabIndex = 0
    this.canvas.setAttribute("role", "application")
    this.canvas.setAttribute(
      "aria-label", "The character in 3D. Arrow keys turn, with Shift they move, plus and minus "
        + "zoom, Home resets, Enter chooses the point of the body in the middle.",
    )
    this.legend = make("div", "card legend", this.root)
    this.bone = make("div", "card bone", this.root)
    this.cross = make("div", "cross", this.root, false)
    this.cross.setAttribute("aria-hidden", "true")
    this.angle = make("div", "card angle", this.root)
    this.transport = make("div", "card transport", this.root)
    this.hint = make("div", "card hint", this.root, false)
    this.hint.textContent = "drag to turn · right-drag to move · scroll to zoom · click a bone or the body"
    this.painting = make("div", "card painting-hint", this.root)
    this.painting.textContent = matchMedia("(any-hover: none)").matches
      ? "one finger paints · beside the body it turns · two move"
      : "drag over the body to paint · beside it to turn · [ ] size · Esc ends"
    this.waiting = make("div", "card waiting", this.root, false)
    this.waiting.textContent = "Loading the character …"
    this.failed = make("div", "card failed", this.root)
    this.drop = make("div", "card drop", this.root)
  }

  theme({top, bottom, ink, card, paper}) {
    this.root.style.setProperty("--paper", paper)
    this.root.style.background = `linear-gradient(${top}, ${bottom})`
    this.root.style.setProperty("--ink", ink)
    this.root.style.setProperty("--card", card)
  }

  showLegend(legend) {
    this.legend.hidden = !legend
    if (!legend) { return }
    const {title, low, high, swatches} = legend
    this.legend.replaceChildren(element("b", {}, title))
    if (legend.table) {
      const ends = [low, high].map((text) => element("i", {}, text))
      this.legend.append(colorBar(plain(legend.table)), element("span", {}, ...ends))
    }
    for (const [color, text] of swatches || []) {
      const swatch = element("p", {}, text)
      swatch.style.setProperty("--swatch", color)
      this.legend.append(swatch)
    }
  }

  // The contents of each view, and the lines between views.
  showViews(captions, tiles) {
    if (!this.views) {
      this.views = element("div")
      this.root.append(this.views)
    }
    const put = (className, text, style) => {
      const made = element("div", {className}, ...text ? [element("span", {}, text)] : [])
      Object.assign(made.style, style)
      this.views.append(made)
    }
    this.views.replaceChildren()
    this.root.classList.toggle("several", captions.length > 1)  // feet stand where the hint is
    captions.forEach((text, i) => {
      const [left, top, width, height] = tiles[i]
      const px = (value) => `${value}px`
      put("card caption", text, {
        left: px(left + 10), top: px(top + 10), maxWidth: px(width - 20),
        boxSizing: "border-box",
      })
      if (left > tiles[0][0]) { put("seam", "", {left: px(left), top: px(top), width: "1px", height: px(height)}) }
      if (top > tiles[0][1]) { put("seam", "", {left: px(left), top: px(top), width: px(width), height: "1px"}) }
    })
  }

  // What the pointer does with a brush.
  showPainting(on) {
    this.root.classList.toggle("painting", on)
    this.painting.hidden = !on
  }

  showBone(name, x, y, isBone = true) {
    this.bone.hidden = !name
    this.canvas.classList.toggle("over-bone", Boolean(name) && isBone)
    if (!name) { return }
    this.bone.textContent = name
    this.bone.style.left = `${x}px`
    this.bone.style.top = `${y}px`
  }

  // Where Enter chooses a point; seen while the canvas has the keys.
  showTarget([x, y]) {
    Object.assign(this.cross.style, {left: `${x}px`, top: `${y}px`})
  }

  // A notice over the canvas, with a button if there is something to stop.
  say(text, stop) {
    this.drop.hidden = !text
    this.drop.textContent = text || ""
    if (text && stop) { this.drop.append(button({on: {click: stop}}, "Cancel")) }
  }

  fail(message) {
    this.waiting.hidden = true
    this.failed.hidden = false
    this.failed.textContent = message
  }
}

// A gradient, not a canvas: that would wait for the graphics card, which has a picture to draw.
function colorBar(table) {
  const bar = element("div", {className: "bar"})
  const stops = Array.from({length: table.length / 3}, (_, i) => `rgb(${table.subarray(3 * i, 3 * i + 3).join(" ")})`)
  bar.style.background = `linear-gradient(to right, ${stops.join(", ")})`
  return bar
}
