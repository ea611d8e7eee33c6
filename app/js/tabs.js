// The strip of tabs in the sidebar: an icon and a word each, one of them chosen.

const TABS_STYLE = `
:host { display: block; }
.strip { display: flex; gap: 2px; padding: 3px; border-radius: 10px;
  background: color-mix(in srgb, var(--mui-palette-text-primary, #223) 6%, transparent); }
button { all: unset; box-sizing: border-box; flex: 1 1 auto; min-width: 0; padding: 6px 0 5px;
  border-radius: 8px; cursor: pointer; text-align: center; transition: background .15s;
  font: 500 10.5px/1.2 Roboto, system-ui, sans-serif; letter-spacing: -.005em;
  color: var(--mui-palette-text-secondary, #667); }
button:hover { color: var(--mui-palette-text-primary, #223); }
button[aria-selected=true] { color: var(--mui-palette-primary-main, #147);
  background: var(--mui-palette-background-paper, #fff); box-shadow: 0 1px 3px rgba(10,20,40,.16); }
button:focus-visible { outline: 2px solid var(--mui-palette-primary-main, #147);
  outline-offset: 1px; }
svg { display: block; width: 19px; height: 19px; margin: 0 auto 3px; fill: none;
  stroke: currentColor; stroke-width: 1.6; stroke-linecap: round; stroke-linejoin: round; }
`

export function render({model}) {
  const style = document.createElement("style")
  style.textContent = TABS_STYLE
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
  root.append(style, list)
  return root
}
