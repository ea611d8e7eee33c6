// The card of one vertex: its weights as bars, its nearest bones, where it belongs.

const CARD_STYLE = `
.vertex-card { pointer-events: auto; box-sizing: border-box; width: 100%; max-height: inherit;
  overflow: auto; padding: 12px 14px 13px; border-radius: 12px; font: 12.5px/1.4 Roboto,
  system-ui, sans-serif; color: var(--mui-palette-text-primary, #223);
  background: color-mix(in srgb, var(--mui-palette-background-paper, #fff) 92%, transparent);
  border: 1px solid var(--mui-palette-divider, #dde); backdrop-filter: blur(10px);
  box-shadow: 0 6px 24px rgba(10, 20, 40, .14); }
.vertex-card header { display: flex; align-items: baseline; gap: 8px; }
.vertex-card h2 { font-size: 14px; font-weight: 600; margin: 0; flex: 1; }
.vertex-card h3 { font-size: 11px; font-weight: 600; letter-spacing: .04em; margin: 13px 0 5px;
  color: var(--mui-palette-text-secondary, #667); display: flex; justify-content: space-between; }
.vertex-card h3 small { font-weight: 400; letter-spacing: 0; font-size: 11px; }
.vertex-card .quiet { color: var(--mui-palette-text-secondary, #667); font-size: 12px; }
.vertex-card .close { all: unset; cursor: pointer; width: 26px; height: 26px; margin: -4px -6px 0 0;
  border-radius: 6px; display: grid; place-items: center; font-size: 17px; line-height: 1;
  color: var(--mui-palette-text-secondary, #667); }
.vertex-card .close:hover { background: color-mix(in srgb, currentColor 12%, transparent); }
.vertex-card button:focus-visible { outline: 2px solid var(--mui-palette-primary-main, #147); }
.vertex-card .row { all: unset; box-sizing: border-box; display: grid; width: 100%; cursor: pointer;
  grid-template-columns: 92px 1fr 36px; gap: 8px; align-items: center; padding: 2px 4px;
  margin: 0 -4px; border-radius: 5px; }
.vertex-card .row:hover { background: color-mix(in srgb, currentColor 7%, transparent); }
.vertex-card .name { overflow: hidden; text-overflow: ellipsis; white-space: nowrap; }
.vertex-card .bars { display: block; }
.vertex-card .bar { display: block; height: 8px; border-radius: 4px; min-width: 2px; }
.vertex-card .bar + .bar { margin-top: 2px; height: 4px; background: none !important;
  box-shadow: inset 0 0 0 1.2px currentColor; opacity: .62; }
.vertex-card .dot { width: 8px; height: 8px; border-radius: 50%; flex: none; display: inline-block;
  margin-right: 7px; }
.vertex-card .value { text-align: right; font-variant-numeric: tabular-nums; }
.vertex-card .state { display: flex; align-items: baseline; margin: 12px 0 0; }
`

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

function row(model, {joint, name, color}, bars, value, spoken) {
  const made = element("button", "row")
  made.type = "button"
  made.title = `Choose ${name}`
  made.setAttribute("aria-label", spoken)
  const track = element("span", "bars")
  track.append(...bars)
  // What many names begin with ("mixamorig:") tells none of them apart, and there is little room.
  const short = name.replace(/^.*[:|](?=.)/, "")
  made.append(element("span", "name", short), track, element("span", "value", value))
  made.addEventListener("click", () => model.send_msg({type: "bone", joint}))
  return made
}

function card(model, facts) {
  const root = element("section", "vertex-card")
  root.setAttribute("aria-label", `Vertex ${facts.vertex}`)
  const header = element("header")
  const close = element("button", "close", "×")
  close.type = "button"
  close.setAttribute("aria-label", "Close the vertex")
  close.addEventListener("click", () => model.send_msg({type: "close"}))
  header.append(element("h2", "", `Vertex ${facts.vertex.toLocaleString("en")}`), close)
  root.append(header)
  if (!facts.computed) {
    root.append(element("div", "quiet", "Its weights come as soon as they are computed."))
    return root
  }
  const {number, of, vertices} = facts.component
  const part = of === 1 ? "The mesh is one part" : `Part ${number} of ${of} of the mesh`
  const size = `${vertices.toLocaleString("en")} ${vertices === 1 ? "vertex" : "vertices"}`
  root.append(element("div", "quiet", `${part} · ${size}`))

  const heading = element("h3", "", "Weights")
  if (facts.artist) { heading.append(element("small", "", "outlined: the file's own")) }
  root.append(heading)
  for (const bone of facts.weights) {
    const bars = [bar(bone.color, bone.ours)]
    let spoken = `${bone.name}: weight ${bone.ours.toFixed(2)}`
    if (facts.artist) {
      bars.push(bar(bone.color, bone.artist))
      spoken += `, in the file ${bone.artist.toFixed(2)}`
    }
    root.append(row(model, bone, bars, bone.ours.toFixed(2), spoken))
  }

  const distances = element("h3", "", "The nearest bones")
  distances.append(element("small", "", "distance; longest side = 1"))
  root.append(distances)
  const most = Math.max(...facts.distances.map(({distance}) => distance), 1e-12)
  for (const bone of facts.distances) {
    const {name, distance, color} = bone
    const spoken = `${name}: distance ${distance.toFixed(3)}`
    root.append(row(model, bone, [bar(color, distance / most)], distance.toFixed(3), spoken))
  }

  const state = element("div", "state")
  const dot = element("span", "dot")
  dot.style.background = facts.reached ? "#4c9a2a" : "#d9822b"
  const why = facts.reached ? "Reached through the body."
    : `It follows its nearest bones in a straight line: ${facts.reason}.`
  state.append(dot, element("span", "", why))
  root.append(state)
  return root
}

export function render({model}) {
  const root = document.createElement("div")
  root.style.maxHeight = "inherit"
  const style = document.createElement("style")
  style.textContent = CARD_STYLE
  const show = () => root.replaceChildren(style, ...(model.facts ? [card(model, model.facts)] : []))
  const escape = (e) => {
    if (e.key === "Escape" && model.facts) { model.send_msg({type: "close"}) }
  }
  document.addEventListener("keydown", escape)
  model.on("remove", () => document.removeEventListener("keydown", escape))
  model.on("facts", show)
  show()
  return root
}
