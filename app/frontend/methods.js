// The table of methods: which are seen, and how good they are.

import {stylesheet} from "./styles.js"

const styled = await stylesheet("methods.css")

export function render({model}) {
  const table = document.createElement("table")
  table.setAttribute("aria-label", model.label)
  const cell = (row, tag, text, title) => {
    const made = row.appendChild(document.createElement(tag))
    made.textContent = text
    if (title) { made.title = title }
    return made
  }
  const fill = () => {
    const held = table.querySelector("input:focus")?.name
    const head = document.createElement("thead")
    const top = head.appendChild(document.createElement("tr"))
    cell(top, "th", "Method").scope = "col"
    for (const [text, title] of model.columns) { cell(top, "th", text, title).scope = "col" }
    const body = document.createElement("tbody")
    for (const {id, title, values, best, note, state, chosen, fixed} of model.rows) {
      const row = body.appendChild(document.createElement("tr"))
      row.className = chosen ? "chosen" : "idle"
      const first = cell(row, "td", "")
      const label = first.appendChild(document.createElement("label"))
      const box = label.appendChild(document.createElement("input"))
      Object.assign(box, {type: "checkbox", name: id, checked: chosen, disabled: fixed})
      label.append(title)
      if (fixed) { label.title = chosen ? "Two stay at least" : "Four at most: take one away first" }
      box.addEventListener("change", () => model.send_msg({id, on: box.checked}))
      values.forEach((value, i) => {
        cell(row, "td", value).className = best[i] ? "best" : ""
      })
      if (note) {
        const below = body.appendChild(document.createElement("tr"))
        below.className = `note ${state}`
        const words = cell(below, "td", note)
        words.colSpan = 1 + values.length
        words.id = `note-${id}`
        box.setAttribute("aria-describedby", words.id)
        if (state === "running") {
          words.prepend(Object.assign(document.createElement("i"), {className: "ring"}))
        }
      }
    }
    table.replaceChildren(head, body)
    if (held) { table.querySelector(`input[name="${CSS.escape(held)}"]`)?.focus() }
  }
  model.on("rows", fill)
  model.on("columns", fill)
  fill()
  const root = document.createElement("div")
  root.append(styled(), table)
  return root
}
