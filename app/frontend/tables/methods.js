// The table of methods: which are seen, and how good they are.

import {element, renew} from "../common/elements.js"
import {stylesheet} from "../common/styles.js"

const styled = await stylesheet("tables/methods.css")

/** @param {{model: Model}} widget */
export function render({model}) {
  const table = element("table", {aria: {label: model.label}})
  const fill = () => {
    const columns = [[model.heading, ""], ...model.columns].map(([text, title]) =>
      element("th", {scope: "col", title}, text))
    const head = element("thead", {}, element("tr", {}, ...columns))
    const body = element("tbody")
    for (const {id, title, values, best, note, state, chosen, fixed} of model.rows) {
      const change = () => model.send_msg({type: "show-method", id, on: box.checked})
      const box = element("input", {
        type: model.single ? "radio" : "checkbox", name: id, checked: chosen, disabled: fixed,
        on: {change},
      })
      const label = element("label", {}, box, title)
      if (fixed && !model.single) {
        label.title = chosen ? "Keep at least two" : "Deselect one first (max. 4)"
      }
      const cell = (value, i) => element("td", {className: best[i] ? "best" : ""}, value)
      body.append(element(
        "tr", {className: chosen ? "chosen" : "idle"},
        element("td", {}, label), ...values.map(cell)))
      if (note) {
        const words = element("td", {colSpan: 1 + values.length, id: `note-${id}`}, note)
        box.setAttribute("aria-describedby", words.id)
        if (state === "running") { words.prepend(element("i", {className: "ring"})) }
        body.append(element("tr", {className: `note ${state}`}, words))
      }
    }
    renew(table, head, body)
  }
  model.on("rows", fill)
  model.on("columns", fill)
  fill()
  return element("div", {}, styled(), table)
}
