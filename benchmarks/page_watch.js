// Samples the page's canvas at every frame, and tells when its pixels changed.

{
  // Pixels can be read at any time, on both sides alike.
  const get = HTMLCanvasElement.prototype.getContext
  HTMLCanvasElement.prototype.getContext = function (type, options) {
    const kept = type.startsWith("webgl") ? {...options, preserveDrawingBuffer: true} : options
    return get.call(this, type, kept)
  }
}

const watch = {
  painted: 0, changed: 0, running: true, last: null, same: 0,

  canvas(root = document) {
    let best = null
    for (const element of root.querySelectorAll("*")) {
      const found = element.tagName === "CANVAS" ? element
        : element.shadowRoot ? this.canvas(element.shadowRoot) : null
      if (found && (!best || found.width * found.height > best.width * best.height)) { best = found }
    }
    return best
  },

  sample() {
    if (!this.found?.isConnected) { this.found = this.canvas() }
    if (!this.found || this.found.width < 300) { return null }
    this.small ??= Object.assign(document.createElement("canvas"), {width: 120, height: 90})
    const context = this.small.getContext("2d", {willReadFrequently: true})
    context.clearRect(0, 0, 120, 90)
    context.drawImage(this.found, 0, 0, 120, 90)
    return context.getImageData(0, 0, 120, 90).data
  },

  differ(a, b) {
    let count = 0
    for (let i = 0; i < a.length; i += 4) {
      if (Math.abs(a[i] - b[i]) + Math.abs(a[i + 1] - b[i + 1]) + Math.abs(a[i + 2] - b[i + 2]) > 12) {
        count += 1
      }
    }
    return count
  },

  now() { return performance.timeOrigin + performance.now() },

  look() {
    const pixels = this.sample()
    if (!pixels) { return }
    if (!this.painted) {
      // A picture: the middle is not what the corner is.
      const middle = pixels.subarray(4 * (45 * 120 + 60), 4 * (45 * 120 + 60) + 4)
      const corner = pixels.subarray(4 * (2 * 120 + 2), 4 * (2 * 120 + 2) + 4)
      if (middle[3] && [0, 1, 2].some((i) => Math.abs(middle[i] - corner[i]) > 12)) {
        this.painted = this.now()
      }
    }
    const moved = this.last ? this.differ(pixels, this.last) : 1
    this.same = moved ? 0 : this.same + 1
    if (this.waiting && !this.changed && moved > 6) { this.changed = this.now() }
    this.last = pixels
  },

  tick() {
    if (this.running) { this.look(); requestAnimationFrame(() => this.tick()) }
  },

  // Wait until the picture has been the same for a while.
  async settle() {
    if (!this.running) { this.running = true; this.tick() }
    this.waiting = false
    this.same = 0
    const begin = performance.now()
    while (this.same < 20 || performance.now() - begin < 400) {
      await new Promise((done) => setTimeout(done, 50))
    }
  },

  expect() { this.changed = 0; this.waiting = true },

  // Note when the next event of a kind arrives in the page.
  hear(kind) {
    this.heard = 0
    window.addEventListener(kind, () => { this.heard = this.now() }, {capture: true, once: true})
  },

  stop() { this.running = false },

  count() {
    this.frames = []
    this.counting = true
    let last = null
    const tick = (now) => {
      if (last !== null) { this.frames.push(now - last) }
      last = now
      if (this.counting) { requestAnimationFrame(tick) }
    }
    requestAnimationFrame(tick)
  },

  counted() { this.counting = false; return this.frames },
}
window.watch = watch
requestAnimationFrame(() => watch.tick())
