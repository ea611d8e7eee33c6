// A short list of things that can be chosen, each with a number and a bar.

import {button, drawn, h} from "../common/nodes.js"
import {stylesheet} from "../common/styles.js"

const styled = await stylesheet("tables/rows.css")

/** @param {{model: Model}} widget */
export function render({model}) {
  const point = (row) => () => model.points && model.send_msg({type: "point-at-row", ...row})
  const away = point({name: null})
  const item = ([name, note, part], place) => {
    // A row is identified by its name, since the server may have moved it.
    const nth = model.rows.slice(0, place).filter(([other]) => other === name).length
    const row = {name, nth}
    return h("li", {key: `${nth} ${name}`}, button({
      "aria-current": String(place === model.chosen),
      "onclick": () => model.send_msg({type: "pick-row", ...row}),
      "onmouseenter": point(row), "onfocus": point(row), "onmouseleave": away, "onblur": away,
    },
    h("span", {title: name}, name), h("b", {}, note), h("i", {style: {width: `${100 * part}%`}})))
  }
  return drawn(model, ["rows", "chosen"], styled, () =>
    h("ol", {"aria-label": model.label}, model.rows.map(item)))
}
