// Small plots beside a lesson's text: weight over distance, error over the resolution R.
//
//   const {node, show} = smallPlot()
//   show(plot)          // of `learn/plots.py`; null hides it
//
// `node` is a <figure>. Rules: `stylesheet("small_plot.css")` in the same shadow root.

import {make} from "./drag_handle.js"
import {element} from "./elements.js"
import {lengthText, weightText} from "./text.js"

const [WIDTH, HEIGHT] = [300, 150]
const [LEFT, RIGHT, TOP, BOTTOM] = [34, 16, 10, 30]
const POINTS = 80
const DASHES = ["none", "6 3", "2 3", "8 3 2 3"]

/** The paper's kernel (equation 1) at a distance, up to a factor. */
export function kernel(distance, diagonal, alpha) {
  const x = distance / diagonal
  return ((1 - alpha) * x + alpha * x * x) ** -2
}

/** The weight of a joint at a distance, where all joints of a vertex have these distances. */
export function weightAt(distance, {distances, diagonal, alpha}) {
  const least = Math.max(Math.min(...distances), 1e-12 * diagonal)
  const part = (one) => kernel(one, diagonal, alpha) / kernel(least, diagonal, alpha)
  const sum = distances.reduce((sum, one) => sum + part(Math.max(one, least)), 0)
  return part(Math.max(distance, least)) / sum
}

const KINDS = {
  // The curve that all joints of the vertex lie on, and its joints.
  falloff(plot) {
    const {marks, distances} = plot
    const end = 1.15 * Math.max(...marks.map(({distance}) => distance), 1e-9)
    const start = Math.min(...distances)
    const places = Array.from({length: POINTS}, (_, i) => start + (end - start) * i / (POINTS - 1))
    const curve = places.map((distance) => [distance, weightAt(distance, plot)])
    const dots = marks.map(({name, distance, weight, chosen}) =>
      ({name, chosen, at: [distance, plot.on_curve ? weightAt(distance, plot) : weight]}))
    const top = Math.max(...curve.map(([, y]) => y), ...dots.map(({at: [, y]}) => y))
    return {
      curves: [{name: "paper's falloff", points: curve}], dots,
      x: {label: "distance", from: 0, to: end, ticks: [0, end / 2, end], text: lengthText},
      y: {label: "weight", from: 0, to: top, ticks: [0, top], text: weightText},
      says: dots.map(({name, at}) => `${name} ${weightText(at[1])} at ${lengthText(at[0])}`),
    }
  },
  // A curve for each connectivity, on logarithmic axes.
  error({curves, at}) {
    const all = curves.flatMap(({points}) => points)
    const limits = (i) => [Math.min(...all.map((p) => p[i])), Math.max(...all.map((p) => p[i]))]
    const [[fewest, most], [least, worst]] = [limits(0), limits(1)]
    const now = Math.min(Math.max(at, fewest), most)
    return {
      curves, dots: [], line: now,
      x: {label: "R", from: fewest, to: most, log: true,
        ticks: curves[0].points.map(([r]) => r), text: String},
      y: {label: "error in %", from: least, to: worst, log: true, ticks: [least, worst],
        text: lengthText},
      says: curves.map(({name, points}) =>
        `${name} ${points.map(([r, e]) => `${lengthText(e)} % at R = ${r}`).join(", ")}`),
    }
  },
}

export function smallPlot() {
  const node = element("figure", {hidden: true})
  const show = (plot) => {
    node.hidden = !plot
    if (plot) { node.replaceChildren(...drawn(KINDS[plot.kind](plot))) }
  }
  return {node, show}
}

function drawn({curves, dots, line, x, y, says}) {
  const place = ({from, to, log}, low, high) => {
    const scale = log ? Math.log : (value) => value
    const size = scale(to) - scale(from) || 1
    return (value) => low + (high - low) * (scale(value) - scale(from)) / size
  }
  const across = place(x, LEFT, WIDTH - RIGHT)
  const up = place(y, HEIGHT - BOTTOM, TOP)
  const holder = element("div")
  const svg = make("svg", "plot", holder, {role: "img", viewBox: `0 0 ${WIDTH} ${HEIGHT}`})
  svg.setAttribute("aria-label", `${y.label} over ${x.label}: ${says.join("; ")}`)
  const text = (content, className, [left, top]) => {
    make("text", className, svg, {x: left, y: top}).textContent = content
  }
  const path = (points, attributes) =>
    make("path", "curve", svg, {d: `M${points.map((p) => p.join(" ")).join("L")}`, ...attributes})
  path([[LEFT, TOP], [LEFT, HEIGHT - BOTTOM], [WIDTH - RIGHT, HEIGHT - BOTTOM]], {class: "axis"})
  for (const tick of x.ticks) { text(x.text(tick), "tick", [across(tick), HEIGHT - BOTTOM + 12]) }
  for (const tick of y.ticks) { text(y.text(tick), "tick end", [LEFT - 4, up(tick) + 4]) }
  text(x.label, "tick", [(LEFT + WIDTH - RIGHT) / 2, HEIGHT - 4])
  if (line) { path([[across(line), TOP], [across(line), HEIGHT - BOTTOM]], {class: "now"}) }
  curves.forEach(({points}, i) => path(points.map(([a, b]) => [across(a), up(b)]),
    {style: `stroke-dasharray: ${DASHES[i % DASHES.length]}`}))
  for (const {name, at: [a, b], chosen} of dots) {
    const [className, r] = chosen ? ["dot chosen", 5] : ["dot", 3.5]
    make("circle", className, svg, {cx: across(a), cy: up(b), r})
    if (chosen) { text(name, "name", [across(a) + 8, up(b) - 6]) }
  }
  const key = element("figcaption", {}, y.label, ...curves.map(({name}, i) => {
    const sample = element("span")
    make("path", "curve", make("svg", "", sample, {viewBox: "0 0 24 6", width: 24, height: 6}),
      {d: "M0 3H24", style: `stroke-dasharray: ${DASHES[i % DASHES.length]}`})
    sample.append(name)
    return sample
  }))
  return [key, svg]
}
