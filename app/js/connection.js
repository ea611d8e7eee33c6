// When the server is gone: says so, tries again, and comes back with what the address holds.

const RETRY_MS = 2000

class Connection {
  constructor(overlay) {
    this.overlay = overlay
    this.note = document.createElement("div")
    this.note.className = "card lost"
    this.note.setAttribute("role", "alert")
    this.note.hidden = true
    const style = document.createElement("style")
    style.textContent = `.lost { inset: 12px 12px auto; margin: auto; width: max-content;
      max-width: calc(100% - 48px); padding: 10px 16px; font-size: 14px; z-index: 6;
      background: var(--paper); border: 1px solid #e05a00; }
    .without-server .tools { visibility: hidden; }`
    overlay.root.append(style, this.note)
    const documents = window.Bokeh?.documents || []
    this.document = documents[documents.length - 1]
    this.lost = () => this.retry()
    this.document?.on_event("connection_lost", this.lost)
  }

  async retry() {
    if (this.trying || this.gone) { return }
    this.trying = true
    this.note.hidden = false
    this.overlay.root.classList.add("without-server")  // its tools could do nothing
    this.note.textContent = "The connection to the server is lost. Trying again\u00a0…"
    while (!this.gone) {
      await new Promise((done) => setTimeout(done, RETRY_MS))
      try {
        const answer = await fetch(location.pathname, {method: "HEAD", cache: "no-store"})
        if (answer.status < 500) { break }
      } catch { /* not there yet: try again */ }
    }
    if (this.gone) { return }
    this.note.textContent = "The server is there again. Coming back\u00a0…"
    location.reload()
  }

  remove() {
    this.gone = true
    this.document?.remove_on_event?.("connection_lost", this.lost)
  }
}
