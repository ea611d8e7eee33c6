// The card of one vertex: its weights as bars, its nearest bones, where it belongs; or of a node.

import {button, drawn, h, nameOf, numberBox, span} from "../common/nodes.js"
import {stylesheet} from "../common/styles.js"
import {lengthText, percentText, weightText} from "../common/text.js"

const styled = await stylesheet("widgets/inspector.css")

const quiet = (...text) => h("div", {class: "quiet"}, ...text)
const dot = (background) => h("span", {class: "dot", style: {background}})
const heading = (text, small = "") => h("h3", {}, text, small && h("small", {}, small))

function bar(background, part, name = "bar") {
  return h("span", {
    class: name, style: {background, width: `${Math.max(0, Math.min(1, part)) * 100}%`},
  })
}

function row(model, {joint, name, short}, bars, value, spoken) {
  return button({
    "class": "row", "title": `Choose ${name}`, "aria-label": spoken,
    "onclick": () => model.send_msg({type: "pick", joint}),
  }, nameOf(short ?? name), span("bars", ...bars), span("value", value))
}

// What is shown of another vertex or node begins at its top.
function frame(model, what, number, ...content) {
  const label = `${what} ${number}`
  return h("section", {"key": label, "class": "vertex-card", "aria-label": label},
    h("header", {}, h("h2", {}, `${what} ${number.toLocaleString("en")}`),
      button({
        "class": "close", "aria-label": `Close the ${what.toLowerCase()}`,
        "onclick": () => model.send_msg({type: "close"}),
      }, "×")),
    ...content)
}

const FORMS = {mesh: "●", interior: "■", surface: "▲"}

// A node of the graph; a press on a neighbour goes there.
function nodeCard(model, facts) {
  const {node, unit, kind, position, winding, degree, neighbours, triangle, vertices} = facts
  const facing = [
    ["position", position.map(lengthText).join(", ")],
    ["winding number", winding.toFixed(3)],
    ...triangle ? [["cut from", `face ${triangle[0]}: ${triangle.slice(1).join(", ")}`]] : [],
    ...vertices.length ? [[vertices.length > 1 ? "vertices" : "vertex", vertices.join(", ")]] : [],
  ]
  const title = degree === 1 ? "1 neighbour" : `${degree} neighbours`
  return frame(model, "Node", node, quiet(`${FORMS[kind]} ${kind} node`),
    h("dl", {}, facing.map(([name, value]) => [h("dt", {}, name), h("dd", {}, value)])),
    heading(title, `length in ${unit}`),
    neighbours.map((other) => button({
      "class": "row step",
      "aria-label": `Go to ${other.kind} node ${other.node}, ${lengthText(other.length)} away`,
      "onclick": () => model.send_msg({type: "pick-node", node: other.node}),
    }, span("name", `${FORMS[other.kind]} ${other.node}`), span("", other.kind),
    span("value", lengthText(other.length)))))
}

const PIECES = {
  "mesh edge": "along the mesh", "interior edge": "inside", "surface edge": "through the skin",
  "line of sight": "straight inside", "outside": "outside",
}

const lengthOf = (path) => path.reduce((sum, [, length]) => sum + length, 0)

// A path as a bar of its pieces, as long as they are, and the share of each kind.
function pathBar(path) {
  const whole = lengthOf(path) || 1
  const pieces = path.map(([kind, length]) => h("span", {
    class: `piece ${kind.replaceAll(" ", "-")}`, style: {flexGrow: 100 * length / whole},
    title: `${PIECES[kind]}: ${percentText(length / whole)}`,
  }))
  const lengths = new Map()
  for (const [kind, length] of path) { lengths.set(kind, (lengths.get(kind) || 0) + length) }
  const shares = [...lengths].map(([kind, length]) =>
    `${percentText(length / whole)} ${PIECES[kind]}`)
  return [span("path", ...pieces), quiet(shares.join(" · "))]
}

// From distance to weight, one step a line; the part that a step removes is pale.
function waterfall({color, steps, file}) {
  const line = (name, value, ...bars) => [h("dt", {}, name),
    h("dd", {}, span("track", ...bars), span("value", weightText(value)))]
  return h("dl", {class: "steps"},
    steps.map(([name, value], i) => {
      const lost = i ? steps[i - 1][1] - value : 0
      return line(name, value, bar(color, value), lost > 0.005 && bar(color, lost, "bar lost"))
    }),
    file !== null && line("in the file", file, bar(color, file, "bar files")))
}

// One length: the distance that the weights use, or else that of the path.
function distanceText({path, distance, straight, factors, effective}) {
  const air = straight === null ? "" : `, through the air ${lengthText(straight)}`
  if (distance === null && path.length) {
    return `Path ${lengthText(lengthOf(path))}${air}: too far for a weight.`
  }
  if (distance === null) { return straight === null ? "It has no bone." : `No distance${air}.` }
  const times = factors.map(([name, value]) => `×\u202f${value.toPrecision(2)} ${name}`)
  const counts = times.length ? `; ${times.join(", ")}: effective ${lengthText(effective)}` : ""
  return `Distance ${lengthText(distance)}${air}${counts}.`
}

