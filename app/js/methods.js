// The table of methods: which are seen, and how good they are.

const METHODS_STYLE = `
:host { display: block; }
table { border-collapse: collapse; width: 100%; font: 12.5px/1.3 Roboto, system-ui, sans-serif;
  color: var(--mui-palette-text-primary, #223); }
th { font-weight: 500; font-size: 11px; color: var(--mui-palette-text-secondary, #667);
  text-align: right; padding: 2px 0 4px 6px; }
th:first-child { text-align: left; padding-left: 0; }
td { padding: 0 0 0 6px; text-align: right; font-variant-numeric: tabular-nums; vertical-align: top;
  padding-top: 6px; white-space: nowrap; }
td:first-child { padding: 0; text-align: left; white-space: normal; }
label { display: flex; gap: 8px; align-items: flex-start; padding: 5px 0; cursor: pointer; }
input { margin: 1px 0 0; width: 15px; height: 15px; flex: none;
  accent-color: var(--mui-palette-primary-main, #147); }
tr.idle td { color: var(--mui-palette-text-secondary, #667); }
tr:has(input:disabled) label { cursor: default; }
tr:has(:focus-visible) { outline: 2px solid var(--mui-palette-primary-main, #147); }
tbody tr + tr:not(.note) td { border-top: 1px solid var(--mui-palette-divider, #8883); }
.note td:first-child { padding: 0 0 7px 23px; font-size: 11px; overflow-wrap: anywhere;
  color: var(--mui-palette-text-secondary, #667); }
.note.failed td:first-child { color: var(--mui-palette-error-main, #b3261e); }
td.best { font-weight: 600; }
.ring { display: inline-block; width: 9px; height: 9px; margin-right: 5px; border-radius: 50%;
  border: 2px solid var(--mui-palette-primary-main, #147); border-top-color: transparent;
  vertical-align: -1px; animation: turn .9s linear infinite; }
@keyframes turn { to { transform: rotate(1turn) } }
@media (prefers-reduced-motion: reduce) { .ring { animation: none; } }
`

export function render({model}) {
  const style = document.createElement("style")
  style.textContent = METHODS_STYLE
  const table = document.createElement("table")
  table.setAttribute("aria-label", model.label)
  const cell = (row, tag, text, title) => {
    const made = row.appendChild(document.createElement(tag))
    made.textContent = text
    if (title) { made.title = title }
    return made
  }
  const fill = () => {
    const held = table.querySelector("input:focus")?.name
    const head = document.createElement("thead")
    const top = head.appendChild(document.createElement("tr"))
    cell(top, "th", "Method").scope = "col"
    for (const [text, title] of model.columns) { cell(top, "th", text, title).scope = "col" }
    const body = document.createElement("tbody")
    for (const {id, title, values, best, note, state, chosen, fixed} of model.rows) {
      const row = body.appendChild(document.createElement("tr"))
      row.className = chosen ? "chosen" : "idle"
      const first = cell(row, "td", "")
      const label = first.appendChild(document.createElement("label"))
      const box = label.appendChild(document.createElement("input"))
      Object.assign(box, {type: "checkbox", name: id, checked: chosen, disabled: fixed})
      label.append(title)
      if (fixed) { label.title = chosen ? "Two stay at least" : "Four at most: take one away first" }
      box.addEventListener("change", () => model.send_msg({id, on: box.checked}))
      values.forEach((value, i) => {
        cell(row, "td", value).className = best[i] ? "best" : ""
      })
      if (note) {
        const below = body.appendChild(document.createElement("tr"))
        below.className = `note ${state}`
        const words = cell(below, "td", note)
        words.colSpan = 1 + values.length
        words.id = `note-${id}`
        box.setAttribute("aria-describedby", words.id)
        if (state === "running") {
          words.prepend(Object.assign(document.createElement("i"), {className: "ring"}))
        }
      }
    }
    table.replaceChildren(head, body)
    if (held) { table.querySelector(`input[name="${CSS.escape(held)}"]`)?.focus() }
  }
  model.on("rows", fill)
  model.on("columns", fill)
  fill()
  const root = document.createElement("div")
  root.append(style, table)
  return root
}
