// The first things that Tab reaches: links over the sidebar's controls.

import {element} from "../common/elements.js"

const PLACE = "position: fixed; z-index: 2000; left: 12px; padding: 8px 14px; border-radius: 8px;"
  + "outline: 2px solid #e05a00; font: 500 14px Roboto, system-ui, sans-serif; color: #1f2632;"
  + "background: #fff;"

// Returns a function that removes the link. Its target is in a shadow tree, which addresses do not
// reach: an empty element in the page marks it.
export function skipLink(id, text, findTarget) {
  const mark = element("span", {id})
  const go = (e) => { e.preventDefault(); findTarget().focus() }
  const on = {focus: () => show(true), blur: () => show(false), click: go}
  const link = element("a", {href: `#${id}`, on}, text)
  const show = (seen) => { link.style.cssText = PLACE + `top: ${seen ? 8 : -80}px` }
  show(false)
  document.body.prepend(link)
  document.body.append(mark)
  return () => { link.remove(); mark.remove() }
}