// Why a joint has its weight, or why it has none.
function explained(bone, first) {
  const {color, name, short, path, steps, straight, absence, rank, chosen} = bone
  const title = absence ? `Why not ${short ?? name}?` : short ?? name
  const place = rank ? ` Number ${rank} of the joints by distance.` : ""
  const hasShare = steps.some(([, weight]) => weight >= 0.0005)
  return h("details", {key: name, open: first || (chosen && absence !== "")},
    h("summary", {title: name}, dot(color), nameOf(title),
      span("value", weightText(steps.at(-1)[1]))),
    absence && h("div", {class: "absence"}, `${absence}${place}`),
    straight !== null && (path.length ? pathBar(path)
      : quiet("No path to this joint through the body.")),
    quiet(distanceText(bone)), hasShare && waterfall(bone))
}

// What a person gives the vertex in place of what is computed; it is scaled to sum to one.
function overruling(model, {offered, overruled}) {
  const give = (weights) => model.send_msg({type: "override", weights})
  const submit = (e) => {
    e.preventDefault()
    const boxes = [...e.currentTarget.querySelectorAll("input")]
    for (const box of boxes) { box.defaultValue = box.value }
    give(boxes.map((box) => [Number(box.name), box.valueAsNumber]))
  }
  return h("form", {class: "overrule", onsubmit: submit},
    heading("Override", overruled ? "set manually" : "scaled to sum to one"),
    offered.map(({joint, name, short, color, weight}) =>
      h("label", {key: joint, title: name}, dot(color), nameOf(short ?? name),
        numberBox(String(Number(weight.toFixed(3))), {
          "type": "number", "name": joint, "min": 0, "max": 1, "step": 0.05, "required": true,
          "aria-label": `Weight of ${name}`,
        }))),
    h("div", {class: "buttons"}, button({type: "submit"}, "Override"),
      overruled && button({onclick: () => give(null)}, "Reset")))
}

function explanation(model, facts) {
  const why = {
    "class": "why", "aria-expanded": String(facts.explain),
    "onclick": () => model.send_msg({type: "explain"}),
  }
  return [
    button(why, facts.explain ? "Hide why" : "Why these weights?"),
    facts.explain && !facts.why.length && quiet("Tracing paths …"),
    facts.why.map((bone, number) => explained(bone, number === 0)),
    facts.explain && overruling(model, facts),
  ]
}

// Which part of the mesh the vertex belongs to; a press on it shows that part alone.
function component(model, {number, of, vertices}, asks) {
  const part = of === 1 ? "The mesh is one part" : `Part ${number} of ${of} of the mesh`
  const size = `${vertices.toLocaleString("en")} ${vertices === 1 ? "vertex" : "vertices"}`
  if (of === 1 || !asks) { return quiet(`${part} · ${size}`) }
  return button({
    class: "quiet part", title: "See this part apart, and choose how it is bound",
    onclick: () => model.send_msg({type: "show-part"}),
  }, `${part} · ${size}`)
}

function weightRow(model, bone, {artist}) {
  const bars = [bar(bone.color, bone.ours)]
  let spoken = `${bone.name}: weight ${weightText(bone.ours)}`
  if (artist) {
    bars.push(bar(bone.color, bone.artist))
    spoken += `, in the file ${weightText(bone.artist)}`
  }
  return row(model, bone, bars, weightText(bone.ours), spoken)
}

function distanceRows(model, distances) {
  const most = Math.max(...distances.map(({distance}) => distance), 1e-12)
  return distances.map((bone) => {
    const length = lengthText(bone.distance)
    const spoken = `${bone.name}: distance ${length}`
    return row(model, bone, [bar(bone.color, bone.distance / most)], length, spoken)
  })
}

function vertexCard(model, facts) {
  const method = facts.method && quiet(`Method: ${facts.method}`)
  if (!facts.computed) {
    return frame(model, "Vertex", facts.vertex, method, quiet("No weights computed yet."))
  }
  const asks = facts.explain !== undefined  // a page without a server has no answers
  const reached = facts.reached ? "Reached through the body from at least one joint."
    : `It follows its nearest bones in a straight line: ${facts.reason}.`
  return frame(model, "Vertex", facts.vertex, method,
    component(model, facts.component, asks),
    heading(facts.overruled ? "Weights, set manually" : "Weights",
      facts.artist && "outlined: the file's own"),
    facts.weights.map((bone) => weightRow(model, bone, facts)),
    facts.distances && [  // else of another method
      heading("The nearest bones", `distance in ${facts.unit}`),
      distanceRows(model, facts.distances), asks && explanation(model, facts),
      h("div", {class: "state"}, dot(facts.reached ? "#4c9a2a" : "#d9822b"), span("", reached)),
    ])
}

/** @param {{model: Model}} widget */
export function render({model}) {
  const places = new Map()  // of the boxes: they stay, whichever weight is the largest now
  let vertex = null
  const inPlace = (facts) => {
    if (facts.vertex !== vertex) { places.clear(); vertex = facts.vertex }
    const placeOf = ({joint}) => {
      if (!places.has(joint)) { places.set(joint, places.size) }
      return places.get(joint)
    }
    facts.offered?.forEach(placeOf)
    return {...facts, offered: facts.offered?.toSorted((a, b) => placeOf(a) - placeOf(b))}
  }
  const draw = () => model.facts && (model.facts.node === undefined
    ? vertexCard(model, inPlace(model.facts)) : nodeCard(model, model.facts))
  const escape = (e) => {
    if (e.key === "Escape" && model.facts) { model.send_msg({type: "close"}) }
  }
  document.addEventListener("keydown", escape)
  model.on("remove", () => document.removeEventListener("keydown", escape))
  return drawn(model, ["facts"], styled, draw)
}
