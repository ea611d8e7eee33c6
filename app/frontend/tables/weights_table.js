// A table of weights: headings sort it, cells are edited, and a click on a row chooses its vertex.

import {button, element, renew} from "../common/elements.js"
import {stylesheet} from "../common/styles.js"

const styled = await stylesheet("tables/weights_table.css")

/** @param {{model: Model}} widget */
export function render({model}) {
  const table = element("table", {aria: {label: model.label}})
  const pager = element("nav", {aria: {label: "Pages of the table"}})
  const fill = () => {
    const {columns = [], rows = [], totals = [], order = [], pages = [0, 0]} = model.content
    const [sorted, down] = order
    const head = element("tr", {}, ...columns.map(([title], column) => {
      const sort = () => model.send_msg({type: "sort", column})
      const is = column === sorted
      const heading = button({name: `sort-${column}`, on: {click: sort}, title},
        title, is ? (down ? " ↓" : " ↑") : "")
      const th = element("th", {scope: "col"}, heading)
      if (is) { th.setAttribute("aria-sort", down ? "descending" : "ascending") }
      return th
    }))
    const body = rows.map(([vertex, ...values]) => {
      const click = () => model.send_msg({type: "pick-vertex", vertex})
      const name = button({name: `row-${vertex}`, on: {click}, title: "Show this vertex"},
        String(vertex))
      const cells = values.map((value, i) => cell(vertex, value, i + 1, columns[i + 1]))
      return element("tr", {}, element("th", {scope: "row"}, name), ...cells)
    })
    const foot = totals.map(([name, ...values]) => element("tr", {},
      element("th", {scope: "row"}, name),
      ...values.map((value) => element("td", {}, value.toFixed(name === "Total" ? 1 : 3)))))
    table.hidden = !columns.length
    renew(table, element("thead", {}, head), element("tbody", {}, ...body),
      element("tfoot", {}, ...foot))
    turn(...pages)
  }
  const cell = (vertex, value, column, [title, edited]) => {
    const text = value.toFixed(3)
    if (!edited) { return element("td", {}, text) }
    const put = () => {
      const entered = Number(input.value.replace(",", "."))
      const is = input.value.trim() !== "" && entered >= 0 && entered <= 1
      if (!is || input.value === text) { input.value = text; return }
      model.send_msg({type: "edit-weight", vertex, column, value: entered})
    }
    const keydown = (e) => {
      if (e.key === "Enter") { input.blur(); e.preventDefault() }
      if (e.key === "Escape") { input.value = text; input.blur(); e.stopPropagation() }
    }
    const input = element("input", {
      type: "text", inputMode: "decimal", value: text, name: `cell-${vertex}-${column}`,
      aria: {label: `Weight of ${title} at vertex ${vertex}`}, on: {change: put, keydown},
    })
    input.classList.toggle("zero", value === 0)
    return element("td", {}, input)
  }
  const turn = (page, pages) => {
    pager.hidden = pages < 2
    const go = (label, to, text) => button({
      disabled: to < 0 || to >= pages, aria: {label}, on: {click: () =>
        model.send_msg({type: "page", page: to})}}, text)
    pager.replaceChildren(go("Previous page", page - 1, "‹"),
      element("span", {}, `${page + 1} of ${pages}`), go("Next page", page + 1, "›"))
  }
  model.on("content", fill)
  fill()
  return element("div", {}, styled(), element("div", {className: "scroll"}, table), pager)
}
