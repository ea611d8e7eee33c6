// The table of methods: which are seen, and how good they are.

import {drawn, h} from "../common/nodes.js"
import {stylesheet} from "../common/styles.js"

const styled = await stylesheet("tables/methods.css")

// Boxes follow the choice as it changes: a click stays while the answer to the last one comes.
const follow = (chosen) => (box) => {
  if (box && box.defaultChecked !== chosen) {
    box.defaultChecked = chosen
    box.checked = chosen
  }
}

/** @param {{model: Model}} widget */
export function render({model}) {
  const method = ({id, title, values, best, note, state, chosen, fixed}) => {
    const box = h("input", {
      "type": model.single ? "radio" : "checkbox", "name": id, "disabled": fixed,
      "ref": follow(chosen),
      "aria-describedby": note ? `note-${id}` : null,
      "onchange": (e) => model.send_msg({type: "show-method", id, on: e.target.checked}),
    })
    const why = chosen ? "Keep at least two" : "Deselect one first (max. 4)"
    const ring = state === "running" && h("i", {class: "ring"})
    return [
      h("tr", {key: id, class: chosen ? "chosen" : "idle"},
        h("td", {}, h("label", {title: fixed && !model.single ? why : null}, box, title)),
        values.map((value, i) => h("td", {class: best[i] ? "best" : null}, value))),
      note && h("tr", {key: `note ${id}`, class: `note ${state}`},
        h("td", {id: `note-${id}`, colspan: 1 + values.length}, ring, note)),
    ]
  }
  const draw = () => h("table", {"aria-label": model.label},
    h("thead", {}, h("tr", {}, [[model.heading, ""], ...model.columns].map(([text, title]) =>
      h("th", {scope: "col", title}, text)))),
    h("tbody", {}, model.rows.flatMap(method)))
  return drawn(model, ["rows", "columns"], styled, draw)
}
