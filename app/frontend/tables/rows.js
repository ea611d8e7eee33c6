// A short list of things that can be chosen, each with a number and a bar.

import {button, element, renew} from "../common/elements.js"
import {stylesheet} from "../common/styles.js"

const styled = await stylesheet("tables/rows.css")

/** @param {{model: Model}} widget */
export function render({model}) {
  const list = element("ol")
  const fill = () => {
    list.setAttribute("aria-label", model.label)
    renew(list, ...model.rows.map(([name, note, part], row) => {
      const bar = element("i")
      bar.style.width = `${100 * part}%`
      const click = () => model.send_msg({type: "pick-row", row})
      const point = () => model.points && model.send_msg({type: "point-at-row", row})
      const leave = () => model.points && model.send_msg({type: "point-at-row", row: -1})
      const on = {click, mouseenter: point, focus: point, mouseleave: leave, blur: leave}
      return element("li", {}, button(
        {on}, element("span", {title: name}, name), element("b", {}, note), bar))
    }))
    mark()
  }
  const mark = () => list.querySelectorAll("button").forEach((one, row) => {
    one.setAttribute("aria-current", String(row === model.chosen))
  })
  model.on("rows", fill)
  model.on("chosen", mark)
  fill()
  return element("div", {}, styled(), list)
}
