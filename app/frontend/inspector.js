// The card of one vertex: its weights as bars, its nearest bones, where it belongs.

import {nameElement} from "./elements.js"
import {stylesheet} from "./styles.js"
import {lengthText, percentText, weightText} from "./text.js"

const styled = await stylesheet("inspector.css")

function element(tag, className, text) {
  const made = document.createElement(tag)
  if (className) { made.className = className }
  if (text !== undefined) { made.textContent = text }
  return made
}

function bar(color, part) {
  const made = element("span", "bar")
  made.style.background = color
  made.style.width = `${Math.max(0, Math.min(1, part)) * 100}%`
  return made
}

function row(model, {joint, name, short}, bars, value, spoken) {
  const made = element("button", "row")
  made.type = "button"
  made.title = `Choose ${name}`
  made.setAttribute("aria-label", spoken)
  const track = element("span", "bars")
  track.append(...bars)
  made.append(nameElement(short ?? name), track, element("span", "value", value))
  made.addEventListener("click", () => model.send_msg({type: "bone", joint}))
  return made
}

function empty(model, what, number) {
  const root = element("section", "vertex-card")
  root.setAttribute("aria-label", `${what} ${number}`)
  const header = element("header")
  const close = element("button", "close", "×")
  close.type = "button"
  close.setAttribute("aria-label", `Close the ${what.toLowerCase()}`)
  close.addEventListener("click", () => model.send_msg({type: "close"}))
  header.append(element("h2", "", `${what} ${number.toLocaleString("en")}`), close)
  root.append(header)
  return root
}

const FORMS = {mesh: "●", interior: "■", surface: "▲"}

// A node of the graph; a press on a neighbour goes there.
function nodeCard(model, {node, kind, position, winding, degree, neighbours, triangle, vertices}) {
  const root = empty(model, "Node", node)
  root.append(element("div", "quiet", `${FORMS[kind]} ${kind} node`))
  const list = element("dl")
  const tell = (name, value) => list.append(element("dt", "", name), element("dd", "", value))
  tell("position", position.map(lengthText).join(", "))
  tell("winding number", winding.toFixed(3))
  if (triangle) { tell("cut from", `face ${triangle[0]}: ${triangle.slice(1).join(", ")}`) }
  if (vertices.length) { tell(vertices.length > 1 ? "vertices" : "vertex", vertices.join(", ")) }
  const heading = element("h3", "", degree === 1 ? "1 neighbour" : `${degree} neighbours`)
  heading.append(element("small", "", "length, in the file's units"))
  root.append(list, heading)
  for (const other of neighbours) {
    const button = element("button", "row step")
    button.type = "button"
    const length = lengthText(other.length)
    button.setAttribute("aria-label", `Go to ${other.kind} node ${other.node}, ${length} away`)
    button.append(element("span", "name", `${FORMS[other.kind]} ${other.node}`), element("span", "", other.kind), element("span", "value", length))
    button.addEventListener("click", () => model.send_msg({type: "node", node: other.node}))
    root.append(button)
  }
  return root
}

const PIECES = {
  "mesh edge": "along the mesh", "interior edge": "inside", "surface edge": "through the skin",
  "line of sight": "straight inside", outside: "outside",
}

// A path as a bar of its pieces, as long as they are.
function pathBar(path) {
  const bar = element("span", "path")
  const whole = path.reduce((sum, [, length]) => sum + length, 0) || 1
  for (const [kind, length] of path) {
    const piece = element("span", `piece ${kind.replaceAll(" ", "-")}`)
    piece.style.flexGrow = 100 * length / whole
    piece.title = `${PIECES[kind]}: ${percentText(length / whole)}`
    bar.append(piece)
  }
  return bar
}

