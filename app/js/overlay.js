// What is written over the canvas: the legend, the name of a bone, and hints.

// The rings have a layer of their own (will-change): Chromium left a copy of them behind where
// nothing else was drawn again, when the character stepped aside.
const STYLE = `
:host { display: block; }
.stage { position: relative; width: 100%; height: 100%; min-height: 240px; overflow: hidden;
  font-family: Roboto, system-ui, sans-serif; touch-action: none; user-select: none; }
.canvas { position: absolute; inset: 0; outline: none; cursor: grab; touch-action: none; }
.canvas:active { cursor: grabbing; }
.canvas.over-bone { cursor: pointer; }
.canvas:focus-visible { box-shadow: inset 0 0 0 2px #ff6c0c88; }
.canvas > canvas, .canvas canvas { width: 100% !important; height: 100% !important; display: block; }
.card { position: absolute; color: var(--ink); background: var(--card); pointer-events: none;
  backdrop-filter: blur(6px); border-radius: 8px; font-size: 12px; line-height: 1.3; }
.legend { left: 16px; bottom: 16px; width: 208px; padding: 10px 12px 9px; }
.legend b { display: -webkit-box; -webkit-line-clamp: 2; -webkit-box-orient: vertical;
  font-weight: 500; overflow: hidden; overflow-wrap: anywhere; }
.legend b + * { margin-top: 7px !important; }
.legend .bar { height: 8px; border-radius: 4px;
  box-shadow: 0 0 0 1px color-mix(in srgb, var(--ink) 22%, transparent); }
.legend span { display: flex; justify-content: space-between; gap: 8px; margin-top: 4px; opacity: .75;
  font-variant-numeric: tabular-nums; }
.legend i { font-style: normal; }
.legend p { margin: 5px 0 0; display: flex; align-items: center; gap: 8px; opacity: .9;
  overflow-wrap: anywhere; }
.legend p::before { content: ""; width: 14px; height: 8px; border-radius: 3px; flex: none;
  background: var(--swatch); }
.bone { padding: 4px 8px; transform: translate(14px, -110%); white-space: nowrap; }
.caption { padding: 5px 10px; overflow: hidden; font-weight: 500; }
.caption span { display: -webkit-box; -webkit-line-clamp: 2; -webkit-box-orient: vertical;
  overflow: hidden; overflow-wrap: anywhere; }
.seam { position: absolute; background: var(--ink); opacity: .14; pointer-events: none; }
.gizmo { position: absolute; inset: 0; width: 100%; height: 100%; pointer-events: none;
  will-change: transform; }
.gizmo path { fill: none; }
.gizmo .reach { stroke: transparent; stroke-width: 20; pointer-events: stroke; cursor: grab;
  touch-action: none; }
.gizmo .halo { stroke: #0006; stroke-width: 4.5; }
.gizmo .ring { stroke-width: 2.5; stroke-linecap: round; }
.gizmo .far { opacity: .3; }
.gizmo g:hover .ring, .gizmo g.held .ring { stroke-width: 4; }
.gizmo.holding g:not(.held) { opacity: .25; }
.gizmo.holding .reach { cursor: grabbing; }
.gizmo text { font: 600 11px Roboto, system-ui, sans-serif; fill: #fff; text-anchor: middle;
  dominant-baseline: central; pointer-events: none; }
.angle { padding: 4px 9px; transform: translate(-50%, 14px); white-space: nowrap; font-weight: 500;
  font-variant-numeric: tabular-nums; }
.transport { left: 50%; bottom: 16px; transform: translateX(-50%); pointer-events: auto;
  display: flex; align-items: center; gap: 8px; padding: 5px 12px 5px 6px;
  width: min(400px, calc(100% - 500px)); min-width: 250px; box-sizing: border-box; }
.transport[hidden] { display: none; }
.transport button { all: unset; box-sizing: border-box; display: grid; place-items: center;
  min-width: 32px; height: 32px; border-radius: 16px; cursor: pointer; font-weight: 500;
  font-variant-numeric: tabular-nums; }
.transport button:hover { background: color-mix(in srgb, var(--ink) 10%, transparent); }
.transport button:focus-visible, .transport input:focus-visible { outline: 2px solid #ff6c0c; }
.transport svg { width: 18px; height: 18px; fill: currentColor; }
.transport input { flex: 1; min-width: 60px; accent-color: var(--mui-palette-primary-main, #17678c);
  margin: 0; height: 20px; }
.transport output { min-width: 66px; text-align: right; font-variant-numeric: tabular-nums;
  white-space: nowrap; }
.stage { container-type: inline-size; }
@container (max-width: 900px) {
  .moving .legend { bottom: 70px; }
  .transport { width: calc(100% - 32px); max-width: 460px; } }
@container (max-width: 760px) { .hint { display: none; } }
.moving .hint, .several .hint { display: none; }
.hint { right: 16px; bottom: 16px; padding: 0; background: none; opacity: .72; backdrop-filter: none; }
.waiting { inset: 0; margin: auto; width: max-content; height: max-content; background: none;
  backdrop-filter: none; font-size: 14px; padding: 76px 0 0; opacity: .8; }
.failed { inset: 0; margin: auto; width: min(420px, 80%); height: max-content; padding: 20px;
  font-size: 14px; text-align: center; }
.drop { inset: 12px; z-index: 5; border: 2px dashed #ff6c0c; border-radius: 14px; display: grid;
  place-content: center; justify-items: center; gap: 14px; font-size: 18px; }
.drop button { pointer-events: auto; font: 500 14px Roboto, system-ui, sans-serif; cursor: pointer;
  padding: 6px 16px; border-radius: 8px; border: 1px solid currentColor; background: none;
  color: inherit; }
[hidden] { display: none !important; }
@media (max-width: 700px) { .hint { display: none } .legend { left: 8px; bottom: 8px; width: 184px } }
`

