// What the handles over the scene have in common: an SVG, and what the pointer holds in it.

// An SVG element of a class, in a parent.
export function make(tag, className, parent, attributes = {}) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag)
  for (const [name, value] of Object.entries({class: className, ...attributes})) {
    element.setAttribute(name, value)
  }
  parent.append(element)
  return element
}

// A path through pixels.
export function line(pixels) {
  return `M${pixels.map(([x, y]) => `${x.toFixed(1)} ${y.toFixed(1)}`).join("L")}`
}

export class DragHandle {
  /**
   * @param {string} className @param {number} every @param {Overlay} overlay
   * @param {Renderer} renderer
   * @param {{tell: Tell, moved: (state?: any) => void}} hears
   */
  constructor(className, every, overlay, renderer, {tell, moved}) {
    this.every = every
    this.overlay = overlay
    this.renderer = renderer
    this.tell = tell
    this.moved = moved
    this.held = null
    // Numbers and sliders do the same by keys.
    this.svg = make("svg", `handle ${className}`, overlay.root, {"aria-hidden": "true"})
  }

  /** What must be remembered of the beginning; null where nothing begins. @returns {any} */
  begin(_e, _kind) { return null }

  /** Whether anything moved. @returns {boolean} */
  follow(_dx, _dy, _e) { return false }

  // Tells the server.
  say(_done) {}

  // Lets a part of the SVG be dragged.
  grip(element, kind) {
    element.addEventListener("pointerdown", (e) => this.take(e, kind))
    element.addEventListener("pointermove", (e) => this.drag(e))
    for (const type of ["pointerup", "pointercancel"]) {
      element.addEventListener(type, (e) => this.release(e))
    }
  }

  take(e, kind) {
    const held = this.held || e.button ? null : this.begin(e, kind)
    if (!held) { return }
    e.preventDefault()
    e.stopPropagation()
    e.target.setPointerCapture(e.pointerId)
    this.held = {...held, pointer: e.pointerId, x: e.clientX, y: e.clientY, sentAt: 0}
    this.svg.classList.add("holding")
  }

  drag(e) {
    const {held} = this
    if (!held || e.pointerId !== held.pointer) { return }
    e.stopPropagation()
    if (!this.follow(e.clientX - held.x, e.clientY - held.y, e)) { return }
    held.moved = true
    clearTimeout(held.later)
    const tell = () => { held.sentAt = performance.now(); this.say(false) }
    const wait = held.sentAt + this.every - performance.now()
    if (wait > 0) { held.later = setTimeout(tell, wait) } else { tell() }
  }

  release(e) {
    e.stopPropagation()
    if (this.held?.moved) { this.say(true) }
    this.drop()
  }

  drop() {
    clearTimeout(this.held?.later)
    this.held = null
    this.svg.classList.remove("holding")
  }

  remove() {
    this.drop()
  }
}
