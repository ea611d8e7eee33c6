// The card of one vertex: its weights as bars, its nearest bones, where it belongs; or of a node.

import {button, element, focusIn, nameElement, span} from "../common/elements.js"
import {stylesheet} from "../common/styles.js"
import {lengthText, percentText, weightText} from "../common/text.js"

const styled = await stylesheet("widgets/inspector.css")

const quiet = (text) => element("div", {className: "quiet"}, text)
const dot = (background) => element("span", {className: "dot", style: {background}})
const heading = (text, ...small) =>
  element("h3", {}, text, ...small.map((one) => element("small", {}, one)))

function bar(color, part, className = "bar") {
  const width = `${Math.max(0, Math.min(1, part)) * 100}%`
  return element("span", {className, style: {background: color, width}})
}

function row(model, {joint, name, short}, bars, value, spoken) {
  const click = () => model.send_msg({type: "pick", joint})
  const about = {className: "row", title: `Choose ${name}`, aria: {label: spoken}, on: {click}}
  return button(about, nameElement(short ?? name), span("bars", ...bars), span("value", value))
}

function empty(model, what, number) {
  const click = () => model.send_msg({type: "close"})
  const label = `Close the ${what.toLowerCase()}`
  return element("section", {className: "vertex-card", aria: {label: `${what} ${number}`}},
    element("header", {}, element("h2", {}, `${what} ${number.toLocaleString("en")}`),
      button({className: "close", aria: {label}, on: {click}}, "×")))
}

const FORMS = {mesh: "●", interior: "■", surface: "▲"}

// A node of the graph; a press on a neighbour goes there.
function nodeCard(model, facts) {
  const {node, unit, kind, position, winding, degree, neighbours, triangle, vertices} = facts
  const root = empty(model, "Node", node)
  root.append(quiet(`${FORMS[kind]} ${kind} node`))
  const list = element("dl")
  const tell = (name, value) => list.append(element("dt", {}, name), element("dd", {}, value))
  tell("position", position.map(lengthText).join(", "))
  tell("winding number", winding.toFixed(3))
  if (triangle) { tell("cut from", `face ${triangle[0]}: ${triangle.slice(1).join(", ")}`) }
  if (vertices.length) { tell(vertices.length > 1 ? "vertices" : "vertex", vertices.join(", ")) }
  const title = degree === 1 ? "1 neighbour" : `${degree} neighbours`
  root.append(list, heading(title, `length in ${unit}`))
  for (const other of neighbours) {
    const length = lengthText(other.length)
    const label = `Go to ${other.kind} node ${other.node}, ${length} away`
    const click = () => model.send_msg({type: "pick-node", node: other.node})
    root.append(button({className: "row step", aria: {label}, on: {click}},
      span("name", `${FORMS[other.kind]} ${other.node}`), span("", other.kind),
      span("value", length)))
  }
  return root
}

const PIECES = {
  "mesh edge": "along the mesh", "interior edge": "inside", "surface edge": "through the skin",
  "line of sight": "straight inside", "outside": "outside",
}

const lengthOf = (path) => path.reduce((sum, [, length]) => sum + length, 0)

