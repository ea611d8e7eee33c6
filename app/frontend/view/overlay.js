// What is written over the canvas: the legend, the name of a bone, and hints.

import {plain} from "../common/panel.js"
import {button, element, span} from "../common/elements.js"
import {stylesheet} from "../common/styles.js"

const styled = await stylesheet("view/overlay.css")

export const VIEWING = "drag to turn · right-drag to move · scroll to zoom"

export class Overlay {
  constructor() {
    const card = (name, text = "") =>
      element("div", {className: `card ${name}`, hidden: !text}, text)
    const label = "The character in 3D. Arrow keys turn, with Shift they move, plus and minus "
      + "zoom, Home resets, Enter chooses the point of the body in the middle."
    const aria = {role: "application", label}
    this.canvas = element("div", {className: "canvas", tabIndex: 0, aria})
    this.legend = card("legend")
    this.bone = card("bone")
    this.cross = element("div", {className: "cross", aria: {hidden: true}})
    this.angle = card("angle")
    this.transport = card("transport")
    this.hint = card("hint", `${VIEWING} · click a bone or the body`)
    this.painting = card("painting-hint", matchMedia("(any-hover: none)").matches
      ? "one finger paints · beside the body it turns · two move"
      : "drag over the body to paint · beside it to turn · [ ] size · Esc ends")
    this.painting.hidden = true
    this.waiting = card("waiting", "Loading the character …")
    this.drop = card("drop")
    this.views = element("div")
    const {canvas, legend, bone, cross, angle, transport, hint, painting, waiting, drop} = this
    this.root = element("div", {className: "viewport"}, styled(), canvas, legend, bone, cross,
      angle, transport, hint, painting, waiting, drop, this.views)
  }

  /** @param {Theme} theme */
  theme({top, bottom, ink, card, paper}) {
    this.root.style.setProperty("--paper", paper)
    this.root.style.background = `linear-gradient(${top}, ${bottom})`
    this.root.style.setProperty("--ink", ink)
    this.root.style.setProperty("--card", card)
  }

  /** @param {Legend | null} legend */
  showLegend(legend) {
    this.legend.hidden = !legend
    if (!legend) { return }
    const {title, low, high, swatches} = legend
    this.legend.replaceChildren(element("b", {}, title))
    if (legend.table) {
      const ends = [low, high].map((text) => element("i", {}, text))
      this.legend.append(colorBar(plain(legend.table)), element("span", {}, ...ends))
    }
    for (const [color, text] of swatches) {
      this.legend.append(element("p", {style: {"--swatch": color}}, text))
    }
  }

  // The contents of each view, and the lines between views.
  showViews(captions, tiles) {
    const put = (className, style, ...text) =>
      this.views.append(element("div", {className, style}, ...text.map((one) => span("", one))))
    this.views.replaceChildren()
    this.root.classList.toggle("several", captions.length > 1)  // feet stand where the hint is
    captions.forEach((text, i) => {
      const [left, top, width, height] = tiles[i]
      const px = (value) => `${value}px`
      put("card caption", {
        "left": px(left + 10), "top": px(top + 10), "max-width": px(width - 20),
        "box-sizing": "border-box",
      }, text)
      const seam = (wide, high) =>
        put("seam", {left: px(left), top: px(top), width: wide, height: high})
      if (left > tiles[0][0]) { seam("1px", px(height)) }
      if (top > tiles[0][1]) { seam(px(width), "1px") }
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
    Object.assign(this.bone.style, {left: `${x}px`, top: `${y}px`})
  }

  /** Where Enter chooses a point; seen while the canvas has the keys. @param {number[]} at */
  showTarget([x, y]) {
    Object.assign(this.cross.style, {left: `${x}px`, top: `${y}px`})
  }

  // A notice over the canvas, with a button if there is something to stop.
  say(text, stop) {
    this.drop.hidden = !text
    this.drop.textContent = text || ""
    if (text && stop) { this.drop.append(button({on: {click: stop}}, "Cancel")) }
  }
}

// A gradient, not a canvas: that would wait for the graphics card, which has a picture to draw.
function colorBar(table) {
  const color = (_, i) => `rgb(${table.subarray(3 * i, 3 * i + 3).join(" ")})`
  const stops = Array.from({length: table.length / 3}, color)
  const background = `linear-gradient(to right, ${stops.join(", ")})`
  return element("div", {className: "bar", style: {background}})
}
