// The browser's address: the page's choices, written at most twice a second. Browsers refuse
// faster changes (Safari: a hundred in ten seconds), and a page in a frame may have no history.

const REST = 500  // milliseconds

export class AddressBar {
  constructor({history, location, setTimeout, clearTimeout}) {
    this.history = history
    this.location = location
    this.hasAddress = false
    this.rest = () => { this.resting = setTimeout(() => this.rested(), REST) }
    this.stop = () => { clearTimeout(this.resting); this.resting = null; this.waiting = null }
    this.stop()
  }

  // Writes an address: now, or half a second after the last change. Another character or another
  // step is a new page: the browser's Back leads to the one before.
  put(address) {
    const before = this.waiting ?? this.location.search
    const isNew = this.hasAddress && pageOf(address) !== pageOf(before)
    if (isNew) {
      this.rested()
      this.write("pushState", address)
    } else if (this.resting === null) {
      this.write("replaceState", address)
    } else {
      this.waiting = address
    }
  }

  rested() {
    const address = this.waiting
    this.stop()
    if (address !== null) { this.write("replaceState", address) }
  }

  // The last one is written.
  remove() {
    this.rested()
  }

  write(how, address) {
    this.stop()
    try {
      this.history[how](this.history.state, "", this.location.pathname + address)
    } catch (error) {
      console.info(`The address stays as it is: ${/** @type {Error} */ (error).message}.`)
    }
    this.hasAddress = true
    this.rest()
  }
}

// What the browser's Back returns to: a character, and a step of the lesson.
function pageOf(query) {
  const entries = new URLSearchParams(query)
  return `${entries.get("rig")} ${entries.get("step")}`
}
