// Elements of the page, each made in one expression. Texts are texts, never HTML.

// Properties of the element; beside them `aria`: its role and attributes of ARIA, `on`: what hears
// its events, `icon`: what an SVG of 24 by 24 units holds.
export function element(tag, {aria = {}, on = {}, icon, ...properties} = {}, ...children) {
  const made = Object.assign(document.createElement(tag), properties)
  for (const [name, value] of Object.entries(aria)) {
    made.setAttribute(name === "role" ? name : `aria-${name}`, value)
  }
  for (const [type, act] of Object.entries(on)) { made.addEventListener(type, act) }
  if (icon) { made.innerHTML = `<svg viewBox="0 0 24 24" aria-hidden="true">${icon}</svg>` }
  made.append(...children)
  return made
}

const TAIL = 7  // letters at the end of a name that are always seen

// A name that a narrow box shortens in the middle: what tells joints apart is often at its end.
export function nameElement(text) {
  const [start, tail] = [text.slice(0, -TAIL), text.slice(-TAIL)]
  const parts = [["start", start], ["tail", tail]]
  return element("span", {className: "name"}, ...parts.map(([className, textContent]) => element("span", {className, textContent})))
}

export const button = (about, ...children) => element("button", {type: "button", ...about}, ...children)
