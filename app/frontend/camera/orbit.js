// The camera: a turntable that keeps the character upright. Drag turns, right drag or
// Shift moves, the wheel or two fingers zoom, a double click goes back to the start.

export const VIEW_ANGLE = 30
const MAX_PITCH = 1.5
const STEP = 24  // pixels that a key moves the view

export class Orbit {
  /** @param {HTMLElement} element @param {Record<string, (e?: any) => any>} hears */
  constructor(element, {changed, rested, clicked, hovered, chosen, away = () => [0, 0]}) {
    this.element = element
    this.away = away  // of a pointer, from where the target is seen
    this.changed = changed
    this.rested = rested
    this.chosen = chosen
    this.home = {target: [0, 0, 0], yaw: 0.4, pitch: 0.15, distance: 4}
    this.reset()
    this.pointers = new Map()
    this.moving = false
    this.painting = false  // then the left button is the brush's, and the right one turns
    this.listening = new AbortController()
    const {signal} = this.listening
    const on = (type, act) => element.addEventListener(type, act, {passive: false, signal})
    // Arrow keys turn when the canvas was reached by keys; after a click they change the bone.
    on("blur", () => { this.byMouse = false })
    on("pointerdown", (e) => {
      this.byMouse = true
      element.setPointerCapture(e.pointerId)
      this.pointers.set(e.pointerId, [e.clientX, e.clientY])
      this.pressed = this.pointers.size === 1 ? [e.clientX, e.clientY, e.button] : null
    })
    on("pointermove", (e) => {
      if (this.pointers.has(e.pointerId)) {
        this.drag(e)
      } else if (e.pointerType === "mouse") {
        hovered(e)
      }
    })
    on("pointerup", (e) => {
      this.release(e)
      const p = this.pressed
      if (p && p[2] === 0 && Math.hypot(e.clientX - p[0], e.clientY - p[1]) < 5) { clicked(e) }
      this.pressed = null
    })
    on("pointercancel", (e) => this.release(e))
    on("pointerleave", () => hovered(null))
    on("contextmenu", (e) => e.preventDefault())
    on("dblclick", () => { this.reset(); this.move(); this.rest() })
    on("wheel", (e) => {
      e.preventDefault()
      const moved = Math.min(Math.max(e.deltaY, -120), 120)
      this.zoom(Math.exp(moved * 0.0012), this.away(e))
      this.rest(180)
    })
    on("keydown", (e) => this.key(e))
  }

  reset() {
    this.put(this.home)
  }

  put({target, yaw, pitch, distance}) {
    this.target = target
    this.yaw = yaw
    this.pitch = pitch
    this.distance = distance
  }

  // Remembers this camera as the one that a double click goes back to.
  setHome(position, target) {
    this.home = turntable(position, target)
    this.reset()
  }

  // Goes nearer or farther, and takes the start along: the same is seen in another window.
  scale(factor) {
    this.home.distance *= factor
    this.distance *= factor
  }

  // Looks from a place at another, and leaves the start as it is.
  look(position, target) {
    this.put(turntable(position, target))
  }

  get atHome() {
    const {home} = this
    const near = (a, b) => Math.abs(a - b) < 1e-6 * Math.max(1, home.distance)
    return near(this.yaw, home.yaw) && near(this.pitch, home.pitch)
      && near(this.distance, home.distance) && this.target.every((x, i) => near(x, home.target[i]))
  }

  get position() {
    const c = Math.cos(this.pitch)
    const out = [c * Math.sin(this.yaw), Math.sin(this.pitch), c * Math.cos(this.yaw)]
    return out.map((x, i) => this.target[i] + this.distance * x)
  }

