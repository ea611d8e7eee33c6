// A place in the sidebar to drop files on, or to choose them with a click.

import {stylesheet} from "./styles.js"
import {acceptDrops, Uploader} from "./upload.js"

const styled = await stylesheet("file_drop.css")

export function render({model}) {
  const label = document.createElement("label")
  const text = document.createElement("span")
  text.textContent = model.label
  const small = document.createElement("small")
  small.textContent = model.hint
  const input = document.createElement("input")
  input.type = "file"
  input.multiple = true
  input.setAttribute("aria-label", model.label)
  const bar = document.createElement("i")
  label.append(text, small, input, bar)
  const cancel = document.createElement("button")
  cancel.type = "button"
  cancel.textContent = "Cancel"
  cancel.hidden = true
  cancel.addEventListener("click", () => uploader.cancel())
  const uploader = new Uploader(model, {
    started: (files) => { text.textContent = `Sending ${files.map((f) => f.name).join(", ")}`
      cancel.hidden = false },
    moved: (part) => { bar.style.width = `${100 * part}%` },
    ended: () => { bar.style.width = "0"; input.value = ""; text.textContent = model.label
      cancel.hidden = true },
  })
  input.addEventListener("change", () => uploader.send(input.files))
  acceptDrops(label, (over) => label.classList.toggle("over", over), (f) => uploader.send(f))
  const root = document.createElement("div")
  root.append(styled(), label, cancel)
  return root
}
