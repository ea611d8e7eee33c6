// The presentation of a lesson: its keys, a black screen, and the window of the speaker's notes.

import {element, elementsWithKey} from "../common/elements.js"
import {pageRoot} from "../common/panel.js"

const CHANNEL = "cutcell lesson"
const FORWARD = ["ArrowRight", "ArrowDown", "PageDown", " ", "Enter"]
const BACKWARD = ["ArrowLeft", "ArrowUp", "PageUp"]
const USED = "input, textarea, select, [role=slider], button, a"
const BESIDE = "header, nav, .MuiDrawer-root"  // what a presentation covers

// What joins the windows of a browser: the lesson, and the notes.
export function channel(heard) {
  const joined = new BroadcastChannel(CHANNEL)
  joined.addEventListener("message", ({data}) => heard(data))
  return {
    // oxlint-disable-next-line unicorn/require-post-message-target-origin -- it has none
    tell: (message) => joined.postMessage(message),
    close: () => joined.close(),
  }
}

export class Stage {
  /**
   * @param {{root: HTMLElement, forward(): void, backward(): void}} card
   * @param {LessonHost} host
   */
  constructor(card, host) {
    this.card = card
    this.host = host
    /** @type {LessonNow | null} */
    this.now = null
    const on = {click: () => this.blacken(false)}
    this.black = element("div", {className: "black", hidden: true, on})
    card.root.append(this.black)
    this.listener = (e) => this.pressed(e)
    addEventListener("keydown", this.listener, true)
    this.channel = channel((message) => this.heard(message))
  }

  /** @param {LessonNow} now */
  show(now) {
    const was = this.now?.staged
    this.now = now
    this.report()
    if (was === now.staged) { return }
    this.blacken(false)
    // What is covered must not take the focus.
    for (const part of pageRoot(this.card.root)?.querySelectorAll(BESIDE) ?? []) {
      part.inert = now.staged
    }
  }

  report() {
    if (this.now && this.now.step >= 0) { this.channel.tell(this.now) }
  }

  // The window of the notes asks for the step, or walks.
  heard({act}) {
    if (act === "report") { this.report() }
    if (act === "forward") { this.card.forward() }
    if (act === "backward") { this.card.backward() }
  }

  openNotes() {
    open(`${location.pathname}?notes`, CHANNEL, "popup,width=720,height=640")
  }

  pressed(e) {
    const {now} = this
    if (!now || now.step < 0 || e.ctrlKey || e.metaKey || e.altKey) { return }
    const path = elementsWithKey(e)
    const isUsed = path.some((part) => part.matches(USED))
    if (!now.staged) {
      if (e.key === "f" && !path.some((part) => part.matches("input, textarea"))) {
        this.take(e)
        this.host.stage(true)
      }
      return
    }
    if (e.key === "Tab" || (isUsed && !["Escape", "PageDown", "PageUp"].includes(e.key))) { return }
    this.take(e)  // all other keys of the page rest
    if (FORWARD.includes(e.key)) { this.card.forward() }
    if (BACKWARD.includes(e.key)) { this.card.backward() }
    if (["b", "."].includes(e.key)) { this.blacken(this.black.hidden) }
    if (e.key === "n") { this.openNotes() }
    if (e.key === "Escape" || e.key === "f") { this.host.stage(false) }
  }

  take(e) {
    e.preventDefault()
    e.stopImmediatePropagation()
  }

  blacken(on) {
    this.black.hidden = !on
  }

  remove() {
    removeEventListener("keydown", this.listener, true)
    this.channel.close()
  }
}
