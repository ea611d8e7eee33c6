// The clipboard: the link to what the page shows, and code that computes its weights again.

import {element} from "./elements.js"

const SEEN = 1600  // milliseconds

/** Copy a text, and say so; where the browser refuses, show it to be copied by hand.
 * @param {Overlay} overlay @param {string} text @param {string} what "Link", say */
export async function copy(overlay, text, what) {
  try {
    await navigator.clipboard.writeText(text)
  } catch {
    byHand(overlay, text, what)  // only encrypted pages and those of this machine may copy
    return
  }
  const note = element("div", {className: "card copied", aria: {role: "status"}}, `${what} copied`)
  overlay.root.append(note)
  setTimeout(() => note.remove(), SEEN)
}

/** @param {Overlay} overlay */
export const copyLink = (overlay, link = "") =>
  copy(overlay, new URL(link || location.search, location.href).href, "Link")

function byHand(overlay, text, what) {
  const rows = text.trimEnd().split("\n").length
  const area = element("textarea", {value: text, readOnly: true, rows, aria: {label: what}})
  const dialog = element("dialog", {className: "keys", aria: {label: what}},
    element("p", {}, `Copy this ${what.toLowerCase()}:`), area)
  dialog.addEventListener("close", () => dialog.remove())
  overlay.root.append(dialog)
  dialog.showModal()
  area.select()
}