  drag(e) {
    const last = this.pointers.get(e.pointerId)
    const dx = e.clientX - last[0]
    const dy = e.clientY - last[1]
    if (this.pointers.size > 1) {
      const [other] = [...this.pointers].filter(([id]) => id !== e.pointerId).map(([, p]) => p)
      const before = Math.hypot(last[0] - other[0], last[1] - other[1])
      const after = Math.hypot(e.clientX - other[0], e.clientY - other[1])
      const middle = {clientX: (e.clientX + other[0]) / 2, clientY: (e.clientY + other[1]) / 2}
      if (before > 0 && after > 0) { this.zoom(before / after, this.away(middle)) }
      this.pan(dx / 2, dy / 2)
    } else if (e.shiftKey || (this.painting ? e.buttons & 4 : e.ctrlKey || (e.buttons & 6))) {
      this.pan(dx, dy)
    } else {
      this.turn(-dx * 0.008, dy * 0.008)
    }
    this.pointers.set(e.pointerId, [e.clientX, e.clientY])
  }

  // Takes over a pointer that another tool has used so far.
  join(id, place) {
    this.pointers.set(id, place)
  }

  release(e) {
    this.pointers.delete(e.pointerId)
    if (this.pointers.size === 0) { this.rest() }
  }

  turn(yaw, pitch) {
    this.yaw += yaw
    this.pitch = Math.max(-MAX_PITCH, Math.min(MAX_PITCH, this.pitch + pitch))
    this.move()
  }

  /**
   * What lies at the target's depth, some pixels away from it, stays where it is seen.
   * @param {number} factor @param {number[]} [from]
   */
  zoom(factor, from = [0, 0]) {
    const [dx, dy] = from
    const {distance} = this.home
    const after = Math.max(distance * 0.04, Math.min(distance * 6, this.distance * factor))
    const part = 1 - after / this.distance
    this.pan(-part * dx, -part * dy)
    this.distance = after
    this.move()
  }

  pan(dx, dy) {
    const scale = 2 * this.distance * Math.tan(VIEW_ANGLE * Math.PI / 360)
      / this.element.clientHeight
    const [sy, cy] = [Math.sin(this.yaw), Math.cos(this.yaw)]
    const [sp, cp] = [Math.sin(this.pitch), Math.cos(this.pitch)]
    const right = [cy, 0, -sy]
    const up = [-sp * sy, cp, -sp * cy]
    this.target = this.target.map((x, i) => x + scale * (-dx * right[i] + dy * up[i]))
    this.move()
  }

  key(e) {
    const moves = {
      ArrowLeft: [STEP, 0], ArrowRight: [-STEP, 0], ArrowUp: [0, STEP], ArrowDown: [0, -STEP],
    }[e.key]
    const act = e.shiftKey && moves ? () => this.pan(...moves) : {
      "Enter": () => this.chosen(),
      "ArrowLeft": () => this.turn(-0.12, 0), "ArrowRight": () => this.turn(0.12, 0),
      "ArrowUp": () => this.turn(0, 0.08), "ArrowDown": () => this.turn(0, -0.08),
      "+": () => this.zoom(0.88), "=": () => this.zoom(0.88), "-": () => this.zoom(1.14),
      "Home": () => { this.reset(); this.move() },
    }[e.key]
    if (!act || e.ctrlKey || e.metaKey || e.altKey) { return }
    if (this.byMouse && e.key.startsWith("Arrow")) { return }
    e.preventDefault()
    e.stopPropagation()
    act()
    this.rest(180)
  }

  move() {
    this.moving = true
    clearTimeout(this.timer)
    this.changed()
  }

  rest(after = 0) {
    clearTimeout(this.timer)
    this.timer = setTimeout(() => {
      if (this.moving && this.pointers.size === 0) { this.moving = false; this.rested() }
    }, after)
  }

  remove() {
    clearTimeout(this.timer)
    this.listening.abort()
  }
}

// Where a camera is on the turntable around its target.
function turntable(position, target) {
  const [x, y, z] = position.map((x, i) => x - target[i])
  const distance = Math.hypot(x, y, z)
  return {target: [...target], distance, yaw: Math.atan2(x, z), pitch: Math.asin(y / distance)}
}
