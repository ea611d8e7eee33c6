// A short list of things that can be chosen, each with a number and a bar.

const ROWS_STYLE = `
:host { display: block; }
ol { list-style: none; margin: 0; padding: 0; }
button { all: unset; box-sizing: border-box; position: relative; display: flex; gap: 8px;
  justify-content: space-between; width: 100%; padding: 6px 8px; margin: 1px 0; border-radius: 6px;
  cursor: pointer; overflow: hidden; font: 12.5px/1.35 Roboto, system-ui, sans-serif;
  color: var(--mui-palette-text-primary, #223); }
button i { position: absolute; inset: auto auto 2px 8px; height: 2px; border-radius: 1px;
  background: #d64a50; max-width: calc(100% - 16px); }
button span { min-width: 0; overflow: hidden; text-overflow: ellipsis; white-space: nowrap; }
button b { font-weight: 500; white-space: nowrap; font-variant-numeric: tabular-nums; }
button:hover, button[aria-current=true] {
  background: color-mix(in srgb, var(--mui-palette-primary-main, #147) 11%, transparent); }
button:focus-visible { outline: 2px solid var(--mui-palette-primary-main, #147);
  outline-offset: -2px; }
`

export function render({model}) {
  const style = document.createElement("style")
  style.textContent = ROWS_STYLE
  const list = document.createElement("ol")
  const fill = () => {
    list.setAttribute("aria-label", model.label)
    list.replaceChildren(...model.rows.map(([name, note, part], row) => {
      const item = document.createElement("li")
      const button = item.appendChild(document.createElement("button"))
      button.type = "button"
      const bar = document.createElement("i")
      bar.style.width = `${100 * part}%`
      const [text, value] = [document.createElement("span"), document.createElement("b")]
      text.textContent = text.title = name
      value.textContent = note
      button.append(text, value, bar)
      button.addEventListener("click", () => model.send_msg({row}))
      return item
    }))
    mark()
  }
  const mark = () => list.querySelectorAll("button").forEach((button, row) => {
    button.setAttribute("aria-current", row === model.chosen)
  })
  model.on("rows", fill)
  model.on("chosen", mark)
  fill()
  const root = document.createElement("div")
  root.append(style, list)
  return root
}
