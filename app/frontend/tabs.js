// The strip of tabs in the sidebar: an icon and a word each, one of them chosen.

import {stylesheet} from "./styles.js"

const styled = await stylesheet("tabs.css")

export function render({model}) {
  const list = document.createElement("div")
  list.className = "strip"
  list.setAttribute("role", "tablist")
  list.setAttribute("aria-label", model.label)
  const tabs = model.tabs.map(([id, title, icon]) => {
    const tab = document.createElement("button")
    tab.type = "button"
    tab.setAttribute("role", "tab")
    tab.innerHTML = `<svg viewBox="0 0 24 24" aria-hidden="true">${icon}</svg>`
    tab.append(title)
    tab.addEventListener("click", () => { model.value = id })
    list.append(tab)
    return tab
  })
  const ids = model.tabs.map(([id]) => id)
  const show = () => tabs.forEach((tab, i) => {
    const chosen = ids[i] === model.value
    tab.setAttribute("aria-selected", chosen)
    tab.tabIndex = chosen ? 0 : -1
  })
  list.addEventListener("keydown", (e) => {
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
  })
  model.on("value", show)
  show()
  const root = document.createElement("section")
  root.append(styled(), list)
  return root
}
