// When the server is gone: shows a message, reconnects, and restores the state from the address.

import {element} from "../common/elements.js"
import {onConnectionLost} from "../common/panel.js"
import {stylesheet} from "../common/styles.js"

const styled = await stylesheet("page/connection.css")

const RETRY_MS = 2000

export class Connection {
  constructor(overlay) {
    this.overlay = overlay
    this.note = element("div", {className: "card lost", hidden: true, aria: {role: "alert"}})
    overlay.root.append(styled(), this.note)
    this.forget = onConnectionLost(() => this.retry())
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
    this.note.textContent = "Connected again. Reloading\u00a0…"
    location.reload()
  }

  remove() {
    this.gone = true
    this.forget()
  }
}
