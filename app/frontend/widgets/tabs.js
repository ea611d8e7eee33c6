// The strip of tabs in the sidebar: an icon and a word each, one of them chosen.

import {button, element} from "../common/elements.js"
import {stylesheet} from "../common/styles.js"

const styled = await stylesheet("widgets/tabs.css")

/** @param {{model: Model}} widget */
export function render({model}) {
  const ids = model.tabs.map(([id]) => id)
  const tabs = model.tabs.map(([id, title, icon]) =>
    button({aria: {role: "tab"}, icon, on: {click: () => { model.value = id }}}, title))
  const show = () => tabs.forEach((tab, i) => {
    const chosen = ids[i] === model.value
    tab.setAttribute("aria-selected", chosen)
    tab.tabIndex = chosen ? 0 : -1
  })
  const walk = (e) => {
    const now = tabs.indexOf(e.target)
    const next = {
      ArrowLeft: now - 1, ArrowRight: now + 1, Home: 0, End: tabs.length - 1,
    }[e.key]
    if (next === undefined) { return }
    e.preventDefault()
    e.stopPropagation()
    const i = (next + tabs.length) % tabs.length
    model.value = ids[i]
    tabs[i].focus()
  }
  model.on("value", show)
  show()
  const aria = {role: "tablist", label: model.label}
  const strip = element("div", {className: "strip", aria, on: {keydown: walk}}, ...tabs)
  return element("section", {}, styled(), strip)
}