// From distance to weight, one step a line; the part that a step removes is pale.
function waterfall({color, steps, file}) {
  const list = element("dl", "steps")
  let before = null
  for (const [name, value] of [...steps, ...(file === null ? [] : [["in the file", file]])]) {
    const track = element("dd")
    const own = bar(color, value)
    if (name === "in the file") { own.className = "bar files" }
    const bars = element("span", "track")
    bars.append(own)
    if (before !== null && value < before - 0.005 && name !== "in the file") {
      const lost = bar(color, before - value)
      lost.className = "bar lost"
      bars.append(lost)
    }
    track.append(bars, element("span", "value", weightText(value)))
    list.append(element("dt", "", name), track)
    before = value
  }
  return list
}

// A length is told once: the distance that the weights follow, else that of the path.
function distanceText({path, distance, straight, factors, effective}) {
  const air = straight === null ? "" : `, through the air ${lengthText(straight)}`
  if (distance === null && path.length) {
    const length = path.reduce((sum, [, piece]) => sum + piece, 0)
    return `Path ${lengthText(length)}${air}: too far for a weight.`
  }
  if (distance === null) { return straight === null ? "It has no bone." : `No distance${air}.` }
  const times = factors.map(([name, value]) => `×\u202f${value.toPrecision(2)} ${name}`)
  const counts = times.length ? `; ${times.join(", ")}: effective ${lengthText(effective)}` : ""
  return `Distance ${lengthText(distance)}${air}${counts}.`
}

function explained(bone, first) {
  const root = element("details")
  root.open = first
  const summary = element("summary")
  const dot = element("span", "dot")
  dot.style.background = bone.color
  summary.append(dot, nameElement(bone.short ?? bone.name), element("span", "value", weightText(bone.steps.at(-1)[1])))
  summary.title = bone.name
  root.append(summary)
  if (bone.path.length) {
    const lengths = new Map()
    for (const [kind, length] of bone.path) { lengths.set(kind, (lengths.get(kind) || 0) + length) }
    const whole = bone.path.reduce((sum, [, length]) => sum + length, 0) || 1
    const parts = [...lengths].map(([kind, length]) => `${percentText(length / whole)} ${PIECES[kind]}`)
    root.append(pathBar(bone.path), element("div", "quiet", parts.join(" · ")))
  } else {
    root.append(element("div", "quiet", "No path to this joint through the body."))
  }
  root.append(element("div", "quiet", distanceText(bone)), waterfall(bone))
  return root
}

// What a person gives the vertex in place of what is computed; it is scaled to sum to one.
function overruling(model, facts) {
  const form = element("form", "overrule")
  const heading = element("h3", "", "Override")
  heading.append(element("small", "", facts.overruled ? "set manually" : "scaled to sum to one"))
  form.append(heading)
  const fields = facts.offered.map(({joint, name, short, color, weight}) => {
    const label = element("label")
    const dot = element("span", "dot")
    dot.style.background = color
    const input = element("input")
    Object.assign(input, {type: "number", min: 0, max: 1, step: 0.05, required: true})
    input.defaultValue = String(Number(weight.toFixed(3)))
    input.setAttribute("aria-label", `Weight of ${name}`)
    label.title = name
    label.append(dot, nameElement(short ?? name), input)
    form.append(label)
    return [joint, input]
  })
  const buttons = element("div", "buttons")
  const give = element("button", "", "Override")
  give.type = "submit"
  buttons.append(give)
  if (facts.overruled) {
    const reset = element("button", "", "Reset")
    reset.type = "button"
    reset.addEventListener("click", () => model.send_msg({type: "overrule", weights: null}))
    buttons.append(reset)
  }
  form.append(buttons)
  form.addEventListener("submit", (e) => {
    e.preventDefault()
    const weights = fields.map(([joint, input]) => [joint, input.valueAsNumber])
    for (const [, input] of fields) { input.defaultValue = input.value }
    model.send_msg({type: "overrule", weights})
  })
  return form
}

// Text typed into a card and not yet sent, by field.
function typedNumbers(card) {
  const inputs = [...card?.querySelectorAll("input") ?? []]
  const edited = inputs.filter((input) => input.value !== input.defaultValue)
  return new Map(edited.map((input) => [input.getAttribute("aria-label"), input.value]))
}

