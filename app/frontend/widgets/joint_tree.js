// The joints as a tree: one stop of the Tab key, the arrows walk in it, Space lets a joint carry
// weight or not.

import {element} from "../common/elements.js"
import {h, icon, nameOf, span} from "../common/nodes.js"
import {closedAtFirst, Forest} from "./forest.js"
import {render as renderNodes} from "../vendor/preact.js"
import {stylesheet} from "../common/styles.js"

const styled = await stylesheet("widgets/joint_tree.css")

const LOCK = '<path d="M6 11h12v9H6zM8.5 11V8a3.5 3.5 0 0 1 7 0v3"/>'
const HELP = "Space or click: deforms or not. Arrows walk, open and close."

const percent = (part) => part === null ? "–" : part === 0 ? "0" : part < 0.0005 ? "<.1"
  : (100 * part).toFixed(part < 0.0995 ? 1 : 0)

// The parts of a row after its box: `most` is the largest share of all joints.
function contents(row, most) {
  const {name, short, why, color, control, locked, gain, ours, file} = row
  const own = {"--own": color}
  const bars = [["ours", ours], ["file", file]].map(([kind, part]) => part !== null
    && h("i", {class: kind, style: {...own, width: `${100 * Math.min(1, part / most)}%`}}))
  return [
    h("span", {class: control ? "chip control" : "chip", style: own}),
    nameOf(short, why ? `${name}: ${why}` : name),
    locked && h("span", {class: "lock", title: "Lock to file weights"}, icon(LOCK)),
    gain !== 1 && span("gain", `×${Number(gain.toPrecision(2))}`),
    h("span", {class: "bars", title: spoken(row).slice(1).join(", ")}, ...bars),
    span("share", percent(ours ?? file)),
  ]
}

// What a screen reader tells of a row.
function spoken({name, control, ours, file, locked}) {
  const says = [name]
  if (control) { says.push("control") }
  if (ours !== null) { says.push(`${percent(ours)}% of the skin`) }
  if (file !== null) { says.push(`${percent(file)}% in the file`) }
  if (locked) { says.push("locked") }
  return says
}

