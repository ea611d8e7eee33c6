// Curves with a button at each point: its value is shown on hover, and a click reports it.

import {drawn, h, span} from "../common/nodes.js"
import {stylesheet} from "../common/styles.js"
import {curve, sample} from "./plot.js"

const styled = await stylesheet("tables/curves.css")

const [WIDTH, HEIGHT] = [280, 140]
const [LEFT, RIGHT, TOP, BOTTOM] = [36, 12, 10, 22]

const across = (x) => LEFT + x * (WIDTH - LEFT - RIGHT)
const up = (y) => HEIGHT - BOTTOM - y * (HEIGHT - BOTTOM - TOP)

/** @param {{model: Model}} widget */
export function render({model}) {
  const point = ({id, title, text, at: [x, y], chosen}, value) => {
    const says = `${title}: ${text}`
    const show = (e) => { value(e).textContent = says }
    const choose = () => model.send_msg({type: "pick-point", id})
    const press = (e) => {
      if (e.key === "Enter" || e.key === " ") { e.preventDefault(); choose() }
    }
    return h("g", {
      "key": id, "class": "point", "role": "button", "tabindex": 0, "aria-label": says,
      "aria-pressed": String(chosen), "onclick": choose, "onkeydown": press,
      "onpointerenter": show, "onfocus": show,
      "onpointerleave": (e) => { value(e).textContent = "" },
    }, h("circle", {class: "target", cx: across(x), cy: up(y), r: 11}),
    h("circle", {class: "dot", cx: across(x), cy: up(y), r: chosen ? 5.5 : 4}))
  }
  const plot = ({title, curves, x_ticks, y_ticks}) => {
    const value = ({currentTarget}) => currentTarget.closest("figure").querySelector(".value")
    return h("figure", {key: title},
      h("figcaption", {}, span("title", title), span("value")),
      h("svg", {"class": "plot", "role": "group", "aria-label": title,
        "viewBox": `0 0 ${WIDTH} ${HEIGHT}`},
      x_ticks.map(([at, text]) => [
        h("path", {class: "grid", d: `M${across(at)} ${up(0)}V${up(1)}`}),
        h("text", {class: "tick", x: across(at), y: HEIGHT - 7}, text)]),
      y_ticks.map(([at, text]) => [
        h("path", {class: "grid", d: `M${across(0)} ${up(at)}H${across(1)}`}),
        h("text", {class: "tick end", x: LEFT - 5, y: up(at) + 4}, text)]),
      curves.map(({points}, i) => curve(i, points.map(({at: [x, y]}) => [across(x), up(y)]))),
      curves.flatMap(({points}) => points).map((one) => point(one, value))),
      curves.map(({name}, i) => name && sample(i, name)))
  }
  return drawn(model, ["plots"], styled, () => model.plots.map(plot))
}