function explanation(model, facts) {
  const why = element("button", "why", facts.explain ? "Hide why" : "Why these weights?")
  why.type = "button"
  why.setAttribute("aria-expanded", String(facts.explain))
  why.addEventListener("click", () => model.send_msg({type: "explain"}))
  const parts = [why]
  if (facts.explain && !facts.why.length) { parts.push(element("div", "quiet", "Tracing paths …")) }
  parts.push(...facts.why.map((bone, number) => explained(bone, number === 0)))
  if (facts.explain) { parts.push(overruling(model, facts)) }
  return parts
}

function card(model, facts) {
  if (facts.node !== undefined) { return nodeCard(model, facts) }
  const root = empty(model, "Vertex", facts.vertex)
  if (facts.method) { root.append(element("div", "quiet", `Method: ${facts.method}`)) }
  if (!facts.computed) {
    root.append(element("div", "quiet", "No weights computed yet."))
    return root
  }
  const asks = facts.explain !== undefined  // a page without a server has no answers
  const {number, of, vertices} = facts.component
  const part = of === 1 ? "The mesh is one part" : `Part ${number} of ${of} of the mesh`
  const size = `${vertices.toLocaleString("en")} ${vertices === 1 ? "vertex" : "vertices"}`
  if (of === 1 || !asks) {
    root.append(element("div", "quiet", `${part} · ${size}`))
  } else {
    const apart = element("button", "quiet part", `${part} · ${size}`)
    apart.type = "button"
    apart.title = "See this part apart, and choose how it is bound"
    apart.addEventListener("click", () => model.send_msg({type: "part"}))
    root.append(apart)
  }

  const heading = element("h3", "", facts.overruled ? "Weights, set manually" : "Weights")
  if (facts.artist) { heading.append(element("small", "", "outlined: the file's own")) }
  root.append(heading)
  for (const bone of facts.weights) {
    const bars = [bar(bone.color, bone.ours)]
    let spoken = `${bone.name}: weight ${weightText(bone.ours)}`
    if (facts.artist) {
      bars.push(bar(bone.color, bone.artist))
      spoken += `, in the file ${weightText(bone.artist)}`
    }
    root.append(row(model, bone, bars, weightText(bone.ours), spoken))
  }

  if (!facts.distances) { return root }  // of another method
  const distances = element("h3", "", "The nearest bones")
  distances.append(element("small", "", "distance, in the file's units"))
  root.append(distances)
  const most = Math.max(...facts.distances.map(({distance}) => distance), 1e-12)
  for (const bone of facts.distances) {
    const {name, distance, color} = bone
    const spoken = `${name}: distance ${lengthText(distance)}`
    root.append(row(model, bone, [bar(color, distance / most)], lengthText(distance), spoken))
  }

  if (asks) { root.append(...explanation(model, facts)) }

  const state = element("div", "state")
  const dot = element("span", "dot")
  dot.style.background = facts.reached ? "#4c9a2a" : "#d9822b"
  const reached = facts.reached ? "Reached through the body from at least one joint."
    : `It follows its nearest bones in a straight line: ${facts.reason}.`
  state.append(dot, element("span", "", reached))
  root.append(state)
  return root
}

export function render({model}) {
  const root = document.createElement("div")
  const show = () => {
    const old = root.querySelector(".vertex-card")
    const [label, top] = [old?.getAttribute("aria-label"), old?.scrollTop ?? 0]
    const typed = typedNumbers(old)
    const focused = old?.getRootNode().activeElement?.getAttribute("aria-label")
    root.replaceChildren(styled(), ...(model.facts ? [card(model, model.facts)] : []))
    // The same vertex with other numbers stays where it was read.
    const now = root.querySelector(".vertex-card")
    if (!now || now.getAttribute("aria-label") !== label) { return }
    now.scrollTop = top
    for (const input of now.querySelectorAll("input")) {
      const name = input.getAttribute("aria-label")
      input.value = typed.get(name) ?? input.value
      if (name === focused) { input.focus({preventScroll: true}) }
    }
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