class Overlay {
  constructor() {
    const make = (tag, className, parent, hidden = true) => {
      const element = document.createElement(tag)
      element.className = className
      element.hidden = hidden
      parent?.append(element)
      return element
    }
    this.root = make("div", "stage", null, false)
    const style = document.createElement("style")
    style.textContent = STYLE
    this.root.append(style)
    this.canvas = make("div", "canvas", this.root, false)
    this.canvas.tabIndex = 0
    this.canvas.setAttribute("role", "application")
    this.canvas.setAttribute(
      "aria-label", "The character in 3D. Arrow keys turn, plus and minus zoom, Home resets.",
    )
    this.legend = make("div", "card legend", this.root)
    this.bone = make("div", "card bone", this.root)
    this.gizmo = document.createElementNS("http://www.w3.org/2000/svg", "svg")
    this.gizmo.classList.add("gizmo")
    this.root.append(this.gizmo)
    this.angle = make("div", "card angle", this.root)
    this.transport = make("div", "card transport", this.root)
    this.hint = make("div", "card hint", this.root, false)
    this.hint.textContent = "drag to turn · right-drag to move · scroll to zoom · click a bone or the body"
    this.waiting = make("div", "card waiting", this.root, false)
    this.waiting.textContent = "The character is on its way …"
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
    this.legend.replaceChildren()
    const add = (tag, text) => {
      const element = document.createElement(tag)
      element.textContent = text
      this.legend.append(element)
      return element
    }
    add("b", title)
    if (legend.table) {
      this.legend.append(colorBar(plain(legend.table)))
      const ends = add("span", "")
      for (const text of [low, high]) {
        const end = document.createElement("i")
        end.textContent = text
        ends.append(end)
      }
    }
    for (const [color, text] of swatches || []) {
      add("p", text).style.setProperty("--swatch", color)
    }
  }

  // What stands in each view, and the seams between them.
  showViews(captions, tiles) {
    if (!this.views) {
      this.views = document.createElement("div")
      this.root.append(this.views)
    }
    const put = (className, text, style) => {
      const element = document.createElement("div")
      element.className = className
      if (text) { element.appendChild(document.createElement("span")).textContent = text }
      Object.assign(element.style, style)
      this.views.append(element)
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

  showBone(name, x, y, isBone = true) {
    this.bone.hidden = !name
    this.canvas.classList.toggle("over-bone", Boolean(name) && isBone)
    if (!name) { return }
    this.bone.textContent = name
    this.bone.style.left = `${x}px`
    this.bone.style.top = `${y}px`
  }

  // A notice over the canvas, with a button if there is something to stop.
  say(text, stop) {
    this.drop.hidden = !text
    this.drop.textContent = text || ""
    if (text && stop) {
      const button = document.createElement("button")
      button.type = "button"
      button.textContent = "Cancel"
      button.addEventListener("click", stop)
      this.drop.append(button)
    }
  }

  fail(message) {
    this.waiting.hidden = true
    this.failed.hidden = false
    this.failed.textContent = message
  }
}

// A gradient, not a canvas: that would wait for the graphics card, which has a picture to draw.
function colorBar(table) {
  const bar = document.createElement("div")
  bar.className = "bar"
  const stops = Array.from({length: table.length / 3}, (_, i) => `rgb(${table.subarray(3 * i, 3 * i + 3).join(" ")})`)
  bar.style.background = `linear-gradient(to right, ${stops.join(", ")})`
  return bar
}