/** @param {{model: Model}} widget */
export function render({model}) {
  const root = element("div")
  let forest = new Forest([], new Set())
  let names = ""
  let cursor = -1
  let most = 1

  const item = (i) => {
    const row = forest.rows[i]
    const {joint, level, carries, changed} = row
    const parent = forest.hasChildren(i)
    const stopping = (act) => (e) => { e.stopPropagation(); act(i) }
    return h("div", {
      "key": joint, "class": carries ? "item" : "item idle", "role": "treeitem",
      "style": {paddingLeft: `${4 + 6 * Math.min(level, 8)}px`}, "onclick": () => choose(i),
      "aria-level": level + 1, "aria-checked": String(carries),
      "aria-selected": String(joint === model.chosen), "aria-label": spoken(row).join(", "),
      "aria-expanded": parent ? String(!forest.closed.has(joint)) : null,
      "tabindex": joint === cursor ? 0 : -1, "data-joint": joint,
    }, h("span", {class: "twist", onclick: stopping(toggle)}, parent ? "▾" : ""),
    h("span", {
      class: changed ? "box changed" : "box", onclick: stopping(carry),
      title: carries ? "Deforms the mesh" : "Does not deform the mesh",
    }, carries ? "✓" : ""), contents(row, most))
  }

  const doubtful = ({joint, name, short, why, carries, ours}) => h("label",
    {key: joint, class: "item"}, h("input", {
      "type": "checkbox", "role": "switch", "checked": carries,
      "aria-label": `${name} deforms the mesh`,
      "onchange": (e) => model.send_msg({type: "carry", joint, on: e.target.checked}),
    }), nameOf(short), span("why", why), span("share", percent(ours)))

  const draw = () => {
    if (!forest.at.has(cursor)) {
      cursor = forest.at.has(model.chosen) ? model.chosen : forest.rows[0]?.joint ?? -1
    }
    const doubts = model.rows.filter((row) => row.doubtful)
      .sort((a, b) => (b.ours ?? 0) - (a.ours ?? 0))
    renderNodes([
      h("div", {"class": "doubts", "role": "group", "aria-label": "Doubtful joints"},
        doubts.length ? h("div", {class: "head"},
          span("", "Doubtful joints"), span("", "% of the skin")) : null, doubts.map(doubtful)),
      h("div", {class: "head", title: HELP}, span("", "✓ deforms"), span("", "% of the skin")),
      h("div", {
        "class": "tree", "role": "tree", "aria-label": "Joints", "aria-describedby": "how",
        "onkeydown": press,
      }, forest.seen().map(item)),
      h("div", {id: "how", hidden: true}, "Enter chooses, Space lets a joint carry weight or not"),
    ], root)
  }
  const fill = () => {
    const {rows} = model
    const now = rows.map(({joint, name}) => `${joint} ${name}`).join("\n")
    forest = new Forest(rows, now === names ? forest.closed : closedAtFirst(rows))
    if (now !== names && model.chosen >= 0) { forest.reveal(model.chosen) }
    names = now
    most = Math.max(1e-9, ...rows.map(({ours, file}) => Math.max(ours ?? 0, file ?? 0)))
    draw()
  }
  /** @returns {HTMLElement | null} */
  const find = (joint) => root.querySelector(`[data-joint="${joint}"]`)
  const show = (one) => {
    if (!one) { return }
    const list = one.parentElement
    const above = one.offsetTop - list.scrollTop
    const below = above + one.offsetHeight - list.clientHeight
    if (above < 0) { list.scrollTop += above - 40 }
    if (below > 0) { list.scrollTop += below + 40 }
  }
  const focus = (joint) => {
    cursor = joint
    draw()
    const one = find(joint)
    one?.focus({preventScroll: true})
    show(one)
  }
  const choose = (i) => {
    focus(forest.rows[i].joint)
    model.send_msg({type: "pick", joint: forest.rows[i].joint})
  }
  const carry = (i) => {
    const {joint, carries} = forest.rows[i]
    model.send_msg({type: "carry", joint, on: !carries})
  }
  const toggle = (i, open) => {
    const {joint} = forest.rows[i]
    if (!forest.hasChildren(i)) { return }
    const close = open === undefined ? !forest.closed.has(joint) : !open
    if (close) { forest.closed.add(joint) } else { forest.closed.delete(joint) }
    focus(joint)
  }

  const press = (e) => {
    if (e.ctrlKey || e.metaKey || e.altKey) { return }
    const seen = forest.seen()
    const i = forest.at.get(cursor)
    const place = seen.indexOf(i)
    const open = forest.hasChildren(i) && !forest.closed.has(cursor)
    const go = (k) => { if (k >= 0 && k < forest.rows.length) { focus(forest.rows[k].joint) } }
    const acts = {
      "ArrowDown": () => go(seen[place + 1] ?? -1),
      "ArrowUp": () => go(seen[place - 1] ?? -1),
      "ArrowRight": () => open ? go(i + 1) : toggle(i, true),
      "ArrowLeft": () => open ? toggle(i, false) : go(forest.parent(i)),
      "Home": () => go(seen[0]),
      "End": () => go(seen.at(-1)),
      "Enter": () => choose(i),
      " ": () => carry(i),
    }
    if (!acts[e.key]) { return }
    e.preventDefault()
    e.stopPropagation()
    acts[e.key]()
  }
  model.on("rows", fill)
  model.on("chosen", () => {
    forest.reveal(model.chosen)
    if (!find(cursor)?.matches(":focus")) { cursor = model.chosen }
    draw()
    show(find(model.chosen))
  })
  fill()
  requestAnimationFrame(() => show(find(model.chosen)))
  return element("div", {}, styled(), root)
}
