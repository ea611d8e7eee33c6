// A histogram whose bars are chosen by clicks, by dragging across them, or by keys and Shift.

import {button, element, renew, span} from "../common/elements.js"
import {stylesheet} from "../common/styles.js"

const styled = await stylesheet("tables/histogram.css")
const LOWEST = 4  // percent of the height, of bars with anything in them

/** @param {{model: Model}} widget */
export function render({model}) {
  const bars = element("div", {className: "bars", role: "group"})
  let begun = null, ended = null
  const choose = (a, b) =>
    model.send_msg({type: "pick-bars", first: Math.min(a, b), last: Math.max(a, b)})
  const numberAt = (e) => {
    const {left, width} = bars.getBoundingClientRect()
    const at = Math.floor((e.clientX - left) / width * model.bars.length)
    return Math.min(Math.max(at, 0), model.bars.length - 1)
  }
  bars.addEventListener("pointerdown", (e) => {
    ended = numberAt(e)
    begun = e.shiftKey && model.chosen.length ? model.chosen[0] : ended
    bars.setPointerCapture(e.pointerId)
    choose(begun, ended)
  })
  bars.addEventListener("pointermove", (e) => {
    if (begun === null || numberAt(e) === ended) { return }
    ended = numberAt(e)
    choose(begun, ended)
  })
  for (const type of ["pointerup", "pointercancel"]) {
    bars.addEventListener(type, () => { begun = null })
  }
  const fill = () => {
    const most = Math.max(1, ...model.bars.map(([, count]) => count))
    bars.setAttribute("aria-label", model.label)
    bars.hidden = !model.bars.length
    renew(bars, ...model.bars.map(([range, count], i) => {
      const bar = element("i")
      bar.style.height = `${count ? Math.max(100 * count / most, LOWEST) : 0}%`
      const label = `${range}: ${count.toLocaleString("en")}`
      // Pointers are heard by the whole; keys press the button.
      const click = (e) => {
        if (e.detail) { return }
        choose(e.shiftKey && model.chosen.length ? model.chosen[0] : i, i)
      }
      return button({title: label, aria: {label}, on: {click}}, bar)
    }))
    mark()
  }
  const mark = () => [...bars.children].forEach((one, i) => {
    const [first, last] = model.chosen
    one.setAttribute("aria-pressed", String(first <= i && i <= last))
  })
  model.on("bars", fill)
  model.on("chosen", mark)
  fill()
  const ends = element("div", {className: "ends"}, span("", "0"), span("", "1"))
  return element("div", {}, styled(), bars, ends)
}
