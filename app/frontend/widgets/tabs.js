// The strip of tabs in the sidebar: an icon and a word each, one of them chosen.

import {button, drawn, h, icon} from "../common/nodes.js"
import {stylesheet} from "../common/styles.js"

const styled = await stylesheet("widgets/tabs.css")

/** @param {{model: Model}} widget */
export function render({model}) {
  const ids = model.tabs.map(([id]) => id)
  const walk = (e) => {
    const now = ids.indexOf(model.value)
    const next = {
      ArrowLeft: now - 1, ArrowRight: now + 1, Home: 0, End: ids.length - 1,
    }[e.key]
    if (next === undefined) { return }
    e.preventDefault()
    e.stopPropagation()
    model.value = ids.at(next % ids.length)
    e.currentTarget.children[ids.indexOf(model.value)].focus()
  }
  const tab = ([id, title, drawing]) => button({
    "role": "tab", "aria-selected": String(id === model.value),
    "tabindex": id === model.value ? 0 : -1, "onclick": () => { model.value = id },
  }, icon(drawing), title)
  const about = {"class": "strip", "role": "tablist", "aria-label": model.label}
  return drawn(model, ["value"], styled, () =>
    h("div", {...about, onkeydown: walk}, model.tabs.map(tab)))
}
