// The joints as a tree: one stop of the Tab key, the arrows walk in it, Space lets a joint carry
// weight or not.

import {nameElement} from "./elements.js"
import {closedAtFirst, Forest} from "./forest.js"
import {stylesheet} from "./styles.js"

const styled = await stylesheet("joint_tree.css")

const LOCK = '<svg viewBox="0 0 24 24" aria-hidden="true"><path d="M6 11h12v9H6zM8.5 11V8a3.5 3.5 0 0 1 7 0v3"/></svg>'

function element(tag, className, text, parent) {
  const made = document.createElement(tag)
  made.className = className
  if (text) { made.textContent = text }
  parent?.append(made)
  return made
}

const percent = (part) => part === null ? "–" : part === 0 ? "0" : part < 0.0005 ? "<.1"
  : (100 * part).toFixed(part < 0.0995 ? 1 : 0)

export function render({model}) {
  const root = document.createElement("div")
  const list = element("div", "tree")
  list.setAttribute("role", "tree")
  list.setAttribute("aria-label", "Joints")
  list.setAttribute("aria-describedby", "how")
  const head = element("div", "head")
  element("span", "", "✓ deforms", head)
  element("span", "", "% of the skin", head)
  const how = element("div", "", "Enter chooses, Space lets a joint carry weight or not")
  Object.assign(how, {id: "how", hidden: true})
  root.append(styled(), head, list, how)
  head.title = "Space or click: deforms or not. Arrows walk, open and close."
  let forest = new Forest([], new Set())
  let names = ""
  let cursor = -1
  let top = 0  // heard, not asked for: to ask makes the browser lay out the whole page at once
  list.addEventListener("scroll", () => { top = list.scrollTop })

  const item = (i) => {
    const row = forest.rows[i]
    const made = element("div", "item")
    made.setAttribute("role", "treeitem")
    made.dataset.joint = row.joint
    made.setAttribute("aria-level", row.level + 1)
    made.setAttribute("aria-checked", row.carries)
    if (forest.hasChildren(i)) { made.setAttribute("aria-expanded", !forest.closed.has(row.joint)) }
    made.classList.toggle("idle", !row.carries)
    made.style.paddingLeft = `${4 + 6 * Math.min(row.level, 8)}px`
    const twist = element("span", "twist", forest.hasChildren(i) ? "▾" : "", made)
    twist.addEventListener("click", (e) => { e.stopPropagation(); toggle(i) })
    const box = element("span", "box", row.carries ? "✓" : "", made)
    box.classList.toggle("changed", row.changed)
    box.title = row.carries ? "Deforms the mesh" : "Does not deform the mesh"
    box.addEventListener("click", (e) => { e.stopPropagation(); carry(i) })
    const chip = element("span", row.control ? "chip control" : "chip", "", made)
    chip.style.setProperty("--own", row.color)
    const name = nameElement(row.short)
    made.append(name)
    name.title = row.why ? `${row.name}: ${row.why}` : row.name
    if (row.locked) {
      const lock = element("span", "lock", "", made)
      lock.innerHTML = LOCK
      lock.title = "Lock to file weights"
    }
    if (row.gain !== 1) { element("span", "gain", `×${Number(row.gain.toPrecision(2))}`, made) }
    const bars = element("span", "bars", "", made)
    for (const [kind, part] of [["ours", row.ours], ["file", row.file]]) {
      if (part === null) { continue }
      const bar = element("i", kind, "", bars)
      bar.style.width = `${100 * Math.min(1, part / most)}%`
      bar.style.setProperty("--own", row.color)
    }
    element("span", "share", percent(row.ours ?? row.file), made)
    const says = [row.name]
    if (row.control) { says.push("control") }
    if (row.ours !== null) { says.push(`${percent(row.ours)}% of the skin`) }
    if (row.file !== null) { says.push(`${percent(row.file)}% in the file`) }
    if (row.locked) { says.push("locked") }
    made.setAttribute("aria-label", says.join(", "))
    bars.title = says.slice(1).join(", ")
    made.addEventListener("click", () => choose(i))
    return made
  }

  let most = 1
  const fill = () => {
    const {rows} = model
    const now = rows.map(({joint, name}) => `${joint} ${name}`).join("\n")
    const held = root.getRootNode().activeElement?.getAttribute("role") === "treeitem"
    forest = new Forest(rows, now === names ? forest.closed : closedAtFirst(rows))
    if (now !== names && model.chosen >= 0) { forest.reveal(model.chosen) }
    names = now
    most = Math.max(1e-9, ...rows.map(({ours, file}) => Math.max(ours ?? 0, file ?? 0)))
    draw(held)
  }
  const draw = (held) => {
    const was = top
    if (!forest.at.has(cursor)) { cursor = forest.at.has(model.chosen) ? model.chosen : forest.rows[0]?.joint ?? -1 }
    list.replaceChildren(...forest.seen().map(item))
    if (was) { list.scrollTop = was }
    mark()
    if (held) { focus(cursor) }
  }
  const mark = () => {
    for (const one of list.children) {
      const joint = Number(one.dataset.joint)
      one.setAttribute("aria-selected", joint === model.chosen)
      one.tabIndex = joint === cursor ? 0 : -1
    }
  }
  const find = (joint) => list.querySelector(`[data-joint="${joint}"]`)
  const show = (one) => {
    if (!one) { return }
    const [above, below] = [one.offsetTop - list.scrollTop, one.offsetTop + one.offsetHeight - list.scrollTop]
    if (above < 0) { list.scrollTop += above - 40 }
    if (below > list.clientHeight) { list.scrollTop += below - list.clientHeight + 40 }
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
    model.send_msg({type: "choose", joint: forest.rows[i].joint})
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

  list.addEventListener("keydown", (e) => {
    if (e.ctrlKey || e.metaKey || e.altKey) { return }
    const seen = forest.seen()
    const i = forest.at.get(cursor)
    const place = seen.indexOf(i)
    const open = forest.hasChildren(i) && !forest.closed.has(cursor)
    const go = (k) => { if (k >= 0 && k < forest.rows.length) { focus(forest.rows[k].joint) } }
    const acts = {
      ArrowDown: () => go(seen[place + 1] ?? -1),
      ArrowUp: () => go(seen[place - 1] ?? -1),
      ArrowRight: () => open ? go(i + 1) : toggle(i, true),
      ArrowLeft: () => open ? toggle(i, false) : go(forest.parent(i)),
      Home: () => go(seen[0]),
      End: () => go(seen.at(-1)),
      Enter: () => choose(i),
      " ": () => carry(i),
    }
    if (!acts[e.key]) { return }
    e.preventDefault()
    e.stopPropagation()
    acts[e.key]()
  })
  model.on("rows", fill)
  model.on("chosen", () => {
    forest.reveal(model.chosen)
    const held = root.getRootNode().activeElement?.getAttribute("role") === "treeitem"
    if (!held) { cursor = model.chosen }
    draw(held)
    show(find(model.chosen))
  })
  fill()
  requestAnimationFrame(() => show(find(model.chosen)))
  return root
}
