// A place in the sidebar to drop files on, or to choose them with a click.

import {button, element} from "../common/elements.js"
import {stylesheet} from "../common/styles.js"
import {acceptDrops, Uploader} from "../page/upload.js"

const styled = await stylesheet("widgets/file_drop.css")

/** @param {{model: Model}} widget */
export function render({model}) {
  const text = element("span", {}, model.label)
  const input = element("input", {
    type: "file", multiple: true, aria: {label: model.label},
    on: {change: () => uploader.send(input.files)},
  })
  const bar = element("i")
  const label = element("label", {}, text, element("small", {}, model.hint), input, bar)
  const cancel = button({hidden: true, on: {click: () => uploader.cancel()}}, "Cancel")
  const uploader = new Uploader(model, {
    started: (files) => {
      text.textContent = `Sending ${files.map((f) => f.name).join(", ")}`
      cancel.hidden = false
    },
    moved: (part) => { bar.style.width = `${100 * part}%` },
    ended: () => {
      bar.style.width = "0"; input.value = ""; text.textContent = model.label
      cancel.hidden = true
    },
  })
  acceptDrops(label, (over) => label.classList.toggle("over", over), (f) => uploader.send(f))
  return element("div", {}, styled(), label, cancel)
}
