// The joints as a tree: one stop of the Tab key, the arrows walk in it, Space lets a joint carry
// weight or not.

import {element, focusIn, nameElement, span} from "../common/elements.js"
import {closedAtFirst, Forest} from "./forest.js"
import {stylesheet} from "../common/styles.js"

const styled = await stylesheet("widgets/joint_tree.css")

const LOCK = '<path d="M6 11h12v9H6zM8.5 11V8a3.5 3.5 0 0 1 7 0v3"/>'

const percent = (part) => part === null ? "–" : part === 0 ? "0" : part < 0.0005 ? "<.1"
  : (100 * part).toFixed(part < 0.0995 ? 1 : 0)

// The parts of a row after its box: `most` is the largest share of all joints.
function contents(row, most) {
  const {name, short, why, color, control, locked, gain, ours, file} = row
  const own = {"--own": color}
  const shares = [["ours", ours], ["file", file]].filter(([, part]) => part !== null)
  const bars = shares.map(([className, part]) => element("i", {
    className, style: {...own, width: `${100 * Math.min(1, part / most)}%`},
  }))
  const lock = {className: "lock", icon: LOCK, title: "Lock to file weights"}
  return [
    element("span", {className: control ? "chip control" : "chip", style: own}),
    Object.assign(nameElement(short), {title: why ? `${name}: ${why}` : name}),
    ...locked ? [element("span", lock)] : [],
    ...gain !== 1 ? [span("gain", `×${Number(gain.toPrecision(2))}`)] : [],
    element("span", {className: "bars", title: spoken(row).slice(1).join(", ")}, ...bars),
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
  let top = 0  // heard, not asked for: to ask makes the browser lay out the whole page at once
  const list = element("div", {
    className: "tree", aria: {role: "tree", label: "Joints", describedby: "how"},
    on: {scroll: () => { top = list.scrollTop }, keydown: (e) => press(e)},
  })
  const group = {role: "group", label: "Doubtful joints"}
  const doubts = element("div", {className: "doubts", aria: group})
  const title = "Space or click: deforms or not. Arrows walk, open and close."
  const root = element("div", {}, styled(), doubts,
    element("div", {className: "head", title}, span("", "✓ deforms"), span("", "% of the skin")),
    list, element("div", {id: "how", hidden: true},
      "Enter chooses, Space lets a joint carry weight or not"))
  let forest = new Forest([], new Set())
  let names = ""
  let cursor = -1
  const item = (i) => {
    const row = forest.rows[i]
    const {joint, level, carries, changed} = row
    const parent = forest.hasChildren(i)
    const stopping = (act) => (e) => { e.stopPropagation(); act(i) }
    const made = element("div", {
      className: carries ? "item" : "item idle", on: {click: () => choose(i)},
      style: {"padding-left": `${4 + 6 * Math.min(level, 8)}px`},
      aria: {
        role: "treeitem", level: level + 1, checked: carries, label: spoken(row).join(", "),
        ...parent ? {expanded: !forest.closed.has(joint)} : {},
      },
    }, element("span", {className: "twist", on: {click: stopping(toggle)}}, parent ? "▾" : ""),
    element("span", {
      className: changed ? "box changed" : "box", on: {click: stopping(carry)},
      title: carries ? "Deforms the mesh" : "Does not deform the mesh",
    }, carries ? "✓" : ""), ...contents(row, most))
    made.dataset.joint = joint
    return made
  }

  const doubtful = ({joint, name, short, why, carries, ours}) => element("label",
    {className: "item"}, element("input", {
      type: "checkbox", checked: carries, aria: {role: "switch", label: `${name} deforms the mesh`},
      on: {change: (e) => model.send_msg({type: "carry", joint, on: e.target.checked})},
    }), nameElement(short), span("why", why), span("share", percent(ours)))

  let most = 1
  const fill = () => {
    const {rows} = model
    const now = rows.map(({joint, name}) => `${joint} ${name}`).join("\n")
    const held = focusIn(root)?.getAttribute("role") === "treeitem"
    forest = new Forest(rows, now === names ? forest.closed : closedAtFirst(rows))
    if (now !== names && model.chosen >= 0) { forest.reveal(model.chosen) }
    names = now
    most = Math.max(1e-9, ...rows.map(({ours, file}) => Math.max(ours ?? 0, file ?? 0)))
    const listed = rows.filter((row) => row.doubtful).sort((a, b) => (b.ours ?? 0) - (a.ours ?? 0))
    const head = element("div", {className: "head"},
      span("", "Doubtful joints"), span("", "% of the skin"))
    doubts.replaceChildren(...listed.length ? [head, ...listed.map(doubtful)] : [])
    draw(held)
  }
  const draw = (held) => {
    const was = top
    if (!forest.at.has(cursor)) {
      cursor = forest.at.has(model.chosen) ? model.chosen : forest.rows[0]?.joint ?? -1
    }
    list.replaceChildren(...forest.seen().map(item))
    if (was) { list.scrollTop = was }
    mark()
    if (held) { focus(cursor) }
  }
  const mark = () => {
    for (const one of /** @type {NodeListOf<HTMLElement>} */ (list.querySelectorAll(".item"))) {
      const joint = Number(one.dataset.joint)
      one.setAttribute("aria-selected", String(joint === model.chosen))
      one.tabIndex = joint === cursor ? 0 : -1
    }
  }
  /** @returns {HTMLElement | null} */
  const find = (joint) => list.querySelector(`[data-joint="${joint}"]`)
  const show = (one) => {
    if (!one) { return }
    const above = one.offsetTop - list.scrollTop
    const below = above + one.offsetHeight - list.clientHeight
    if (above < 0) { list.scrollTop += above - 40 }
    if (below > 0) { list.scrollTop += below + 40 }
  }
  const focus = (joint) => {
    cursor = joint
    mark()
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
    cursor = joint
    draw(true)
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
    const held = focusIn(root)?.getAttribute("role") === "treeitem"
    if (!held) { cursor = model.chosen }
    draw(held)
    show(find(model.chosen))
  })
  fill()
  requestAnimationFrame(() => show(find(model.chosen)))
  return root
}
