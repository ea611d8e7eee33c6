// Elements of the page, each made in one expression. Texts are texts, never HTML.

/**
 * Properties of the element; beside them `aria`: its role and attributes of ARIA, `style`: its own
 * rules of CSS, `on`: what hears its events, `icon`: the contents of an SVG of 24 by 24 units.
 * @template {keyof HTMLElementTagNameMap} T
 * @param {T} tag
 * @param {Record<string, any>} [about]
 * @param {...(Node | string)} children
 * @returns {HTMLElementTagNameMap[T]}
 */
export function element(tag, about = {}, ...children) {
  const {aria = {}, style = {}, on = {}, icon, ...properties} = about
  const made = Object.assign(document.createElement(tag), properties)
  for (const [name, value] of Object.entries(aria)) {
    made.setAttribute(name === "role" ? name : `aria-${name}`, String(value))
  }
  for (const [name, value] of Object.entries(style)) { made.style.setProperty(name, value) }
  for (const [type, act] of Object.entries(on)) { made.addEventListener(type, act) }
  if (icon) { made.innerHTML = svg(icon) }
  made.append(...children)
  return made
}

export const svg = (icon) => `<svg viewBox="0 0 24 24" aria-hidden="true">${icon}</svg>`

/** @param {Record<string, any>} about @param {...(Node | string)} children */
export const button = (about, ...children) =>
  element("button", {type: "button", ...about}, ...children)

/** @param {string} className @param {...(Node | string)} children */
export const span = (className, ...children) => element("span", {className}, ...children)

/**
 * The elements that receive a key, from the innermost out. An element that was just hidden keeps
 * the focus until the next frame; its keys belong to the page, so there are none then.
 * @param {KeyboardEvent} event
 * @returns {HTMLElement[]}
 */
export function elementsWithKey(event) {
  const path = /** @type {HTMLElement[]} */ (
    event.composedPath().filter((part) => part instanceof Element))
  return path[0]?.checkVisibility() ? path : []
}

/** Where a pointer is, from the upper left corner of an element. @param {Element} element */
export function within(element, {clientX, clientY}) {
  const {left, top} = element.getBoundingClientRect()
  return [clientX - left, clientY - top]
}

/** Where on the page a place of an element is. @param {Element} element @param {number[]} at */
export function onPage(element, [x, y]) {
  const {left, top} = element.getBoundingClientRect()
  return [x + left, y + top]
}
