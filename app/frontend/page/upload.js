// Files on their way to the server: in pieces, each waited for, so that neither side holds
// a whole file more than once.

const PIECE = 2 * 1024 * 1024

export class Uploader {
  /** @param {Model} model @param {Record<string, (about?: any) => void>} hears */
  constructor(model, {started = () => {}, moved = () => {}, ended = () => {}}) {
    this.model = model
    this.started = started
    this.moved = moved
    this.ended = ended
    /** @type {((answer: UploadAnswer) => void)[]} */
    this.answers = []
    this.hear = (message) => {
      if (message.upload) { this.answers.shift()?.(message.upload) }
    }
    model.on("msg:custom", this.hear)
  }

  remove() {
    this.model.off?.("msg:custom", this.hear)
  }

  /** @param {FromBrowser} message @returns {Promise<UploadAnswer>} */
  ask(message) {
    return new Promise((resolve) => {
      this.answers.push(resolve)
      this.model.send_msg(message)
    })
  }

  // Stops after the current piece; the server discards the pieces that it has.
  cancel() {
    this.stopped = true
  }

  async send(files) {
    files = [...files]
    if (!files.length || this.busy) { return }
    this.busy = true
    this.stopped = false
    try {
      const list = files.map(({name, size}) => ({name, size}))
      const total = list.reduce((sum, {size}) => sum + size, 0)
      this.started(list)
      let answer = await this.ask({type: "upload-begin", files: list})
      let sent = 0
      for (let index = 0; index < files.length && answer.ok; index++) {
        for (let at = 0; at < files[index].size && answer.ok && !this.stopped; at += PIECE) {
          const data = await files[index].slice(at, at + PIECE).arrayBuffer()
          answer = await this.ask({type: "upload-piece", index, data})
          sent += data.byteLength
          this.moved(sent / total)
        }
      }
      if (answer.ok) {
        answer = await this.ask({type: this.stopped ? "upload-cancel" : "upload-end"})
      }
    } catch {
      await this.ask({type: "upload-cancel", unreadable: true})  // moved or changed on its disk
    } finally {
      this.busy = false
      this.ended()
    }
  }
}

// Lets files be dropped on an element; `over` hears whether some hang above it.
export function acceptDrops(element, over, drop) {
  let depth = 0
  const carries = (e) => [...(e.dataTransfer?.types || [])].includes("Files")
  const on = (type, act) => element.addEventListener(type, (e) => {
    if (!carries(e)) { return }
    e.preventDefault()
    e.stopPropagation()
    act(e)
  })
  on("dragenter", () => { depth += 1; over(true) })
  on("dragover", (e) => { e.dataTransfer.dropEffect = "copy" })
  on("dragleave", () => { depth -= 1; if (depth <= 0) { depth = 0; over(false) } })
  on("drop", (e) => { depth = 0; over(false); drop(e.dataTransfer.files) })
}
