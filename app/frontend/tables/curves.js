// Curves with a button at each point: its value is shown on hover, and a click reports it.

import {make} from "../handles/drag_handle.js"
import {element, renew, span} from "../common/elements.js"
import {stylesheet} from "../common/styles.js"

const styled = await stylesheet("tables/curves.css")

const [WIDTH, HEIGHT] = [280, 140]
const [LEFT, RIGHT, TOP, BOTTOM] = [36, 12, 10, 22]
const DASHES = ["none", "6 3", "2 3", "8 3 2 3"]

const across = (x) => LEFT + x * (WIDTH - LEFT - RIGHT)
const up = (y) => HEIGHT - BOTTOM - y * (HEIGHT - BOTTOM - TOP)

/** @param {{model: Model}} widget */
export function render({model}) {
  const figure = element("figure")
  const fill = () => renew(figure, ...model.plots.flatMap((plot) => drawn(plot, model)))
  model.on("plots", fill)
  fill()
  return element("div", {}, styled(), figure)
}

function drawn({title, curves, x_ticks, y_ticks}, model) {
  const value = span("value")
  const holder = element("div")
  const svg = make("svg", "plot", holder,
    {"role": "group", "aria-label": title, "viewBox": `0 0 ${WIDTH} ${HEIGHT}`})
  for (const [at, text] of x_ticks) {
    make("path", "grid", svg, {d: `M${across(at)} ${up(0)}V${up(1)}`})
    make("text", "tick", svg, {x: across(at), y: HEIGHT - 7}).textContent = text
  }
  for (const [at, text] of y_ticks) {
    make("path", "grid", svg, {d: `M${across(0)} ${up(at)}H${across(1)}`})
    make("text", "tick end", svg, {x: LEFT - 5, y: up(at) + 4}).textContent = text
  }
  for (const [i, {points}] of curves.entries()) {
    const places = points.map(({at: [x, y]}) => `${across(x)} ${up(y)}`)
    make("path", "curve", svg,
      {d: `M${places.join("L")}`, style: `stroke-dasharray: ${DASHES[i % DASHES.length]}`})
  }
  for (const {id, title: name, text, at: [x, y], chosen} of curves.flatMap(({points}) => points)) {
    const point = make("g", "point", svg, {
      "role": "button", "tabindex": 0, "data-id": id, "aria-label": `${name}: ${text}`,
      "aria-pressed": chosen,
    })
    make("circle", "target", point, {cx: across(x), cy: up(y), r: 11})
    make("circle", "dot", point, {cx: across(x), cy: up(y), r: chosen ? 5.5 : 4})
    const show = () => { value.textContent = `${name}: ${text}` }
    const choose = () => model.send_msg({type: "pick-point", id})
    const press = (event) => {
      if (event.key === "Enter" || event.key === " ") { event.preventDefault(); choose() }
    }
    for (const type of ["pointerenter", "focus"]) { point.addEventListener(type, show) }
    point.addEventListener("pointerleave", () => { value.textContent = "" })
    point.addEventListener("click", choose)
    point.addEventListener("keydown", press)
  }
  const names = curves.filter(({name}) => name).map(({name}, i) => {
    const sample = span("name")
    const line = make("svg", "", sample, {viewBox: "0 0 24 6", width: 24, height: 6})
    make("path", "curve", line,
      {d: "M0 3H24", style: `stroke-dasharray: ${DASHES[i % DASHES.length]}`})
    sample.append(name)
    return sample
  })
  return [element("figcaption", {}, span("title", title), value), svg, ...names]
}