// A path as a bar of its pieces, as long as they are, and the share of each kind.
function pathBar(path) {
  const whole = lengthOf(path) || 1
  const pieces = path.map(([kind, length]) => element("span", {
    className: `piece ${kind.replaceAll(" ", "-")}`, style: {"flex-grow": 100 * length / whole},
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
  const list = element("dl", {className: "steps"})
  const line = (name, value, ...bars) => list.append(element("dt", {}, name), element("dd", {},
    span("track", ...bars), span("value", weightText(value))))
  steps.forEach(([name, value], i) => {
    const lost = i ? steps[i - 1][1] - value : 0
    const removed = lost > 0.005 ? [bar(color, lost, "bar lost")] : []
    line(name, value, bar(color, value), ...removed)
  })
  if (file !== null) { line("in the file", file, bar(color, file, "bar files")) }
  return list
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
  const way = path.length ? pathBar(path) : [quiet("No path to this joint through the body.")]
  const hasShare = steps.some(([, weight]) => weight >= 0.0005)
  return element("details", {open: first || (chosen && absence !== "")},
    element("summary", {title: name}, dot(color), nameElement(title),
      span("value", weightText(steps.at(-1)[1]))),
    ...absence ? [element("div", {className: "absence"}, `${absence}${place}`)] : [],
    ...straight === null ? [] : way, quiet(distanceText(bone)),
    ...hasShare ? [waterfall(bone)] : [])
}

// What a person gives the vertex in place of what is computed; it is scaled to sum to one.
function overruling(model, facts) {
  const give = (weights) => model.send_msg({type: "override", weights})
  const labels = facts.offered.map(({joint, name, short, color, weight}) => {
    const input = element("input", {
      type: "number", name: joint, min: 0, max: 1, step: 0.05, required: true,
      defaultValue: String(Number(weight.toFixed(3))), aria: {label: `Weight of ${name}`},
    })
    return element("label", {title: name}, dot(color), nameElement(short ?? name), input)
  })
  const submit = (e) => {
    e.preventDefault()
    const inputs = numberBoxes(e.currentTarget)
    for (const input of inputs) { input.defaultValue = input.value }
    give(inputs.map((input) => [Number(input.name), input.valueAsNumber]))
  }
  const buttons = element("div", {className: "buttons"}, button({type: "submit"}, "Override"))
  if (facts.overruled) { buttons.append(button({on: {click: () => give(null)}}, "Reset")) }
  return element("form", {className: "overrule", on: {submit}},
    heading("Override", facts.overruled ? "set manually" : "scaled to sum to one"),
    ...labels, buttons)
}

/** @param {HTMLElement} form */
const numberBoxes = (form) => [...form.querySelectorAll("input")]

// Change a form to another one. Boxes stay where they are: one that is built again loses its caret.
function renewForm(form, other) {
  const old = new Map(numberBoxes(form).map((input) => [input.name, input]))
  form.firstChild.replaceWith(other.firstChild)
  form.lastChild.replaceWith(other.lastChild)
  for (const input of numberBoxes(other)) {
    const box = old.get(input.name)
    old.delete(input.name)
    if (!box) { form.lastChild.before(input.parentElement); continue }
    if (box.value === box.defaultValue && box.value !== input.value) {
      box.value = input.value
      if (box === focusIn(form)) { box.select() }
    }
    box.defaultValue = input.value
  }
  for (const box of old.values()) { box.parentElement.remove() }
}

// Change a card to another one of the same vertex; it stays where it was read.
function renewCard(old, other) {
  const top = old.scrollTop
  const nameOf = (one) => one?.getAttribute("aria-label") ?? one?.className
  const focused = nameOf(focusIn(old))
  const [form, next] = [old, other].map((one) => one.querySelector(".overrule"))
  if (form && next) {
    renewForm(form, next)
    const parts = [...other.childNodes]
    const place = parts.indexOf(next)
    while (old.firstChild !== form) { old.firstChild.remove() }
    while (old.lastChild !== form) { old.lastChild.remove() }
    form.before(...parts.slice(0, place))
    form.after(...parts.slice(place + 1))
  } else {
    old.replaceChildren(...other.childNodes)
  }
  old.scrollTop = top
  if (!focused || old.contains(focusIn(old))) { return }
  const again = [...old.querySelectorAll("button")].find((one) => nameOf(one) === focused)
  again?.focus({preventScroll: true})
}

function explanation(model, facts) {
  const why = {
    className: "why", aria: {expanded: facts.explain},
    on: {click: () => model.send_msg({type: "explain"})},
  }
  /** @type {HTMLElement[]} */
  const parts = [button(why, facts.explain ? "Hide why" : "Why these weights?")]
  if (facts.explain && !facts.why.length) { parts.push(quiet("Tracing paths …")) }
  parts.push(...facts.why.map((bone, number) => explained(bone, number === 0)))
  if (facts.explain) { parts.push(overruling(model, facts)) }
  return parts
}

// Which part of the mesh the vertex belongs to; a press on it shows that part alone.
function component(model, {number, of, vertices}, asks) {
  const part = of === 1 ? "The mesh is one part" : `Part ${number} of ${of} of the mesh`
  const size = `${vertices.toLocaleString("en")} ${vertices === 1 ? "vertex" : "vertices"}`
  if (of === 1 || !asks) { return quiet(`${part} · ${size}`) }
  const title = "See this part apart, and choose how it is bound"
  const click = () => model.send_msg({type: "show-part"})
  return button({className: "quiet part", title, on: {click}}, `${part} · ${size}`)
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

function card(model, facts) {
  if (facts.node !== undefined) { return nodeCard(model, facts) }
  const root = empty(model, "Vertex", facts.vertex)
  if (facts.method) { root.append(quiet(`Method: ${facts.method}`)) }
  if (!facts.computed) {
    root.append(quiet("No weights computed yet."))
    return root
  }
  const asks = facts.explain !== undefined  // a page without a server has no answers
  const own = facts.artist ? ["outlined: the file's own"] : []
  root.append(
    component(model, facts.component, asks),
    heading(facts.overruled ? "Weights, set manually" : "Weights", ...own),
    ...facts.weights.map((bone) => weightRow(model, bone, facts)))
  if (!facts.distances) { return root }  // of another method
  root.append(heading("The nearest bones", `distance in ${facts.unit}`),
    ...distanceRows(model, facts.distances), ...asks ? explanation(model, facts) : [])
  const reached = facts.reached ? "Reached through the body from at least one joint."
    : `It follows its nearest bones in a straight line: ${facts.reason}.`
  root.append(element("div", {className: "state"},
    dot(facts.reached ? "#4c9a2a" : "#d9822b"), span("", reached)))
  return root
}

/** @param {{model: Model}} widget */
export function render({model}) {
  const root = element("div")
  const show = () => {
    const old = root.querySelector(".vertex-card")
    const other = model.facts && card(model, model.facts)
    if (old && other && old.ariaLabel === other.ariaLabel) { renewCard(old, other); return }
    root.replaceChildren(styled(), ...other ? [other] : [])
  }
  const escape = (e) => {
    if (e.key === "Escape" && model.facts) { model.send_msg({type: "close"}) }
  }
  document.addEventListener("keydown", escape)
  model.on("remove", () => document.removeEventListener("keydown", escape))
  model.on("facts", show)
  show()
  return root
}
