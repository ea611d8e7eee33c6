// Smooth edges where there is time for them: four samples a pixel cost a machine without a
// graphics card more than all the rest.

const SAMPLES = 4
const SLOW = 30  // milliseconds; a machine that needs less draws every frame in full
const SLOWER = 60

export class Smooth {
  constructor(gl) {
    this.gl = gl
    this.cost = {rough: 0, full: Infinity}
  }

  get slow() {
    return this.cost.full > SLOW
  }

  // Whether rough edges alone do not make it quick.
  get slower() {
    return this.cost.rough > SLOWER
  }

  draw(size, rough, paint) {
    if (rough) {
      paint()
    } else {
      this.target(size)
      paint()
      this.show(size)
    }
    this.time(rough ? "rough" : "full")
  }

  // Makes what is drawn now go where there are several samples a pixel.
  target([width, height]) {
    const {gl} = this
    if (String(this.size) !== String([width, height])) {
      this.drop()
      this.size = [width, height]
      this.frame = gl.createFramebuffer()
      gl.bindFramebuffer(gl.FRAMEBUFFER, this.frame)
      const parts = [["COLOR_ATTACHMENT0", gl.RGBA8], ["DEPTH_ATTACHMENT", gl.DEPTH_COMPONENT24]]
      this.buffers = parts.map(([place, format]) => {
        const buffer = gl.createRenderbuffer()
        gl.bindRenderbuffer(gl.RENDERBUFFER, buffer)
        gl.renderbufferStorageMultisample(gl.RENDERBUFFER, SAMPLES, format, width, height)
        gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl[place], gl.RENDERBUFFER, buffer)
        return buffer
      })
    }
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.frame)
  }

  show([width, height]) {
    const {gl} = this
    const scissored = gl.isEnabled(gl.SCISSOR_TEST)
    gl.disable(gl.SCISSOR_TEST)
    gl.bindFramebuffer(gl.READ_FRAMEBUFFER, this.frame)
    gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, null)
    const all = [0, 0, width, height]
    gl.blitFramebuffer(...all, ...all, gl.COLOR_BUFFER_BIT, gl.NEAREST)
    gl.bindFramebuffer(gl.FRAMEBUFFER, null)
    if (scissored) { gl.enable(gl.SCISSOR_TEST) }
  }

  // Time on the GPU, measured by a fence: the calls themselves return at once.
  time(kind) {
    if (this.asking) { return }
    const {gl} = this
    const [start, fence] = [performance.now(), gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0)]
    if (!fence) { return }
    const ask = () => {
      const state = gl.clientWaitSync(fence, gl.SYNC_FLUSH_COMMANDS_BIT, 0)
      if (state === gl.TIMEOUT_EXPIRED && !this.gone) {
        this.asking = setTimeout(ask, 3)
        return
      }
      this.asking = null
      this.cost[kind] = performance.now() - start
      gl.deleteSync(fence)
    }
    this.asking = setTimeout(ask, 0)
  }

  drop() {
    for (const buffer of this.buffers || []) { this.gl.deleteRenderbuffer(buffer) }
    if (this.frame) { this.gl.deleteFramebuffer(this.frame) }
  }

  remove() {
    this.gone = true
    this.drop()
  }
}
