// Small plots beside a lesson's text: weight over distance, error over the resolution R.
//
//   const {node, show} = smallPlot()
//   show(plot)          // of `learn/plots.py`; null hides it
//
// `node` is a <figure>. Rules: `stylesheet("lesson/small_plot.css")` in the same shadow root.

import {element} from "../common/elements.js"
import {h} from "../common/nodes.js"
import {lengthText, weightText} from "../common/text.js"
import {curve, sample} from "../tables/plot.js"
import {render} from "../vendor/preact.js"

const [WIDTH, HEIGHT] = [300, 130]
const [LEFT, RIGHT, TOP, BOTTOM] = [34, 16, 20, 30]

/** A part of one, as a fraction where it has a short one. @param {number} part */
export function fractionText(part) {
  const below = Math.round(1 / part)
  const isUnit = below <= 16 && Math.abs(part * below - 1) < 1e-6
  const short = {0: "0", 0.25: "¼", 1: "1"}[Number(part.toFixed(6))]
  return short ?? (isUnit ? `1/${below}` : weightText(part))
}

const KINDS = {
  // The curve of the falloff with the joints of the vertex, relative to the nearest, at d.
  falloff({curve, marks, twice, unit}) {
    const [d] = curve.points[0]
    const named = [["1", [d, 1]], [fractionText(twice[1]), twice]]
    return {
      curves: [curve],
      dots: [...marks, ...named.map(([name, at]) => ({name, at, chosen: false, isNamed: true}))],
      x: {label: `distance in ${unit}`, from: 0, to: curve.points.at(-1)[0], ticks: [0, d, 2 * d],
        text: (x) => ({[d]: `d = ${lengthText(d)}`, [2 * d]: "2d"})[x] ?? "0"},
      y: {label: "weight, nearest bone: 1", from: 0, to: 1, ticks: [0, 0.25, 1],
        text: fractionText},
      says: [...marks.map(({name, at}) => `${name} ${weightText(at[1])} at ${lengthText(at[0])}`),
        `${fractionText(twice[1])} at 2d`],
    }
  },
  // A curve for each connectivity; R is on a logarithmic axis.
  error({curves, at, reference}) {
    const all = curves.flatMap(({points}) => points)
    const [sizes, errors] = [0, 1].map((i) => all.map((point) => point[i]))
    const [fewest, most, worst] = [Math.min(...sizes), Math.max(...sizes), Math.max(...errors)]
    const top = 10 * Math.ceil(worst / 10)
    return {
      curves, dots: [], line: Math.min(Math.max(at, fewest), most),
      x: {label: "R", from: fewest, to: most, log: true,
        ticks: curves[0].points.map(([r]) => r), text: String},
      y: {label: `mean error in %, against ${reference}`, from: 0, to: top,
        ticks: [0, top / 2, top], text: lengthText},
      says: curves.map(({name, points}) =>
        `${name} ${points.map(([r, e]) => `${lengthText(e)} % at R = ${r}`).join(", ")}`),
    }
  },
}

export function smallPlot() {
  const node = element("figure", {hidden: true})
  const show = (plot) => {
    node.hidden = !plot
    if (plot) { render(drawn(KINDS[plot.kind](plot)), node) }
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
  const text = (content, className, [left, top]) =>
    h("text", {class: className, x: left, y: top}, content)
  const vertical = (at, className, end = "") =>
    h("path", {class: className, d: `M${at} ${TOP}V${HEIGHT - BOTTOM}${end}`})
  const label = `${y.label} over ${x.label}: ${says.join("; ")}`
  return [
    h("figcaption", {}, y.label, curves.map(({name}, i) => sample(i, name))),
    h("svg", {"class": "plot", "role": "img", "aria-label": label,
      "viewBox": `0 0 ${WIDTH} ${HEIGHT}`},
    vertical(LEFT, "axis", `H${WIDTH - RIGHT}`),
    x.ticks.map((tick) => text(x.text(tick), "tick", [across(tick), HEIGHT - BOTTOM + 12])),
    y.ticks.map((tick) => text(y.text(tick), "tick end", [LEFT - 4, up(tick) + 4])),
    text(x.label, "tick", [(LEFT + WIDTH - RIGHT) / 2, HEIGHT - 4]),
    line && vertical(across(line), "now"),
    curves.map(({points}, i) => curve(i, points.map(([a, b]) => [across(a), up(b)]))),
    dots.map(({name, at: [a, b], chosen, isNamed}) => [
      h("circle", {
        class: isNamed ? "dot mark" : chosen ? "dot chosen" : "dot",
        cx: across(a), cy: up(b), r: chosen || isNamed ? 5 : 3.5,
      }),
      (chosen || isNamed) && text(name, "name", [across(a) + 8, up(b) - 6]),
    ])),
  ]
}
