// A table of weights: headings sort it, cells are edited, and a click on a row chooses its vertex.

import {button, drawn, h, numberBox} from "../common/nodes.js"
import {stylesheet} from "../common/styles.js"

const styled = await stylesheet("tables/weights_table.css")

/** @param {{model: Model}} widget */
export function render({model}) {
  const cell = (vertex, value, [title, joint]) => {
    const text = value.toFixed(3)
    if (joint < 0) { return h("td", {key: joint}, text) }
    const put = ({target: input}) => {
      const entered = Number(input.value.replace(",", "."))
      const is = input.value.trim() !== "" && entered >= 0 && entered <= 1
      if (!is || input.value === text) { input.value = text; return }
      input.defaultValue = input.value
      model.send_msg({type: "edit-weight", vertex, joint, value: entered})
    }
    const keydown = (e) => {
      if (e.key === "Enter") { e.target.blur(); e.preventDefault() }
      if (e.key === "Escape") { e.target.value = text; e.target.blur(); e.stopPropagation() }
    }
    return h("td", {key: joint}, numberBox(text, {
      "type": "text", "inputmode": "decimal", "name": `cell-${vertex}-${joint}`,
      "class": value === 0 ? "zero" : null, "onchange": put, "onkeydown": keydown,
      "aria-label": `Weight of ${title} at vertex ${vertex}`,
    }))
  }
  const draw = () => {
    const {columns = [], rows = [], totals = [], order = [], pages: turns = [0, 0]} = model.content
    const [[sorted, down], [page, pages]] = [order, turns]
    const heading = ([title, column]) => {
      const is = column === sorted
      const sort = () => model.send_msg({type: "sort", column})
      return h("th", {"scope": "col", "aria-sort": is ? (down ? "descending" : "ascending") : null},
        button({title, name: `sort-${column}`, onclick: sort}, title,
          is ? (down ? " ↓" : " ↑") : ""))
    }
    const row = ([vertex, ...values]) => {
      const pick = () => model.send_msg({type: "pick-vertex", vertex})
      return h("tr", {key: vertex},
        h("th", {scope: "row"}, button(
          {name: `row-${vertex}`, title: "Show this vertex", onclick: pick}, vertex)),
        values.map((value, i) => cell(vertex, value, columns[i + 1])))
    }
    const total = ([name, ...values]) => h("tr", {}, h("th", {scope: "row"}, name),
      values.map((value) => h("td", {}, value.toFixed(name === "Total" ? 1 : 3))))
    const turn = (label, to, text) => button({
      "disabled": to < 0 || to >= pages, "aria-label": label,
      "onclick": () => model.send_msg({type: "page", page: to}),
    }, text)
    return [
      h("div", {class: "scroll"},
        h("table", {"aria-label": model.label, "hidden": !columns.length},
          h("thead", {}, h("tr", {}, columns.map(heading))),
          h("tbody", {}, rows.map(row)), h("tfoot", {}, totals.map(total)))),
      h("nav", {"aria-label": "Pages of the table", "hidden": pages < 2},
        turn("Previous page", page - 1, "‹"), h("span", {}, `${page + 1} of ${pages}`),
        turn("Next page", page + 1, "›")),
    ]
  }
  return drawn(model, ["content"], styled, draw)
}
